//! `cophase link record` against `cophase run`: the same loop and the same machine write the same files.

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use cophase_link::client::Client;
use cophase_link::message::Message;
use cophase_link::server::Hub;
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::live::SimulatedDevice;

use assert_cmd::Command;

/// A scene with everything that edges depend on: phase offsets that move, a reversed axis, a gear and a
/// motor of its own.
const SCENE: &str = r#"
name = "recorded"
fidelity = "kinematic"
[machine]
allow_commanded_tilt = true
crank_radius_mm = 20
lambda = 0.3
load_kg = 5
[control]
settle_s = 0.05
[limits]
speed_hz = 8
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 2000
homing_speed_hz = 5
[axes]
count = 3
drive = "stepper"
steps_per_turn = 400
trim_rate_deg_per_s = 40
[drift]
tilt_limit_mrad = 20
[[axis]]
number = 0
trim_deg = -4.5
[[axis]]
number = 1
reversed = true
[[axis]]
number = 2
steps_per_turn = 1000
gear = [2, 3]
index = false
[[program]]
amax_g = 5
ramp_s = 0.5
hold_s = 0.3
[[program]]
amax_g = 1
ramp_s = 0.3
hold_s = 0.1
"#;

/// Columns that a controller cannot measure.
const UNKNOWN: [&str; 9] = [
    "actual_turns_0",
    "actual_turns_1",
    "actual_turns_2",
    "tilt_x_mrad",
    "tilt_y_mrad",
    "warp_deg",
    "z_m",
    "accel_mps2",
    "amax_actual_mps2",
];

fn cophase() -> Command {
    let mut command = Command::cargo_bin("cophase").unwrap();
    command.timeout(Duration::from_secs(120));
    command
}

/// Writes the scene to a file in a new folder.
fn scene() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, SCENE).unwrap();
    (folder, path)
}

fn record(scene: &Path, out: &Path, options: &[&str]) -> String {
    let to = format!("sim:{}", scene.display());
    let mut command = cophase();
    command
        .args(["link", "record", "--to", &to, "--out"])
        .arg(out);
    let done = command.args(options).assert().success();
    String::from_utf8(done.get_output().stdout.clone()).unwrap()
}

/// Returns the exit status and the result of the comparison, from the start command on.
fn compare(a: &Path, b: &Path) -> (i32, serde_json::Value) {
    let mut command = cophase();
    command.arg("compare").args([a, b]);
    let output = command
        .args(["--from", "start", "--json"])
        .output()
        .unwrap();
    let found = serde_json::from_slice(&output.stdout);
    (output.status.code().unwrap(), found.unwrap())
}

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap()
}

/// If this fails, a recorded run cannot be compared with a simulated one.
#[test]
fn a_recording_equals_the_run_of_its_scene() {
    let (folder, scene) = scene();
    let (ran, recorded) = (folder.path().join("ran"), folder.path().join("recorded"));
    // A recording begins while the machine is idle, so the run must begin so too.
    let commanded = folder.path().join("commanded.toml");
    let start = "[[command]]\nat_s = 0.001\ndo = \"start\"\n";
    fs::write(&commanded, format!("{SCENE}{start}")).unwrap();
    let mut command = cophase();
    command.arg("run").arg(&commanded).arg("--out").arg(&ran);
    command
        .args(["--quiet", "--every", "1", "--window", "all"])
        .assert()
        .success();
    record(&scene, &recorded, &["--window", "all"]);
    let (status, found) = compare(&ran, &recorded);
    assert_eq!(status, 0, "{found:#}");
    let trace = fs::read_to_string(ran.join("trace.csv")).unwrap();
    let rows = trace.lines().skip(1);
    let of_the_run = rows.filter(|row| !row.contains(",idle,")).count() as u64;
    let compared = found["points"].as_u64().unwrap();
    assert!(
        compared >= of_the_run,
        "{compared} of {of_the_run} rows are compared"
    );
    for column in found["columns"].as_array().unwrap() {
        let is_unknown = UNKNOWN.contains(&column["name"].as_str().unwrap());
        assert_eq!(
            column["compared"].as_u64().unwrap(),
            if is_unknown { 0 } else { compared },
            "{column}"
        );
        // Values are equal to the last digit, and not only within a tolerance.
        assert!(
            is_unknown || column["largest"].as_f64().unwrap_or(0.0) == 0.0,
            "{column}"
        );
    }
    assert_eq!(found["events"]["equal"], 4);
    let wires = found["edges"]["wires"].as_array().unwrap();
    let equal: u64 = wires
        .iter()
        .map(|wire| wire["equal"].as_u64().unwrap())
        .sum();
    assert!(equal > 10_000, "{equal} edges");
    for wire in ["dir_0", "step_0", "step_1", "step_2", "enable"] {
        assert!(wires.iter().any(|known| known["name"] == wire), "{wire}");
    }
    let unknown = &found["edges"]["unknown"];
    assert_eq!(
        *unknown,
        serde_json::json!(["index_0", "index_1", "index_2", "sync"])
    );
    let report = report(&recorded);
    assert_eq!(report["samples"]["lost"], 0);
    assert_eq!(report["ended"]["state"], "parked");
    let of_run = self::report(&ran);
    assert_eq!(report["speed_top_hz"], of_run["speed_top_hz"]);
    for state in ["homing", "run", "stop"] {
        let key = "time_in_state_s";
        assert_eq!(report[key][state], of_run[key][state], "{state}");
    }
    // Of an axis, a recording has everything but the truth.
    for axis in 0..3 {
        for (key, value) in report["axes"][axis].as_object().unwrap() {
            assert_eq!(*value, of_run["axes"][axis][key], "{key} of axis {axis}");
        }
        let of_truth = &report["axes"][axis]["actual_turns"];
        assert!(of_truth.is_null(), "{of_truth}");
    }
}

