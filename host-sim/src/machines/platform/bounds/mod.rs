//! Bounds on the error of each model level of a platform on cranks, relative to the top level, for each output.

mod frame;
mod linear;
mod required_torque;
mod rods;

use std::f64::consts::TAU;

use cophase_scene::file::{Fidelity, Rods};

use crate::drives::Motor;
use crate::dynamics::{Body, Frame, Mode};
use crate::machines::{Bounds, Duty};
use crate::mechanism::Mechanism;
use crate::output::Output;
use linear::{Worst, worst};

/// Factor for effects that the computation neglects: coefficients that change within a turn, and transients.
///
/// If inertia and stiffness of a crank change by a part ε twice a turn, its response has, to first order, sidebands of at most
/// ε/2 each. Where their ranges hold a resonance, the bound already uses the worst values in these ranges.
const MARGIN: f64 = 1.5;

/// Factor on the steady response of a mode of the frame or the rods, for the oscillation that a ramp excites. It is at most 2, as
/// for a step.
const SET_SWINGING: f64 = 2.0;

/// A platform on cranks that torque moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnCranks<'a> {
    pub body: &'a Body,
    /// Motors, one per axis.
    pub motors: &'a [Motor],
    /// Frame, if it moves.
    pub frame: Option<&'a Frame>,
    /// Fastest mode.
    pub mode: Mode,
}

/// Data of a platform on cranks from which the bounds follow.
#[derive(Clone, Debug)]
pub(super) struct Cranks {
    worst: Worst,
    /// Ratio of the [greatest load](crate::operating_range::OperatingRange::max_load) of a motor; 0 if the torque of none is known.
    steady_load: f64,
    /// Change of the platform's acceleration by a moving frame, relative to amax; 0 without a frame.
    frame: f64,
    /// Change of the platform's acceleration by elastic rods, relative to amax. Only levels from phased on compute it. It is 0 for
    /// quasi-static rods.
    rods: f64,
    /// Largest distance of the platform from its position on quasi-static rods, m; `None` for elastic rods.
    quasi_static_m: Option<f64>,
    /// Tilt per difference between two cranks, mrad/rad.
    tilt_mrad: f64,
    /// Largest part of a peak that the samples at ticks miss.
    sampling: f64,
    /// True for a motor with a torque limit: beyond it, a stepper slips and a servo lags.
    limited: Vec<bool>,
    /// True if all cranks turn in phase, as the linear computation assumes. Up to three cranks may also be apart. With more, the
    /// force of the rods on cranks that are apart changes within a turn, and its effect has no bound here.
    in_phase: bool,
    /// Fastest mode.
    mode: Mode,
}

impl Cranks {
    /// Creates the bounds of a platform with these rods and their damping factor.
    pub fn new(platform: &OnCranks<'_>, duty: &Duty<'_>, (rods, rod_zeta): (Rods, f64)) -> Self {
        let body = platform.body;
        let mechanism = &body.mechanism;
        let worst = worst(platform, duty);
        let step_rad = duty.top_rad_s * duty.tick_s;
        let has_elastic_rods = rods == Rods::Elastic;
        Self {
            // Corners that are off by ± half the spread tilt the plane of 3 to 6 of them by at most 0.71 of it, and of two by 0.5.
            tilt_mrad: 0.75e3 * mechanism.crank_radius_m() * mechanism.max_s()
                / body.mount_radius_m,
            // The nearest sample is at most half a tick from the peak.
            sampling: mechanism.peak_sharpness() * step_rad * step_rad / 8.0,
            limited: platform
                .motors
                .iter()
                .map(|motor| motor.max_nm(0.0).is_finite())
                .collect(),
            in_phase: !duty.leads_apart
                && (body.axes() <= 3 || duty.standing_apart_rad == 0.0 && worst.spread_rad == 0.0),
            frame: SET_SWINGING * frame::share(platform, duty),
            rods: if has_elastic_rods {
                SET_SWINGING * rods::share(body, rod_zeta, duty)
            } else {
                0.0
            },
            quasi_static_m: (!has_elastic_rods).then(|| rods::quasi_static_m(body, rod_zeta, duty)),
            worst,
            steady_load: duty.steady_load,
            mode: platform.mode,
        }
    }

