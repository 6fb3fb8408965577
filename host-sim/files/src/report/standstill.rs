//! Warnings of injected faults that come when the machine stands for good. Nothing turns that could show them, so a run with such a
//! fault tests nothing.

use cophase_core::monitor::alternatives;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_scene::entry;
use cophase_scene::file::{FaultAt, FaultName};
use host_sim::checked::Checked;
use host_sim::sim::RunRecord;
use host_sim::sim::events::{Event, EventKind};

/// Returns a warning for each fault of a scene that comes when the machine stands for good, and that no report shows.
pub(super) fn faults_at_standstill(checked: &Checked, record: &RunRecord) -> Vec<String> {
    let events = &record.events;
    let Some(stopped_s) = stands_since(events) else {
        return Vec::new();
    };
    // Cranks whose drives are off may turn on after the stop.
    let coasted_s = record.moved_until_s.unwrap_or(0.0);
    let stood_s = stopped_s.max(coasted_s);
    let warning = |(i, fault): (usize, &FaultAt)| {
        let injected = |event: &Event| event.what == EventKind::Injected(*fault);
        let at = events.iter().position(injected)?;
        let is_shown = events[at..].iter().any(|event| match &event.what {
            EventKind::Reported(report) | EventKind::Fault { fault: report, .. } => {
                may_show(report, fault, checked)
            }
            // Without the enable input, a parked machine becomes idle, and drives that hold are switched off.
            EventKind::State(_) | EventKind::LetGo => fault.kind == FaultName::EnableLoss,
            _ => false,
        });
        if events[at].t_s < stood_s || is_shown {
            return None;
        }
        let key = entry::place(&format!("fault[{i}].at_s"), None);
        Some(format!(
            "{key}: \"{}\" comes at {} s, and the machine stood from {stood_s:.3} s to the end, so nothing showed the fault. Give a time \
             before {stood_s:.3} s, or a [[command]] that starts the machine later.",
            fault.kind.name(),
            fault.at_s
        ))
    };
    let faults = checked.scene.fault.iter().enumerate();
    faults.filter_map(warning).collect()
}

/// Returns the time from which the machine stands to the end, s; none if it does not.
fn stands_since(events: &[Event]) -> Option<f64> {
    // It is idle at power-up.
    let mut since_s = Some(0.0);
    for event in events {
        since_s = match event.what {
            EventKind::State(State::Idle | State::Parked | State::Fault)
            | EventKind::Stopped { .. } => since_s.or(Some(event.t_s)),
            EventKind::State(_) | EventKind::Running { .. } => None,
            _ => since_s,
        };
    }
    since_s
}