/// Without every tick there are no edges, and edges of an earlier recording are removed.
#[test]
fn a_recording_without_every_tick_explains_its_missing_edges() {
    let (folder, scene) = scene();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("steps.vcd"), "of an earlier recording").unwrap();
    let text = record(
        &scene,
        &out,
        &["--every", "10", "--for", "0.5", "--channels", "speed,phase"],
    );
    assert!(
        text.contains("there is no steps.vcd: not every tick was recorded"),
        "{text}"
    );
    assert!(!out.join("steps.vcd").exists());
    let report = report(&out);
    assert_eq!(report["written"]["every"], 10);
    assert!(report["written"]["window_from_s"].is_null());
    let trace = fs::read_to_string(out.join("trace.csv")).unwrap();
    let header: Vec<&str> = trace.lines().next().unwrap().split(',').collect();
    let known = [
        "t_s",
        "state",
        "state_code",
        "amax_commanded_mps2",
        "omega_rad_s",
        "phase_turns",
        "version",
        "commit",
    ];
    for line in trace.lines().skip(1) {
        for (name, field) in header.iter().zip(line.split(',')) {
            assert_eq!(field.is_empty(), !known.contains(name), "{name}: `{field}`");
        }
    }
}

/// Drops some packets of samples, and counts the samples in them.
#[derive(Default)]
struct LossyLine {
    frame: Vec<u8>,
    packets: u32,
    lost: Arc<AtomicU64>,
}

impl LossyLine {
    /// Returns the bytes that pass the line.
    fn pass(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut passed = Vec::new();
        for &byte in bytes {
            self.frame.push(byte);
            if byte != 0 {
                continue;
            }
            let samples = samples(&self.frame);
            self.packets += u32::from(samples > 0);
            // The first packet fixes the start of the recording. Later packets reveal that these were
            // lost.
            if samples > 0 && matches!(self.packets, 5 | 6 | 20 | 41) {
                self.lost.fetch_add(samples, Ordering::SeqCst);
            } else {
                passed.extend_from_slice(&self.frame);
            }
            self.frame.clear();
        }
        passed
    }
}

/// Returns the count of samples in a frame.
fn samples(frame: &[u8]) -> u64 {
    let mut client = Client::new();
    let mut count = 0;
    for &byte in frame {
        if let Some(Message::Samples { count: samples, .. }) = client.push(byte) {
            count = samples.into();
        }
    }
    count
}

/// Serves a simulated controller behind a TCP port whose line loses packets.
fn serve(lost: Arc<AtomicU64>, is_over: Arc<AtomicBool>) -> (u16, std::thread::JoinHandle<()>) {
    let checked = Checked::new(load::parse(SCENE).unwrap()).unwrap();
    let mut hub = Hub::<_, 1>::new(SimulatedDevice::new(checked, 1.0).unwrap());
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let thread = std::thread::spawn(move || {
        let (mut stream, _): (TcpStream, _) = listener.accept().unwrap();
        stream
            .set_read_timeout(Some(Duration::from_millis(1)))
            .unwrap();
        hub.connect(0);
        let mut line = LossyLine {
            lost,
            ..LossyLine::default()
        };
        let mut bytes = [0; 1024];
        while !is_over.load(Ordering::SeqCst) {
            let read = stream.read(&mut bytes);
            // Only the line must lose samples. The hub has room for a few frames only, and a request may
            // fill it.
            let mut may_be_more = true;
            while may_be_more {
                may_be_more = hub.poll_one();
                let mut sent = [0; 4096];
                let count = hub.transmit(0, &mut sent);
                if stream.write_all(&line.pass(&sent[..count])).is_err() {
                    return;
                }
            }
            match read {
                Ok(0) => return,
                Ok(count) => hub.receive(0, &bytes[..count]),
                Err(_) => {}
            }
        }
    });
    (port, thread)
}

