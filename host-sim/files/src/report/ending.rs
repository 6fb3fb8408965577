//! Sentences about the end of a run: by its program or by a fault, with the drives and cranks after it.

use std::fmt::Write;
use std::ops::Range;

use cophase_core::supervisor::{Fault, FaultKind, Reaction, State};
use cophase_scene::file::{FaultAt, FaultName, InputLine};
use host_sim::checked::Checked;
use host_sim::sim::Outcome;
use host_sim::sim::events::{Event, EventKind, StoppedBy};
use host_sim::sim::record::rounded;

use super::causes::{causes, causes_in_words};
use super::phrases::{fault_words, plural};

/// Distance of a crank from its command beyond which it did not follow, turns. A crank moves less after a stop.
const FOLLOWS_TURNS: f64 = 0.75;

/// Returns the latched faults in the order of time, each with its first name, and its last one if it got a better name later.
fn latched(events: &[Event]) -> Vec<[(f64, &Fault); 2]> {
    let mut all: Vec<[(f64, &Fault); 2]> = Vec::new();
    for event in events {
        let EventKind::Fault { fault, .. } = &event.what else {
            continue;
        };
        let named = (event.t_s, fault);
        match all.last_mut() {
            // A better name keeps the tick of the detection.
            Some([(_, first), last]) if first.tick == fault.tick => *last = named,
            _ => all.push([named, named]),
        }
    }
    all
}

/// Returns sentences about the cause of a run's end.
pub fn ending(checked: &Checked, outcome: &Outcome) -> String {
    let record = &outcome.record;
    if outcome.diverged.is_some() {
        return "The simulated machine diverged: its equations, not the controller, came to an end.".to_owned();
    }
    let faults = latched(&record.events);
    match (faults.last(), outcome.state) {
        (Some(&names), State::Fault) => stopped_by_fault(checked, outcome, names),
        (Some(_), state) => {
            let count = faults.len();
            let were = if count == 1 { "was" } else { "were" };
            format!(
                "There {were} {count} fault{}, and the machine ended in state `{}`.",
                plural(count),
                state.name(),
            )
        }
        (None, State::Parked) => match record.stopped_by {
            Some(StoppedBy::Request) => "The machine was stopped on request, and parked.",
            _ => "The program ran to its end, and the machine parked.",
        }
        .to_owned(),
        (None, state) => format!("The machine ended in state `{}`.", state.name()),
    }
}

/// Returns a sentence about the tilt of a platform that the drives held after a fault.
pub fn held(page: &mut String, outcome: &Outcome) -> std::fmt::Result {
    let figures = &outcome.record.figures;
    let held_mrad = figures.tilt_at_stop_mrad.zip(figures.tilt_worst_held_mrad);
    let Some((at_stop_mrad, worst_mrad)) = held_mrad else {
        return Ok(());
    };
    writeln!(
        page,
        "As the stop ended the platform was tilted by {at_stop_mrad:.3} mrad; held by the drives, it tilted by at most {worst_mrad:.3} mrad after that.",
    )
}

/// Returns a sentence about the motion of cranks without drives.
pub fn coasting(page: &mut String, checked: &Checked, outcome: &Outcome) -> std::fmt::Result {
    let record = &outcome.record;
    let Some(coasted_s) = record.figures.coasted_s else {
        return Ok(());
    };
    let until = if record.is_coasting {
        ", when the run was ended"
    } else {
        ", until they stood"
    };
    let tilted = record
        .figures
        .tilt_worst_off_mrad
        .map_or_else(String::new, |tilt_mrad| {
            format!("; the platform tilted by at most {tilt_mrad:.3} mrad then")
        });
    writeln!(
        page,
        "After the drives were off the {}s turned on for {coasted_s:.2} s{until}{tilted}.",
        checked.machine.axis_noun(),
    )?;
    if outcome.state != State::Fault {
        return Ok(());
    }
    // Commands do not change after the drives are off.
    let ends = (0..checked.scene.axes.count).map(|axis| {
        // Adding 0 makes a positive zero of a negative one.
        let away_deg = rounded(away_turns(checked, outcome, axis)? * 360.0, 1) + 0.0;
        Some(format!("axis {axis} {away_deg:+.1}°"))
    });
    let Some(ends) = ends.collect::<Option<Vec<_>>>() else {
        return Ok(());
    };
    writeln!(
        page,
        "They ended this far from where they were commanded to be: {}.",
        ends.join(", ")
    )
}

