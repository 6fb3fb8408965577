//! A designed screen as a scene: its box on springs with one shaft.

use core::f64::consts::TAU;

use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use super::Design;
use crate::design::scene::{aligned, number};

/// Assumed ratio of the shaft's inertia to that of its block about the shaft's axis.
const SHAFT: f64 = 4.0;

impl Design {
    /// The scene, as TOML text. The design has no motor and no length of the box, so these are assumed and marked.
    pub fn scene(&self) -> String {
        let required = &self.requirement;
        let speed_hz = self.speed_rad_s() / TAU;
        let throw_m = required.exciter_kg * required.eccentricity_mm / 1e3 / self.whole_kg();
        let amax_g = throw_m * self.speed_rad_s().powi(2) / STANDARD_GRAVITY_MPS2;
        let inertia_kgm2 = SHAFT * required.exciter_kg * (required.eccentricity_mm / 1e3).powi(2);
        aligned(&format!(
            "# A screen with one unbalanced shaft, made by\n\
             # cophase design screen --exciter-kg {} --vibrating-kg {} --eccentricity-mm {} --speed-rpm {} --scene\n\
             # Lines marked \"assumed\" are no part of the design: put your machine's values there.\n\
             name = \"design\"\n\
             description = \"a box of {} kg on springs, one shaft at {} rpm\"\n\
             fidelity = \"kinematic\"       # the shaft as commanded; \"phased\" needs the drive's gains\n\
             \n[screen]\n\
             box_kg = {}\n\
             length_mm = 4000             # assumed\n\
             block_kg = {}\n\
             eccentricity_mm = {}\n\
             shafts_mm = [0]              # in the middle\n\
             stiffness_n_per_mm = {}  # G ω², of all springs together\n\
             \n[control]\n\
             park_deg = 270               # block at the bottom\n\
             \n[limits]\n\
             speed_hz = {}              # 5 % above the design's speed\n\
             acceleration_hz_per_s = {}  # assumed\n\
             jerk_hz_per_s2 = {}         # assumed\n\
             \n[axes]\n\
             count = 1\n\
             drive = \"pulse-servo\"        # assumed\n\
             steps_per_turn = 2000        # assumed\n\
             rotor_inertia_kgm2 = {}  # assumed\n\
             \n[[program]]\n\
             amax_g = {}           # throw · ω² at {} rev/s\n\
             ramp_s = 4\n\
             hold_s = 4\n",
            required.exciter_kg,
            required.vibrating_kg,
            required.eccentricity_mm,
            required.speed_rpm,
            required.vibrating_kg,
            required.speed_rpm,
            required.vibrating_kg,
            required.exciter_kg,
            required.eccentricity_mm,
            number(self.stiffness_n_per_m() / 1e3),
            number(1.05 * speed_hz),
            number(0.6 * speed_hz),
            number(6.0 * speed_hz),
            number(inertia_kgm2),
            number(amax_g),
            number(speed_hz),
        ))
    }
}