#[test]
fn lost_samples_are_counted_and_not_invented() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (lost, is_over) = (
        Arc::new(AtomicU64::new(0)),
        Arc::new(AtomicBool::new(false)),
    );
    let (port, thread) = serve(lost.clone(), is_over.clone());
    let to = format!("tcp:127.0.0.1:{port}");
    let mut command = cophase();
    command
        .args(["link", "record", "--to", &to, "--start", "--yes", "--out"])
        .arg(&out);
    let done = command.assert().success();
    is_over.store(true, Ordering::SeqCst);
    thread.join().unwrap();
    let lost = lost.load(Ordering::SeqCst);
    assert!(lost > 0);
    let report = report(&out);
    assert_eq!(report["samples"]["lost"], lost);
    assert_eq!(
        report["samples"]["gaps"], 3,
        "two packets follow each other"
    );
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    assert!(text.contains(&format!("{lost} lost in 3 gaps")), "{text}");
    assert!(
        text.contains("there is no steps.vcd: samples were lost"),
        "{text}"
    );
    assert!(!out.join("steps.vcd").exists());
    // Rows are at the ticks that arrived. The count of missing rows between the first and the last is the
    // count of lost samples.
    let trace = fs::read_to_string(out.join("trace.csv")).unwrap();
    let ticks: Vec<u64> = trace
        .lines()
        .skip(1)
        .map(|line| {
            (line.split(',').next().unwrap().parse::<f64>().unwrap() * 2000.0).round() as u64
        })
        .collect();
    assert_eq!(
        ticks.last().unwrap() - ticks[0] + 1 - ticks.len() as u64,
        lost
    );
    assert_eq!(report["samples"]["recorded"], ticks.len());
}

/// Ctrl-C ends a recording, and the recorder then writes its files.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_recording_and_writes_it() {
    let (folder, scene) = scene();
    let long = SCENE.replace("hold_s = 0.3", "hold_s = 1000");
    fs::write(&scene, long).unwrap();
    let out = folder.path().join("out");
    let mut recording = std::process::Command::new(assert_cmd::cargo::cargo_bin("cophase"))
        .args([
            "link",
            "record",
            "--to",
            &format!("sim:{}", scene.display()),
            "--quiet",
            "--out",
        ])
        .arg(&out)
        .spawn()
        .unwrap();
    // The files are created before the recording begins. A second later it is under way.
    while !out.exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(1000));
    let interrupt = std::process::Command::new("kill")
        .args(["-INT", &recording.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    assert_eq!(recording.wait().unwrap().code(), Some(0));
    let report = report(&out);
    assert!(report["samples"]["recorded"].as_u64().unwrap() > 100);
    assert!(out.join("steps.vcd").exists());
}

#[test]
fn invalid_recording_options_are_refused() {
    let (folder, scene) = scene();
    let taken = folder.path().join("taken");
    fs::create_dir_all(taken.join("trace.csv")).unwrap();
    let to = format!("sim:{}", scene.display());
    for (options, problem) in [
        (vec!["--out", taken.to_str().unwrap()], "is a directory"),
        (
            vec!["--out", "x", "--every", "0"],
            "--every 0: give a whole number, 1 to 10000",
        ),
        (vec!["--out", "x", "--channels", "torque"], "give one of "),
        (
            vec!["--out", "x", "--every", "2", "--window", "0..1"],
            "--window: with --every 2 there are no edges to show",
        ),
        (vec![], "--out"),
    ] {
        let mut command = cophase();
        command
            .current_dir(folder.path())
            .args(["link", "record", "--to", &to])
            .args(&options);
        let done = command.assert().code(2);
        let error = String::from_utf8(done.get_output().stderr.clone()).unwrap();
        assert!(error.contains(problem), "{error}");
    }
    assert!(!folder.path().join("x").exists());
}
