//! Sine and cosine together, from a quarter-wave table of 1,025 entries with linear interpolation.
//!
//! Linear interpolation over steps of 2π/4096 errs by at most (2π/4096)²/8 = 2.94e-7; rounding of
//! the table and of the product adds below 3e-9. The table is 4 KiB of flash.

use super::ONE_Q30;

/// Sine and cosine with 30 fraction bits: ±2³⁰ is ±1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SineCosine {
    /// Sine, 30 fraction bits.
    pub sine: i32,
    /// Cosine, 30 fraction bits.
    pub cosine: i32,
}

const STEPS: usize = 1024;
const INDEX_BITS: u32 = STEPS.trailing_zeros();
const QUARTER_BITS: u32 = 30; // bits of the angle below the quadrant
const REST_BITS: u32 = QUARTER_BITS - INDEX_BITS;

static QUARTER_WAVE: [i32; STEPS + 1] = quarter_wave();

/// Sine and cosine of an angle given as a fraction of a turn, 2³² to the turn.
///
/// Error at most 3.0e-7 (tested: mean, rms and maximum).
pub fn sine_cosine(angle: u32) -> SineCosine {
    let quadrant = angle >> QUARTER_BITS;
    let within = angle & ((1 << QUARTER_BITS) - 1);
    let rising = interpolate(within);
    let falling = interpolate((1 << QUARTER_BITS) - within);
    let (sine, cosine) = match quadrant {
        0 => (rising, falling),
        1 => (falling, -rising),
        2 => (-rising, -falling),
        _ => (-falling, rising),
    };
    SineCosine { sine, cosine }
}

/// The sine over the first quarter, `within` from 0 to 2³⁰ inclusive.
fn interpolate(within: u32) -> i32 {
    let index = (within >> REST_BITS) as usize;
    let rest = (within & ((1 << REST_BITS) - 1)) as i32;
    let Some(&low) = QUARTER_WAVE.get(index) else {
        return ONE_Q30;
    };
    let Some(&high) = QUARTER_WAVE.get(index + 1) else {
        return low; // the very end of the quarter: the last entry is exact
    };
    // A step of the table is below 2^21 and the rest below 2^20: the product needs 64 bits, or two
    // shifts. The lost bits are 2^-30 of a step.
    low + ((i64::from(high - low) * i64::from(rest)) >> REST_BITS) as i32
}

const fn quarter_wave() -> [i32; STEPS + 1] {
    let mut table = [0; STEPS + 1];
    let mut i = 0;
    while i <= STEPS {
        let angle = core::f64::consts::FRAC_PI_2 * (i as f64) / (STEPS as f64);
        table[i] = (sine_series(angle) * (ONE_Q30 as f64) + 0.5) as i32;
        i += 1;
    }
    table
}

/// Taylor's series, for compile time only: below 1e-17 over the first quarter.
const fn sine_series(angle: f64) -> f64 {
    let mut term = angle;
    let mut sum = angle;
    let mut n = 1.0;
    while n < 25.0 {
        term = -term * angle * angle / ((n + 1.0) * (n + 2.0));
        sum += term;
        n += 2.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Interpolating a sine with chords always errs inwards; over a step of size h the mean is
    /// h²/12 · mean|sin| and the rms h²/sqrt(120) · rms(sin), h = 2π/4096.
    #[test]
    fn error_is_as_derived() {
        let h = core::f64::consts::TAU / 4096.0;
        let (mut sum, mut squares, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        let samples = 1_000_003_u32; // prime: falls everywhere between the entries
        for i in 0..samples {
            let angle = ((u64::from(i) << 32) / u64::from(samples)) as u32;
            let got = sine_cosine(angle);
            let radians = f64::from(angle) / 4294967296.0 * core::f64::consts::TAU;
            for (got, want) in [(got.sine, radians.sin()), (got.cosine, radians.cos())] {
                let error = (f64::from(got) / f64::from(ONE_Q30) - want).abs();
                sum += error;
                squares += error * error;
                worst = worst.max(error);
            }
        }
        let count = 2.0 * f64::from(samples);
        let mean = sum / count;
        let rms = (squares / count).sqrt();
        let mean_derived = h * h / 12.0 * 2.0 / core::f64::consts::PI;
        let rms_derived = h * h / 120.0_f64.sqrt() / 2.0_f64.sqrt();
        assert!((mean / mean_derived - 1.0).abs() < 0.01, "mean {mean:e}");
        assert!((rms / rms_derived - 1.0).abs() < 0.01, "rms {rms:e}");
        assert!(worst < 3.0e-7, "max {worst:e}");
    }

    #[test]
    fn quadrant_corners_are_exact() {
        for (angle, sine, cosine) in [
            (0, 0, ONE_Q30),
            (1 << 30, ONE_Q30, 0),
            (2 << 30, 0, -ONE_Q30),
            (3 << 30, -ONE_Q30, 0),
        ] {
            assert_eq!(sine_cosine(angle), SineCosine { sine, cosine });
        }
    }
}
