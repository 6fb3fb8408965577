//! Descriptions of events and faults.

use cophase_core::supervisor::{Fault, FaultKind, RefusalReason, RefusedCommand, State};
use cophase_core::units::Turns;
use cophase_scene::file::{FaultAt, InputLine, Lines};
use cophase_scene::units::degrees;
use host_sim::sim::events::{Event, EventKind};

use super::remedy::remedy;

/// Description of the fault state. Only a simulated run adds the state of the drives.
const FAULT_STATE: &str = "waiting for a reset";

/// Returns the description of an event.
pub fn describe(what: &EventKind) -> String {
    match *what {
        EventKind::State(state) => match state {
            State::Idle => "idle, drives off",
            State::Homing => "drives on, turning slowly to detect every index",
            State::Run => "running",
            State::Stop => "stopping, all axes together",
            State::Parked => "parked",
            State::Fault => FAULT_STATE,
        }
        .to_owned(),
        EventKind::Stopped { holds: true } => format!("{FAULT_STATE}; the drives hold"),
        EventKind::Stopped { holds: false } => format!("{FAULT_STATE}; the drives are off"),
        EventKind::LetGo => "the drives are off, and hold no longer".to_owned(),
        EventKind::Running { from_s: 0.0 } => "running the program".to_owned(),
        EventKind::Running { from_s } => format!("going on with the program at its {from_s:.3} s"),
        EventKind::Commanded(command) => format!("command: {}", command.name()),
        EventKind::Refused(refused) => format!("refused: {}", refused_words(&refused)),
        EventKind::Input { line, active } => {
            let line = match line {
                InputLine::Enable => "enable",
                InputLine::Stop => "stop",
            };
            format!("{line} input {}", if active { "on" } else { "off" })
        }
        EventKind::BandCrossed { in_s, upwards } => {
            let direction = if upwards { "upwards" } else { "downwards" };
            format!("band crossed {direction} in {in_s:.3} s")
        }
        EventKind::TurnedBackInBand {
            in_s,
            entered_upwards,
        } => {
            let direction = if entered_upwards {
                "upwards"
            } else {
                "downwards"
            };
            format!("band entered {direction}, turned back, and left after {in_s:.3} s")
        }
        EventKind::HeldAtBand { for_s } => {
            format!(
                "the program requests a forbidden band, for {for_s:.2} s: kept at its nearer edge"
            )
        }
        EventKind::Lagged { for_s, worst_mps2 } => {
            format!("behind the program for {for_s:.2} s, by at most {worst_mps2:.2} m/s²")
        }
        EventKind::Corrected { by_deg, in_s } => {
            let axes = by_deg.iter().enumerate().filter(|(_, deg)| **deg != 0.0);
            let moved: Vec<_> = axes
                .map(|(axis, deg)| format!("axis {axis} by {deg:+.2}°"))
                .collect();
            format!("phase corrected in {in_s:.2} s: {}", moved.join(", "))
        }
        EventKind::Slipped { axis, cycles: 0 } => format!("axis {axis} slips, and is back in step"),
        EventKind::Slipped { axis, cycles } => {
            let direction = if cycles < 0 { "behind" } else { "ahead" };
            let plural = if cycles.abs() == 1 { "" } else { "s" };
            format!(
                "axis {axis} slips: now {} electrical cycle{plural} {direction}",
                cycles.abs()
            )
        }
        EventKind::Missed { deadlines } => {
            let plural = if deadlines == 1 { "" } else { "s" };
            format!("{deadlines} deadline{plural} missed: all axes stood still")
        }
        EventKind::Injected(fault) => format!("injected: {}", injected_words(&fault)),
        EventKind::Reported(fault) => format!("reported: {}", fault_words(&fault)),
        EventKind::Fault {
            fault,
            leading_deg: Some(leading_deg),
        } if fault.kind == FaultKind::Tilt => format!(
            "fault: {}; the cranks lead at {:.0}° around the platform",
            fault_words(&fault),
            leading_deg.round().rem_euclid(360.0),
        ),
        EventKind::Fault { fault, .. } => format!("fault: {}", fault_words(&fault)),
    }
}

