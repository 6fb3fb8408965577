//! Motors that need more torque than they have, cranks that bend the rods, and a loop that runs too slowly.

use cophase_core::supervisor::{FaultKind, State};
use cophase_lab::chart::breakdown::{overload, pull_out, rods, runs};
use host_sim::sim::Outcome;
use host_sim::sim::events::EventKind;

use super::failed;

/// Returns the electrical cycles that each motor slipped.
fn slips(outcome: &Outcome) -> Vec<i64> {
    let axes = outcome.record.axes.iter();
    axes.map(|axis| axis.motor_slips).collect()
}

/// If this fails, a motor that is too weak does not slip, or its slip is detected late or never.
#[test]
fn the_slip_of_a_weak_motor_is_detected() {
    let strong = pull_out::measure(1.0).unwrap().outcome;
    assert_eq!(slips(&strong), [0, 0, 0]);
    assert_eq!((strong.state, strong.fault), (State::Parked, None));

    let weak = pull_out::measure(pull_out::WEAK).unwrap();
    let slipped = slips(&weak.outcome);
    assert!(slipped[pull_out::WEAK_AXIS] < 0, "{slipped:?}");
    let slip_s = runs::first_slip_s(&weak.outcome).expect("it slips");
    let fault = weak.outcome.fault.expect("the drift monitor sees it");
    // The slip delays the index, so the first fault is an index timeout. The index passes a little later, with a phase error that
    // is not a whole cycle.
    assert_eq!(fault.axis, Some(pull_out::WEAK_AXIS));
    let names: Vec<_> = weak
        .outcome
        .record
        .events
        .iter()
        .filter_map(|event| match event.what {
            EventKind::Fault { fault, .. } => Some(fault.kind),
            _ => None,
        })
        .collect();
    assert_eq!(names[..2], [FaultKind::IndexTimeout, FaultKind::Slip]);
    // An index is detected once a turn, at most one tick late, and evaluated in the next tick.
    let detected_s = runs::fault_s(&weak.outcome).expect("it is an event") - slip_s;
    let turn_s = weak.turn_s(slip_s);
    assert!(
        detected_s > 0.0 && detected_s <= turn_s + 2.0 * pull_out::TICK_S,
        "{detected_s} s, a turn {turn_s} s"
    );
    assert_eq!(weak.outcome.state, State::Fault);

    // The torque comparison before the run shows that the motor needs more torque than it has.
    assert!(pull_out::torque_used(pull_out::WEAK).unwrap() > 1.0);
    assert!(pull_out::torque_used(1.0).unwrap() < 0.5);
    failed(&pull_out::scene("phased", pull_out::WEAK));
}

/// If this fails, a machine that bends its rods runs on, and the report does not state that it is over-constrained.
#[test]
fn a_crank_that_bends_the_rods_is_stopped() {
    // One crank of four that is 1° off is 0.25° off the plane of all four.
    for (limit_deg, fault) in [(0.2, Some(FaultKind::HomingRangeExceeded)), (0.3, None)] {
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

/// If this fails, motors that all slip together are not detected, because the platform does not tilt, or they do not slip.
#[test]
fn five_times_the_load_causes_a_common_lag_fault() {
    let sized = overload::measure(overload::SIZED_KG).unwrap().outcome;
    assert_eq!(slips(&sized), [0, 0, 0]);
    assert_eq!((sized.state, sized.fault), (State::Parked, None));
    let over = overload::measure(5.0 * overload::SIZED_KG).unwrap();
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
    // Torque is in proportion to the load where rotors need little of it. The model level that compares torques shows the excess
    // before the run.
    let used = overload::torque_used(overload::SIZED_KG).unwrap();
    assert!((0.5..0.6).contains(&used), "{used}");
    assert!(overload::torque_used(5.0 * overload::SIZED_KG).unwrap() > 1.0);
    failed(&overload::scene("phased", 5.0 * overload::SIZED_KG));
}

/// If this fails, a loop that takes five ticks for each tick runs on in phase but too slowly, or loses its phase.
#[test]
fn a_loop_five_times_too_slow_causes_an_overrun() {
    let outcome = runs::run(&overload::slow_loop(), &mut |_| {}).unwrap();
    assert_eq!(
        outcome.fault.map(|fault| fault.kind),
        Some(FaultKind::Overrun)
    );
    assert_eq!(outcome.state, State::Fault);
    let figures = &outcome.record.figures;
    assert!(figures.missed_deadlines >= 3);
    assert_eq!(figures.phase_spread_worst_deg, Some(0.0));
    failed(&overload::slow_loop());
}
