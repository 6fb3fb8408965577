//! Motors that are asked for more than they have, cranks that bend the rods, and a loop that has no time.

use cophase_core::supervisor::{FaultKind, State};
use cophase_lab::chart::breakdown::{overload, pull_out, rods, runs};
use host_sim::sim::events::Happening;

use super::failed;

/// Were it wrong, a motor that is too weak would hold all the same, or its slips be noticed late or by nobody.
#[test]
fn a_motor_that_pulls_out() {
    let strong = pull_out::look(1.0).unwrap().outcome;
    assert_eq!(strong.statistics.slipped_cycles, [0, 0, 0]);
    assert_eq!((strong.state, strong.fault), (State::Parked, None));

    let weak = pull_out::look(pull_out::WEAK).unwrap();
    let slipped = &weak.outcome.statistics.slipped_cycles;
    assert!(slipped[pull_out::WEAK_AXIS] < 0, "{slipped:?}");
    let slip_s = runs::first_slip_s(&weak.outcome).expect("it slips");
    let fault = weak.outcome.fault.expect("the drift monitor sees it");
    // Its index is overdue as it slips, and passes a little later: what that shows is no whole cycle.
    assert_eq!(fault.axis, Some(pull_out::WEAK_AXIS));
    let names: Vec<_> = weak
        .outcome
        .statistics
        .events
        .iter()
        .filter_map(|event| match event.what {
            Happening::Fault { fault, .. } => Some(fault.kind),
            _ => None,
        })
        .collect();
    assert_eq!(names[..2], [FaultKind::Silent, FaultKind::Slip]);
    // An index is heard once a turn, a tick later at the latest, and judged in the next.
    let heard_s = runs::fault_s(&weak.outcome).expect("it is an event") - slip_s;
    let turn_s = weak.turn_s(slip_s);
    assert!(
        heard_s > 0.0 && heard_s <= turn_s + 2.0 * pull_out::TICK_S,
        "{heard_s} s, a turn {turn_s} s"
    );
    assert_eq!(weak.outcome.state, State::Fault);

    // Beforehand: more is asked than there is.
    assert!(pull_out::torque_used(pull_out::WEAK).unwrap() > 1.0);
    assert!(pull_out::torque_used(1.0).unwrap() < 0.5);
    failed(&pull_out::scene("phased", pull_out::WEAK));
}

/// Were it wrong, a machine that bends its rods would go on, and nobody be told that it is over-constrained.
#[test]
fn a_crank_that_bends_the_rods_is_stopped() {
    // One of four that is 1° off is 0.25° off the plane of all.
    for (limit_deg, fault) in [(0.2, Some(FaultKind::TooFarOut)), (0.3, None)] {
        let text = rods::scene(rods::SOFT_N_PER_UM, 1.0, limit_deg, "");
        let outcome = runs::run(&text, &mut |_| {}).unwrap();
        assert_eq!(outcome.fault.map(|fault| fault.kind), fault, "{limit_deg}°");
        assert_eq!(
            outcome.state,
            if fault.is_some() {
                State::Fault
            } else {
                State::Parked
            }
        );
    }
    let report = failed(&rods::scene(rods::SOFT_N_PER_UM, 1.0, 0.2, ""));
    let left_out = report["fidelity"]["left_out"].to_string();
    assert!(left_out.contains("over-constrain"), "{left_out}");
}

/// Were it wrong, motors that all slip together would go unseen, as nothing tilts; or would not slip.
#[test]
fn five_times_the_load() {
    let sized = overload::look(overload::SIZED_KG).unwrap().outcome;
    assert_eq!(sized.statistics.slipped_cycles, [0, 0, 0]);
    assert_eq!((sized.state, sized.fault), (State::Parked, None));
    let over = overload::look(5.0 * overload::SIZED_KG).unwrap();
    let slip_s = runs::first_slip_s(&over.outcome).expect("they slip");
    let fault = over.outcome.fault.expect("the common lag is watched");
    assert_eq!(fault.kind, FaultKind::CommonLag);
    assert!(runs::fault_s(&over.outcome).expect("an event") > slip_s);
    assert_eq!(over.outcome.state, State::Fault);
    let worst = over
        .ahead_deg
        .iter()
        .fold(0.0_f64, |worst, (_, deg)| worst.max(deg.abs()));
    assert!(worst > overload::COMMON_LIMIT_DEG, "{worst}°");
    // Torque is in proportion to the load where rotors take little of it: the rung that compares torques says so beforehand.
    let used = overload::torque_used(overload::SIZED_KG).unwrap();
    assert!((0.5..0.6).contains(&used), "{used}");
    assert!(overload::torque_used(5.0 * overload::SIZED_KG).unwrap() > 1.0);
    failed(&overload::scene("phased", 5.0 * overload::SIZED_KG));
}

/// Were it wrong, a loop that takes five ticks for each would turn on, in phase and too slowly, or lose its phase.
#[test]
fn a_loop_five_times_too_slow() {
    let outcome = runs::run(&overload::slow_loop(), &mut |_| {}).unwrap();
    assert_eq!(
        outcome.fault.map(|fault| fault.kind),
        Some(FaultKind::Overrun)
    );
    assert_eq!(outcome.state, State::Fault);
    assert!(outcome.statistics.missed_deadlines >= 3);
    assert_eq!(outcome.statistics.worst_spread_deg, 0.0);
    failed(&overload::slow_loop());
}
