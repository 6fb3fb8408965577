//! Largest stable gain of the correction by phase offsets, against the delay.
//!
//! Once per turn, an index shows the phase error e of an axis. The offset then changes by −g e, with an error that was measured d turns
//! ago: e[k+1] = e[k] − g e[k−d]. This loop is closed here around the controller's own phase offsets, which move in whole steps.
//!
//! Theory: the characteristic equation z^(d+1) = z^d − g has its first roots on the unit circle at
//! g = 2 sin(π / (2 (2d + 1))).

use std::collections::VecDeque;
use std::f64::consts::PI;

use cophase_core::phase_offset::PhaseOffsets;
use cophase_core::settings::{AxisSettings, Settings};
use cophase_core::units::Turns;

const TICK_HZ: u32 = 500;
const TICKS_A_TURN: u32 = 50;
const STEPS_PER_TURN: u32 = 65_536;
const LIMIT_TURNS: f64 = 0.1;
/// Initial phase error of the crank, turns: far below the limit of the offset, and far above a step.
const SLIP_TURNS: f64 = 0.01;
/// Number of turns, length of the compared parts, and start of the earlier part, turns. The later part is at the end.
const PLAYED: usize = 2400;
const COMPARED: usize = 200;
const SETTLED: usize = 400;
/// Relative error of the limit.
const TOLERANCE: f64 = 2e-4;

/// Returns the largest gain at which the phase error decays, by theory.
pub fn theory(delay_turns: f64) -> f64 {
    2.0 * (PI / (2.0 * (2.0 * delay_turns + 1.0))).sin()
}

/// Measures the largest gain at which it decays.
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

/// Runs the loop. Returns true if the phase error is zero at the end, or smaller than in between.
fn dies_out(gain: f64, delay_turns: u32) -> bool {
    let mut settings = Settings::new();
    settings.tick_hz = TICK_HZ;
    let axis = AxisSettings {
        steps_per_turn: STEPS_PER_TURN,
        cycle_steps: 0,
        trim_limit_turns: LIMIT_TURNS,
        trim_rate_hz: 10.0, // four times the limit in a turn
        ..AxisSettings::DEFAULT
    };
    settings.axes = std::iter::once(axis).collect();
    let mut offsets = PhaseOffsets::new();
    offsets.configure(&settings);
    let mut phase_error_turns = SLIP_TURNS;
    let mut target = Turns::ZERO;
    let mut measured = VecDeque::from(vec![0.0; delay_turns as usize]);
    let (mut early, mut late) = (0.0, 0.0);
    for turn in 0..PLAYED {
        for _ in 0..TICKS_A_TURN {
            let moved = offsets.advance(true);
            phase_error_turns += moved.map_or(0.0, |moved| moved.turns.to_num::<f64>());
        }
        if (SETTLED..SETTLED + COMPARED).contains(&turn) {
            early += phase_error_turns * phase_error_turns;
        } else if turn >= PLAYED - COMPARED {
            late += phase_error_turns * phase_error_turns;
        }
        measured.push_back(phase_error_turns);
        let known = measured.pop_front().unwrap_or_default();
        target = target.wrapping_sub(Turns::from_num(
            (gain * known).clamp(-LIMIT_TURNS, LIMIT_TURNS),
        ));
        if !offsets.set_user(0, target) {
            return false; // it has grown to the limit
        }
    }
    // A phase error of some steps counts as zero, as offsets are rounded to whole steps.
    let gone = (4.0 / f64::from(STEPS_PER_TURN)).powi(2) * COMPARED as f64;
    late < early || late < gone
}
