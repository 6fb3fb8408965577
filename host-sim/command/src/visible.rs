//! Output in which control characters are visible.
//!
//! A name or text may come from a board or a file. Its control characters could command the terminal, so that all output passes here.

use std::io::{self, Write};

/// First byte of a control character U+0080 to U+009F in UTF-8.
const C1: u8 = 0xC2;

/// Writer that replaces each control character, other than a tab and the end of a line, by its escape of Rust, such as `\u{1b}`.
#[derive(Debug)]
pub(super) struct Visible<W> {
    inner: W,
    /// The last byte was [`C1`], and is not written yet.
    follows_c1: bool,
}

impl<W> Visible<W> {
    pub(super) const fn new(inner: W) -> Self {
        Self {
            inner,
            follows_c1: false,
        }
    }
}

impl<W: Write> Write for Visible<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut shown = Vec::with_capacity(bytes.len());
        for &byte in bytes {
            let follows_c1 = std::mem::replace(&mut self.follows_c1, byte == C1);
            let is_control = match byte {
                b'\n' | b'\t' => false,
                0x80..=0x9F => follows_c1,
                _ => byte.is_ascii_control(),
            };
            if follows_c1 && !is_control {
                shown.push(C1);
            }
            if is_control {
                shown.extend(format!("\\u{{{byte:x}}}").bytes());
            } else if byte != C1 {
                shown.push(byte);
            }
        }
        self.inner.write_all(&shown)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.follows_c1) {
            self.inner.write_all(&[C1])?;
        }
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(parts: &[&[u8]]) -> String {
        let mut bytes = Vec::new();
        let mut out = Visible::new(&mut bytes);
        for part in parts {
            out.write_all(part).unwrap();
        }
        out.flush().unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(
            shown(&[b"a\x1b[31mb\x07\rc\x7f\n\td"]),
            "a\\u{1b}[31mb\\u{7}\\u{d}c\\u{7f}\n\td"
        );
        // U+009B begins a command, too. It may be split.
        assert_eq!(shown(&["\u{9b}31m".as_bytes()]), "\\u{9b}31m");
        assert_eq!(shown(&[&[0xC2], &[0x9B]]), "\\u{9b}");
    }

    #[test]
    fn all_other_text_is_unchanged() {
        let text = "18 kg, 3 m/s², ±0.02°, − … \u{a0}\u{ff}漢\n";
        assert_eq!(shown(&[text.as_bytes()]), text);
        let bytes = text.as_bytes();
        let single: Vec<_> = bytes.chunks(1).collect();
        assert_eq!(shown(&single), text);
        // A byte at the end that begins a character is not lost.
        let mut out = Vec::new();
        let mut visible = Visible::new(&mut out);
        visible.write_all(&[C1, C1]).unwrap();
        visible.flush().unwrap();
        assert_eq!(out, [C1, C1]);
    }
}
