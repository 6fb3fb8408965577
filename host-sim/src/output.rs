//! Outputs of a run that a scene can request.

use cophase_scene::file::Questions;

/// Output of a run, in the order of [`Output::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Largest lag or lead of a crank while running, degrees.
    Lag,
    /// Largest difference between two cranks' lags, degrees.
    Spread,
    /// Largest tilt of the platform, mrad.
    Tilt,
    /// Largest acceleration of the platform, m/s²; its tolerance is in percent of it.
    Amax,
    /// Largest torque of a motor, N·m; its tolerance is in percent of it.
    Torque,
    /// Set of the steppers that slipped and the servos that reached their torque limit, a bit each; always exact.
    Slips,
    /// Largest force on the ground beyond the weight, N; its tolerance is in percent of it.
    Ground,
}

impl Output {
    /// All outputs.
    pub const ALL: [Self; 7] = [
        Self::Lag,
        Self::Spread,
        Self::Tilt,
        Self::Amax,
        Self::Torque,
        Self::Slips,
        Self::Ground,
    ];

    /// Returns its key in `[questions]`, which has the unit of its tolerance.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Lag => "lag_deg",
            Self::Spread => "spread_deg",
            Self::Tilt => "tilt_mrad",
            Self::Amax => "amax_percent",
            Self::Torque => "torque_percent",
            Self::Slips => "slips",
            Self::Ground => "ground_percent",
        }
    }

    /// Returns its name in words. `axis` is the part that an axis turns, such as "crank".
    pub fn words(self, axis: &str) -> String {
        match self {
            Self::Lag => return format!("largest lag of a {axis}"),
            Self::Spread => return format!("largest phase difference of two {axis}s"),
            Self::Tilt => "largest tilt",
            Self::Amax => "greatest acceleration",
            Self::Torque => "greatest motor torque",
            Self::Slips => "motors that slip, or reach their torque limit",
            Self::Ground => "greatest force on the ground",
        }
        .to_owned()
    }

    /// Returns the unit of tolerance, bound and difference.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Lag | Self::Spread => "°",
            Self::Tilt => "mrad",
            Self::Amax | Self::Torque | Self::Ground => "%",
            Self::Slips => "motors",
        }
    }

    /// Returns the unit of its value.
    pub const fn value_unit(self) -> &'static str {
        match self {
            Self::Amax => "m/s²",
            Self::Torque => "N·m",
            Self::Ground => "N",
            Self::Lag | Self::Spread | Self::Tilt | Self::Slips => self.unit(),
        }
    }

    /// Returns the permitted error, if the output is requested.
    pub fn tolerance(self, questions: &Questions) -> Option<f64> {
        match self {
            Self::Lag => questions.lag_deg,
            Self::Spread => questions.spread_deg,
            Self::Tilt => questions.tilt_mrad,
            Self::Amax => questions.amax_percent,
            Self::Torque => questions.torque_percent,
            // Half a motor, so no motor may differ.
            Self::Slips => (questions.slips == Some(true)).then_some(0.5),
            Self::Ground => questions.ground_percent,
        }
    }

    /// Returns the difference between `found` and `right`, in the unit of the tolerance.
    pub fn difference(self, found: f64, right: f64) -> f64 {
        match self {
            Self::Lag | Self::Spread | Self::Tilt => (found - right).abs(),
            Self::Amax | Self::Torque | Self::Ground if found == right => 0.0,
            Self::Amax | Self::Torque | Self::Ground => (found / right - 1.0).abs() * 100.0,
            Self::Slips => f64::from((found as u64 ^ right as u64).count_ones()),
        }
    }
}
