//! What counts as the detection of a crank beyond its limit.

use super::*;
use crate::campaign::watch::Place;
use host_sim::scene::library;

const BEYOND_TURNS: f64 = 10.0;

fn place(turns: f64) -> Place {
    Place {
        moment: (turns * 100.0) as u64,
        t_s: turns / 10.0,
        turns,
        speed_hz: 10.0,
        acceleration_hz_per_s: 0.0,
        state: State::Run,
    }
}

fn fault_event(kind: FaultKind, axis: Option<usize>, done: Reaction, turns: f64) -> FaultEvent {
    FaultEvent {
        reported: ReportedFault { kind, axis },
        done,
        place: place(turns),
        turns,
        is_moved: false,
        is_beyond_limit: true,
    }
}

/// The default scene, axis 1 of which slips, and what was detected of it: beyond its limit at [`BEYOND_TURNS`], and reported as such.
fn slipped(fault_events: &[FaultEvent]) -> (Scene, Observation) {
    let mut scene = library::find("default").unwrap().scene();
    scene.correction.gain = 0.5;
    scene.fault = vec![FaultAt {
        axis: Some(1),
        rate_deg_per_s: Some(10.0),
        ..FaultAt::new(0.9, FaultName::Slip)
    }];
    let stopped = fault_events
        .iter()
        .find(|fault_event| fault_event.done >= Reaction::Stop);
    let observation = Observation {
        injected: Some(place(9.0)),
        beyond_limit: Some(place(BEYOND_TURNS)),
        is_beyond_limit: true,
        fault_events: fault_events.to_vec(),
        reported_faults: fault_events
            .iter()
            .map(|fault_event| fault_event.reported)
            .collect(),
        fault: stopped.map(|fault_event| fault_event.reported),
        end: Some(place(20.0)),
        ..Observation::default()
    };
    (scene, observation)
}

fn judged((scene, observation): &(Scene, Observation)) -> (Verdict, Option<f64>) {
    let judgement = judge(scene, None, observation, (false, false));
    (judgement.verdict, judgement.turns)
}

/// Were anything that is reported a detection, a loop would be praised for seeing a glitch while a crank walks off; were a stop for
/// another crank one, it would be for stopping by chance.
#[test]
fn what_is_detected_is_stopped_for() {
    use FaultKind::{EncoderGlitch, Slip, Tilt};
    use Reaction::{Correct, Report, Stop};
    let glitch = fault_event(EncoderGlitch, Some(1), Report, 10.1);
    let corrected = fault_event(Slip, Some(1), Correct, 10.2);
    let other = fault_event(Slip, Some(2), Stop, 10.3);
    let of_none = fault_event(Tilt, None, Stop, 10.6);
    let own = fault_event(Slip, Some(1), Stop, 11.4);
    let near =
        |turns: Option<f64>, expected: f64| turns.is_some_and(|t| (t - expected).abs() < 1e-9);

    let (verdict, turns) = judged(&slipped(&[glitch, corrected, own]));
    assert!(verdict == Verdict::Right && near(turns, 1.4), "{turns:?}");
    let (_, turns) = judged(&slipped(&[glitch, of_none, own]));
    assert!(near(turns, 0.6), "{turns:?}");
    // Stopped, but for another crank's sake: wrongly named, and never detected, however soon it was.
    let (scene, mut observation) = slipped(&[glitch, other]);
    observation.end = Some(place(BEYOND_TURNS + 0.5));
    let judgement = judge(&scene, None, &observation, (false, false));
    assert_eq!(judgement.verdict, Verdict::Misnamed);
    assert_eq!((judgement.turns, judgement.in_time), (None, Some(false)));
    // Unless that one had been dragged along; the name is as wrong.
    let dragged = FaultEvent {
        is_moved: true,
        ..other
    };
    let (verdict, turns) = judged(&slipped(&[glitch, dragged]));
    assert!(
        verdict == Verdict::Misnamed && near(turns, 0.3),
        "{turns:?}"
    );
    // Reported, and gone on from, with the crank still out.
    for reported in [&[glitch][..], &[corrected], &[glitch, corrected]] {
        assert_eq!(judged(&slipped(reported)), (Verdict::Missed, None));
    }
}

/// Were a correction that was enough none, a machine would have to stop for what it fixes; were one that was not, or that may not
/// be made, a machine could go on beyond its limit for ever.
#[test]
fn a_correction_counts_where_it_was_enough() {
    let corrected = fault_event(FaultKind::Slip, Some(1), Reaction::Correct, 9.5);
    let (scene, mut observation) = slipped(&[corrected]);
    observation.is_beyond_limit = false;
    let (verdict, turns) = judged(&(scene.clone(), observation.clone()));
    assert_eq!((verdict, turns), (Verdict::Right, Some(9.5 - BEYOND_TURNS)));

    let mut reported_only = scene.clone();
    reported_only.correction.gain = 0.0;
    assert_eq!(
        judged(&(reported_only, observation.clone())).0,
        Verdict::Missed
    );

    // It walks on, and is stopped for after all: that is when it was detected beyond its limit.
    let stopped = fault_event(FaultKind::Slip, Some(1), Reaction::Stop, 12.0);
    observation.fault_events.push(stopped);
    observation.fault = Some(stopped.reported);
    assert_eq!(judged(&(scene.clone(), observation.clone())).1, Some(2.0));
    // It is stopped for all the same, though it is within its limits again.
    observation.fault_events[1].is_beyond_limit = false;
    let (_, turns) = judged(&(scene.clone(), observation.clone()));
    assert_eq!(turns, Some(9.5 - BEYOND_TURNS));
    // It was for too long.
    observation.stay_turns = 1.7;
    assert_eq!(judged(&(scene, observation)).1, Some(2.0));
}

/// Were it counted late, a loop would have to detect an index that does not come any more; were it in time, a crank that stays out
/// for turns would pass for detected.
#[test]
fn a_turn_that_is_not_made_is_not_waited_for() {
    let corrected = fault_event(FaultKind::Slip, Some(1), Reaction::Correct, 9.5);
    let (scene, mut observation) = slipped(&[corrected]);
    let in_time =
        |observation: &Observation| judge(&scene, None, observation, (false, false)).in_time;
    assert_eq!(in_time(&observation), Some(false));
    observation.end = Some(place(BEYOND_TURNS + 0.9));
    assert_eq!(in_time(&observation), None);
    assert_eq!(
        judge(&scene, None, &observation, (false, false)).verdict,
        Verdict::Right
    );
    observation.fault_events.clear();
    assert_eq!(
        judge(&scene, None, &observation, (false, false)).verdict,
        Verdict::Moot
    );
    observation.end = Some(place(BEYOND_TURNS + 1.1));
    assert_eq!(
        judge(&scene, None, &observation, (false, false)).verdict,
        Verdict::Missed
    );
}
