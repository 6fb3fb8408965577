//! Summary that `cophase run` prints.

use std::fmt::Write;

use cophase_core::settings::AxisSettings;
use cophase_scene::file::Fidelity;
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::checked::Checked;
use host_sim::machines::follower::Peaks;
use host_sim::sim::Outcome;
use host_sim::sim::events::{Event, EventKind};
use host_sim::sim::record::AxisRecord;

use super::ending::{coasting, ending, held};
use super::phrases::plural;
use super::questions::model;
use super::{describe, motors, notable, warnings};
use crate::trace::trace_info::TraceInfo;

/// Number of events that are listed at most, and number of those from the end.
const LISTED: usize = 24;
const LISTED_LAST: usize = 8;

/// Returns the summary of a run.
pub fn summary(
    checked: &Checked,
    outcome: &Outcome,
    written: Option<TraceInfo>,
    wall_s: f64,
) -> String {
    let mut page = String::new();
    // Writing to a String cannot fail.
    let _ = write_page(&mut page, checked, outcome, written, wall_s);
    page
}

fn write_page(
    page: &mut String,
    checked: &Checked,
    outcome: &Outcome,
    written: Option<TraceInfo>,
    wall_s: f64,
) -> std::fmt::Result {
    let scene = &checked.scene;
    let (record, figures) = (&outcome.record, &outcome.record.figures);
    let colon = if scene.description.is_empty() {
        ""
    } else {
        ": "
    };
    writeln!(page, "{}{colon}{}", scene.name, scene.description)?;
    model(page, checked, outcome)?;
    writeln!(page)?;

    let mut listed = notable(&record.events);
    let all = listed.len();
    if all > LISTED {
        // A motor may slip hundreds of times. Only its first and last slips are listed, so they hide no other events.
        let axis = |event: &Event| match event.what {
            EventKind::Slipped { axis, .. } => Some(axis),
            _ => None,
        };
        let slips: Vec<_> = listed.iter().map(|event| axis(event)).collect();
        let mut place = 0;
        listed.retain(|_| {
            let (before, rest) = slips.split_at(place);
            place += 1;
            let own = rest[0];
            own.is_none() || !before.contains(&own) || !rest[1..].contains(&own)
        });
    }
    // Users look at the end most often, so a long list is shortened in the middle.
    let (first, last) = if listed.len() > LISTED {
        (
            &listed[..LISTED - LISTED_LAST],
            &listed[listed.len() - LISTED_LAST..],
        )
    } else {
        (&listed[..], &listed[..0])
    };
    for event in first {
        writeln!(page, "  {:9.3} s  {}", event.t_s, describe(&event.what))?;
    }
    let between = all - first.len() - last.len() + record.events_left_out;
    if between > 0 {
        writeln!(
            page,
            "               … {between} more, which report.json lists …"
        )?;
    }
    for event in last {
        writeln!(page, "  {:9.3} s  {}", event.t_s, describe(&event.what))?;
    }
    writeln!(page)?;

    writeln!(page, "{}", ending(checked, outcome))?;
    if let Some(holding) = figures.holding.filter(|holding| holding.held_s > 0.0) {
        writeln!(
            page,
            "The commanded amax was held for {:.1} s in all, within {} of the program; at most {:.1} g, at {:.2} rev/s{}.",
            holding.held_s,
            relative(holding.worst_relative_error),
            figures.amax_top_mps2 / STANDARD_GRAVITY_MPS2,
            figures.speed_top_hz,
            of_master(checked),
        )?;
    }
    if let Some(about_amax) = checked.machine.about_amax(figures.accel_worst_mps2) {
        writeln!(page, "{about_amax}")?;
    }
    let lagged = notable(&record.events)
        .iter()
        .filter(|event| matches!(event.what, EventKind::Lagged { .. }))
        .count();
    if lagged > 0 {
        writeln!(
            page,
            "The limits held the shaft behind its program {lagged} time{} (a limit, no fault).",
            plural(lagged)
        )?;
    }
    let axis = checked.machine.axis_noun();
    let commanded_mrad = checked.settings.commanded_tilt_mrad();
    let spread_deg = figures.phase_spread_worst_deg.unwrap_or(0.0);
    if checked.scene.axes.count == 1 {
        // One shaft has no difference of phases.
    } else if spread_deg < 1e-6 && commanded_mrad > 0.0 {
        writeln!(
            page,
            "The cranks were exactly as far apart as commanded, which tilts the platform by up to {commanded_mrad:.3} mrad. Its centre accelerates by less than amax then."
        )?;
    } else if spread_deg < 1e-6 {
        let stayed = if checked.commanded_apart().is_none() {
            "stayed exactly in phase with each other"
        } else {
            "were exactly as far apart as commanded"
        };
        let by_model = match checked.fidelity {
            Fidelity::Kinematic | Fidelity::Rigid => " (in this model they cannot do otherwise)",
            _ => "",
        };
        writeln!(page, "The {axis}s {stayed}{by_model}.")?;
    } else {
        let tilts_mrad = figures.tilt_worst_mrad.zip(figures.tilt_limit_mrad);
        let tilted = tilts_mrad.map_or_else(String::new, |(worst_mrad, limit_mrad)| {
            format!(
                "; the platform tilted by at most {worst_mrad:.3} mrad of the {limit_mrad} allowed"
            )
        });
        writeln!(
            page,
            "The {axis}s were at most {spread_deg:.3}° apart ({:.3}° rms while running){tilted}.",
            figures.phase_spread_rms_deg.unwrap_or(0.0),
        )?;
    }
    held(page, outcome)?;
    coasting(page, checked, outcome)?;
    if record.axes.iter().any(|axis| axis.correction_deg != 0.0) {
        let trims = record.axes.iter().enumerate();
        let trims: Vec<_> = trims
            .map(|(i, axis)| format!("axis {i} {:.2}°", axis.correction_deg))
            .collect();
        writeln!(
            page,
            "Phase offsets by the correction as the run ended: {}.",
            trims.join(", ")
        )?;
    }
    if let Some(coupling) = coupling(checked) {
        writeln!(page, "{coupling}")?;
    }
    for (table, points, off) in checked.cam_tables() {
        if let Some(off) = off {
            writeln!(
                page,
                "Cam table \"{}\": {points} points; the curve's acceleration is within {:.1} % of its law's peak.",
                table.name,
                // Rounded up, so that it is a bound.
                (1e3 * off).ceil() / 10.0
            )?;
        }
    }
    parts(page, checked, outcome)?;
    let machine_figures = figures.machine_figures.iter();
    for figure in machine_figures.filter(|figure| !figure.sentence.is_empty()) {
        writeln!(page, "{}", figure.sentence)?;
    }
    let axes = record.axes.iter().enumerate();
    let closest = axes
        .clone()
        .filter_map(|(i, axis)| Some((i, (axis.pull_out_used?, axis.pull_out_used_at_hz))));
    let min = closest
        .clone()
        .map(|(_, (used, _))| used)
        .fold(f64::INFINITY, f64::min);
    if let Some((axis, (used, hz))) = closest.max_by(|a, b| a.1.0.total_cmp(&b.1.0)) {
        if used.is_finite() {
            // Smaller differences print as the same number.
            let (which, has) = if min > 0.995 * used && scene.axes.count > 1 {
                ("all axes".to_owned(), "they have")
            } else {
                (format!("axis {axis}"), "it has")
            };
            writeln!(
                page,
                "Closest to pull-out: {which}, loaded to {:.0} % of the torque that {has} at {hz:.2} rev/s.",
                used * 100.0
            )?;
        } else {
            writeln!(
                page,
                "Axis {axis} was loaded at {hz:.2} rev/s, where its pull-out torque counts as zero."
            )?;
        }
    }
    let torques = axes.filter_map(|(i, axis)| Some((i, axis.torque_worst_nm?)));
    if let Some((axis, torque_nm)) = torques.max_by(|a, b| a.1.total_cmp(&b.1)) {
        writeln!(
            page,
            "Greatest motor torque: {torque_nm:.3} N·m, of axis {axis}."
        )?;
    }
    if let Some(frame) = figures.frame {
        writeln!(
            page,
            "The frame went at most {:.1} µm from rest; the ground took at most {:.1} N beyond the weight.",
            frame.displacement_worst_um, frame.ground_force_worst_n,
        )?;
    }
    for line in motors::lines(checked) {
        writeln!(page, "{line}")?;
    }
    for warning in warnings(checked, outcome) {
        writeln!(page, "Warning: {warning}")?;
    }
    if written.is_some_and(|written| written.is_empty()) {
        writeln!(page, "Warning: steps.vcd is empty: the shaft did not move.")?;
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

/// Returns the shaft to which amplitude and speed of a summary belong, where not every axis turns once with the master.
fn of_master(checked: &Checked) -> &'static str {
    if checked.turns_with_master() {
        ""
    } else {
        " of the master, for a shaft that turns once with it"
    }
}

/// Writes a line about the axes' own parts, if they have any.
fn parts(page: &mut String, checked: &Checked, outcome: &Outcome) -> std::fmt::Result {
    let axes = outcome.record.axes.iter();
    let sentence = (axes.filter_map(|axis| axis.follower))
        .reduce(Peaks::or)
        .and_then(|worst| checked.machine.about_parts(checked.fidelity, &worst));
    sentence.map_or(Ok(()), |sentence| writeln!(page, "{sentence}"))
}

/// Returns a line with the gains of the cross-coupling, if there is one.
pub fn coupling(checked: &Checked) -> Option<String> {
    let settings = &checked.settings.correction;
    let given = &checked.scene.correction;
    (settings.coupling != 0.0 || settings.coupling_per_s != 0.0).then(|| {
        let derived = match (given.coupling, given.coupling_per_s) {
            (Some(_), Some(_)) => "given",
            _ if !given.couple => "given",
            (None, None) => "derived",
            _ => "one given, one derived",
        };
        format!(
            "Cross-coupling of the setpoints: gain {:.4}, integral gain {:.3} 1/s ({derived}).",
            settings.coupling, settings.coupling_per_s
        )
    })
}

fn steps(page: &mut String, checked: &Checked, outcome: &Outcome) -> std::fmt::Result {
    let axes = &outcome.record.axes;
    let what = match checked.scene.axes.drive.kind().is_open_loop() {
        true => "steps",
        false => "counts",
    };
    let given = |(axis, settings): (&AxisRecord, &AxisSettings)| {
        let (steps, turns) = (axis.steps, axis.command_turns);
        match settings.follower.constant_ratio() {
            Some(_) => format!("was given {steps} {what}, {turns:.3} turns."),
            // It may have gone back and forth.
            None => format!(
                "followed its cam table, and ended {steps} {what} from where it began, at {turns:.3} turns."
            ),
        }
    };
    let all: Vec<_> = axes.iter().zip(&checked.settings.axes).map(given).collect();
    if all.windows(2).all(|pair| pair[0] == pair[1]) {
        return writeln!(page, "Every axis {}", all[0]);
    }
    for (i, given) in all.iter().enumerate() {
        writeln!(page, "Axis {i} {given}")?;
    }
    Ok(())
}

fn relative(error: f64) -> String {
    match error {
        e if e < 1e-9 => "a billionth".to_owned(),
        e if e < 1e-3 => format!("{:.2} parts in a million", e * 1e6),
        e => format!("{:.2} %", e * 100.0),
    }
}
