//! Warnings: the simulated machine and its controller disagree, or the run does not show what was
//! requested.

use cophase_core::monitor::{Knowledge, Mount};
use cophase_core::supervisor::State;
use cophase_scene::file::{CommandAt, CommandName, FaultAt, FaultName};
use host_sim::checked::Checked;
use host_sim::drives::DriveModel;
use host_sim::operating_range::{Load, OperatingRange};
use host_sim::sim::Outcome;
use host_sim::sim::events::StoppedBy;

use super::standstill::faults_at_standstill;

/// Returns the warnings, a sentence each.
pub fn warnings(checked: &Checked, outcome: &Outcome) -> Vec<String> {
    let (scene, record) = (&checked.scene, &outcome.record);
    let mut warnings = Vec::new();
    warnings.extend(unwatched(checked));
    warnings.extend(lacking(checked).or_else(|| lacking_in_ramps(checked)));
    warnings.extend(beyond_pull_out(checked));
    warnings.extend(before_start(&scene.command));
    warnings.extend(faults_at_standstill(checked, record));
    warnings.extend(not_reached(checked, outcome));
    warnings.extend(record.machine_warnings.iter().cloned());
    if let Some(why) = &outcome.diverged {
        warnings.push(format!(
            "The simulated machine diverged, and the run was ended there: {why}."
        ));
    }
    let undamped = scene.axes.damping_nms == 0.0 && !scene.axes.pull_out.is_empty();
    if undamped && checked.moves_by_torque() {
        warnings.push(
            "Steppers without axes.damping_nms swing on for ever: real drives damp them, so give what yours do."
                .to_owned(),
        );
    }
    warnings.extend(lost_unnoticed(checked, outcome));
    let limit_mrad = scene.drift.tilt_limit_mrad;
    let is_beyond = |tilt_mrad: &f64| *tilt_mrad > limit_mrad;
    if let Some(tilt_mrad) = record.figures.tilt_worst_mrad.filter(is_beyond) {
        let commanded_mrad = checked.settings.commanded_tilt_mrad();
        let cause = if commanded_mrad > limit_mrad {
            format!(
                "the commanded phases alone tilt it by up to {commanded_mrad:.2} mrad in each turn, which machine.allow_commanded_tilt accepts."
            )
        } else if scene.axes.encoder {
            "what moves a crank, or holds it, does so until all stand (docs/faults.md).".to_owned()
        } else {
            "an index is detected once a turn, and what moves a crank, or holds it, does so until all stand (docs/faults.md).".to_owned()
        };
        warnings.push(format!(
            "The platform tilted by {tilt_mrad:.2} mrad, beyond its limit of {limit_mrad}: {cause}"
        ));
    }
    let coasted_s = record.figures.coasted_s;
    let tilt_off_mrad = record.figures.tilt_worst_off_mrad.filter(is_beyond);
    if let Some((tilt_mrad, _)) = tilt_off_mrad.zip(coasted_s) {
        warnings.push(format!(
            "With the drives off the platform tilted by {tilt_mrad:.2} mrad, beyond its limit of {limit_mrad}: nothing holds the cranks \
             together then but what they carry (docs/faults.md)."
        ));
    }
    if let Some(coasted_s) = coasted_s.filter(|_| record.is_coasting) {
        warnings.push(format!(
            "The {}s still turned {coasted_s:.1} s after the drives were off; the run was ended there.",
            checked.machine.axis_noun()
        ));
    }
    let swapped = |fault: &FaultAt| fault.kind == FaultName::SwappedWiring;
    if scene.fault.iter().any(swapped) && outcome.fault.is_none() && record.reported == 0 {
        warnings.push(
            "Lines of two axes were swapped, and the controller did not find out: correction.prove_wiring looks for that."
                .to_owned(),
        );
    }
    if outcome.diverged.is_none() && !matches!(outcome.state, State::Parked | State::Fault) {
        warnings.push(format!(
            "The machine was still in state `{}` when nothing more was to happen; the run was ended there.",
            outcome.state.name()
        ));
    }
    warnings
}

