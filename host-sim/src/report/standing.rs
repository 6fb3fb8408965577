//! Warnings of injected faults that come when the machine stands for good. Nothing turns that could show them, so a run with such a
//! fault tests nothing.

use cophase_core::supervisor::State;

use crate::scene::entry;
use crate::scene::file::FaultAt;
use crate::sim::events::{Event, EventKind};

/// Returns a warning for each fault of a scene after which nothing happened, because the machine stood already.
pub(super) fn faults_at_standstill(faults: &[FaultAt], events: &[Event]) -> Vec<String> {
    let warning = |(i, fault): (usize, &FaultAt)| {
        let injected = |event: &Event| event.what == EventKind::Injected(*fault);
        let at = events.iter().position(injected)?;
        let (before, after) = events.split_at(at);
        let is_injection = |event: &Event| matches!(event.what, EventKind::Injected(_));
        let stood_s = stands_since(before).filter(|_| after.iter().all(is_injection))?;
        let key = entry::place(&format!("fault[{i}].at_s"), None);
        Some(format!(
            "{key}: \"{}\" comes at {} s, and the machine stood from {stood_s:.3} s to the end, so nothing showed the fault. Give a time \
             before {stood_s:.3} s, or a [[command]] that starts the machine later.",
            fault.kind.name(),
            fault.at_s
        ))
    };
    faults.iter().enumerate().filter_map(warning).collect()
}

/// Returns the time since which the machine stands after some events, s.
fn stands_since(events: &[Event]) -> Option<f64> {
    let state = |event: &Event| match event.what {
        EventKind::State(State::Idle | State::Parked | State::Fault)
        | EventKind::Stopped { .. } => Some(Some(event.t_s)),
        EventKind::State(_) | EventKind::Running { .. } => Some(None),
        _ => None,
    };
    // It is idle at power-up.
    events.iter().rev().find_map(state).unwrap_or(Some(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Checked, library, load};
    use crate::sim::simulate;

    /// Runs the scene `default` with more entries, and returns these warnings.
    fn warned(more: &str) -> Vec<String> {
        let text = library::find("default").unwrap().text.to_owned() + more;
        let checked = Checked::new(load::parse(&text).unwrap()).unwrap();
        let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
        faults_at_standstill(&checked.scene.fault, &outcome.statistics.events)
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
        let expected = "fault[0].at_s (1st [[fault]] entry): \"lost-steps\" comes at 70 s, and the machine stood from 58.502 s to the end";
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
        for more in [&lost_steps(0.5), alarm, swapped, &restarted] {
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
}
