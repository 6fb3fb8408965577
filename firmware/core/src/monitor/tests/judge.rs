//! Limits, gates and errors of readings as `docs/detection.md` and `docs/faults.md` define them, computed apart from the monitor.

use super::cranks::settings;
use crate::settings::Settings;
use crate::units::{MAX_AXES, PerAxis};
use std::sync::LazyLock;
use std::vec::Vec;

/// Steps per turn of all axes here.
const STEPS: f64 = 3200.0;

/// Sensors of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sensors {
    None,
    Index,
    Encoder,
    Both,
}

impl Sensors {
    pub const fn has_index(self) -> bool {
        matches!(self, Self::Index | Self::Both)
    }

    pub const fn has_encoder(self) -> bool {
        matches!(self, Self::Encoder | Self::Both)
    }

    /// Readings of which an estimate is made. An encoder counts from its first reading. An index beside it is compared with a reading.
    pub const fn readings(self) -> u8 {
        match self {
            Self::None => 0,
            Self::Index => 1,
            Self::Encoder => 2,
            Self::Both => 3,
        }
    }
}

/// Machine whose limits and sensors are known.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    pub sensors: Vec<Sensors>,
    /// Steps of an electrical cycle; 0 for none.
    pub cycle_steps: u32,
    pub reading_error_deg: f64,
    pub tilt_limit_mrad: f64,
    pub warp_limit_deg: f64,
    pub common_limit_deg: f64,
    /// Phases at which the flags are.
    pub flags: PerAxis<f64>,
}

/// A mode: a limit, and the effect that an error of each crank has on what is compared with it.
struct Mode {
    limit: f64,
    effects: Vec<[f64; 2]>,
}

/// Amplitude of the phase error, turns, that tilts the platform of the sample settings by 1 mrad at the worst crank angle.
static TURNS_PER_MRAD: LazyLock<f64> = LazyLock::new(|| {
    let angles = (0..100_000).map(|i| f64::from(i) * core::f64::consts::PI / 100_000.0);
    let max_travel = angles.fold(0.0, |max: f64, alpha| {
        let (sin, cos) = alpha.sin_cos();
        max.max(sin + 0.3 * sin * cos / (1.0 - 0.09 * sin * sin).sqrt())
    });
    1e-3 * 0.25 / 0.02 / max_travel / core::f64::consts::TAU
});

impl Machine {
    pub fn settings(&self) -> Settings {
        let mut settings = settings(
            self.sensors.len(),
            self.tilt_limit_mrad,
            self.warp_limit_deg,
            self.common_limit_deg,
        );
        settings.drift.reading_error_deg = self.reading_error_deg;
        for (i, axis) in settings.axes.iter_mut().enumerate() {
            axis.cycle_steps = self.cycle_steps;
            axis.index_turns = self.sensors[i].has_index().then_some(self.flags[i]);
            axis.encoder = self.sensors[i].has_encoder();
        }
        settings
    }

    pub fn watched(&self) -> Vec<usize> {
        let axes = 0..self.sensors.len();
        axes.filter(|&i| self.sensors[i] != Sensors::None).collect()
    }

    /// r, the largest error of a reading, turns.
    pub fn tolerance(&self) -> f64 {
        self.reading_error_deg / 360.0 + 2.0 / STEPS
    }

    /// g, turns.
    pub fn gate(&self) -> f64 {
        let r = self.tolerance();
        let half = f64::from(self.cycle_steps) / STEPS / 2.0;
        let sure = if half - r < 2.0 * r { half } else { half - r };
        if half == 0.0 {
            4.0 * r
        } else {
            (4.0 * r).min(sure.max(2.0 * r))
        }
    }

    /// Largest error of an estimate of each axis if no reading errs by more than `reading`, turns.
    pub fn estimates(&self, reading: f64) -> Vec<f64> {
        let errors = self.sensors.iter();
        errors.map(|s| f64::from(s.readings()) * reading).collect()
    }

