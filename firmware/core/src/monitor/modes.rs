//! Spatial modes of N phase errors around a circle.
//!
//! Axis i stands at θ = 2π i/N. A platform that is a rigid plane follows e = c + a cos θ + b sin θ: c is
//! the common mode, a and b are tilt, and the remainder of the best such fit is warp. As the axes
//! stand evenly, the least-squares fit is a discrete Fourier transform: c = Σe/N, a = 2/N Σ e cos θ,
//! b = 2/N Σ e sin θ. Two axes have only one tilt, a = (e₀ − e₁)/2, and b is 0. Up to three axes
//! there is no warp.
//!
//! If some axes have no sensor, there are fewer equations ([`Knowledge`] says how many), and the weights of the best plane differ.
//! Errors of the plane grow as it is extrapolated: opposite three neighbours of six they are six times as large.

use core::hash::{Hash, Hasher};

use super::angles::Angle;
use crate::functions::multiply_q30;
use crate::units::{AxisSet, MAX_AXES, PerAxis, Turns};

/// The modes of one set of phase errors, turns of crank angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modes {
    /// Mean of all: lag if negative.
    pub common: Turns,
    /// Amplitude of cos θ: tilt towards axis 0.
    pub tilt_x: Turns,
    /// Amplitude of sin θ.
    pub tilt_y: Turns,
    /// Largest deviation, without sign, of an axis from the plane through all.
    pub warp: Turns,
}

impl Modes {
    /// Modes of cranks without phase errors.
    pub const ZERO: Self = Self {
        common: Turns::ZERO,
        tilt_x: Turns::ZERO,
        tilt_y: Turns::ZERO,
        warp: Turns::ZERO,
    };

    /// Side on which the errors are positive, degrees around the platform from axis 0 towards axis 1, from −180 to 180; none if
    /// the errors do not tilt it. The error is below 0.2 degrees (micromath's arctangent).
    pub fn tilt_direction_deg(&self) -> Option<f32> {
        let (x, y) = (self.tilt_x.to_num::<f32>(), self.tilt_y.to_num::<f32>());
        let tilts = (x, y) != (0.0, 0.0);
        tilts.then(|| micromath::F32(y).atan2(micromath::F32(x)).0.to_degrees())
    }
}

/// Weights that separate the phase errors of evenly spaced axes into modes. Some or all axes have sensors.
#[derive(Clone, Debug)]
pub struct Mount {
    axes: PerAxis<MountedAxis>,
    detected: AxisSet,
}

/// Part of one axis in the modes.
#[derive(Clone, Copy, Debug, Hash)]
struct MountedAxis {
    /// Weights of its phase error in common mode and tilt, 28 fraction bits; zero if it is not detected.
    common: i32,
    tilt_x: i32,
    tilt_y: i32,
    /// Cosine and sine of its angle, 30 fraction bits.
    cosine: i32,
    sine: i32,
}

impl MountedAxis {
    const NONE: Self = Self {
        common: 0,
        tilt_x: 0,
        tilt_y: 0,
        cosine: 0,
        sine: 0,
    };
}

/// Fraction bits that are dropped from an angle. ±½ turn then fits 30 bits, and so does a weighted sum of six.
const DROPPED_BITS: u32 = 3;

/// Fraction bits of a product of a drift and a weight, less those of a drift.
const WEIGHT_BITS: u32 = 28;

/// One turn in the unit of phase error times weight.
const ONE_TURN_OF_SUM: i32 = 1 << (32 - DROPPED_BITS + WEIGHT_BITS - 30);

/// Modes that a set of axes shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// Nothing.
    Nothing,
    /// One axis: it stands for all. Tilt is not known.
    Common,
    /// Two: the common part, and the least tilt that explains their difference.
    OneTilt,
    /// Three: a plane. Warp is not known.
    Plane,
    /// Four and more: the plane that fits best, and the deviations from it.
    All,
}

impl Mount {
    /// Mount without axes.
    pub(super) const NONE: Self = Self {
        axes: [MountedAxis::NONE; MAX_AXES],
        detected: 0,
    };

    /// `count` axes evenly around the circle, axis 0 at θ = 0, all of them detected.
    pub fn new(count: usize) -> Self {
        Self::with(count, ((1_u32 << count) - 1) as AxisSet)
    }

