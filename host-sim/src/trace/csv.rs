//! `trace.csv`: one line a row, every column with its unit in its name.
//!
//! *Decimals*: how many digits a column may have after the point. Each column has a fixed number of them, so
//! its resolution is known, and trailing zeros are left off, so the text is the shortest one that
//! says the value to that resolution: tick 1 of a 2 kHz loop is `0.0005`, not `0.000500000`.
//!
//! What is not a number is written `NaN`, `inf` or `-inf`, which Rust, pandas and numpy all read back.

use std::io::{self, Write};

use thiserror::Error;

use super::Row;

/// Why a trace could not be written.
#[derive(Debug, Error)]
pub enum TraceError {
    /// A row has another number of axes than the header.
    #[error("a row has {actual} axes where the header names {expected}")]
    Axes {
        /// Axes in the header.
        expected: usize,
        /// Axes in the row.
        actual: usize,
    },
    /// The `csv` crate or the file under it refused.
    #[error("trace not written: {0}")]
    Csv(#[from] ::csv::Error),
    /// The last bytes could not be flushed.
    #[error("trace not flushed: {0}")]
    Flush(#[from] io::Error),
}

/// Digits after the point, for each kind of column.
mod decimals {
    /// Seconds: 1 ns.
    pub const TIME: u32 = 9;
    /// m/s²: 0.1 mm/s², 1e-5 g.
    pub const ACCELERATION: u32 = 4;
    /// rad/s: 1 µrad/s.
    pub const SPEED: u32 = 6;
    /// Turns: 1e-9, about the resolution of a phase with 32 fraction bits (2.3e-10).
    pub const TURNS: u32 = 9;
    /// Degrees: 10 µdeg.
    pub const DEGREES: u32 = 5;
    /// Milliradians: 10 nrad.
    pub const TILT: u32 = 5;
    /// Metres: 1 nm.
    pub const HEIGHT: u32 = 9;
}

/// Writes rows as comma-separated values.
///
/// ```
/// use host_sim::trace::{Row, TraceCsv};
///
/// let mut trace = TraceCsv::new(Vec::new(), 0)?;
/// trace.write(&Row { t_s: 0.0005, state: "idle", ..Row::default() })?;
/// let text = String::from_utf8(trace.finish()?).unwrap();
/// assert!(text.ends_with("\n0.0005,idle,0,0,0,0,0,0,0,0,0,0\n"));
/// # Ok::<(), host_sim::trace::TraceError>(())
/// ```
pub struct TraceCsv<W: Write> {
    lines: ::csv::Writer<W>,
    axes: usize,
    text: Vec<u8>,
}

impl<W: Write> TraceCsv<W> {
    /// Writes the header for `axes` axes, which are counted from 0.
    ///
    /// The writer is buffered here; `w` need not be.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(w: W, axes: usize) -> Result<Self, TraceError> {
        let mut lines = ::csv::Writer::from_writer(w);
        lines.write_record(columns(axes))?;
        Ok(Self {
            lines,
            axes,
            text: Vec::with_capacity(32),
        })
    }

    /// Writes one row.
    ///
    /// # Errors
    /// When the row has another number of axes than the header, in which case nothing of it is written, or
    /// when the writer refuses.
    pub fn write(&mut self, row: &Row) -> Result<(), TraceError> {
        if row.axes.len() != self.axes {
            return Err(TraceError::Axes {
                expected: self.axes,
                actual: row.axes.len(),
            });
        }
        self.number(row.t_s, decimals::TIME)?;
        self.lines.write_field(row.state)?;
        self.number(row.state_code.into(), 0)?;
        self.number(row.amax_requested_mps2, decimals::ACCELERATION)?;
        self.number(row.amax_commanded_mps2, decimals::ACCELERATION)?;
        self.number(row.omega_rad_s, decimals::SPEED)?;
        self.number(row.phase_turns, decimals::TURNS)?;
        for axis in &row.axes {
            self.text.clear();
            // Writing to a Vec cannot fail.
            let _ = write!(self.text, "{}", axis.steps);
            self.lines.write_field(&self.text)?;
            self.number(axis.command_turns, decimals::TURNS)?;
            self.number(axis.actual_turns, decimals::TURNS)?;
            self.number(axis.phase_error_deg, decimals::DEGREES)?;
        }
        self.number(row.tilt_x_mrad, decimals::TILT)?;
        self.number(row.tilt_y_mrad, decimals::TILT)?;
        self.number(row.warp_deg, decimals::DEGREES)?;
        self.number(row.z_m, decimals::HEIGHT)?;
        self.number(row.accel_mps2, decimals::ACCELERATION)?;
        // Ends the line.
        self.lines.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// Flushes and gives the writer back.
    ///
    /// # Errors
    /// When the writer refuses the last bytes. Dropping the trace instead would lose such an error.
    pub fn finish(self) -> Result<W, TraceError> {
        Ok(self.lines.into_inner().map_err(|e| e.into_error())?)
    }

    fn number(&mut self, value: f64, decimals: u32) -> Result<(), TraceError> {
        self.text.clear();
        push_decimal(&mut self.text, value, decimals);
        self.lines.write_field(&self.text)?;
        Ok(())
    }
}

/// The header's names, in order.
fn columns(axes: usize) -> Vec<String> {
    let first = [
        "t_s",
        "state",
        "state_code",
        "amax_requested_mps2",
        "amax_commanded_mps2",
        "omega_rad_s",
        "phase_turns",
    ];
    let per_axis = ["steps", "command_turns", "actual_turns", "phase_error_deg"];
    let last = [
        "tilt_x_mrad",
        "tilt_y_mrad",
        "warp_deg",
        "z_m",
        "accel_mps2",
    ];
    let mut names: Vec<String> = first.map(String::from).into();
    names.extend((0..axes).flat_map(|i| per_axis.map(|name| format!("{name}_{i}"))));
    names.extend(last.map(String::from));
    names
}

/// Appends `value` rounded to `decimals` (at most 9) digits after the point, without trailing zeros.
///
/// Goes through an integer, which is several times as fast as the exact `{:.9}` and differs from it by less
/// than half an ulp of `value`; where the integer would not be exact, the slow way is taken.
fn push_decimal(text: &mut Vec<u8>, value: f64, decimals: u32) {
    const EXACT: f64 = 9_007_199_254_740_992.0; // 2^53
    let unit = 10_u64.pow(decimals);
    // Powers of ten up to 1e9 are exact in f64.
    let scaled = (value * unit as f64).round();
    // Writing to a Vec cannot fail.
    if scaled.is_nan() || scaled.abs() >= EXACT {
        let from = text.len();
        let _ = write!(text, "{value:.*}", decimals as usize);
        if text[from..].contains(&b'.') {
            trim(text);
        }
        return;
    }
    if scaled < 0.0 {
        text.push(b'-');
    }
    let magnitude = scaled.abs() as u64;
    let (whole, fraction) = (magnitude / unit, magnitude % unit);
    let _ = write!(text, "{whole}");
    if fraction != 0 {
        text.push(b'.');
        let mut place = unit / 10;
        let mut rest = fraction;
        while rest != 0 {
            text.push(b'0' + (rest / place) as u8);
            rest %= place;
            place /= 10;
        }
    }
}

/// Takes trailing zeros, and a point left bare by that, off a number that has a point.
fn trim(text: &mut Vec<u8>) {
    while text.last() == Some(&b'0') {
        text.pop();
    }
    if text.last() == Some(&b'.') {
        text.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, decimals: u32) -> String {
        let mut text = Vec::new();
        push_decimal(&mut text, value, decimals);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn numbers_are_short_and_without_a_negative_zero() {
        assert_eq!(text(0.0, 9), "0");
        assert_eq!(text(-0.0, 9), "0");
        assert_eq!(text(-1e-12, 9), "0");
        assert_eq!(text(0.1 + 0.2, 9), "0.3");
        assert_eq!(text(-12.5, 4), "-12.5");
        assert_eq!(text(1_234.000_000_001, 9), "1234.000000001");
        assert_eq!(text(100.0, 0), "100");
    }

    #[test]
    fn what_an_integer_cannot_hold_is_written_all_the_same() {
        assert_eq!(text(f64::NAN, 4), "NaN");
        assert_eq!(text(f64::INFINITY, 4), "inf");
        assert_eq!(text(f64::NEG_INFINITY, 4), "-inf");
        assert_eq!(text(1e15, 9), "1000000000000000");
        assert_eq!(text(123_456_789.5, 9), "123456789.5");
    }

    #[test]
    fn tick_times_are_exact_multiples_after_any_number_of_ticks() {
        // 2 kHz for eleven hours: the time in f64 is off by ulps, the text is not.
        for tick in [1_u64, 3, 7, 1_999, 7_200_001, 79_999_999] {
            let t_s = tick as f64 * 0.0005;
            let ten_thousandths = tick * 5;
            let expected = format!(
                "{}.{:04}",
                ten_thousandths / 10_000,
                ten_thousandths % 10_000
            );
            assert_eq!(
                text(t_s, 9),
                expected.trim_end_matches('0').trim_end_matches('.')
            );
        }
    }

    proptest! {
        /// Half a unit of the last place, plus one rounding in scaling (2^-53 of the value).
        #[test]
        fn reads_back_within_half_the_last_place(value in -1e7_f64..1e7, decimals in 0_u32..=9) {
            let back: f64 = text(value, decimals).parse().unwrap();
            let bound = 0.5 * 10_f64.powi(-(decimals as i32)) + value.abs() * f64::EPSILON;
            prop_assert!((back - value).abs() <= bound, "{value} became {back}");
        }
    }
}
