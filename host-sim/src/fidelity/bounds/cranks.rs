//! By how much each model level of a platform on cranks may be off the top one, output by output.

use std::f64::consts::TAU;

use super::linear::{Drive, Worst};
use super::{frame, rods};
use crate::dynamics::Driven;
use crate::fidelity::Output;
use crate::mechanism::Mechanism;
use crate::scene::file::Fidelity;

/// What is allowed for that the computation leaves out: coefficients that change within a turn, and transients.
///
/// A crank whose inertia and stiffness change by a part ε twice a turn answers, to first order, with sidebands of ε/2 each,
/// at most; where both are within their ranges of a resonance the worst over the ranges has been taken already.
const MARGIN: f64 = 1.5;

/// Factor on the steady answer of a mode that carries no crank, of a frame or of rods, as a ramp sets it swinging: at most twice that,
/// as if the ramp came at once.
const SET_SWINGING: f64 = 2.0;

/// What is to be known of a platform on cranks to bound what a model level leaves out.
#[derive(Clone, Debug)]
pub struct Cranks {
    worst: Worst,
    /// What a moving frame does to the platform's acceleration, as a part of it; 0 if the machine has none.
    frame: f64,
    /// What springs for rods do to it, which only model levels with cranks of their own know; 0 where rods settle.
    rods: f64,
    /// How far the platform is from where quasi-static rods have it, m; 0 where they spring.
    quasi_static_m: f64,
    /// mrad of tilt to a rad between cranks.
    tilt_mrad: f64,
    /// What is missed of a peak between two ticks, as a part of it.
    sampling: f64,
    /// Motors whose torque has a limit: steppers beyond it slip, servos fall behind.
    limited: Vec<bool>,
    /// Whether all cranks turn as one, which is all that the linear computation knows; up to three may also be apart. With more, rods
    /// pull on cranks that are apart, harder and softer over each turn, and what that excites has no bound here.
    in_phase: bool,
}

impl Cranks {
    /// Of a machine whose worst is known.
    pub fn new(
        driven: &Driven,
        drive: &Drive,
        worst: Worst,
        standing_apart_rad: f64,
        leads_apart: bool,
        (elastic, rod_zeta): (bool, f64),
    ) -> Self {
        let body = driven.body();
        let mechanism = &body.mechanism;
        let most_s = mechanism.greatest_s();
        let step_rad = drive.top_rad_s * drive.tick_s;
        Self {
            // Corners ± half the spread away: at most 0.71 of it in the plane of 3 to 6, 0.5 of two.
            tilt_mrad: 0.75e3 * mechanism.crank_radius_m() * most_s / body.mount_radius_m,
            // Half a tick beside the peak.
            sampling: mechanism.peak_sharpness() * step_rad * step_rad / 8.0,
            limited: driven
                .motors()
                .iter()
                .map(|motor| motor.most_nm(0.0).is_finite())
                .collect(),
            in_phase: !leads_apart
                && (body.axes() <= 3 || standing_apart_rad == 0.0 && worst.spread_rad == 0.0),
            frame: SET_SWINGING * frame::share(driven, drive),
            rods: if elastic {
                SET_SWINGING * rods::share(body, rod_zeta, drive)
            } else {
                0.0
            },
            quasi_static_m: if elastic {
                0.0
            } else {
                rods::quasi_static_m(body, rod_zeta, drive)
            },
            worst,
        }
    }

    /// The dimensionless numbers and phase errors that they are made of, in words.
    pub fn numbers(&self) -> String {
        let worst = &self.worst;
        let most = |used: &[f64]| used.iter().copied().fold(0.0, f64::max);
        let required = most(&worst.torque_ratio_required);
        if !required.is_finite() {
            return "at top speed a motor has no torque left".to_owned();
        }
        let lag = if worst.lag_rad.is_finite() {
            format!("lag of at most {:.2}°", degrees(worst.lag_rad))
        } else {
            "a lag that nothing bounds".to_owned()
        };
        format!(
            "torque ratio {required:.2} ({:.2} with what oscillates), frequency ratio {:.2}, {lag}",
            most(&worst.torque_ratio),
            worst.frequency_ratio,
        )
    }

    /// Axis whose motor has the smallest part of the torque that steady turning requires of it, and required over available torque:
    /// infinite where the motor has none left.
    pub fn torque_ratio(&self) -> (usize, f64) {
        let ratios = self.worst.torque_ratio_steady.iter().copied();
        // Of equal ones the first.
        let most = ratios.enumerate().rev().max_by(|a, b| a.1.total_cmp(&b.1));
        most.unwrap_or((0, 0.0))
    }

    /// How far the platform is from where quasi-static rods have it at most, m.
    pub fn quasi_static_m(&self) -> f64 {
        self.quasi_static_m
    }

