//! Times at which the bytes of a stream were written: a line for each piece of it, `CYCLE LENGTH`, in their order.

use std::path::Path;

use crate::error::Error;

/// The pieces of a stream. Bytes are read in rising order.
#[derive(Clone, Debug)]
pub struct Stamps {
    /// Cycle of each piece, and the offset after its last byte.
    pieces: std::vec::IntoIter<(u64, usize)>,
    present: Option<(u64, usize)>,
}

impl Stamps {
    /// Parses the text of the file at `path`.
    ///
    /// # Errors
    /// A line that is not two numbers.
    pub fn parse(text: &str, path: &Path) -> Result<Self, Error> {
        let mut end = 0;
        let mut pieces = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let piece = line.split_once(' ').and_then(|(cycle, length)| {
                Some((cycle.parse().ok()?, length.trim().parse::<usize>().ok()?))
            });
            let Some((cycle, length)) = piece else {
                let problem = format!(
                    "line {}: `{line}` is not the cycle of a piece and its length in bytes, as `125000 17`",
                    i + 1
                );
                return Err(Error::content(path, problem));
            };
            end += length;
            pieces.push((cycle, end));
        }
        let mut pieces = pieces.into_iter();
        let present = pieces.next();
        Ok(Self { pieces, present })
    }

    /// The cycle of the byte at `offset`; none after the last piece.
    pub fn of_byte(&mut self, offset: usize) -> Option<u64> {
        while let Some((cycle, end)) = self.present {
            if offset < end {
                return Some(cycle);
            }
            self.present = self.pieces.next();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_has_the_cycle_of_its_piece() {
        let mut stamps = Stamps::parse("100 2\n250 3\n900 1\n", Path::new("-")).unwrap();
        let cycles: Vec<_> = (0..7).map(|offset| stamps.of_byte(offset)).collect();
        let [a, b, c] = [Some(100), Some(250), Some(900)];
        assert_eq!(cycles, [a, a, b, b, b, c, None]);
    }

    #[test]
    fn a_line_that_is_not_two_numbers_is_named() {
        let error = Stamps::parse("100 2\n250\n", Path::new("stamps")).unwrap_err();
        assert!(
            error.to_string().starts_with("stamps: line 2: `250`"),
            "{error}"
        );
    }
}
