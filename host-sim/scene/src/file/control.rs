//! Settings of the loop beside its machine: limits of the shaft, and corrections. The core has the tables of the others.

use super::is_unset;
use cophase_core::keys;
use cophase_core::settings::key::or_value;
use cophase_core::settings::rows::{COUPLING, COUPLING_PER_S, GAIN};
use cophase_core::settings::{
    ACCELERATION_HZ_PER_S, BAND_HZ, HOMING_SPEED_HZ, JERK_HZ_PER_S2, SPEED_HZ,
    STOP_ACCELERATION_HZ_PER_S, STOP_JERK_HZ_PER_S2,
};
use serde::{Deserialize, Serialize};

keys! {
    /// Limits of the master shaft.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Limits {
        /// Greatest speed, rev/s.
        speed_hz: f64 = SPEED_HZ,
        /// Greatest acceleration, rev/s².
        acceleration_hz_per_s: f64 = ACCELERATION_HZ_PER_S,
        /// Greatest jerk, rev/s³.
        jerk_hz_per_s2: f64 = JERK_HZ_PER_S2,
        /// Greatest acceleration of a stop after a fault, rev/s², as the motors' torque allows. The default is the acceleration
        /// above.
        stop_acceleration_hz_per_s: Option<f64> = STOP_ACCELERATION_HZ_PER_S,
        /// Greatest jerk of such a stop, rev/s³. The default is the jerk above.
        stop_jerk_hz_per_s2: Option<f64> = STOP_JERK_HZ_PER_S2,
        /// Homing speed, rev/s, also used to reach the parking phase.
        homing_speed_hz: f64 = HOMING_SPEED_HZ,
        /// Forbidden bands of speeds, lowest first.
        band: Vec<Band> = or_value("[]"),
    }
}

keys! {
    /// Band of speeds at which the machine must not dwell.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Band {
        /// Lower edge, rev/s.
        from_hz: f64 = BAND_HZ,
        /// Upper edge, rev/s.
        to_hz: f64 = BAND_HZ.such_as("12"),
    }
}

keys! {
    /// Corrections of phase errors.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Correction left out if is_unset, {
        /// Part of a difference between cranks that trims remove per turn; 0 for no correction.
        gain: f64 = GAIN,
        /// True if homing moves each crank by an amount of its own, and checks that this crank follows.
        prove_wiring: bool = or_value("false"),
        /// True for cross-coupling of servos. Gains that are not given are derived from `[axes.servo]`.
        couple: bool = or_value("false"),
        /// Proportional gain of the cross-coupling, from the deviation of an axis from the mean of all to its setpoint.
        coupling: Option<f64> = COUPLING,
        /// Integral gain of the cross-coupling, 1/s.
        coupling_per_s: Option<f64> = COUPLING_PER_S,
    }
}