/// True if a report may be an effect of an injected fault. Lines and deadlines state their own cause. Sensors may state any.
fn may_show(report: &Fault, fault: &FaultAt, checked: &Checked) -> bool {
    let axis = report.axis.and_then(|axis| checked.settings.axes.get(axis));
    // A servo drive may raise its alarm because of another fault.
    let has_alternatives = axis.is_some_and(|axis| alternatives(report, axis).next().is_some());
    let states_cause = match report.kind {
        FaultKind::DriveAlarm => !has_alternatives,
        FaultKind::EnableLost
        | FaultKind::StopInput
        | FaultKind::Overrun
        | FaultKind::StepFifoUnderrun => true,
        _ => false,
    };
    !states_cause || (report.kind.name() == fault.kind.name() && report.axis == fault.axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::file::Fidelity;
    use cophase_scene::{library, load};
    use host_sim::sim::simulate;

    /// Runs the scene `default` with more entries, and returns these warnings.
    fn warned(more: &str) -> Vec<String> {
        warned_on(Fidelity::Auto, more).0
    }

    /// Returns these warnings on a model level, and the time for which cranks coasted, s.
    fn warned_on(model_level: Fidelity, more: &str) -> (Vec<String>, f64) {
        let text = library::find("default").unwrap().text.to_owned() + more;
        let mut scene = load::parse(&text).unwrap();
        scene.fidelity = model_level;
        let checked = Checked::new(scene).unwrap();
        let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
        let warnings = faults_at_standstill(&checked, &outcome.record);
        (warnings, outcome.record.figures.coasted_s.unwrap_or(0.0))
    }

    /// Returns the time from which the machine stood, by the only one of these warnings, s.
    fn stood_s(said: &[String]) -> f64 {
        let [said] = said else { panic!("{said:?}") };
        let (_, after) = said.split_once("stood from ").unwrap();
        after.split_once(' ').unwrap().0.parse().unwrap()
    }

    fn lost_steps(at_s: f64) -> String {
        format!("[[fault]]\nat_s = {at_s}\nkind = \"lost-steps\"\naxis = 1\n")
    }

    /// If this fails, a fault after the end of the program seems to be harmless, because the run ends without one.
    #[test]
    fn a_fault_that_comes_after_the_end_is_reported_with_its_key_and_the_end() {
        let said = warned(&lost_steps(70.0));
        let [said] = &said[..] else {
            panic!("{said:?}");
        };
        let expected = "fault[0].at_s (1st [[fault]] entry): \"lost-steps\" comes at 70 s, and the machine stood from 59.631 s to the end";
        assert!(said.starts_with(expected), "{said}");
    }

    /// A fault in homing, one that is reported after the standstill, one that is permanent from power-up on whatever its time is, and one
    /// before a later start have effects.
    #[test]
    fn faults_that_have_an_effect_are_not_reported() {
        let alarm = "[[fault]]\nat_s = 70.0\nkind = \"drive-alarm\"\naxis = 1\n";
        let swapped = "[[fault]]\nat_s = 70.0\nkind = \"swapped-wiring\"\naxis = 1\nwith = 2\nlines = \"sensors\"\n";
        let start = |at_s: f64| format!("[[command]]\nat_s = {at_s}\ndo = \"start\"\n");
        let restarted = start(0.0) + &start(75.0) + &lost_steps(70.0);
        let cut = "[[fault]]\nat_s = 70.0\nkind = \"enable-loss\"\n";
        for more in [&lost_steps(0.5), alarm, cut, swapped, &restarted] {
            assert_eq!(warned(more), [""; 0], "{more}");
        }
    }

    /// A second fault comes when the first has stopped the machine.
    #[test]
    fn a_fault_after_a_stop_by_another_is_reported() {
        let said = warned(&(lost_steps(26.0) + &lost_steps(30.0)));
        let [said] = &said[..] else {
            panic!("{said:?}");
        };
        assert!(
            said.starts_with("fault[1].at_s (2nd [[fault]] entry)"),
            "{said}"
        );
    }

    /// If this fails, a fault of a crank that still turns seems to be harmless.
    #[test]
    fn cranks_that_coast_do_not_stand() {
        let cut = "[[fault]]\nat_s = 26.0\nkind = \"enable-loss\"\n";
        let stuck = "[[fault]]\nat_s = 26.2\nkind = \"stuck\"\naxis = 1\n";
        let (said, coasted_s) = warned_on(Fidelity::Phased, &(cut.to_owned() + stuck));
        assert!(coasted_s > 0.2, "{coasted_s}");
        assert_eq!(said, [""; 0]);
        let (said, coasted_s) = warned_on(Fidelity::Phased, &(cut.to_owned() + &lost_steps(35.0)));
        let coasted_until_s = 26.0 + coasted_s;
        assert!((stood_s(&said) - coasted_until_s).abs() < 0.002, "{said:?}");
    }

    /// If this fails, a warning recommends a time at which the machine stands too.
    #[test]
    fn a_fault_at_rest_does_not_begin_another_standstill() {
        let alarm = "[[fault]]\nat_s = 60.0\nkind = \"drive-alarm\"\naxis = 1\n";
        let said = warned(&(alarm.to_owned() + &lost_steps(61.0)));
        assert_eq!(stood_s(&said), 59.631);
    }

    /// If this fails, an input or another fault hides that a fault had no effect.
    #[test]
    fn later_events_of_other_causes_do_not_show_a_fault() {
        let input = "[[input]]\nat_s = 65.0\nline = \"enable\"\nactive = false\n";
        let alarm = "[[fault]]\nat_s = 65.0\nkind = \"drive-alarm\"\naxis = 1\n";
        for later in [input, alarm] {
            let said = warned(&(lost_steps(62.0) + later));
            assert_eq!(stood_s(&said), 59.631, "{later}");
        }
    }
}
