//! Lines of the summary about the model level: what it computes, why it was chosen, and how accurate its answers are.

use std::fmt::Write;

use host_sim::checked::Checked;
use host_sim::checked::Judged;
use host_sim::model_level::is_undisturbed;
use host_sim::output::Output;
use host_sim::sim::Outcome;
use host_sim::sim::events::{Event, EventKind};

use super::model::judged;

/// Writes the lines about the model level.
pub(super) fn model(page: &mut String, checked: &Checked, outcome: &Outcome) -> std::fmt::Result {
    writeln!(
        page,
        "{} model ({}): {}.",
        capital(checked.fidelity.name()),
        checked.machine.motion(checked.fidelity),
        checked.why()
    )?;
    for judged in judged(checked) {
        writeln!(page, "  {}", answered(judged, checked, outcome))?;
    }
    Ok(())
}

/// Returns a line about a requested output: its value, and the accuracy of that.
fn answered(judged: &Judged, checked: &Checked, outcome: &Outcome) -> String {
    let output = judged.output;
    let in_unit = |value: f64, unit: &str| match unit {
        "°" => format!("{}°", significant(value)),
        unit => format!("{} {unit}", significant(value)),
    };
    let with_unit = |value: f64| in_unit(value, output.unit());
    let value = match judged.value {
        Some(value) if output == Output::Slips => {
            format!("{value}{}", slipped_off(checked, outcome, value as usize))
        }
        Some(value) => in_unit(value, output.value_unit()),
        None => "this model does not compute it".to_owned(),
    };
    let allowed = match output {
        Output::Slips => "none".to_owned(),
        Output::Lag | Output::Spread => format!("{}°", judged.tolerance),
        _ => format!("{} {}", judged.tolerance, output.unit()),
    };
    let limit = match judged.bound {
        Some(bound) => format!("at most {} by calculation", with_unit(bound)),
        None if is_undisturbed(checked) => "no limit is known by calculation".to_owned(),
        None => "no limit by calculation, as the scene disturbs the machine".to_owned(),
    };
    let measured = judged.measured.map_or_else(String::new, |(off, against)| {
        format!(
            "; {} in a sample run, against the {} model",
            with_unit(off),
            against.name()
        )
    });
    let step_error = judged.step_error.map_or_else(String::new, |off| {
        format!("; at most {} by the time step", with_unit(off))
    });
    format!(
        "{}: {value}. Error: {allowed} allowed; {limit}{measured}{step_error}.",
        output.words(checked.machine.axis_noun())
    )
}

/// Returns the part of the slipped motors that slipped only after the drives were off, in words; empty if there is none, or if
/// motors at their torque limit may be among them.
fn slipped_off(checked: &Checked, outcome: &Outcome, all: usize) -> String {
    let axes = 0..checked.scene.axes.count;
    let slips = |axis: usize| {
        let is_slip = |event: &Event| matches!(event.what, EventKind::Slipped { axis: own, .. } if own == axis);
        outcome.record.events.iter().any(is_slip)
    };
    if axes
        .clone()
        .any(|axis| !checked.settings.axes[axis].drive.is_open_loop())
    {
        return String::new();
    }
    match all.saturating_sub(axes.filter(|&axis| slips(axis)).count()) {
        0 => String::new(),
        off => format!(" ({off} of them only after the drives were off)"),
    }
}

/// Formats a number with two digits, which is enough for a bound.
fn significant(value: f64) -> String {
    // Smaller values are rounding errors.
    if value < 2e-6 {
        "0".to_owned()
    } else if (0.01..1000.0).contains(&value) {
        let digits = if value < 0.1 { 3 } else { 2 };
        format!("{value:.digits$}")
    } else {
        format!("{value:.1e}")
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
