//! Kind of a file that a user names, so that a refusal can say what the file is instead of the right one.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use cophase_link::header::MAGIC;

/// Kind of a file: by what it begins with, else by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scene, or other TOML.
    Scene,
    /// A settings file.
    Settings,
    /// Firmware in one of its forms.
    Uf2,
    /// As [`Self::Uf2`].
    Elf,
    /// As [`Self::Uf2`].
    IntelHex,
    /// A table, such as `trace.csv`.
    Table,
    /// `report.json`, or other JSON.
    Json,
    /// Edges, such as `steps.vcd`.
    Vcd,
    /// Edges in binary form, such as `steps.fst`.
    Fst,
    /// A trace in binary form, `trace.mcap`.
    Mcap,
    /// A drawing.
    Svg,
    /// A page.
    Html,
    /// A bitmap.
    Bitmap,
    /// Compressed files.
    Archive,
    /// A document.
    Pdf,
    /// A program.
    Python,
}

/// Beginnings of files. Spaces before them are left out; capitals do not matter.
const BEGINNINGS: [(&[u8], FileKind); 22] = [
    (&MAGIC, FileKind::Settings),
    (b"UF2\n", FileKind::Uf2),
    (b"\x7fELF", FileKind::Elf),
    (b":02000004", FileKind::IntelHex),
    (b"\x1f\x8b", FileKind::Archive),
    (b"PK\x03\x04", FileKind::Archive),
    (b"\x28\xb5\x2f\xfd", FileKind::Archive),
    (b"%PDF", FileKind::Pdf),
    (b"\x89PNG", FileKind::Bitmap),
    (b"\xff\xd8\xff", FileKind::Bitmap),
    (b"\x89MCAP0", FileKind::Mcap),
    (b"<svg", FileKind::Svg),
    (b"<?xml", FileKind::Svg),
    (b"<!doctype html", FileKind::Html),
    (b"<html", FileKind::Html),
    (b"$date", FileKind::Vcd),
    (b"$version", FileKind::Vcd),
    (b"$timescale", FileKind::Vcd),
    (b"#!/usr/bin/env python", FileKind::Python),
    (b"import ", FileKind::Python),
    (b"\"\"\"", FileKind::Python),
    (b"{", FileKind::Json),
];

/// Ends of names.
const ENDS: [(&str, FileKind); 13] = [
    ("toml", FileKind::Scene),
    ("settings", FileKind::Settings),
    ("csv", FileKind::Table),
    ("tsv", FileKind::Table),
    ("json", FileKind::Json),
    ("vcd", FileKind::Vcd),
    ("fst", FileKind::Fst),
    ("mcap", FileKind::Mcap),
    ("svg", FileKind::Svg),
    ("html", FileKind::Html),
    ("png", FileKind::Bitmap),
    ("jpg", FileKind::Bitmap),
    ("py", FileKind::Python),
];

/// Number of bytes by which a file is recognised.
const BEGIN_BYTES: u64 = 4096;

impl FileKind {
    /// Returns the kind of a plain file, if it is known. A file that cannot be read has none.
    pub fn from_path(path: &Path) -> Option<Self> {
        // A pipe that has no writer cannot be opened.
        if !path.is_file() {
            return None;
        }
        let mut begin = Vec::new();
        let file = File::open(path).ok()?;
        file.take(BEGIN_BYTES).read_to_end(&mut begin).ok()?;
        let begin = begin.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&begin);
        let begin = begin.trim_ascii_start();
        // The last character may be cut.
        let text = begin.utf8_chunks().next().map_or("", |chunk| chunk.valid());
        let line = first_line(text);
        (Self::of_begin(begin))
            .or_else(|| is_toml(line).then_some(Self::Scene))
            .or_else(|| Self::of_name(path))
            .or_else(|| is_header(line).then_some(Self::Table))
    }

    fn of_begin(begin: &[u8]) -> Option<Self> {
        let is_first = |(known, _): &&(&[u8], Self)| {
            let first = begin.get(..known.len());
            first.is_some_and(|first| first.eq_ignore_ascii_case(known))
        };
        BEGINNINGS.iter().find(is_first).map(|(_, kind)| *kind)
    }

    fn of_name(path: &Path) -> Option<Self> {
        let end = path.extension()?;
        let known = ENDS
            .iter()
            .find(|(known, _)| end.eq_ignore_ascii_case(known));
        known.map(|(_, kind)| *kind)
    }
}

/// Returns the first line that is no comment.
fn first_line(text: &str) -> &str {
    let mut lines = text.lines().map(str::trim);
    let line = lines.find(|line| !line.is_empty() && !line.starts_with('#'));
    line.unwrap_or_default()
}

/// Returns true for words that can be a key of TOML, or the name of a column.
fn is_name(text: &str) -> bool {
    let is_of_name = |c: char| c.is_alphanumeric() || "_-. \"".contains(c);
    !text.is_empty() && text.chars().all(is_of_name)
}

fn is_toml(line: &str) -> bool {
    let is_table = line.starts_with('[') && line.ends_with(']');
    is_table || line.split_once('=').is_some_and(|(key, _)| is_name(key))
}

/// Returns true for the names of the columns of a table.
fn is_header(line: &str) -> bool {
    line.contains(',') && line.split(',').all(is_name)
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scene => "a scene (TOML)",
            Self::Settings => "a settings file",
            Self::Uf2 => "a UF2 file for a board (docs/first-machine.md)",
            Self::Elf => "firmware (ELF) for a board (docs/first-machine.md)",
            Self::IntelHex => "firmware (Intel HEX) for a board (docs/first-machine.md)",
            Self::Table => "a table (CSV)",
            Self::Json => "data (JSON)",
            Self::Vcd => "a waveform (VCD)",
            Self::Fst => "a waveform (FST)",
            Self::Mcap => "a recording (MCAP)",
            Self::Svg => "a drawing (SVG)",
            Self::Html => "a web page (HTML)",
            Self::Bitmap => "a bitmap",
            Self::Archive => "a compressed file",
            Self::Pdf => "a document (PDF)",
            Self::Python => "a Python program",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_recognised_by_its_content_or_its_name() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, expected) in [
            ("a.toml", "name = \"a\"\n", Some(FileKind::Scene)),
            ("b.csv", "# mine\n[machine]\n", Some(FileKind::Scene)),
            ("c.toml", "broken", Some(FileKind::Scene)),
            ("d", "t_s,state\n0.1,idle\n", Some(FileKind::Table)),
            ("e.toml", "name, \"a\"\n", Some(FileKind::Scene)),
            ("f.csv", "1;2\n", Some(FileKind::Table)),
            ("g", "{\"a\": 1}", Some(FileKind::Json)),
            ("h", "$date\n", Some(FileKind::Vcd)),
            ("i", "\n<svg xmlns=\"\"></svg>", Some(FileKind::Svg)),
            ("j", "<!DOCTYPE html>", Some(FileKind::Html)),
            ("k.PNG", "broken", Some(FileKind::Bitmap)),
            ("l", "import os\n", Some(FileKind::Python)),
            ("m.py", "x", Some(FileKind::Python)),
            ("n", "COPHASE\0", Some(FileKind::Settings)),
            ("o", "hello", None),
            ("p", "", None),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert_eq!(FileKind::from_path(&path), expected, "{name}");
        }
        assert_eq!(FileKind::from_path(folder.path()), None);
        assert_eq!(FileKind::from_path(&folder.path().join("none.csv")), None);
    }
}