/// Returns the events that are worth printing. The report of a fault that latches at that moment is redundant.
pub fn notable(events: &[Event]) -> Vec<&Event> {
    // Events are in the order of time.
    let latches = |reported: &Fault, t_s: f64| {
        let from = events.partition_point(|event| event.t_s < t_s);
        let now = events[from..].iter().take_while(|event| event.t_s == t_s);
        let mut latched = now.filter_map(|event| match &event.what {
            EventKind::Fault { fault, .. } => Some(fault),
            _ => None,
        });
        latched.any(|fault| fault == reported)
    };
    let is_worth = |event: &&Event| match &event.what {
        EventKind::Reported(fault) => !latches(fault, event.t_s),
        what => is_notable(what),
    };
    events.iter().filter(is_worth).collect()
}

/// Returns true if an event is worth printing. One that lasts only while a band is crossed is not.
fn is_notable(what: &EventKind) -> bool {
    const SHORT_S: f64 = 0.3;
    match what {
        EventKind::HeldAtBand { for_s } | EventKind::Lagged { for_s, .. } => *for_s >= SHORT_S,
        _ => true,
    }
}

/// Returns the description of an injected fault.
fn injected_words(fault: &FaultAt) -> String {
    let mut words = vec![fault.kind.name().replace('-', " ")];
    let number = |number: Option<f64>, unit: &str| number.map(|number| format!("{number}{unit}"));
    let plural = |count: i64| if count.abs() == 1 { "" } else { "s" };
    let lines = fault.lines.map(|lines| match lines {
        Lines::Drive => "drive lines".to_owned(),
        Lines::Sensors => "sensors".to_owned(),
    });
    words.extend(fault.axis.map(|axis| format!("axis {axis}")));
    words.extend(fault.with.map(|with| format!("with axis {with}")));
    words.extend(lines);
    let cycles = fault.cycles;
    words.extend(cycles.map(|cycles| format!("{cycles} cycle{}", plural(cycles))));
    words.extend(number(fault.rate_deg_per_s, "°/s"));
    words.extend(number(fault.speed_hz, " rev/s"));
    words.extend(
        fault
            .count
            .map(|count| format!("{count} time{}", plural(count.into()))),
    );
    let counts = fault.counts;
    words.extend(counts.map(|counts| format!("{counts} count{}", plural(counts))));
    words.extend(number(fault.torque_nm, " N·m"));
    words.extend(number(fault.for_s, " s long"));
    words.join(", ")
}

/// Returns the name of a kind of fault, as in report and log, with its meaning where the name does not state it.
fn named(kind: FaultKind) -> String {
    let (name, words) = (kind.name(), kind.to_string());
    if words == name.replace('-', " ") {
        words
    } else {
        format!("{name} ({words})")
    }
}

/// Describes a fault in words.
pub fn fault_words(fault: &Fault) -> String {
    let mut words = named(fault.kind);
    if let Some(axis) = fault.axis {
        words += &format!(", axis {axis}");
    }
    if fault.size != Turns::ZERO {
        let size_deg = degrees(fault.size);
        words += &match fault.kind {
            // A bound: nothing was measured.
            FaultKind::IndexTimeout => {
                format!(
                    ": no pulse, so the axis may be at its limit, {:.2}° behind, or beyond it",
                    size_deg.abs()
                )
            }
            FaultKind::IndexExtra => format!(": a pulse {size_deg:.2}° from its place"),
            FaultKind::Drift => format!(", by {size_deg:.2}° so far"),
            _ if fault.axis.is_some() => format!(" off by {size_deg:.2}°"),
            _ => format!(", off by {size_deg:.2}°"),
        };
    }
    words
}

/// Describes a command that was not possible, and what to do.
pub fn refused_words(refused: &RefusedCommand) -> String {
    let remedy = match refused.reason {
        RefusalReason::State => format!("; it is possible {}", remedy(refused.command.states())),
        _ => String::new(),
    };
    format!("{refused}{remedy}")
}

/// Returns the ending of a noun after a count.
pub const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
