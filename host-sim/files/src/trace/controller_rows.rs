//! The controller's part of a row, from a sample of its loop.
//!
//! Simulated runs and recordings of controllers fill their rows here, so that equal loops have equal rows.

use cophase_core::mechanism::{AnyMechanism, Mechanism};
use cophase_core::settings::Settings;
use cophase_core::supervisor::State;
use cophase_core::units::Turns;
use cophase_link::sample::Sample;
use cophase_scene::units::{degrees, speed_hz};

use super::Row;

/// Conversion of samples of one controller.
#[derive(Clone, Debug)]
pub struct ControllerRows {
    tick_hz: u32,
    mechanism: AnyMechanism,
}

impl ControllerRows {
    /// Conversion for a controller with these settings.
    pub fn new(settings: &Settings) -> Self {
        Self {
            tick_hz: settings.tick_hz,
            mechanism: settings.mechanism(),
        }
    }

    /// Fills the controller's part of the row of a tick that ends at a time, ns since power-up. Turns are those since power-up.
    pub fn fill(
        &self,
        row: &mut Row,
        end_ns: u64,
        sample: &Sample,
        master_turns: f64,
        command_turns: &[f64],
    ) {
        let speed = Turns::from_bits(sample.speed);
        row.t_s = end_ns as f64 * 1e-9;
        let state = State::ALL.get(usize::from(sample.state));
        row.state = state.map_or("unknown", |state| state.name());
        row.state_code = sample.state;
        row.amax_requested_mps2 = sample.amax().to_num();
        row.amax_commanded_mps2 = self.mechanism.amax(speed).to_num();
        row.omega_rad_s = speed_hz(speed, self.tick_hz) * std::f64::consts::TAU;
        row.phase_turns = master_turns;
        for (i, (axis, &turns)) in row.axes.iter_mut().zip(command_turns).enumerate() {
            axis.steps = sample.steps[i];
            axis.command_turns = turns;
            axis.phase_error_deg = degrees(Turns::from_bits(sample.phase_error[i]));
        }
    }
}
