//! The limits of a scene, against the turns of each crank.
//!
//! Differences over equal times bound the motion from below: a difference of turns over a time τ is at most the largest speed times τ,
//! a second difference at most the largest acceleration times τ², a third at most the largest jerk times τ³. A crank stands within a step
//! of its continuous motion, on one side of it.

use super::stated::Stated;
use super::trace::Trace;

/// Times over which differences are taken, ticks.
const SPANS: [usize; 5] = [1, 8, 64, 512, 4096];

/// Share of a limit by which rounding may exceed it.
const ROUNDING: f64 = 1e-6;

pub fn check(stated: &Stated, trace: &Trace) -> Result<(), String> {
    let homing = trace.states.iter().take_while(|state| *state == "homing");
    let homing = homing.count();
    let coarsest = stated.steps.iter().map(|steps| 1.0 / steps);
    let coarsest = coarsest.fold(0.0, f64::max);
    for (axis, turns) in trace.cranks(stated.count)?.into_iter().enumerate() {
        let step = 1.0 / stated.steps[axis];
        let at_most = |what: &str, key: &str, turns: &[f64], order: i32, limit: f64| {
            SPANS.into_iter().try_for_each(|span| {
                let time_s = span as f64 * stated.tick_s;
                // Differences of numbers between 0 and a step, and of an offset that moves by whole steps at a bounded rate. The axes take
                // turns, and in its own an axis moves for all of them. A turn is a tick, or as long as the axis with the coarsest steps needs
                // for one, with four fifths of its rate.
                let steps = f64::from(1 << (order - 1)) * (step + 1e-9);
                let for_all = stated.homing_offset_hz * stated.count as f64 * stated.tick_s;
                let moves = stated.homing_offset_hz * time_s + for_all.max(1.25 * coarsest) + step;
                let offset = f64::from(1 << (order - 1)) * moves;
                let allowed = limit * time_s.powi(order) * (1.0 + ROUNDING) + steps + offset;
                match max(turns, span, order) {
                    Some(max) if max > allowed => Err(format!(
                        "crank {axis} has {what} of at least {} over {span} ticks, and {key} = {limit}",
                        (max - steps - offset) / time_s.powi(order)
                    )),
                    _ => Ok(()),
                }
            })
        };
        at_most(
            "a homing speed",
            "homing_speed_hz",
            &turns[..homing],
            1,
            stated.homing_hz,
        )?;
        at_most("a speed", "speed_hz", turns, 1, stated.speed_hz)?;
        at_most(
            "an acceleration",
            "acceleration_hz_per_s",
            turns,
            2,
            stated.acceleration,
        )?;
        at_most("a jerk", "jerk_hz_per_s2", turns, 3, stated.jerk)?;
    }
    Ok(())
}

/// Largest magnitude of the first, second or third difference over a number of rows.
fn max(turns: &[f64], span: usize, order: i32) -> Option<f64> {
    let weights: &[f64] = match order {
        1 => &[-1.0, 1.0],
        2 => &[1.0, -2.0, 1.0],
        _ => &[-1.0, 3.0, -3.0, 1.0],
    };
    let rows = turns
        .len()
        .checked_sub(span * (weights.len() - 1))
        .filter(|rows| *rows > 0)?;
    let difference = |row: usize| {
        let terms = weights.iter().enumerate();
        terms
            .map(|(i, weight)| weight * turns[row + i * span])
            .sum::<f64>()
            .abs()
    };
    Some((0..rows).map(difference).fold(0.0, f64::max))
}
