//! Motor of a designed platform behind its belt or gearbox.

use cophase_core::pulse::StepsPerTurn;
use cophase_core::settings::Transmission;

use super::steps::Design;
use crate::design::range::{OutOfRange, Range};
use crate::numbers::{number, whole};
use host_sim::mechanism::Mechanism;
use host_sim::mechanism::turn_search::max_over_turn;

/// Full steps of a common stepper, and of one electrical cycle.
const FULL_STEPS_PER_TURN: f64 = 200.0;
const FULL_STEPS_PER_CYCLE: f64 = 4.0;

/// Choice of motor and gear, which the source's method leaves open. All values are the motor's own.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct MotorChoice {
    /// Belt or gearbox: turns of the motor and of the crank that belong together, such as 57:11
    #[arg(long, value_name = "M:C", value_parser = gear, default_value = "1:1")]
    pub gear: Transmission,
    /// Steps, or counts, per turn of the motor: 4 to 1,048,576
    #[arg(long, value_name = "S", value_parser = whole::<u32>(4..=1_048_576), default_value_t = 3200)]
    pub steps_per_turn: u32,
    /// Inertia of the motor, kg·m²: above 0, up to 1000
    #[arg(long, value_name = "J", allow_hyphen_values = true, value_parser = number)]
    pub rotor_inertia_kgm2: Option<f64>,
}

/// Parses `M:C`.
fn gear(text: &str) -> Result<Transmission, &'static str> {
    let turns = |part: &str| part.trim().parse::<u32>().ok();
    let pair = text
        .split_once(':')
        .and_then(|(motor, crank)| Some((turns(motor)?, turns(crank)?)));
    let (motor_turns, crank_turns) =
        pair.ok_or("give turns of the motor and of the crank, such as 57:11")?;
    Ok(Transmission {
        motor_turns,
        crank_turns,
    })
}

impl Default for MotorChoice {
    /// A motor of 3200 steps per turn on the crank's own shaft.
    fn default() -> Self {
        Self {
            gear: Transmission::DIRECT,
            steps_per_turn: 3200,
            rotor_inertia_kgm2: None,
        }
    }
}

impl MotorChoice {
    /// All numbers that are out of their ranges. Empty if there are none.
    pub fn out_of_range(&self) -> Vec<OutOfRange> {
        let own = [
            (GEAR, f64::from(self.gear.motor_turns)),
            (GEAR, f64::from(self.gear.crank_turns)),
            (STEPS, f64::from(self.steps_per_turn)),
        ];
        let mut wrong = OutOfRange::find_all(own);
        let inertia = self.rotor_inertia_kgm2.map(|kgm2| (INERTIA, kgm2));
        wrong.extend(
            inertia
                .into_iter()
                .flat_map(|one| OutOfRange::find_all([one])),
        );
        wrong
    }

    /// Electrical cycle of a common stepper of 200 full steps, degrees of the crank.
    pub fn electrical_cycle_deg(&self) -> f64 {
        360.0 * FULL_STEPS_PER_CYCLE / FULL_STEPS_PER_TURN / self.gear.ratio()
    }

    /// Step rate at the frequency of a design, steps/s.
    pub fn step_rate_hz(&self, design: &Design) -> f64 {
        design.requirement.freq_hz * self.gear.ratio() * f64::from(self.steps_per_turn)
    }

    /// Torque that a design requires of the motor, N·m at its own shaft, with the safety factor.
    pub fn torque_nm(&self, design: &Design) -> f64 {
        design.motor_torque_with_safety_nm() / self.gear.ratio()
    }

    /// Largest inertia of the load over a turn of the crank, reflected to the motor, over the motor's own; `None` if that is not known.
    pub fn inertia_ratio(&self, design: &Design) -> Option<f64> {
        let own_kgm2 = self.rotor_inertia_kgm2?;
        let mechanism = design.mechanism;
        let s = max_over_turn(|alpha| mechanism.s(alpha).abs()).value;
        let lever_m = mechanism.crank_radius_m() * s / self.gear.ratio();
        let load_kg = design.per_motor(design.requirement.load_kg);
        Some(load_kg * lever_m * lever_m / own_kgm2)
    }
}

const GEAR: Range = Range {
    flag: "--gear",
    low: 1.0,
    closed: true,
    high: Transmission::MAX_TURNS as f64,
    unit: " turns",
    meaning: "the turns of motor and crank that belong together",
    usual: 1.0,
};

const STEPS: Range = Range {
    flag: "--steps-per-turn",
    low: 4.0,
    closed: true,
    high: StepsPerTurn::MAX,
    unit: "",
    meaning: "the resolutions that the planner counts in",
    usual: 3200.0,
};

const INERTIA: Range = Range::above_zero(
    "--rotor-inertia-kgm2",
    1000.0,
    " kg·m²",
    "the inertias of motors",
    1e-3,
);