    /// The same, of which only some are detected.
    #[cold]
    pub fn with(count: usize, detected: AxisSet) -> Self {
        let theta = |i: usize| core::f64::consts::TAU * i as f64 / count as f64;
        let place = |i: usize| {
            // With two axes there is no second direction to tilt in.
            let sine = if count == 2 { 0.0 } else { libm::sin(theta(i)) };
            (libm::cos(theta(i)), sine)
        };
        let axes = || (0..count).filter(|&axis| detected & 1 << axis != 0);
        let mut weights = [[0.0; 3]; MAX_AXES];
        if axes().count() >= 3 {
            // The normal equations of the best plane: M c = Σ e (1, cos θ, sin θ).
            let mut normal = [[0.0; 3]; 3];
            for (x, y) in axes().map(place) {
                let row = [1.0, x, y];
                for i in 0..3 {
                    for j in 0..3 {
                        normal[i][j] += row[i] * row[j];
                    }
                }
            }
            let inverse = inverse(&normal);
            for axis in axes() {
                let (x, y) = place(axis);
                weights[axis] = inverse.map(|row| row[0] + row[1] * x + row[2] * y);
            }
        } else if let (Some(a), Some(b)) = (axes().next(), axes().nth(1)) {
            let ((ax, ay), (bx, by)) = (place(a), place(b));
            let (dx, dy) = (ax - bx, ay - by);
            let square = dx * dx + dy * dy;
            weights[a] = [0.5, dx / square, dy / square];
            weights[b] = [0.5, -dx / square, -dy / square];
        } else if let Some(axis) = axes().next() {
            weights[axis][0] = 1.0;
        }
        let fixed = |value: f64, bits: u32| libm::round(value * f64::from(1_u32 << bits)) as i32;
        Self {
            axes: core::array::from_fn(|i| {
                let [common, tilt_x, tilt_y] = weights[i].map(|weight| fixed(weight, WEIGHT_BITS));
                let (cosine, sine) = place(i);
                MountedAxis {
                    common,
                    tilt_x,
                    tilt_y,
                    cosine: fixed(cosine, 30),
                    sine: fixed(sine, 30),
                }
            }),
            detected,
        }
    }

    /// Hashes the part of an axis. Returns false for the axis after the last.
    #[inline(always)]
    pub(crate) fn hash_axis(&self, axis: usize, hasher: &mut impl Hasher) -> bool {
        let axis = self.axes.get(axis);
        axis.hash(hasher);
        axis.is_some()
    }

    /// Axes that are detected.
    pub(crate) const fn detected(&self) -> AxisSet {
        let Self { axes: _, detected } = self;
        *detected
    }

    /// Modes that these axes show.
    pub const fn knowledge(&self) -> Knowledge {
        match self.detected.count_ones() {
            0 => Knowledge::Nothing,
            1 => Knowledge::Common,
            2 => Knowledge::OneTilt,
            3 => Knowledge::Plane,
            _ => Knowledge::All,
        }
    }

    /// Tilt, and warp of the axis itself, if this axis alone has a phase error of one.
    #[cold]
    pub(super) fn single_axis_limit(&self, axis: usize) -> (f64, f64) {
        let float = |value: i32, bits: u32| f64::from(value) / f64::from(1_u32 << bits);
        let axis = self.axes.get(axis).unwrap_or(&MountedAxis::NONE);
        let weight = |value: i32| float(value, WEIGHT_BITS);
        let (common, x, y) = (
            weight(axis.common),
            weight(axis.tilt_x),
            weight(axis.tilt_y),
        );
        let warp = if self.knowledge() == Knowledge::All {
            1.0 - common - x * float(axis.cosine, 30) - y * float(axis.sine, 30)
        } else {
            0.0
        };
        (libm::sqrt(x * x + y * y), warp)
    }

    /// Decomposes the phase errors; those of axes that are not detected are ignored.
    ///
    /// Error below 1e-6 of the largest, and 2⁻²⁵ turn: phase errors are taken with 29 fraction bits, and up to twelve
    /// products are rounded down.
    #[inline(never)]
    pub fn modes(&self, phase_error: &PerAxis<Angle>) -> Modes {
        // The weights of axes that do not exist are zero.
        let axes = || {
            let errors = phase_error.iter();
            let errors = errors.map(|e| e.0.to_bits() >> DROPPED_BITS);
            errors.zip(&self.axes)
        };
        let (mut common, mut tilt_x, mut tilt_y) = (0, 0, 0);
        for (e, axis) in axes() {
            common += multiply_q30(e, axis.common);
            tilt_x += multiply_q30(e, axis.tilt_x);
            tilt_y += multiply_q30(e, axis.tilt_y);
        }
        // Three neighbours of six that are all far off would be extrapolated to several turns.
        let sum = |of: i32| of.clamp(-ONE_TURN_OF_SUM, ONE_TURN_OF_SUM) << (30 - WEIGHT_BITS);
        let (common, tilt_x, tilt_y) = (sum(common), sum(tilt_x), sum(tilt_y));
        let mut warp = 0;
        if self.knowledge() == Knowledge::All {
            let mut detected = self.detected;
            for (e, axis) in axes() {
                if detected & 1 != 0 {
                    let tilt = multiply_q30(tilt_x, axis.cosine) + multiply_q30(tilt_y, axis.sine);
                    warp = warp.max((e - (common + tilt)).abs());
                }
                detected >>= 1;
            }
        }
        let turns = |value: i32| Turns::from_bits(i64::from(value) << (DROPPED_BITS + 16));
        Modes {
            common: turns(common),
            tilt_x: turns(tilt_x),
            tilt_y: turns(tilt_y),
            warp: turns(warp),
        }
    }
}

