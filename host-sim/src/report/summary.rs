//! The page of words that `cophase run` prints.

use std::fmt::Write;

use cophase_core::supervisor::{FaultKind, State};

use super::{describe, fault_words, is_news};
use crate::design::STANDARD_GRAVITY_MPS2;
use crate::scene::Checked;
use crate::scene::file::Drive;
use crate::sim::Outcome;
use crate::sim::statistics::Happening;

/// More events than this are counted, not listed.
const LISTED: usize = 24;

/// What a run came to, in words.
pub fn summary(checked: &Checked, outcome: &Outcome, wall_s: f64) -> String {
    let mut page = String::new();
    // Writing to a String cannot fail.
    let _ = write_page(&mut page, checked, outcome, wall_s);
    page
}

fn write_page(
    page: &mut String,
    checked: &Checked,
    outcome: &Outcome,
    wall_s: f64,
) -> std::fmt::Result {
    let scene = &checked.scene;
    let seen = &outcome.statistics;
    let colon = if scene.description.is_empty() {
        ""
    } else {
        ": "
    };
    writeln!(page, "{}{colon}{}", scene.name, scene.description)?;
    writeln!(
        page,
        "{} model: {}.",
        capital(checked.fidelity.name()),
        checked.why
    )?;
    writeln!(page)?;

    let news: Vec<_> = seen
        .events
        .iter()
        .filter(|event| is_news(&event.what))
        .collect();
    for event in news.iter().take(LISTED) {
        writeln!(page, "  {:9.3} s  {}", event.t_s, describe(&event.what))?;
    }
    let more = news.len().saturating_sub(LISTED) + seen.events_left_out;
    if more > 0 {
        writeln!(
            page,
            "               … and {more} more; report.json lists them"
        )?;
    }
    writeln!(page)?;

    writeln!(page, "{}", ending(outcome))?;
    let holding = seen.holding;
    if holding.held_s > 0.0 {
        writeln!(
            page,
            "amax was held for {:.1} s in all, within {} of what the program asked; at most {:.1} g, at {:.2} rev/s.",
            holding.held_s,
            relative(holding.worst_relative),
            seen.top_amax_mps2 / STANDARD_GRAVITY_MPS2,
            seen.top_speed_hz,
        )?;
    }
    let lagged = seen
        .events
        .iter()
        .filter(|e| matches!(e.what, Happening::Lagged { .. }))
        .count();
    if lagged > 0 {
        writeln!(
            page,
            "The limits held the shaft behind its program {lagged} time{} (a limit, no fault).",
            plural(lagged)
        )?;
    }
    if seen.worst_spread_deg < 1e-6 {
        writeln!(page, "The cranks stayed in phase to the last count.")?;
    } else {
        writeln!(
            page,
            "The cranks were at most {:.3}° apart ({:.3}° rms while running); the platform tilted by at most {:.3} mrad of the {} allowed.",
            seen.worst_spread_deg,
            seen.rms_spread_deg,
            seen.worst_tilt_mrad,
            scene.drift.tilt_limit_mrad,
        )?;
    }
    writeln!(page)?;
    steps(page, checked, outcome)?;
    writeln!(
        page,
        "Simulated {:.2} s in {:.2} s: {:.0} times real time.",
        outcome.simulated_s(),
        wall_s,
        outcome.simulated_s() / wall_s.max(1e-9),
    )
}

fn steps(page: &mut String, checked: &Checked, outcome: &Outcome) -> std::fmt::Result {
    let seen = &outcome.statistics;
    let what = match checked.scene.axes.drive {
        Drive::Stepper => "steps",
        Drive::Servo => "counts",
    };
    let alike = seen.steps.windows(2).all(|pair| pair[0] == pair[1]);
    if alike {
        return writeln!(
            page,
            "Every axis was given {} {what}, {:.3} turns.",
            seen.steps[0], seen.turns[0].0
        );
    }
    for (axis, (steps, turns)) in seen.steps.iter().zip(&seen.turns).enumerate() {
        writeln!(
            page,
            "Axis {axis} was given {steps} {what}, {:.3} turns.",
            turns.0
        )?;
    }
    Ok(())
}

fn ending(outcome: &Outcome) -> String {
    match (&outcome.fault, outcome.state) {
        (Some(fault), State::Fault) => format!(
            "A fault stopped the machine at {:.3} s: {}. {}",
            fault.tick as f64 / f64::from(outcome.tick_hz),
            fault_words(fault),
            match fault.kind {
                FaultKind::EnableLost => "The drives were switched off the same tick.",
                _ => "All axes came to rest together.",
            },
        ),
        (Some(fault), state) => format!(
            "There was a fault at {:.3} s: {}. After a reset the machine ended {}.",
            fault.tick as f64 / f64::from(outcome.tick_hz),
            fault_words(fault),
            state.name(),
        ),
        (None, State::Parked) => {
            "The program ran to its end, or was stopped, and the machine parked.".to_owned()
        }
        (None, state) => format!(
            "The machine was still in state `{}` when nothing more was to happen; the run ends here.",
            state.name()
        ),
    }
}

fn relative(error: f64) -> String {
    match error {
        e if e < 1e-9 => "a billionth".to_owned(),
        e if e < 1e-3 => format!("{:.2} parts in a million", e * 1e6),
        e => format!("{:.2} %", e * 100.0),
    }
}

const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