    fn place(&self, axis: usize) -> [f64; 2] {
        let count = self.sensors.len();
        let (sin, cos) = (core::f64::consts::TAU * axis as f64 / count as f64).sin_cos();
        [cos, if count == 2 { 0.0 } else { sin }]
    }

    /// Common part and slopes of the watched axes: the plane that fits these errors best, by orthogonal functions. Two axes show their mean
    /// and the least tilt, one shows its error.
    fn plane(&self, errors: &[f64]) -> [f64; 3] {
        let watched = self.watched();
        match *watched.as_slice() {
            [] => [0.0; 3],
            [only] => [errors[only], 0.0, 0.0],
            [a, b] => {
                let ([ax, ay], [bx, by]) = (self.place(a), self.place(b));
                let (x, y) = (ax - bx, ay - by);
                let slope = (errors[a] - errors[b]) / (x * x + y * y);
                [(errors[a] + errors[b]) / 2.0, slope * x, slope * y]
            }
            _ => {
                let functions = |i: usize| [1.0, self.place(i)[0], self.place(i)[1]];
                // Gram-Schmidt: each function less its projections on those before, as coefficients of the three.
                let mut basis: Vec<[f64; 3]> = Vec::new();
                let value = |c: &[f64; 3], i: usize| -> f64 {
                    c.iter().zip(functions(i)).map(|(c, f)| c * f).sum()
                };
                let product = |c: &[f64; 3], of: &dyn Fn(usize) -> f64| -> f64 {
                    watched.iter().map(|&i| value(c, i) * of(i)).sum()
                };
                for k in 0..3 {
                    let mut next = [0.0; 3];
                    next[k] = 1.0;
                    for before in &basis {
                        let part = product(before, &|i| functions(i)[k]);
                        (0..3).for_each(|j| next[j] -= part * before[j]);
                    }
                    let length = product(&next, &|i| value(&next, i)).sqrt();
                    basis.push(next.map(|c| c / length));
                }
                let mut plane = [0.0; 3];
                for function in &basis {
                    let part = product(function, &|i| errors[i]);
                    (0..3).for_each(|j| plane[j] += part * function[j]);
                }
                plane
            }
        }
    }

    /// Modes with their limits. After homing there is a common zero. Limits are lower by a reading error once a crank has moved, but at least
    /// half.
    fn modes(&self, is_homing: bool, has_moved: bool) -> Vec<Mode> {
        let watched = self.watched();
        let count = self.sensors.len();
        let planes: Vec<[f64; 3]> = (0..count)
            .map(|k| {
                let mut unit = [0.0; MAX_AXES];
                unit[k] = f64::from(u8::from(self.sensors[k] != Sensors::None));
                self.plane(&unit[..count])
            })
            .collect();
        let less = |limit: f64| {
            let reading = self.reading_error_deg / 360.0;
            if has_moved {
                (limit - reading).max(limit / 2.0)
            } else {
                limit
            }
        };
        let mode = |limit, effect: &dyn Fn(usize) -> [f64; 2]| Mode {
            limit,
            effects: (0..count).map(effect).collect(),
        };
        let tilt = mode(less(self.tilt_limit_mrad * *TURNS_PER_MRAD), &|k| {
            [planes[k][1], planes[k][2]]
        });
        let common = mode(self.common_limit_deg / 360.0, &|k| [planes[k][0], 0.0]);
        let mut modes = std::vec![tilt];
        if !is_homing {
            modes.push(common);
        }
        if watched.len() >= 4 {
            modes.extend(watched.iter().map(|&j| {
                let [x, y] = self.place(j);
                mode(less(self.warp_limit_deg / 360.0), &|k| {
                    let [c, a, b] = planes[k];
                    [f64::from(u8::from(j == k)) - c - a * x - b * y, 0.0]
                })
            }));
        }
        modes
    }