/// Inverse of a symmetric matrix, which must be invertible.
#[cold]
fn inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |r: usize, c: usize| {
        let (r1, r2) = ((r + 1) % 3, (r + 2) % 3);
        let (c1, c2) = ((c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * minor(0, c)).sum();
    core::array::from_fn(|r| core::array::from_fn(|c| minor(c, r) / determinant))
}

#[cfg(test)]
mod tests {
    use super::super::angles::angle;
    use super::*;
    use proptest::prelude::*;

    /// A plane plus, from four axes on, a warp of alternating sign that no plane contains.
    fn check(count: usize, common: f64, tilt: (f64, f64), warp: f64) {
        let tilt = if count == 2 { (tilt.0, 0.0) } else { tilt };
        let warp = if count == 4 || count == 6 { warp } else { 0.0 };
        let phase_error: PerAxis<Turns> = core::array::from_fn(|i| {
            let theta = core::f64::consts::TAU * i as f64 / count as f64;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            Turns::from_num(common + tilt.0 * theta.cos() + tilt.1 * theta.sin() + sign * warp)
        });
        let modes = Mount::new(count).modes(&phase_error.map(angle));
        for (name, actual, expected) in [
            ("common", modes.common, common),
            ("tilt_x", modes.tilt_x, tilt.0),
            ("tilt_y", modes.tilt_y, tilt.1),
            ("warp", modes.warp, warp.abs()),
        ] {
            let error = actual.to_num::<f64>() - expected;
            assert!(error.abs() < 1e-6, "N = {count}, {name}: off by {error:e}");
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
            let direction = modes.tilt_direction_deg().unwrap();
            let error = f64::from(direction) - f64::from(degree);
            assert!(error.abs() < 0.2, "{degree}: {error}");
        }
    }

    /// If this fails, equal errors have a direction, and a report says that cranks lead at NaN degrees.
    #[test]
    fn errors_that_do_not_tilt_have_no_direction() {
        let modes = Modes {
            common: Turns::from_num(0.1),
            ..Modes::default()
        };
        assert_eq!(modes.tilt_direction_deg(), None);
    }

    proptest! {
        #[test]
        fn what_was_put_in_comes_out(
            common in -0.2..0.2_f64,
            x in -0.1..0.1_f64,
            y in -0.1..0.1_f64,
            warp in -0.1..0.1_f64,
        ) {
            for count in 2..=MAX_AXES {
                check(count, common, (x, y), warp);
            }
        }
    }

    /// Every subset of sensors gives the modes that it can show: a plane from three, a tilt and the mean from two, the mean from one.
    #[test]
    fn missing_sensors_leave_fewer_equations() {
        for count in 2..=MAX_AXES {
            let (c, x, y) = (0.01, 0.02, if count == 2 { 0.0 } else { -0.015 });
            let theta = |i: usize| core::f64::consts::TAU * i as f64 / count as f64;
            let plane = |i: usize| c + x * theta(i).cos() + y * theta(i).sin();
            for detected in 0..1_u32 << count {
                let mount = Mount::with(count, detected as AxisSet);
                // Errors that are not detected have arbitrary values, and must not count.
                let phase_error = core::array::from_fn(|i| {
                    let e = if detected & 1 << i == 0 {
                        0.3
                    } else {
                        plane(i)
                    };
                    Turns::from_num(e)
                });
                let modes = mount.modes(&phase_error.map(angle));
                let actual = [modes.common, modes.tilt_x, modes.tilt_y].map(Turns::to_num::<f64>);
                assert!(modes.warp.to_num::<f64>() < 1e-6, "a plane has no warp");
                let detected: std::vec::Vec<_> =
                    (0..count).filter(|i| detected & 1 << i != 0).collect();
                let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
                match (mount.knowledge(), detected.as_slice()) {
                    (Knowledge::Nothing, []) => assert_eq!(actual, [0.0; 3]),
                    (Knowledge::Common, &[a]) => assert!(near(actual[0], plane(a))),
                    (Knowledge::OneTilt, &[a, b]) => {
                        assert!(near(actual[0], (plane(a) + plane(b)) / 2.0));
                        let at = |i: usize| actual[1] * theta(i).cos() + actual[2] * theta(i).sin();
                        assert!(near(at(a) - at(b), plane(a) - plane(b)));
                        let min = (plane(a) - plane(b)).abs();
                        assert!(
                            actual[1].hypot(actual[2]) <= min + 1e-6,
                            "not the least tilt"
                        );
                    }
                    (Knowledge::Plane | Knowledge::All, _) => {
                        assert!(
                            near(actual[0], c) && near(actual[1], x) && near(actual[2], y),
                            "{actual:?}"
                        );
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    /// One crank out of five or six is off by an electrical cycle. The plane takes 3/N of it, and the rest
    /// is warp.
    #[test]
    fn a_single_axis_shows_as_tilt_and_warp() {
        let mut phase_error = PerAxis::default();
        phase_error[2] = Turns::from_num(0.02);
        let modes = Mount::new(6).modes(&phase_error.map(angle));
        assert!((modes.warp.to_num::<f64>() - 0.01).abs() < 1e-6);
    }
}
