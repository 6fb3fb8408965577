//! Sine and cosine together, from a quarter-wave table of 1,025 entries and two terms of Taylor's
//! series, with products of 32 bits only.
//!
//! The nearest entry of the table is at most δ = π/4096 away. It gives sine and cosine at that place, s and c:
//!
//! ```text
//! sin(a + δ) = s + cδ − sδ²/2        cos(a + δ) = c − sδ − cδ²/2
//! ```
//!
//! The omitted term, δ³/6, is 7.5e-11. Products of 32 bits add three errors: δ is rounded to 25 fraction bits (at most
//! 1.5e-8), its factor is truncated to 16 (2⁻¹⁶ δ = 1.2e-8), and 2π to 12 bits (2.3e-9). The table takes 4 KiB of flash.

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
const QUADRANT: u32 = 1 << 30; // as an angle, with 2³² to the turn
const STEP: u32 = QUADRANT / STEPS as u32;
const TWO_PI_Q9: i32 = 3217; // 2π · 2⁹, to 3e-6

static QUARTER_WAVE: [i32; STEPS + 1] = quarter_wave();

/// Sine and cosine of an angle given as a fraction of a turn, 2³² to the turn.
///
/// The absolute error is at most 3.2e-8 (tested: mean, rms and maximum); whole quarters are exact.
pub fn sine_cosine(angle: u32) -> SineCosine {
    let rounded = angle.wrapping_add(STEP / 2);
    let index = (rounded % QUADRANT / STEP) as usize;
    let (s, c) = (QUARTER_WAVE[index], QUARTER_WAVE[STEPS - index]);

    let rest = (rounded % STEP) as i32 - (STEP / 2) as i32;
    let delta_q25 = (rest * TWO_PI_Q9 + (1 << 15)) >> 16; // below 2¹⁵
    let half_square_q36 = (delta_q25 * delta_q25) >> 15;
    let sine = s + (((c >> 14) * delta_q25) >> 11) - (((s >> 15) * half_square_q36) >> 21);
    let cosine = c - (((s >> 14) * delta_q25) >> 11) - (((c >> 15) * half_square_q36) >> 21);

    let quadrant = rounded / QUADRANT;
    let (sine, cosine) = if quadrant & 1 == 0 {
        (sine, cosine)
    } else {
        (cosine, -sine)
    };
    if quadrant & 2 == 0 {
        SineCosine { sine, cosine }
    } else {
        SineCosine {
            sine: -sine,
            cosine: -cosine,
        }
    }
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

/// Taylor's series, for compile time only; its error is below 1e-17 over the first quarter.
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

    /// Independent errors add in squares. The average is over whole turns, with δ uniform between ±π/4096.
    ///
    /// - The rounding of δ is uniform within 2⁻²⁶ and multiplied by a cosine (1/√2).
    /// - The truncation of the factor is uniform from 0 to 2⁻¹⁶ and multiplied by δ.
    /// - The error of 2π is multiplied by both. It always raises what the truncation always lowers, so twice their mean
    ///   product is subtracted.
    /// - Roundings to 30 bits are 2⁻³⁰/√12 each for the table and two products. In one of the two results both products
    ///   are subtracted, and their truncations add up to 2⁻³⁰.
    ///
    /// The sum's distribution lies between uniform (mean/rms = √3/2) and normal (√(2/π)).
    #[test]
    fn error_statistics_match_their_derivation() {
        let (mut sum, mut squares, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        let samples = 1_000_003_u32; // prime, so samples fall everywhere between the entries
        for i in 0..samples {
            let angle = ((u64::from(i) << 32) / u64::from(samples)) as u32;
            let actual = sine_cosine(angle);
            let radians = f64::from(angle) / 4294967296.0 * core::f64::consts::TAU;
            for (actual, expected) in [(actual.sine, radians.sin()), (actual.cosine, radians.cos())]
            {
                let error = (f64::from(actual) / f64::from(ONE_Q30) - expected).abs();
                sum += error;
                squares += error * error;
                worst = worst.max(error);
            }
        }
        let count = 2.0 * f64::from(samples);
        let mean = sum / count;
        let rms = (squares / count).sqrt();
        let delta = core::f64::consts::PI / 4096.0;
        let bit = |n: i32| f64::from(-n).exp2();
        let two_pi = f64::from(TWO_PI_Q9) / 512.0 / core::f64::consts::TAU - 1.0;
        let squares_derived = bit(26).powi(2) / 3.0 / 2.0
            + bit(16).powi(2) / 3.0 * (delta * delta / 3.0)
            + two_pi.powi(2) / 2.0 * (delta * delta / 3.0)
            - 2.0 * bit(17) * two_pi * core::f64::consts::FRAC_2_PI * (delta * delta / 3.0)
            + bit(30).powi(2) * (3.0 / 12.0 + 1.0 / 2.0);
        let rms_derived = squares_derived.sqrt();
        assert!(
            (rms / rms_derived - 1.0).abs() < 0.02,
            "rms {rms:e}, {rms_derived:e}"
        );
        assert!((0.79..0.87).contains(&(mean / rms)), "mean {mean:e}");
        assert!(worst < 3.2e-8, "max {worst:e}");
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