/// Returns sentences about the fault in which a run ended.
fn stopped_by_fault(
    checked: &Checked,
    outcome: &Outcome,
    [(t_s, fault), (named_s, name)]: [(f64, &Fault); 2],
) -> String {
    let events = &outcome.record.events;
    let states = events.iter().filter_map(|event| match event.what {
        EventKind::State(state) => Some((event.t_s, state)),
        EventKind::Running { .. } => Some((event.t_s, State::Run)),
        EventKind::Stopped { .. } => Some((event.t_s, State::Fault)),
        _ => None,
    });
    let states: Vec<_> = states.collect();
    let end = states.iter().rposition(|&(_, state)| state == State::Fault);
    let off_s = end.map_or(named_s, |end| states[end].0);
    let (from_s, before) = match end {
        Some(end) if end > 0 => states[end - 1],
        _ => (0.0, State::Idle),
    };
    let did = if before == State::Idle {
        "refused the start"
    } else {
        "stopped the machine"
    };
    let detected = format!("A fault {did} at {t_s:.3} s: {}.", fault_words(fault));
    let renamed = if name.kind == fault.kind && name.axis == fault.axis {
        String::new()
    } else {
        format!(" At {named_s:.3} s it was named {}.", fault_words(name))
    };
    let alike = alike(checked, name);
    let is_cut = name.kind.reaction(false) == Reaction::Disable
        || events
            .iter()
            .any(|event| (from_s..=off_s).contains(&event.t_s) && opens_enable(&event.what));
    let holds = outcome.record.is_held;
    let ended = match before {
        State::Idle | State::Fault => "The drives stayed off.".to_owned(),
        State::Parked if holds => "The machine stood already, and the drives hold.".to_owned(),
        State::Parked => "The machine stood already; the drives were switched off.".to_owned(),
        State::Homing | State::Run => {
            format!("The drives were switched off at {off_s:.3} s, without a stop.")
        }
        State::Stop if is_cut => {
            format!("The drives were switched off at {off_s:.3} s, before the stop was over.")
        }
        State::Stop => at_rest(checked, outcome, from_s..off_s),
    };
    let slipped = slipped(events, name, named_s);
    format!("{detected}{renamed} {ended}{alike}{slipped}")
}

/// Returns a sentence about motors that slipped before a fault was named, unless its name says so. Sensors may show less than that: an index
/// that stays away, or a shaft that stands.
fn slipped(events: &[Event], name: &Fault, named_s: f64) -> String {
    let slips = events.iter().filter_map(|event| match event.what {
        EventKind::Slipped { axis, cycles } if cycles != 0 && event.t_s <= named_s => {
            Some((axis, event.t_s))
        }
        _ => None,
    });
    let slips: Vec<_> = slips.collect();
    let mut axes: Vec<_> = slips.iter().map(|(axis, _)| *axis).collect();
    axes.sort_unstable();
    axes.dedup();
    let is_named = name.kind == FaultKind::LostSteps && axes == name.axis.as_slice();
    let Some((_, first_s)) = slips.first().filter(|_| !is_named) else {
        return String::new();
    };
    let axes: Vec<_> = axes.iter().map(usize::to_string).collect();
    format!(
        " In the simulation, axis {} had slipped by then, from {first_s:.3} s on.",
        axes.join(", ")
    )
}

