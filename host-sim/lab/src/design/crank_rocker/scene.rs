//! A designed crank-rocker as a scene: three units under a platform.

use core::f64::consts::TAU;

use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use super::Design;
use crate::design::scene::{NotRunnable, aligned, number};
use host_sim::mechanism::crank_rocker::CrankRocker;
use host_sim::mechanism::turn_search::max_over_turn;
use host_sim::mechanism::{Load, Mechanism, Platform};

/// Assumed values: number of units under the platform, load, kg, working speed, rev/s, and the ratio of the motors'
/// torque to the required torque.
const UNITS: u32 = 3;
const LOAD_KG: f64 = 20.0;
const SPEED_HZ: f64 = 6.0;
const SAFETY: f64 = 2.0;

impl Design {
    /// The scene, as TOML text. The design has no load, no speed and no motors, so these are assumed and marked.
    ///
    /// # Errors
    /// There is no screw.
    pub fn scene(&self) -> Result<String, NotRunnable> {
        let required = &self.requirement;
        let Some(lead_mm) = required.screw_lead_mm else {
            return Err(NotRunnable {
                problem: "a scene's rockers move a platform by screws; give --screw-lead-mm"
                    .to_owned(),
            });
        };
        let mechanism = CrankRocker::new(self.linkage, lead_mm / 1e3 / TAU);
        let [stretched_deg, folded_deg] = self.dead_centres_deg();
        let omega = TAU * SPEED_HZ;
        let load = Load {
            mass_kg: LOAD_KG,
            gravity_mps2: STANDARD_GRAVITY_MPS2,
            platform: Platform::Above,
        };
        let torque = max_over_turn(|a| mechanism.torque_nm(&load, a, omega, 0.0).abs());
        let motor_nm = number(SAFETY * torque.value / f64::from(UNITS));
        let amax_g = mechanism.amax_mps2(omega) / STANDARD_GRAVITY_MPS2;
        let limit_hz = number(1.05 * SPEED_HZ);
        Ok(aligned(&format!(
            "# Crank-rockers with screws under a platform, made by\n\
             # cophase design crank-rocker --swing-deg {} --pressure-deg {} --time-ratio {} --screw-lead-mm {lead_mm} --scene\n\
             # Lines marked \"assumed\" are no part of the design: put your machine's values there.\n\
             name = \"design\"\n\
             description = \"{UNITS} crank-rockers with screws, stroke {} mm\"\n\
             fidelity = \"quasi-static\"   # required against pull-out torque\n\
             \n[machine]\n\
             mechanism = \"crank-rocker\"\n\
             screw_lead_mm = {lead_mm}\n\
             crank_ratio = {:.7}\n\
             coupler_ratio = {:.7}\n\
             ground_ratio = {:.7}\n\
             load_kg = {LOAD_KG}               # assumed\n\
             \n[control]\n\
             park_deg = {:.3}            # folded dead centre, at the bottom\n\
             \n[limits]\n\
             speed_hz = {limit_hz}               # assumed\n\
             acceleration_hz_per_s = 4    # assumed\n\
             jerk_hz_per_s2 = 40          # assumed\n\
             \n[axes]\n\
             count = {UNITS}                    # assumed\n\
             drive = \"stepper\"            # assumed\n\
             steps_per_turn = 3200        # assumed\n\
             # [speed_hz, torque_nm]: {SAFETY} times what this load requires\n\
             pull_out = [[0, {motor_nm}], [{limit_hz}, {motor_nm}]]\n\
             \n[[program]]\n\
             amax_g = {}           # at {SPEED_HZ} rev/s\n\
             ramp_s = 3\n\
             hold_s = 3\n",
            required.swing_deg,
            required.pressure_deg,
            required.time_ratio,
            number(self.stroke_mm().unwrap_or_default()),
            self.linkage.crank,
            self.linkage.coupler,
            self.linkage.ground,
            folded_deg - stretched_deg,
            number(amax_g),
        )))
    }
}
