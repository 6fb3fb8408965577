//! Spatial modes of N phase errors around a circle.
//!
//! Axis i stands at θ = 2π i/N. A platform that is a rigid plane follows e = c + a cos θ + b sin θ: c is
//! the common mode, a and b are tilt, and what the best such fit leaves over is warp. As the axes
//! stand evenly, the least-squares fit is a discrete Fourier transform: c = Σe/N, a = 2/N Σ e cos θ,
//! b = 2/N Σ e sin θ. Two axes have only one tilt, a = (e₀ − e₁)/2, and b is 0. Up to three axes
//! there is no warp.

use crate::functions::{multiply_q30, sine_cosine};
use crate::units::Turns;

/// The modes of one set of drifts, turns of crank angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modes {
    /// Mean of all: lag if negative.
    pub common: Turns,
    /// Amplitude of cos θ: axis 0's side up or down.
    pub tilt_x: Turns,
    /// Amplitude of sin θ.
    pub tilt_y: Turns,
    /// Largest deviation, without sign, of an axis from the plane through all.
    pub warp: Turns,
    /// The axis that deviates so.
    pub warp_axis: usize,
}

impl Modes {
    /// Which side leads, degrees around the platform from axis 0 towards axis 1; for people to read.
    ///
    /// Positive errors lead there. Error below 0.2 degrees (micromath's arctangent).
    pub fn tilt_direction_deg(&self) -> f32 {
        let (x, y) = (self.tilt_x.to_num::<f32>(), self.tilt_y.to_num::<f32>());
        micromath::F32(y).atan2(micromath::F32(x)).0.to_degrees()
    }
}

/// Where `N` axes stand: cosines and sines, 30 fraction bits.
#[derive(Clone, Debug)]
pub struct Mount<const N: usize> {
    cosine: [i32; N],
    sine: [i32; N],
}

/// Fraction bits that are dropped of a drift: ±½ turn then has 30 bits, and so has a sum of six, each below its drift.
const DROPPED_BITS: u32 = 19;

impl<const N: usize> Mount<N> {
    /// 1/N, and the share that a tilt takes of a projection: 30 fraction bits.
    const MEAN: i32 = (1 << 30) / N as i32;
    const SHARE: i32 = if N == 2 { Self::MEAN } else { 2 * Self::MEAN };

    /// Evenly around the circle, axis 0 at θ = 0.
    pub fn new() -> Self {
        let place =
            |i: usize| sine_cosine(((i as u64 * (1 << 32) + N as u64 / 2) / N as u64) as u32);
        Self {
            cosine: core::array::from_fn(|i| place(i).cosine),
            sine: core::array::from_fn(|i| if N == 2 { 0 } else { place(i).sine }),
        }
    }

    /// Takes the drifts, each from −½ to ½ turn, apart.
    ///
    /// Error below 1e-6 of the largest, and 2⁻²⁵ turn: drifts are taken with 29 fraction bits, and up to twelve
    /// products are rounded down.
    #[inline(never)]
    pub fn modes(&self, drift: &[Turns; N]) -> Modes {
        let drift = drift.map(|e| (e.to_bits() >> DROPPED_BITS) as i32);
        let project = |weights: &[i32; N]| {
            let products = drift.iter().zip(weights);
            let sum = products.map(|(&e, &weight)| multiply_q30(e, weight)).sum();
            multiply_q30(sum, Self::SHARE)
        };
        let common = multiply_q30(drift.iter().sum(), Self::MEAN);
        let tilt_x = project(&self.cosine);
        let tilt_y = project(&self.sine);
        let (mut warp, mut warp_axis) = (0, 0);
        if N > 3 {
            for (axis, ((e, &cosine), &sine)) in
                drift.iter().zip(&self.cosine).zip(&self.sine).enumerate()
            {
                let plane = common + multiply_q30(tilt_x, cosine) + multiply_q30(tilt_y, sine);
                let off = (e - plane).abs();
                if off > warp {
                    (warp, warp_axis) = (off, axis);
                }
            }
        }
        let turns = |value: i32| Turns::from_bits(i64::from(value) << DROPPED_BITS);
        Modes {
            common: turns(common),
            tilt_x: turns(tilt_x),
            tilt_y: turns(tilt_y),
            warp: turns(warp),
            warp_axis,
        }
    }
}

impl<const N: usize> Default for Mount<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A plane plus, from four axes on, a warp of alternating sign that no plane contains.
    fn check<const N: usize>(common: f64, tilt: (f64, f64), warp: f64) {
        let tilt = if N == 2 { (tilt.0, 0.0) } else { tilt };
        let warp = if N == 4 || N == 6 { warp } else { 0.0 };
        let drift: [Turns; N] = core::array::from_fn(|i| {
            let theta = core::f64::consts::TAU * i as f64 / N as f64;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            Turns::from_num(common + tilt.0 * theta.cos() + tilt.1 * theta.sin() + sign * warp)
        });
        let modes = Mount::<N>::new().modes(&drift);
        for (name, got, want) in [
            ("common", modes.common, common),
            ("tilt_x", modes.tilt_x, tilt.0),
            ("tilt_y", modes.tilt_y, tilt.1),
            ("warp", modes.warp, warp.abs()),
        ] {
            let error = got.to_num::<f64>() - want;
            assert!(error.abs() < 1e-6, "N = {N}, {name}: off by {error:e}");
        }
    }

    #[test]
    fn direction_is_good_to_a_fifth_of_a_degree() {
        for degree in -179..180 {
            let theta = f64::from(degree).to_radians();
            let modes = Modes {
                tilt_x: Turns::from_num(0.01 * theta.cos()),
                tilt_y: Turns::from_num(0.01 * theta.sin()),
                ..Modes::default()
            };
            let error = f64::from(modes.tilt_direction_deg()) - f64::from(degree);
            assert!(error.abs() < 0.2, "{degree}: {error}");
        }
    }

    proptest! {
        #[test]
        fn what_was_put_in_comes_out(
            common in -0.2..0.2_f64,
            x in -0.1..0.1_f64,
            y in -0.1..0.1_f64,
            warp in -0.1..0.1_f64,
        ) {
            check::<2>(common, (x, y), warp);
            check::<3>(common, (x, y), warp);
            check::<4>(common, (x, y), warp);
            check::<5>(common, (x, y), warp);
            check::<6>(common, (x, y), warp);
        }
    }

    /// One crank out of five or six off by an electrical cycle: the plane takes 3/N of it, the rest
    /// is warp.
    #[test]
    fn a_single_axis_shows_as_tilt_and_warp() {
        let mut drift = [Turns::ZERO; 6];
        drift[2] = Turns::from_num(0.02);
        let modes = Mount::<6>::new().modes(&drift);
        assert!((modes.warp.to_num::<f64>() - 0.01).abs() < 1e-6);
        assert_eq!(modes.warp_axis, 2);
    }
}
