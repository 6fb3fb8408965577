//! Rows that `cophase run --udp` sends, at a receiver's socket.
//!
//! The scene is simulated twice, to get its edges, but its rows must be sent once. There are few rows, so that the system
//! buffers them all until the receiver reads them.

use std::collections::BTreeMap;
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use cophase_files::trace::WRITTEN_BY;
use serde_json::Value;

fn cophase(out: &Path, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cophase"))
        .args(["run", "lost-steps", "--every", "500", "--out"])
        .arg(out)
        .args(options)
        .output()
        .expect("the command starts")
}

/// The rows of `trace.csv`, each by column, without those of the command that wrote it.
fn rows(out: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(out.join("trace.csv")).expect("a trace");
    let rows = reader.deserialize().collect::<Result<Vec<_>, _>>();
    let mut rows: Vec<BTreeMap<_, _>> = rows.expect("rows of the header's length");
    for row in &mut rows {
        row.retain(|name: &String, _| !WRITTEN_BY.contains(&name.as_str()));
    }
    rows
}

/// Returns the line of the summary about the rows sent.
fn sent(output: &Output) -> &str {
    let text = std::str::from_utf8(&output.stdout).expect("UTF-8");
    let line = text.lines().find(|line| line.starts_with("Sent to "));
    line.unwrap_or_else(|| panic!("nothing about what was sent: {text}"))
}

/// If this fails, a live plot lacks rows, or shows other numbers than the table of the same run.
#[test]
fn a_receiver_gets_each_row_of_the_table_once() {
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let address = receiver.local_addr().expect("an address").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let output = cophase(folder.path(), &["--udp", &address]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");

    receiver.set_nonblocking(true).expect("a socket's option");
    let mut datagrams = Vec::new();
    let mut buffer = [0; 65_536];
    while let Ok(length) = receiver.recv(&mut buffer) {
        let value: Value = serde_json::from_slice(&buffer[..length]).expect("JSON");
        datagrams.push(value);
    }
    let rows = rows(folder.path());
    assert!(rows.len() > 40, "{} rows", rows.len());
    assert_eq!(datagrams.len(), rows.len());
    for (datagram, row) in datagrams.iter().zip(&rows) {
        let object = datagram.as_object().expect("an object");
        assert_eq!(object["timestamp"], object["t_s"]);
        assert_eq!(
            object.len(),
            row.len() + 1,
            "each column, and the timestamp"
        );
        for (name, field) in row {
            match &object[name] {
                Value::String(word) => assert_eq!(word, field, "{name}"),
                number => assert_eq!(number.as_f64(), field.parse().ok(), "{name}"),
            }
        }
    }
    let expected = format!("Sent to {address}: {} rows, 0 of them lost.", rows.len());
    assert_eq!(sent(&output), expected);
}

/// If this fails, a user gets no reason for an empty plot, or a run fails because it has no receiver.
#[cfg(target_os = "linux")] // on Linux, loopback reports at once that there is no receiver
#[test]
fn rows_without_a_receiver_are_counted_as_lost() {
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let address = receiver.local_addr().expect("an address").to_string();
    drop(receiver);
    let folder = tempfile::tempdir().expect("a folder");
    let output = cophase(folder.path(), &["--udp", &address]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let rows = rows(folder.path()).len();
    let expected = format!("Sent to {address}: {rows} rows, {rows} of them lost.");
    assert_eq!(sent(&output), expected);
}

/// If this fails, a live plot ends before the user can see it move.
#[test]
fn a_real_time_run_takes_the_simulated_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let began = Instant::now();
    let output = cophase(folder.path(), &["--real-time=5"]);
    let took = began.elapsed();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let last = rows(folder.path()).pop().expect("rows");
    let simulated_s: f64 = last["t_s"].parse().expect("a time");
    assert!(simulated_s > 10.0, "{simulated_s} s");
    assert!(
        took >= Duration::from_secs_f64(simulated_s / 5.0),
        "{took:?}"
    );
}

/// If this fails, a misspelt receiver is treated as one that is absent, or a folder is written before the refusal.
#[test]
fn invalid_receivers_and_factors_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    for (option, right) in [
        ("--udp=127.0.0.1", "127.0.0.1:9870"),
        ("--udp=127.0.0.1:0", "127.0.0.1:9870"),
        ("--udp=:9870", "127.0.0.1:9870"),
        ("--udp=127.0.0.1:70000", "127.0.0.1:9870"),
        ("--real-time=0", "0.001 to 1000"),
        ("--real-time=-1", "0.001 to 1000"),
        ("--real-time=fast", "0.001 to 1000"),
    ] {
        let output = cophase(&out, &[option]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{option}: {message}");
        assert!(message.contains(right), "{option}: {message}");
        assert!(!out.exists(), "{option}");
    }
}
