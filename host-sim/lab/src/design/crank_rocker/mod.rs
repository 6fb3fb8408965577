//! Synthesis of a crank-rocker from the swing of its rocker: a mixer drive whose stroke is set by the process, and not by the crank.
//!
//! The source is a paper of 2013 on a vibro-mixer. A screw turns the rocker's swing into the stroke of a rod. [`Requirement`] is the
//! required motion of the rocker. [`design`] returns the [`Linkage`] that meets it, or an error that names the parameter which prevents
//! it.
//!
//! Let α be the swing, and β the pressure angle where crank and coupler are stretched out. Let k be the time of the forward stroke over
//! that of the return. The angle between the two dead centres is Θ = 180° (1 − k) / (1 + k). Lengths over the rocker's are
//!
//! - crank: 2 q sin(Θ/2) cos(α/2 + Θ/2 − β),
//! - coupler: 2 q cos(Θ/2) sin(α/2 + Θ/2 − β),
//! - ground: √(B² − 2 B sin β + 1), with B = 2 q sin(α/2 + Θ − β),
//!
//! where q = sin(α/2) / sin Θ.

mod output;
mod scene;

use core::f64::consts::{PI, TAU};
use std::path::PathBuf;

use super::range::{OutOfRange, Range};
use crate::numbers::number;
use host_sim::mechanism::crank_rocker::Linkage;
use host_sim::mechanism::turn_search::max_over_turn;

/// Motion of the rocker, and the lead of the screw that it turns.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Requirement {
    /// Swing of the rocker, degrees: above 0, up to 179
    #[arg(long, value_name = "A", allow_hyphen_values = true, value_parser = number)]
    pub swing_deg: f64,
    /// Pressure angle where crank and coupler are stretched out, degrees: from 0 to below half the swing
    #[arg(long, value_name = "B", allow_hyphen_values = true, value_parser = number)]
    pub pressure_deg: f64,
    /// Time of the forward stroke over that of the return: 0.01 to 0.999
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = number)]
    pub time_ratio: f64,
    /// Lead of the screw that the rocker turns, mm: above 0, up to 1000
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = number)]
    pub screw_lead_mm: Option<f64>,
}

/// Options of the method.
#[derive(Clone, Debug, clap::Args)]
pub struct CrankRocker {
    #[command(flatten)]
    requirement: Requirement,
    /// Draw the linkage at both dead centres into this file, too
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

/// Reason why a requirement has no linkage.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Numbers out of their ranges: all of them, never empty. Prints a line each.
    #[error("{}", OutOfRange::lines(.0))]
    OutOfRange(Vec<OutOfRange>),
    /// With this pressure angle, no crank turns fully.
    #[error(
        "--pressure-deg {pressure_deg}: must be below half the swing, {half_swing_deg:.3}°; from there on the linkage folds flat and the \
         crank does not turn all round; try {try_deg:.1}"
    )]
    Pressure {
        /// The pressure angle that was given, degrees.
        pressure_deg: f64,
        /// Half the swing, degrees.
        half_swing_deg: f64,
        /// A third of the swing, which works with time ratios near 1.
        try_deg: f64,
    },
    /// The crank does not turn fully (Grashof).
    #[error(
        "--time-ratio {time_ratio}: no crank turns all round in this linkage: it must be the shortest link, with a Grashof margin above 0, \
         and is {crank:.3} rockers long with a margin of {margin:.3}; give a ratio nearer 1, such as 0.9"
    )]
    Grashof {
        /// The time ratio that was given.
        time_ratio: f64,
        /// Length of the crank, over the rocker.
        crank: f64,
        /// Grashof margin of the linkage, over the rocker.
        margin: f64,
    },
    /// The two dead centres belong to different assembly modes of the linkage.
    #[error(
        "--time-ratio {time_ratio}: the two dead centres lie on two branches of the linkage, and as assembled its rocker swings by \
         {swing_deg:.2}° instead of {requested_deg}°; give a ratio nearer 1, a larger --pressure-deg, or a smaller \
         --swing-deg"
    )]
    Branch {
        /// The time ratio that was given.
        time_ratio: f64,
        /// Swing of the linkage as it is assembled, degrees.
        swing_deg: f64,
        /// Swing that was requested, degrees.
        requested_deg: f64,
    },
}

/// Linkage that meets its requirement, and its figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Requirement that it meets.
    pub requirement: Requirement,
    /// Lengths over the rocker's.
    pub linkage: Linkage,
    /// Angle between the two directions of the coupler at the dead centres, degrees.
    pub theta_deg: f64,
}

/// Largest and least value over a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Largest.
    pub max: f64,
    /// Least.
    pub min: f64,
}

impl Extremes {
    fn over_turn(curve: impl Fn(f64) -> f64) -> Self {
        Self {
            max: max_over_turn(&curve).value,
            min: -max_over_turn(|angle| -curve(angle)).value,
        }
    }
}

impl Design {
    /// Crank angles of the dead centres, degrees from the ground line: stretched out, and folded.
    #[must_use]
    pub fn dead_centres_deg(&self) -> [f64; 2] {
        self.linkage.dead_centres_rad().map(f64::to_degrees)
    }