/// Warns of each axis that the controller lost unnoticed. The run then has exit status 1.
fn lost_unnoticed(checked: &Checked, outcome: &Outcome) -> Vec<String> {
    let lost = |axis: usize| {
        let record = &outcome.record.axes[axis];
        let off_turns = record.off_command_turns;
        let cycles = record.slipped_cycles.unwrap_or(0);
        let by = if off_turns == 0.0 && cycles == 0 {
            "made less than half of its commanded motion".to_owned()
        } else if off_turns == 0.0 {
            format!("slipped by {}", in_cycles(cycles.unsigned_abs()))
        } else {
            let off = if off_turns.abs() < 1.0 {
                format!("{:.1}°", 360.0 * off_turns.abs())
            } else {
                format!("{:.2} turns", off_turns.abs())
            };
            let side = if off_turns < 0.0 {
                "behind"
            } else {
                "ahead of"
            };
            let counted = match cycles {
                0 => String::new(),
                cycles => format!(" ({})", in_cycles(cycles.unsigned_abs())),
            };
            format!("ended {off} {side} its command{counted}")
        };
        let why = if !checked.has_index(axis) && !checked.scene.axes.encoder {
            "it has no sensor"
        } else {
            "its sensors show the same again after a whole turn, or no pulse was due any more"
        };
        format!("Axis {axis} {by}, and the controller did not notice: {why}.")
    };
    outcome.lost_unnoticed().map(lost).collect()
}

fn in_cycles(cycles: u64) -> String {
    let plural = if cycles == 1 { "" } else { "s" };
    format!("{cycles} electrical cycle{plural}")
}

/// Warns of motors that lack torque for the program, on any model level. Where a motor has no torque at all,
/// [`beyond_pull_out`] gives the reason.
fn lacking(checked: &Checked) -> Option<String> {
    let range = OperatingRange::new(checked).ok()??;
    let Load { axis, ratio, .. } = range.max_load()?;
    (ratio > 1.0 && ratio.is_finite()).then(|| {
        format!(
            "The motors lack torque: that of axis {axis} needs {ratio:.1} times what it has. Lower the program's speed or the load, \
             or take stronger motors ({}).",
            DriveModel::for_drive(checked.scene.resolved(axis).drive).torque_key
        )
    })
}

/// Warns of motors that lack torque while the master accelerates at its limit.
fn lacking_in_ramps(checked: &Checked) -> Option<String> {
    let load = OperatingRange::steepest_load(checked).ok()??;
    let Load {
        axis,
        speed_hz,
        ratio,
    } = load;
    (ratio > 1.0 && ratio.is_finite()).then(|| {
        format!(
            "The motors lack torque for the steepest ramp: while the master accelerates by limits.acceleration_hz_per_s = {}, that of axis {axis} \
             needs {ratio:.2} times what it has at {speed_hz:.1} rev/s. Lower that limit or the inertia (axes.rotor_inertia_kgm2), or take stronger \
             motors ({}).",
            checked.scene.limits.acceleration_hz_per_s,
            DriveModel::for_drive(checked.scene.resolved(axis).drive).torque_key
        )
    })
}

/// Warns of a program that ran to its end and contains a speed that the shaft never reached. For a speed inside a forbidden band, events
/// report that the shaft keeps the nearer edge.
fn not_reached(checked: &Checked, outcome: &Outcome) -> Option<String> {
    const NOTABLE: f64 = 0.01;
    let scene = &checked.scene;
    let is_undisturbed =
        scene.command.is_empty() && scene.input.is_empty() && scene.fault.is_empty();
    if outcome.record.stopped_by != Some(StoppedBy::ProgramEnd) || !is_undisturbed {
        return None;
    }
    let (requested_hz, reached_hz) = (checked.top_speed_hz(), outcome.record.figures.speed_top_hz);
    let in_band = scene
        .limits
        .band
        .iter()
        .any(|band| (band.from_hz..=band.to_hz).contains(&requested_hz));
    (reached_hz < (1.0 - NOTABLE) * requested_hz && !in_band).then(|| {
        format!(
            "The program asks for up to {requested_hz:.2} rev/s of the master, and it reached {reached_hz:.2}: limits.acceleration_hz_per_s = {} and \
             limits.jerk_hz_per_s2 = {} do not let it get there within that level. Give a longer ramp_s or hold_s, or higher limits.",
            scene.limits.acceleration_hz_per_s, scene.limits.jerk_hz_per_s2
        )
    })
}

/// Warns of steppers that turn faster than the end of their pull-out curve.
fn beyond_pull_out(checked: &Checked) -> Option<String> {
    let (end_hz, _) = *checked.scene.axes.pull_out.last()?;
    let motor_turns = |axis: usize| {
        let axis = &checked.settings.axes[axis];
        Some(axis.follower.constant_ratio()? * axis.gear.ratio())
    };
    let steppers = (0..checked.scene.axes.count)
        .filter(|&axis| checked.settings.axes[axis].drive.is_open_loop())
        .filter_map(motor_turns);
    let ratio = steppers.map(f64::abs).reduce(f64::max)?;
    let top_hz = checked.top_speed_hz() * ratio;
    (top_hz > end_hz).then(|| {
        format!(
            "axes.pull_out ends at {end_hz} rev/s, and the program turns the motors at up to {top_hz:.2} rev/s: beyond the curve's \
             last speed their torque counts as zero, so give points up to there."
        )
    })
}