    /// A: error with which the estimate of one crank alone is beyond a limit, turns, whatever the readings err by, each by up to `reading`.
    /// In homing, and for a motor that moves with its encoder, no limit is lower because the crank has moved.
    pub fn single_axis_limit(
        &self,
        axis: usize,
        is_homing: bool,
        by_encoder: bool,
        reading: f64,
    ) -> f64 {
        let estimates = self.estimates(reading);
        // Readings that all err by so much in one turn, and by as much to the other side in the next, look like a common motion.
        let common_motion = if is_homing { 0.0 } else { 2.0 * reading };
        let min = |has_moved: bool| {
            let modes = self.modes(is_homing, has_moved).into_iter();
            let of_mode = modes.filter_map(|Mode { limit, effects }| {
                let [x, y] = effects[axis];
                let share = x.hypot(y);
                let others = effects.iter().zip(&estimates).enumerate();
                let hidden: f64 = others
                    .filter(|(i, _)| *i != axis)
                    .map(|(_, ([a, b], err))| ((a * x + b * y) / share * err).abs())
                    .sum();
                (share > 1e-9).then(|| (limit + common_motion + hidden) / share)
            });
            of_mode.fold(f64::INFINITY, f64::min)
        };
        if is_homing || by_encoder {
            return min(false);
        }
        // The motion of a crank counts from a reading, and less that of another.
        let noise = estimates[axis] + estimates.iter().copied().fold(0.0, f64::max);
        min(true).max(self.gate() + noise).min(min(false))
    }

    /// True if errors of estimates alone make no estimate of a crank exceed a limit.
    pub fn bears(&self, estimates: &[f64]) -> bool {
        let modes = self.modes(false, true).into_iter();
        let mut margins = modes.map(|mode| mode.limit - max(&mode, estimates));
        margins.all(|margin| margin > 0.0)
    }

    /// Largest factor by which `errors` can be multiplied so that no limit is exceeded, whatever the estimates err by.
    pub fn max_of(&self, errors: &[f64], estimates: &[f64]) -> f64 {
        let modes = self.modes(false, false).into_iter();
        let of_mode = modes.map(|mode| {
            let [x, y] = sum(&mode, |i| errors[i]);
            (mode.limit - max(&mode, estimates)) / x.hypot(y)
        });
        of_mode.fold(f64::INFINITY, f64::min)
    }
}

fn sum(mode: &Mode, error: impl Fn(usize) -> f64) -> [f64; 2] {
    let effects = mode.effects.iter().enumerate();
    effects.fold([0.0; 2], |[x, y], (i, [a, b])| {
        [x + a * error(i), y + b * error(i)]
    })
}

/// Largest change of a mode by errors of this size, over all their signs.
fn max(mode: &Mode, errors: &[f64]) -> f64 {
    let signs = 0..1_u32 << errors.len();
    let of_signs = signs.map(|signs| {
        let [x, y] = sum(mode, |i| {
            if signs & 1 << i == 0 {
                errors[i]
            } else {
                -errors[i]
            }
        });
        x.hypot(y)
    });
    of_signs.fold(0.0, f64::max)
}

/// If this fails, the margin of "No false alarm" is wrong.
#[test]
fn readings_of_all_cranks_change_a_mode_by_at_most_root_two_of_their_error() {
    for count in 2..=MAX_AXES {
        let machine = Machine {
            sensors: std::vec![Sensors::Index; count],
            cycle_steps: 0,
            reading_error_deg: 0.25,
            tilt_limit_mrad: 3.0,
            warp_limit_deg: 5.0,
            common_limit_deg: 15.0,
            flags: [0.0; MAX_AXES],
        };
        for mode in machine.modes(false, false) {
            let change = max(&mode, &std::vec![1.0; count]);
            assert!(change < 2.0_f64.sqrt() + 1e-12, "{count}: {change}");
        }
    }
}