    /// Pressure angle over a turn, degrees.
    #[must_use]
    pub fn pressure_deg(&self) -> Extremes {
        let (min, max) = self.linkage.pressure_range_rad();
        Extremes {
            max: max.to_degrees(),
            min: min.to_degrees(),
        }
    }

    /// Mean of the signed pressure angle over a turn of the crank, degrees; the error is below 1e-9 of a degree.
    #[must_use]
    pub fn mean_pressure_deg(&self) -> f64 {
        // For a smooth periodic curve, the sum over evenly spaced points converges faster than any power of their number.
        let mean = |places: u32| {
            let angle = |i: u32| TAU * f64::from(i) / f64::from(places);
            let sum: f64 = (0..places)
                .map(|i| self.linkage.pressure_rad(angle(i)))
                .sum();
            (sum / f64::from(places)).to_degrees()
        };
        let (mut places, mut before) = (64, mean(32));
        loop {
            let now = mean(places);
            if (now - before).abs() < 1e-10 || places >= 1 << 20 {
                return now;
            }
            (places, before) = (2 * places, now);
        }
    }

    /// Rocker speed over crank speed, positive in the forward stroke.
    #[must_use]
    pub fn rocker_speed(&self) -> Extremes {
        Extremes::over_turn(|angle| self.linkage.at(angle).slope)
    }

    /// Rocker acceleration over the squared crank speed, at constant crank speed.
    #[must_use]
    pub fn rocker_acceleration(&self) -> Extremes {
        Extremes::over_turn(|angle| self.linkage.at(angle).curvature)
    }

    /// Stroke of the screw's rod, mm; none without a screw.
    #[must_use]
    pub fn stroke_mm(&self) -> Option<f64> {
        let lead_mm = self.requirement.screw_lead_mm?;
        Some(lead_mm * self.linkage.swing_rad() / TAU)
    }
}

const SWING: Range = Range::above_zero(
    "--swing-deg",
    179.0,
    "°",
    "the angles a rocker can swing through",
    60.0,
);

const PRESSURE: Range = Range {
    flag: "--pressure-deg",
    low: 0.0,
    closed: true,
    high: 90.0,
    unit: "°",
    meaning: "the pressure angles with which a coupler pushes at all",
    usual: 20.0,
};

const TIME_RATIO: Range = Range {
    flag: "--time-ratio",
    low: 0.01,
    closed: true,
    high: 0.999,
    unit: "",
    meaning: "the forward stroke's time over the return's; at 1 the dead centres coincide, and beyond it no coupler fits",
    usual: 0.9,
};

const SCREW_LEAD: Range = Range::above_zero(
    "--screw-lead-mm",
    1000.0,
    " mm",
    "the leads that screws are made with",
    12.0,
);

/// Rounding tolerance, rad, for the difference between the swing as assembled and the requested one.
const SAME_RAD: f64 = 1e-9;

/// Lengths for a requirement (the source's formulas 4, 14 and 16 to 18).
///
/// # Errors
/// Numbers out of their ranges, all of them; or the parameter that leaves no crank-rocker.
pub fn design(requirement: &Requirement) -> Result<Design, DesignError> {
    let Requirement {
        swing_deg,
        pressure_deg,
        time_ratio,
        screw_lead_mm,
    } = *requirement;
    let numbers = [
        (SWING, swing_deg),
        (PRESSURE, pressure_deg),
        (TIME_RATIO, time_ratio),
    ];
    let lead = screw_lead_mm.map(|lead_mm| (SCREW_LEAD, lead_mm));
    let wrong = OutOfRange::find_all(numbers.into_iter().chain(lead));
    if !wrong.is_empty() {
        return Err(DesignError::OutOfRange(wrong));
    }
    if pressure_deg >= 0.5 * swing_deg {
        return Err(DesignError::Pressure {
            pressure_deg,
            half_swing_deg: 0.5 * swing_deg,
            try_deg: swing_deg / 3.0,
        });
    }
    let theta = PI * (1.0 - time_ratio) / (1.0 + time_ratio);
    let linkage = synthesized(swing_deg.to_radians(), pressure_deg.to_radians(), theta);
    if !linkage.is_crank_rocker() {
        return Err(DesignError::Grashof {
            time_ratio,
            crank: linkage.crank,
            margin: linkage.grashof_margin(),
        });
    }
    let swing_rad = linkage.swing_rad();
    if (swing_rad - swing_deg.to_radians()).abs() > SAME_RAD {
        return Err(DesignError::Branch {
            time_ratio,
            swing_deg: swing_rad.to_degrees(),
            requested_deg: swing_deg,
        });
    }
    Ok(Design {
        requirement: *requirement,
        linkage,
        theta_deg: theta.to_degrees(),
    })
}

fn synthesized(swing: f64, pressure: f64, theta: f64) -> Linkage {
    let q = (0.5 * swing).sin() / theta.sin();
    let middle = 0.5 * swing + 0.5 * theta - pressure;
    let b = 2.0 * q * (0.5 * swing + theta - pressure).sin();
    Linkage {
        crank: 2.0 * q * (0.5 * theta).sin() * middle.cos(),
        coupler: 2.0 * q * (0.5 * theta).cos() * middle.sin(),
        ground: (b * b - 2.0 * b * pressure.sin() + 1.0).sqrt(),
    }
}
