//! Functions in flash and in RAM, in firmware whose code is made here and is in the flash.

mod support;

use support::code::{POP_R4_PC, PUSH_R4_LR, Part, RETURN, firmware, function};
use support::{inspect, said};

/// If this fails, code of the tick path could wait for the flash unnoticed.
#[test]
fn flash_functions_are_reported_with_their_callers() {
    let functions = [
        function("root", &[PUSH_R4_LR, Part::Call("a"), POP_R4_PC]),
        function("a", &[RETURN]),
        function("b", &[RETURN]),
    ];
    let (_dir, elf) = firmware(&functions);
    let elf = elf.to_str().unwrap();
    let (status, out, err) = said(&inspect(&["places", elf, "--root", "root"], &[]));
    assert_eq!(status, 1, "{out}{err}");
    assert!(
        out.contains("NOT IN RAM a, which is called by root\n"),
        "{out}"
    );
    assert!(out.contains("functions reached: 2\n"), "{out}");
    assert!(!out.contains("RAM b"), "{out}");
}

#[test]
fn a_missing_root_is_an_error() {
    let (_dir, elf) = firmware(&[function("root", &[RETURN])]);
    let elf = elf.to_str().unwrap();
    let (status, _, err) = said(&inspect(&["places", elf, "--root", "other"], &[]));
    assert_eq!(status, 2);
    assert!(err.contains("`other`"), "{err}");
}
