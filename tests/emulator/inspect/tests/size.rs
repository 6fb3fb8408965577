//! Size of a firmware, and the detection of its changes.

mod support;

use std::path::{Path, PathBuf};

use object::{SectionKind, SymbolKind};
use support::{Elf, inspect, said};
use tempfile::TempDir;

/// The firmware of `text` bytes of code, and 600 of constants, 200 of data, 3000 of bss.
fn firmware(text: usize) -> (TempDir, PathBuf) {
    let mut elf = Elf::new();
    let code = elf.section(".text", SectionKind::Text, &vec![0; text]);
    elf.symbol(
        code,
        "_ZN8firmware4main17h0123456789abcdefE",
        SymbolKind::Text,
        1,
        300,
    );
    elf.symbol(code, "small", SymbolKind::Text, 301, 20);
    elf.section(".rodata", SectionKind::ReadOnlyData, &[0; 600]);
    elf.section(".data", SectionKind::Data, &[0; 200]);
    let bss = elf.empty_section(".bss", 3000);
    elf.symbol(bss, "firmware::DMA_WORDS", SymbolKind::Data, 0, 2048);
    elf.symbol(bss, "firmware::FLAG", SymbolKind::Data, 2048, 4);
    elf.section(".debug_info", SectionKind::Debug, &[0; 5000]); // uses no memory of the chip
    let dir = tempfile::tempdir().unwrap();
    let path = elf.write(dir.path());
    (dir, path)
}

fn size(elf: &Path, more: &[&str]) -> (i32, String, String) {
    said(&inspect(
        &[&["size", elf.to_str().unwrap()], more].concat(),
        &[],
    ))
}

#[test]
fn sections_functions_and_buffers_are_listed() {
    let (_dir, elf) = firmware(10_000);
    let (status, out, err) = size(&elf, &[]);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("flash   10800 bytes: text 10000, rodata 600, data 200\n"),
        "{out}"
    );
    assert!(
        out.contains("RAM      3200 bytes: data 200, bss 3000\n"),
        "{out}"
    );
    assert!(
        out.contains("     300 firmware::main\n      20 small\n"),
        "{out}"
    );
    assert!(out.contains("    2048 firmware::DMA_WORDS\n"), "{out}");
    assert!(!out.contains("FLAG"), "{out}");
}

#[test]
fn a_change_beyond_its_margin_fails_until_it_is_blessed() {
    let (dir, elf) = firmware(10_000);
    let golden = dir.path().join("golden.toml");
    let golden = golden.to_str().unwrap();
    let (status, _, err) = size(&elf, &["--golden", golden]);
    assert_eq!(status, 2, "nothing is kept yet");
    assert!(err.contains("golden.toml"), "{err}");

    let stack = ["--stack-bytes", "1000", "--stack-axes", "5"];
    let blessed = [&["--golden", golden, "--bless"][..], &stack].concat();
    assert_eq!(size(&elf, &blessed).0, 0);
    assert_eq!(
        size(&elf, &["--golden", golden, "--stack-bytes", "1040"]).0,
        0
    );
    let (status, out, _) = size(&elf, &["--golden", golden, "--stack-bytes", "1100"]);
    assert_eq!(status, 1);
    assert!(
        out.contains("CHANGED stack_bytes: grew from 1000 to 1100, by 10.0 %"),
        "{out}"
    );
    assert!(out.contains("run this again with --bless"), "{out}");

    let (_other, grown) = firmware(10_600);
    let (status, out, _) = size(&grown, &["--golden", golden]);
    assert_eq!(status, 1);
    assert!(
        out.contains("CHANGED text_bytes: grew from 10000 to 10600, by 6.0 %"),
        "{out}"
    );
    assert!(!out.contains("rodata_bytes:"), "{out}");
    let (_other, shrunk) = firmware(7000);
    let (status, out, _) = size(&shrunk, &["--golden", golden]);
    assert_eq!(status, 1);
    assert!(
        out.contains("CHANGED text_bytes: shrank from 10000 to 7000, by 30.0 %"),
        "{out}"
    );

    // After a blessing without a measured stack, the previous figure stays.
    assert_eq!(size(&grown, &["--golden", golden, "--bless"]).0, 0);
    let kept = std::fs::read_to_string(golden).unwrap();
    assert!(kept.contains("\ntext_bytes = 10600\n"), "{kept}");
    assert!(
        kept.contains("\nstack_axes = 5\nstack_bytes = 1000\n"),
        "{kept}"
    );
}

#[test]
fn a_figure_missing_from_the_golden_file_is_reported() {
    let (dir, elf) = firmware(10_000);
    let golden = dir.path().join("golden.toml");
    std::fs::write(&golden, "text_bytes = 10000\n").unwrap();
    let (status, out, _) = size(&elf, &["--golden", golden.to_str().unwrap()]);
    assert_eq!(status, 1);
    assert!(
        out.contains("CHANGED flash_bytes: is 10800 and was never kept"),
        "{out}"
    );
}