/// Warns of commands that come before the first start.
fn before_start(commands: &[CommandAt]) -> Option<String> {
    let is_start = |command: &&CommandAt| command.r#do == CommandName::Start;
    let starts = commands.iter().filter(is_start);
    let first_s = starts.map(|start| start.at_s).reduce(f64::min)?;
    let mut early: Vec<f64> = commands
        .iter()
        .filter(|command| !is_start(command) && command.at_s < first_s)
        .map(|command| command.at_s)
        .collect();
    early.sort_by(f64::total_cmp);
    let early: Vec<String> = early.iter().map(f64::to_string).collect();
    (!early.is_empty()).then(|| {
        format!(
            "Commands at {} s come before the first start, at {first_s} s, and have no effect: the machine stands idle until then. \
             Give a start at 0 s.",
            early.join(", ")
        )
    })
}

/// Warns of cranks without index sensor and encoder, and of the unknown tilt of their platform.
fn unwatched(checked: &Checked) -> Option<String> {
    let count = checked.scene.axes.count;
    let is_watched = |axis: &usize| checked.has_index(*axis) || checked.scene.axes.encoder;
    let (watched, unwatched): (Vec<usize>, Vec<usize>) = (0..count).partition(is_watched);
    let set = watched.iter().fold(0, |set, axis| set | 1 << axis);
    let coverage = match Mount::with(count, set).knowledge() {
        _ if unwatched.is_empty() => return None,
        Knowledge::Nothing => "nothing measures the platform's tilt",
        Knowledge::Common => "one axis stands for all, and nothing measures the platform's tilt",
        Knowledge::OneTilt => {
            "of the platform two axes show the least tilt that explains their difference"
        }
        Knowledge::Plane => "of the platform three axes show a plane, and nothing checks it",
        Knowledge::All => "the platform's plane is the best through the others",
    };
    let axes: Vec<_> = unwatched.iter().map(usize::to_string).collect();
    let of_platform = if checked.tilt_limit_mrad().is_some() {
        format!("; {coverage}")
    } else {
        String::new()
    };
    Some(format!(
        "Without a sensor the phase error of axis {} is not monitored, and phase_error_deg is 0 there for want of a measurement{of_platform}.",
        axes.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::file::Fidelity;
    use cophase_scene::{library, load};

    /// If this fails, motors that cannot turn their load seem to run, or look like a broken axis.
    #[test]
    fn motors_that_lack_torque_are_named() {
        let run = |limit_nm: f64, curve: &str| {
            let drive = if curve.is_empty() {
                format!(
                    "drive = \"servo\"\nservo = {{ position_gain_per_s = 60, velocity_gain_nms = 2.0, limit_nm = {limit_nm} }}"
                )
            } else {
                format!("drive = \"stepper\"\ndamping_nms = 0.2\npull_out = {curve}")
            };
            let text = format!(
                "name = \"weak\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 20\n\
                 [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
                 [axes]\ncount = 3\n{drive}\nsteps_per_turn = 3200\nrotor_inertia_kgm2 = 1e-3\n\
                 [[program]]\namax_g = 3\nramp_s = 0.2\nhold_s = 0.2\n"
            );
            let checked = Checked::new(load::parse(&text).unwrap()).unwrap();
            let said = lacking(&checked).or_else(|| beyond_pull_out(&checked));
            (checked.fidelity, said)
        };
        assert_eq!(run(50.0, ""), (Fidelity::Kinematic, None));
        // The load alone, 20 kg, requires 20 · 10 · 0.01 / 3 = 0.67 N·m of each motor.
        let (fidelity, said) = run(0.1, "");
        assert_eq!(fidelity, Fidelity::Phased, "the limit implies the question");
        let said = said.expect("a tenth of a newton metre is too little");
        let times = said
            .split(" needs ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let times: f64 = times.unwrap().parse().unwrap();
        assert!(said.contains("axis 0 needs") && times > 6.7, "{said}");
        let (fidelity, said) = run(0.0, "[[0, 20], [2, 20]]");
        assert_eq!(fidelity, Fidelity::Phased);
        let said = said.expect("the curve ends below the top speed");
        assert!(said.contains("ends at 2 rev/s"), "{said}");
    }

    /// If this fails, a run claims to monitor a tilt that nothing measures, or warns of cranks that have encoders.
    #[test]
    fn unmonitored_axes_are_reported() {
        let said = |count: usize, without: &[usize], encoder: bool| {
            let apart: String = without
                .iter()
                .map(|axis| format!("[[axis]]\nnumber = {axis}\nindex = false\n"))
                .collect();
            let text = format!(
                "name = \"sensors\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
                 [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
                 [axes]\ncount = {count}\ndrive = \"servo\"\nsteps_per_turn = 4096\nencoder = {encoder}\n{apart}\
                 [[program]]\namax_g = 1\nhold_s = 1\n"
            );
            unwatched(&Checked::new(load::parse(&text).unwrap()).unwrap())
        };
        assert_eq!(said(4, &[], false), None);
        assert_eq!(said(4, &[0, 1], true), None, "encoders watch them");
        for (without, coverage) in [
            (
                &[2][..],
                "axis 2 is not monitored, and phase_error_deg is 0 there for want of a measurement; of the platform three axes",
            ),
            (
                &[1, 3],
                "axis 1, 3 is not monitored, and phase_error_deg is 0 there for want of a measurement; of the platform two axes",
            ),
            (&[0, 1, 2], "one axis stands for all"),
            (&[0, 1, 2, 3], "nothing measures the platform"),
        ] {
            let said = said(4, without, false).expect("some are not watched");
            assert!(said.contains(coverage), "{said}");
        }
        let said = said(5, &[4], false).expect("one is not watched");
        assert!(said.ends_with("the best through the others."), "{said}");
        let arm = Checked::new(library::find("five-bar").unwrap().scene()).unwrap();
        let said = unwatched(&arm).expect("joints have no sensors");
        assert!(!said.contains("platform"), "{said}");
    }

    fn scene(more: &str, axes: &str) -> Checked {
        let text = format!(
            "name = \"warnings\"\nfidelity = \"kinematic\"\n{more}\n\
             [machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
             [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
             [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n{axes}\
             [[program]]\namax_g = 2\nhold_s = 1\n"
        );
        Checked::new(load::parse(&text).unwrap()).unwrap()
    }

    /// If this fails, a pull-out curve that is too short looks like weak motors, which slip at its end.
    #[test]
    fn a_pull_out_curve_that_ends_early_is_reported() {
        let warned = |axes: &str| beyond_pull_out(&scene("", axes));
        let top_hz = scene("", "").top_speed_hz();
        assert!((5.0..9.9).contains(&top_hz), "{top_hz}");
        assert_eq!(warned(""), None);
        assert_eq!(warned("pull_out = [[0, 30], [10, 28]]\n"), None);
        let words = warned("pull_out = [[0, 30], [5, 28]]\n").unwrap();
        let expected = format!(
            "axes.pull_out ends at 5 rev/s, and the program turns the motors at up to {top_hz:.2} rev/s"
        );
        assert!(words.starts_with(&expected), "{words}");
        assert!(words.contains("torque counts as zero"), "{words}");
        // A motor that makes two turns for one of the master's needs twice the speed.
        let geared = "pull_out = [[0, 30], [10, 28]]\ngear = [2, 1]\n";
        assert!(warned(geared).is_some());
    }

    /// If this fails, motors that only ramps overload seem to have enough torque. Rotors of 0.5 kg·m² need 0.5 · 2π · 20 = 63 N·m.
    #[test]
    fn motors_too_weak_for_the_steepest_ramp_are_reported() {
        let warned = |inertia: f64| {
            let curve = "pull_out = [[0, 30], [10, 28]]";
            lacking_in_ramps(&scene(
                "",
                &format!("{curve}\nrotor_inertia_kgm2 = {inertia}\n"),
            ))
        };
        assert_eq!(warned(1e-3), None);
        let words = warned(0.5).unwrap();
        assert!(
            words.contains("limits.acceleration_hz_per_s = 20"),
            "{words}"
        );
        assert!(
            words.contains("needs 2.") && words.contains("axes.pull_out"),
            "{words}"
        );
    }

    /// If this fails, a scene is idle for its whole length, and its report does not say so.
    #[test]
    fn commands_before_the_first_start_are_reported() {
        let warned = |commands: &str| {
            before_start(&scene(&format!("command = [{commands}]"), "").scene.command)
        };
        assert_eq!(warned(""), None);
        assert_eq!(
            warned("{ at_s = 2, do = \"stop\" }"),
            None,
            "started at once"
        );
        let start = "{ at_s = 9, do = \"start\" }";
        assert_eq!(warned(start), None);
        let words = warned(&format!(
            "{start}, {{ at_s = 5, do = \"stop\" }}, {{ at_s = 3, do = \"hold\" }}"
        ));
        let words = words.unwrap();
        assert!(
            words.starts_with("Commands at 3, 5 s come before the first start, at 9 s"),
            "{words}"
        );
        assert_eq!(
            warned(&format!(
                "{{ at_s = 0, do = \"start\" }}, {{ at_s = 5, do = \"stop\" }}, {start}"
            )),
            None
        );
    }
}
