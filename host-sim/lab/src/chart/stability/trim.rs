//! How hard a trim may correct drift: the edge in gain × delay.
//!
//! Once a turn an index tells an axis's drift e; the trim then goes on by −g e, of a drift that was measured d turns ago:
//! e[k+1] = e[k] − g e[k−d]. That integrator is not in the controller yet, which leaves trims where a scene set them; the
//! axis and the trim that carry it out are, and here the loop is closed around them, in the tick's own fixed point.
//!
//! Theory: the characteristic equation z^(d+1) = z^d − g has its first roots on the unit circle at
//! g = 2 sin(π / (2 (2d + 1))).

use std::collections::VecDeque;
use std::f64::consts::PI;

use cophase_core::axes::Axis;
use cophase_core::settings::{AxisSettings, DriveKind};
use cophase_core::units::{Phase, Turns};

const TICK_HZ: u32 = 500;
const TICKS_A_TURN: u32 = 50;
/// How far out of phase the crank is at first, turns: far below what the trim may be, far above what it can resolve.
const SLIP_TURNS: f64 = 1e-6;
/// Turns that are played, and those at the end, and after a while, that are compared.
const PLAYED: usize = 2400;
const COMPARED: usize = 200;
const SETTLED: usize = 400;
/// The edge is found to this part of it.
const TOLERANCE: f64 = 2e-4;

/// The largest gain at which drift dies out, as theory has it.
pub fn theory(delay_turns: f64) -> f64 {
    2.0 * (PI / (2.0 * (2.0 * delay_turns + 1.0))).sin()
}

/// The largest gain at which it does, as it is measured.
pub fn edge(delay_turns: u32) -> f64 {
    let (mut inside, mut outside) = (0.0, 3.0);
    while outside - inside > TOLERANCE * outside {
        let gain = f64::midpoint(inside, outside);
        if dies_out(gain, delay_turns) {
            inside = gain;
        } else {
            outside = gain;
        }
    }
    inside
}

/// Plays the loop and says whether drift is gone at the end, or less than after a while.
fn dies_out(gain: f64, delay_turns: u32) -> bool {
    let mut axis = Axis::new(
        &AxisSettings {
            drive: DriveKind::Stepper,
            steps_per_turn: 3200,
            reversed: false,
            ratio: (1, 1),
            offset_turns: 0.0,
            index_turns: Some(0.0),
            index_width_turns: 0.0,
            index_delay_s: 0.0,
            encoder: false,
            cycle_steps: 0,
            trim_limit_turns: 0.1,
            trim_rate_hz: 1.0, // two limits' way in a turn
            rotor_inertia_kgm2: 0.0,
        },
        TICK_HZ,
    );
    let a_tick = Turns::from_num(1.0 / f64::from(TICKS_A_TURN));
    let mut master = Phase::from_turns(Turns::ZERO);
    let mut target = Turns::ZERO;
    let mut measured = VecDeque::from(vec![0.0; delay_turns as usize]);
    let (mut early, mut late) = (0.0, 0.0);
    for turn in 0..PLAYED {
        for _ in 0..TICKS_A_TURN {
            axis.advance(a_tick, Turns::ZERO);
            master = master.advanced(a_tick);
        }
        let drift_turns = SLIP_TURNS + axis.phase().since(master).to_num::<f64>();
        if (SETTLED..SETTLED + COMPARED).contains(&turn) {
            early += drift_turns * drift_turns;
        } else if turn >= PLAYED - COMPARED {
            late += drift_turns * drift_turns;
        }
        measured.push_back(drift_turns);
        let known = measured.pop_front().unwrap_or_default();
        target = target.wrapping_sub(Turns::from_num((gain * known).clamp(-0.1, 0.1)));
        if !axis.trim_mut().set(target) {
            return false; // it has grown to the trim's limit
        }
    }
    // Drift a thousandth of what it was has died out, whatever rounding keeps of it.
    let gone = (1e-3 * SLIP_TURNS).powi(2) * COMPARED as f64;
    late < early || late < gone
}
