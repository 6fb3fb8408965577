//! Rows of the keys that a scene has in other units or tables than the settings: those of `[machine]`, `[axes]` and `[correction]`.

use cophase_motion::settings::key::{Key, needed, optional, or, or_value};

use super::Transmission;
use crate::pulse::StepsPerTurn;
use crate::units::STANDARD_GRAVITY_MPS2;

const HALF_A_TURN: &str = "half a turn either way";
const MAX_TRIM_DEG: f64 = 36.0;

/// `machine.crank_radius_mm`
pub const CRANK_RADIUS_MM: Key = optional("20")
    .from(0.1, 500.0)
    .because("the cranks that a vibration platform is built with");
/// `machine.load_kg`
pub const LOAD_KG: Key = needed("2")
    .from(1e-3, 50.0)
    .because("the loads that one platform carries");
/// `machine.gravity_mps2`
pub const GRAVITY_MPS2: Key = or(STANDARD_GRAVITY_MPS2).from(0.0, 20.0);
/// `machine.mount_radius_mm`
pub const MOUNT_RADIUS_MM: Key = or(250.0).from(10.0, 5000.0);

/// `axes.steps_per_turn`
pub const STEPS_PER_TURN: Key = needed("3200")
    .from(4.0, StepsPerTurn::MAX)
    .because("the resolutions that the planner counts in");
/// `axes.gear`
pub const GEAR: Key = or_value("[1, 1]")
    .from(1.0, Transmission::MAX_TURNS as f64)
    .of_parts(&["motor turns", "crank turns"])
    .because(
        "turns that belong together, such as [57, 11] of a belt from 57 teeth on the crank to 11 on the motor",
    );
/// `axes.offset_deg`
pub const OFFSET_DEG: Key = or(0.0).from(-180.0, 180.0).because(HALF_A_TURN);
/// `axes.index_deg`
pub const INDEX_DEG: Key = or(0.0).from(-180.0, 180.0).because(HALF_A_TURN);
/// `axes.index_width_deg`
pub const INDEX_WIDTH_DEG: Key = or(0.0).from(0.0, 90.0);
/// `axes.index_delay_us`
pub const INDEX_DELAY_US: Key = or(0.0).from(0.0, 1000.0);
/// `axes.trim_limit_deg`
pub const TRIM_LIMIT_DEG: Key = or(5.0).from(0.0, MAX_TRIM_DEG);
/// `axis.trim_deg`
pub const TRIM_DEG: Key = or(0.0)
    .from(-MAX_TRIM_DEG, MAX_TRIM_DEG)
    .at_least(-1.0, &[("axes.trim_limit_deg", 1)])
    .at_most(1.0, &[("axes.trim_limit_deg", 1)]);
/// `axes.trim_rate_deg_per_s`
pub const TRIM_RATE_DEG_PER_S: Key = or(1.0).from(1e-3, 360.0);
/// `axes.rotor_inertia_kgm2`
pub const ROTOR_INERTIA_KGM2: Key = or(0.0).from(0.0, 1000.0);

/// `correction.gain`
pub const GAIN: Key = or(0.0).from(0.0, 1.0);
/// `correction.coupling`
pub const COUPLING: Key = optional("2").from(0.0, 20.0);
/// `correction.coupling_per_s`
pub const COUPLING_PER_S: Key = optional("5").from(0.0, 10_000.0);
