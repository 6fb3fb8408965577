//! The wiring diagram shows the pins that the firmware uses.
//!
//! `docs/wiring.md` is the guide for soldering. If it differs from the table in the code, the error shows only on a
//! connected drive.

use std::collections::BTreeMap;

#[path = "../../firmware/src/board/pins.rs"]
mod pins;

/// Returns the name of each used pin, from the code.
fn in_code() -> BTreeMap<u8, String> {
    let mut names = BTreeMap::new();
    let mut name = |pin: u8, name: String| {
        let before = names.insert(pin, name.clone());
        assert_eq!(before, None, "GP{pin} is both that and {name}");
    };
    for axis in 0..pins::AXES {
        name(pins::STEP[axis], format!("STEP {axis}"));
        name(pins::DIR[axis], format!("DIR {axis}"));
        name(pins::INDEX + axis as u8, format!("INDEX {axis}"));
        name(pins::ALARM[axis], format!("ALARM {axis}"));
    }
    name(pins::DRIVE_ENABLE, "DRIVE ENABLE".to_owned());
    name(pins::SYNC, "SYNC".to_owned());
    name(pins::LED, "LED".to_owned());
    name(pins::ENABLE, "ENABLE".to_owned());
    name(pins::STOP, "STOP".to_owned());
    name(pins::START, "START".to_owned());
    names
}

/// Returns the names of pins from the page. In the diagram, a pin's name is beside it, outside. In the text, the name
/// is after the pin.
fn in_docs() -> BTreeMap<u8, String> {
    let page =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/wiring.md")).unwrap();
    let mut names = BTreeMap::new();
    let number = |word: &str| word.strip_prefix("GP").and_then(|n| n.parse::<u8>().ok());
    for row in page
        .lines()
        .filter(|line| line.contains("│               │"))
    {
        let (left, right) = row.split_once("│               │").unwrap();
        let left: Vec<_> = left.split_whitespace().collect();
        let right: Vec<_> = right.split_whitespace().collect();
        if let Some(pin) = number(left[left.len() - 2]) {
            names.insert(pin, left[..left.len() - 2].join(" "));
        }
        if let Some(pin) = number(right[1]) {
            names.insert(pin, right[2..].join(" "));
        }
    }
    let text = page.split_once("On the board:").unwrap().1;
    let text = text.split_once("\n\n").unwrap().0;
    for part in text.split("GP").skip(1) {
        let (pin, rest) = part.split_once(" `").unwrap();
        let name = rest.split_once('`').unwrap().0;
        names.insert(pin.parse().unwrap(), name.to_owned());
    }
    names
}

#[test]
fn diagram_shows_the_pins_of_the_code() {
    assert_eq!(in_docs(), in_code());
}

/// If this fails, the firmware uses a pin that the chip does not have. The index inputs are sampled as neighbours.
#[test]
fn pins_exist_on_the_chip() {
    assert!(in_code().keys().all(|&pin| pin < 30));
}
