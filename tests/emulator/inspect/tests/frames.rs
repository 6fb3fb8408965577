//! Names of the functions at addresses, in firmware whose code is made here and has no debug information.

mod support;

use object::{SectionKind, SymbolKind};
use support::{Elf, inspect, said};
use tempfile::TempDir;

fn elf() -> (TempDir, String) {
    let mut elf = Elf::new();
    let code = elf.section(".text", SectionKind::Text, &[0; 64]);
    elf.symbol(code, "first", SymbolKind::Text, 1, 8);
    let generic = "_RNvMs_NtCs1234_4core10controllerNtB4_10Controller4tick";
    elf.symbol(code, generic, SymbolKind::Text, 9, 16);
    let dir = tempfile::tempdir().unwrap();
    let path = elf.write(dir.path());
    let path = path.to_str().unwrap().to_owned();
    (dir, path)
}

/// If this fails, a profile books cycles to other functions than those that spent them.
#[test]
fn each_address_gives_one_line_in_input_order() {
    let (_dir, elf) = elf();
    let (status, out, err) = said(&inspect(&["frames", &elf, "-"], b"a\n0x2\n18\n"));
    assert_eq!(status, 0, "{err}");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines.len(), 3, "{out}");
    assert!(lines[0].ends_with("Controller::tick"), "{out}");
    assert_eq!(lines[1], "first");
    assert_eq!(lines[2], "?", "no function has address 0x18");
}

#[test]
fn text_that_is_not_an_address_is_refused() {
    let (_dir, elf) = elf();
    let (status, _, err) = said(&inspect(&["frames", &elf, "-"], b"2\nsix\n"));
    assert_eq!(status, 2);
    assert!(err.contains("six"), "{err}");
}