/// Returns a sentence about other faults that look the same to the sensors of the axis, if there are any.
fn alike(checked: &Checked, fault: &Fault) -> String {
    let causes = causes(fault, &checked.settings.axes);
    let Some(axis) = fault.axis else {
        return String::new();
    };
    let others: Vec<_> = (causes.iter().map(|cause| cause.kind))
        .filter(|kind| *kind != fault.kind.name())
        .collect();
    let in_words = causes_in_words(&causes);
    let alike = match &others[..] {
        [] => String::new(),
        [other] => format!(" To the sensors of axis {axis}, {other} looks the same.{in_words}"),
        others => format!(
            " To the sensors of axis {axis}, these look the same: {}.{in_words}",
            others.join(", ")
        ),
    };
    alike + &jitter(checked, fault, axis)
}

/// Returns a sentence about readings that scatter, which no campaign draws as a cause, if they get the name of the fault.
fn jitter(checked: &Checked, fault: &Fault, axis: usize) -> String {
    let reads_index = checked.settings.axes[axis].index_turns.is_some();
    let is_of_scatter = matches!(
        fault.kind,
        FaultKind::Slip | FaultKind::Runaway | FaultKind::IndexTimeout
    );
    if !reads_index || !is_of_scatter {
        return String::new();
    }
    let error_deg = checked.scene.drift.reading_error_deg;
    format!(
        " An index sensor whose readings scatter by more than drift.reading_error_deg, {error_deg}°, looks the same as well."
    )
}

/// Returns a sentence about a stop that ended at rest: the axes that followed it.
fn at_rest(checked: &Checked, outcome: &Outcome, stop_s: Range<f64>) -> String {
    let axes = 0..checked.scene.axes.count;
    let apart: Vec<_> = axes
        .filter(|&axis| !follows(checked, outcome, axis, &stop_s))
        .map(|axis| axis.to_string())
        .collect();
    let (and, then) = if outcome.record.is_held {
        (", and", "the drives hold them.")
    } else {
        (";", "then the drives were switched off.")
    };
    match &apart[..] {
        [] => format!("All axes were brought to rest together{and} {then}"),
        _ => format!(
            "All axes were commanded to stop together, and axis {} did not follow; {then}",
            apart.join(", ")
        ),
    }
}

/// Returns true if an axis followed its command in a stop: it did not slip, no fault of the scene moved it, and it is not turns
/// behind.
fn follows(checked: &Checked, outcome: &Outcome, axis: usize, stop_s: &Range<f64>) -> bool {
    let is_disturbed = outcome.record.events.iter().any(|event| match &event.what {
        EventKind::Slipped { axis: slipped, .. } => *slipped == axis && stop_s.contains(&event.t_s),
        EventKind::Injected(fault) => {
            let until_s = fault.for_s.map_or(f64::INFINITY, |for_s| event.t_s + for_s);
            moves_by_itself(fault, axis) && event.t_s < stop_s.end && until_s > stop_s.start
        }
        _ => false,
    });
    let away_turns = away_turns(checked, outcome, axis).unwrap_or(0.0);
    !is_disturbed && away_turns.abs() < FOLLOWS_TURNS
}

/// Returns the distance of a crank from its command at the end of a run, turns; positive if ahead. Its error at power-up does not count.
/// `None` in a run with a second homing, as motion before that would count.
fn away_turns(checked: &Checked, outcome: &Outcome, axis: usize) -> Option<f64> {
    let record = &outcome.record;
    let homed = |event: &&Event| event.what == EventKind::State(State::Homing);
    let is_homed_once = record.events.iter().filter(homed).count() == 1;
    let start_deg = checked.scene.resolved(axis).own.start_deg;
    let axis = &record.axes[axis];
    let away_turns = axis.actual_turns? - axis.command_turns - start_deg / 360.0;
    is_homed_once.then_some(away_turns)
}

/// Returns true if a fault of a scene moves a crank away from its command.
fn moves_by_itself(fault: &FaultAt, axis: usize) -> bool {
    let kinds = [FaultName::Stuck, FaultName::Slip, FaultName::Runaway];
    fault.axis == Some(axis) && kinds.contains(&fault.kind)
}

fn opens_enable(what: &EventKind) -> bool {
    match what {
        EventKind::Input { line, active } => *line == InputLine::Enable && !active,
        EventKind::Injected(fault) => fault.kind == FaultName::EnableLoss,
        _ => false,
    }
}