    /// Returns true if every motor can give the required torque, including oscillation and margin.
    fn keeps_step(&self) -> bool {
        self.worst
            .torque_ratio
            .iter()
            .all(|used| MARGIN * used < 1.0)
    }

    /// Returns the bound of levels on which cranks do not lag.
    fn left_out_below_rigid(&self, output: Output) -> f64 {
        let worst = &self.worst;
        // A change of the platform's acceleration changes the required torque, most at the longest lever.
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

    /// Returns the bound of a level on which all cranks have the same lag.
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
        // Part of a crank's motion that the other cranks do not share.
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

    /// Returns the bound of a level on which the frame does not move.
    fn left_out_by_phased(&self, output: Output) -> f64 {
        if self.frame == 0.0 {
            return 0.0;
        }
        // The response of the frame is known for heave alone.
        if !self.in_phase {
            return f64::INFINITY;
        }
        match output {
            Output::Amax => 100.0 * self.frame,
            Output::Torque => 100.0 * self.frame * self.worst.torque_of_amax,
            _ => self.frame * self.worst.torque_of_amax * self.left_out_below_rigid(output),
        }
    }

    /// Returns the number of motors for which a model level may give a wrong answer about slipping. If one may slip, there is no
    /// bound: its load passes to the others, and the method's step may decide which of them slips.
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

    /// Returns the deflection of a motor whose torque is a sine of its lag, from that of a linear spring: times asin(e)/e at the worst
    /// motor.
    fn bent(&self, rad: f64) -> f64 {
        let used = self.worst.torque_ratio.iter().copied().fold(0.0, f64::max);
        let used = (MARGIN * used).clamp(1e-9, 1.0);
        rad * used.asin() / used
    }
}

impl Bounds for Cranks {
    fn of(&self, model_level: Fidelity, output: Output) -> f64 {
        if output == Output::Slips {
            return self.slips();
        }
        if output == Output::Ground {
            let knows = model_level == Fidelity::Elastic;
            return if knows { 0.0 } else { f64::INFINITY };
        }
        // A crank that slips can be anywhere, and equal motors that oscillate beyond their torque need not slip equally.
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

    fn mode(&self) -> Option<Mode> {
        Some(self.mode)
    }

    fn quasi_static_m(&self, model_level: Fidelity) -> Option<f64> {
        let moves_on_rods = matches!(model_level, Fidelity::Phased | Fidelity::Elastic);
        self.quasi_static_m.filter(|_| moves_on_rods)
    }

    fn numbers(&self) -> String {
        let worst = &self.worst;
        let max = |used: &[f64]| used.iter().copied().fold(0.0, f64::max);
        let required = max(&worst.torque_ratio_required);
        if !required.is_finite() {
            return "at top speed a motor has no torque left".to_owned();
        }
        let lag = if worst.lag_rad.is_finite() {
            format!("a crank lags by at most {:.2}°", degrees(worst.lag_rad))
        } else {
            "no limit of a crank's lag is known".to_owned()
        };
        // The torque of a servo without a limit is never used up.
        let torque = if required == 0.0 {
            "the scene limits no motor's torque".to_owned()
        } else {
            format!(
                "the motors need {:.0} % of their torque at a steady speed (bounds: {:.0} % with ramps, {:.0} % with oscillations)",
                100.0 * self.steady_load,
                100.0 * required,
                100.0 * max(&worst.torque_ratio)
            )
        };
        format!(
            "{torque}, the load oscillates at no more than {:.2} times a crank's natural frequency, and {lag}",
            worst.frequency_ratio
        )
    }
}

fn degrees(rad: f64) -> f64 {
    rad * 360.0 / TAU
}