    /// Whether every motor surely gives the torque that is required of it, oscillation and margin included.
    pub fn keeps_step(&self) -> bool {
        self.worst
            .torque_ratio
            .iter()
            .all(|used| MARGIN * used < 1.0)
    }

    /// By how much a model level's output may be off the top model level's, in the unit of its tolerance; infinite where the model level cannot
    /// answer, or nothing bounds it.
    pub fn of(&self, model_level: Fidelity, output: Output) -> f64 {
        if output == Output::Slips {
            return self.slips();
        }
        if output == Output::Ground {
            let knows = model_level == Fidelity::Elastic;
            return if knows { 0.0 } else { f64::INFINITY };
        }
        // Half slipped is anywhere, and motors that are alike do not slip alike where they swing past what they have.
        if model_level < Fidelity::Phased && !(self.keeps_step() && self.in_phase) {
            return f64::INFINITY;
        }
        match model_level {
            Fidelity::Kinematic if output == Output::Torque => f64::INFINITY,
            Fidelity::Auto | Fidelity::Kinematic | Fidelity::QuasiStatic => {
                self.left_out_below_rigid(output)
            }
            Fidelity::Rigid => self.left_out_by_rigid(output) + self.left_out_by_phased(output),
            Fidelity::Phased => self.left_out_by_phased(output),
            Fidelity::Elastic => 0.0,
        }
    }

    /// Cranks that never lag.
    fn left_out_below_rigid(&self, output: Output) -> f64 {
        let worst = &self.worst;
        // What changes the platform's acceleration changes what it asks of the cranks, where their lever is longest.
        let shaken = worst.torque_of_amax * (self.frame + self.rods);
        let of_torque = MARGIN * worst.torque + shaken;
        let shaken = 1.0 + shaken;
        match output {
            Output::Lag => degrees(MARGIN * self.bent(worst.lag_rad)) * shaken,
            Output::Spread => degrees(self.apart_rad()) * shaken,
            Output::Tilt => self.tilt_mrad * self.apart_rad() * shaken,
            Output::Amax => 100.0 * (MARGIN * worst.amax + self.sampling + self.frame + self.rods),
            Output::Torque => 100.0 * of_torque,
            Output::Slips | Output::Ground => 0.0,
        }
    }

    /// Cranks that lag alike.
    fn left_out_by_rigid(&self, output: Output) -> f64 {
        let rods = match output {
            Output::Amax => 100.0 * self.rods,
            Output::Torque => 100.0 * self.rods * self.worst.torque_of_amax,
            _ if self.rods == 0.0 => 0.0,
            _ => self.rods * self.worst.torque_of_amax * self.left_out_below_rigid(output),
        };
        if self.worst.spread_rad == 0.0 {
            return rods;
        }
        let worst = &self.worst;
        let apart = self.apart_rad();
        // The part of what a crank does that is not the others'.
        let part = (apart / (MARGIN * worst.lag_rad)).min(1.0);
        match output {
            Output::Lag | Output::Spread => degrees(apart) + rods,
            Output::Tilt => self.tilt_mrad * apart + rods,
            Output::Amax => 100.0 * (part * MARGIN * worst.amax + self.sampling) + rods,
            Output::Torque => {
                100.0 * (part * MARGIN * worst.torque + worst.spring_per_rad * apart) + rods
            }
            Output::Slips | Output::Ground => 0.0,
        }
    }

    /// A frame that does not move.
    fn left_out_by_phased(&self, output: Output) -> f64 {
        if self.frame == 0.0 {
            return 0.0;
        }
        // What shakes it by heave alone is known.
        if !self.in_phase {
            return f64::INFINITY;
        }
        match output {
            Output::Amax => 100.0 * self.frame,
            Output::Torque => 100.0 * self.frame * self.worst.torque_of_amax,
            _ => self.frame * self.worst.torque_of_amax * self.left_out_below_rigid(output),
        }
    }

    /// By how many motors a model level may be wrong about which of them slip. Where one may, nothing bounds it: a motor that
    /// slips leaves its load to the others, and a step of the method may decide which does.
    fn slips(&self) -> f64 {
        let worst = &self.worst.torque_ratio;
        let may_slip = |i: usize| self.limited[i] && !(self.in_phase && MARGIN * worst[i] < 1.0);
        if (0..worst.len()).any(may_slip) {
            f64::INFINITY
        } else {
            0.0
        }
    }

    fn apart_rad(&self) -> f64 {
        MARGIN * self.bent(self.worst.spread_rad)
    }

    /// What a spring that gives way as a sine does gives more than a straight one: asin(e)/e at the worst motor.
    fn bent(&self, rad: f64) -> f64 {
        let used = self.worst.torque_ratio.iter().copied().fold(0.0, f64::max);
        let used = (MARGIN * used).clamp(1e-9, 1.0);
        rad * used.asin() / used
    }
}

fn degrees(rad: f64) -> f64 {
    rad * 360.0 / TAU
}
