//! The log's bytes are decoded to the statements that wrote them, also from a broken stream.

mod support;

use std::path::{Path, PathBuf};

use object::{SectionKind, SymbolKind};
use support::{Elf, inspect, said};
use tempfile::TempDir;

const HELLO: u16 = 1;
const SPEED: u16 = 2;

/// The firmware with two log statements and a timestamp of microseconds.
fn firmware(encoding: &str) -> (TempDir, PathBuf) {
    let mut elf = Elf::new();
    let defmt = elf.section(".defmt", SectionKind::Other, &[0; 4]);
    let mut entry = |tag: &str, data: &str, at| {
        let name = format!(
            r#"{{"package":"image","tag":"{tag}","data":"{data}","disambiguator":"{at}","crate_name":"image"}}"#
        );
        elf.symbol(defmt, &name, SymbolKind::Data, at, 1);
    };
    entry("defmt_info", "hello", HELLO.into());
    entry("defmt_warn", "speed {=u16} of {=u16}", SPEED.into());
    entry("defmt_timestamp", "{=u16:us}", 3);
    elf.symbol(defmt, "_defmt_version_ = 4", SymbolKind::Data, 0, 0);
    let encoding = format!("_defmt_encoding_ = {encoding}");
    elf.symbol(defmt, &encoding, SymbolKind::Data, 0, 0);
    let dir = tempfile::tempdir().unwrap();
    let path = elf.write(dir.path());
    (dir, path)
}

/// A frame: index, time in µs, and the values.
fn frame(index: u16, time_us: u16, arguments: &[u16]) -> Vec<u8> {
    let words = [&[index, time_us], arguments].concat();
    words.into_iter().flat_map(u16::to_le_bytes).collect()
}

/// Reverse zero-compressing COBS: seven bytes without the zeros, then a byte that marks the zeros.
fn rzcobs(frame: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    for group in frame.chunks(7) {
        let zeros = (0..7).filter(|&i| group.get(i).is_none_or(|&byte| byte == 0));
        let mask: u8 = zeros.map(|i| 1 << i).sum();
        assert_ne!(mask, 0, "a group without a zero is coded otherwise");
        out.extend(group.iter().filter(|&&byte| byte != 0));
        out.push(mask);
    }
    out.push(0);
    out
}

fn log(elf: &Path, more: &[&str], bytes: &[u8]) -> (i32, String, String) {
    let arguments = [&["log", elf.to_str().unwrap(), "-"], more].concat();
    said(&inspect(&arguments, bytes))
}

#[test]
fn statements_are_decoded_in_both_encodings() {
    let frames = [frame(HELLO, 7, &[]), frame(SPEED, 1234, &[9, 300])];
    for (encoding, bytes) in [
        ("raw", frames.concat()),
        (
            "rzcobs",
            frames.iter().flat_map(|frame| rzcobs(frame)).collect(),
        ),
    ] {
        let (_dir, elf) = firmware(encoding);
        let (status, out, err) = log(&elf, &[], &bytes);
        let lines: Vec<Vec<&str>> = out
            .lines()
            .map(|l| l.split_whitespace().collect())
            .collect();
        assert_eq!(
            lines,
            [
                vec!["0.000007", "info", "hello"],
                vec!["0.001234", "warn", "speed", "9", "of", "300"]
            ],
            "{encoding}"
        );
        assert_eq!((status, err.as_str()), (0, ""), "{encoding}");
    }
}

/// The first bytes read from the ring may be the middle of a frame, and the last ones may be part
/// of a frame.
#[test]
fn broken_frames_are_skipped_and_reported() {
    let (_dir, elf) = firmware("rzcobs");
    let [hello, speed] = [
        rzcobs(&frame(HELLO, 7, &[])),
        rzcobs(&frame(SPEED, 8, &[1, 2])),
    ];
    let unknown = rzcobs(&frame(99, 7, &[]));
    let bytes = [&speed[4..], &hello, &unknown, &speed, &hello[..2]].concat();
    let (status, out, err) = log(&elf, &[], &bytes);
    assert_eq!(out.lines().count(), 2, "{out}");
    assert!(err.contains("2 malformed frames were skipped"), "{err}");
    assert!(err.contains("the last 2 bytes are no whole frame"), "{err}");
    assert_eq!(status, 0);
}

#[test]
fn an_undecodable_stream_fails() {
    for encoding in ["raw", "rzcobs"] {
        let (_dir, elf) = firmware(encoding);
        let (status, out, err) = log(&elf, &[], &[0xaa; 30]);
        assert_eq!((status, out.as_str()), (1, ""), "{encoding}: {err}");
        let (status, out, err) = log(&elf, &[], &[]);
        assert_eq!(
            (status, out.as_str(), err.as_str()),
            (0, "", ""),
            "{encoding}: nothing was logged"
        );
    }
}

#[test]
fn json_lines_have_the_cycle_of_their_last_byte() {
    let (dir, elf) = firmware("rzcobs");
    let frames = [
        rzcobs(&frame(HELLO, 7, &[])),
        rzcobs(&frame(SPEED, 8, &[1, 2])),
    ];
    // The second frame in two pieces.
    let stamps = dir.path().join("stamps");
    let lengths = [frames[0].len(), 3, frames[1].len() - 3];
    let text = format!(
        "1000 {}\n2000 {}\n3000 {}\n",
        lengths[0], lengths[1], lengths[2]
    );
    std::fs::write(&stamps, text).unwrap();
    let more = ["--json", "--cycles", stamps.to_str().unwrap()];
    let (status, out, err) = log(&elf, &more, &frames.concat());
    assert_eq!((status, out.lines().count()), (0, 2), "{err}");
    let line: serde_json::Value = serde_json::from_str(out.lines().nth(1).unwrap()).unwrap();
    let expected = serde_json::json!({
        "cycle": 3000, "timestamp": "0.000008", "level": "warn", "message": "speed 1 of 2", "location": null
    });
    assert_eq!(line, expected);
}

#[test]
fn firmware_without_a_log_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let elf = Elf::new().write(dir.path());
    let (status, out, err) = log(&elf, &[], &[1]);
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(err.contains("has no .defmt section"), "{err}");
}
