//! What counts as the detection of a crank past its limit.

use super::*;
use crate::campaign::watch::Place;
use host_sim::scene::library;

const PAST_TURNS: f64 = 10.0;

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

fn telling(kind: FaultKind, axis: Option<usize>, done: Reaction, turns: f64) -> Telling {
    Telling {
        told: Told { kind, axis },
        done,
        place: place(turns),
        turns,
        is_moved: false,
        is_past: true,
    }
}

/// The default scene, axis 1 of which slips, and what was seen of it: past its limit at [`PAST_TURNS`], and told so.
fn slipped(tellings: &[Telling]) -> (Scene, Seen) {
    let mut scene = library::find("default").unwrap().scene();
    scene.correction.part = 0.5;
    scene.fault = vec![FaultAt {
        at_s: 0.9,
        kind: FaultName::Slip,
        axis: Some(1),
        with: None,
        lines: None,
        cycles: None,
        rate_deg_per_s: Some(10.0),
        speed_hz: None,
        count: None,
        counts: None,
        torque_nm: None,
        for_s: None,
    }];
    let stopped = tellings
        .iter()
        .find(|telling| telling.done >= Reaction::Stop);
    let seen = Seen {
        injected: Some(place(9.0)),
        past: Some(place(PAST_TURNS)),
        is_past: true,
        tellings: tellings.to_vec(),
        incidents: tellings.iter().map(|telling| telling.told).collect(),
        fault: stopped.map(|telling| telling.told),
        end: Some(place(20.0)),
        ..Seen::default()
    };
    (scene, seen)
}

fn judged((scene, seen): &(Scene, Seen)) -> (Verdict, Option<f64>) {
    let judgement = judge(scene, None, seen, (false, false));
    (judgement.verdict, judgement.turns)
}

/// Were anything that is told a detection, a loop would be praised for seeing a glitch while a crank walks off; were a stop for
/// another crank one, it would be for stopping by chance.
#[test]
fn what_is_detected_is_stopped_for() {
    use FaultKind::{EncoderGlitch, Slip, Tilt};
    use Reaction::{Correct, Report, Stop};
    let glitch = telling(EncoderGlitch, Some(1), Report, 10.1);
    let corrected = telling(Slip, Some(1), Correct, 10.2);
    let other = telling(Slip, Some(2), Stop, 10.3);
    let of_none = telling(Tilt, None, Stop, 10.6);
    let own = telling(Slip, Some(1), Stop, 11.4);
    let near =
        |turns: Option<f64>, expected: f64| turns.is_some_and(|t| (t - expected).abs() < 1e-9);

    let (verdict, turns) = judged(&slipped(&[glitch, corrected, own]));
    assert!(verdict == Verdict::Right && near(turns, 1.4), "{turns:?}");
    let (_, turns) = judged(&slipped(&[glitch, of_none, own]));
    assert!(near(turns, 0.6), "{turns:?}");
    // Stopped, but for another crank's sake: wrongly named, and never detected, however soon it was.
    let (scene, mut seen) = slipped(&[glitch, other]);
    seen.end = Some(place(PAST_TURNS + 0.5));
    let judgement = judge(&scene, None, &seen, (false, false));
    assert_eq!(judgement.verdict, Verdict::Misnamed);
    assert_eq!((judgement.turns, judgement.in_time), (None, Some(false)));
    // Unless that one had been dragged along; the name is as wrong.
    let dragged = Telling {
        is_moved: true,
        ..other
    };
    let (verdict, turns) = judged(&slipped(&[glitch, dragged]));
    assert!(
        verdict == Verdict::Misnamed && near(turns, 0.3),
        "{turns:?}"
    );
    // Told, and gone on from, with the crank still out.
    for told in [&[glitch][..], &[corrected], &[glitch, corrected]] {
        assert_eq!(judged(&slipped(told)), (Verdict::Missed, None));
    }
}

/// Were a correction that was enough none, a machine would have to stop for what it mends; were one that was not, or that may not
/// be made, a machine could go on past its limit for ever.
#[test]
fn a_correction_counts_where_it_was_enough() {
    let corrected = telling(FaultKind::Slip, Some(1), Reaction::Correct, 9.5);
    let (scene, mut seen) = slipped(&[corrected]);
    seen.is_past = false;
    let (verdict, turns) = judged(&(scene.clone(), seen.clone()));
    assert_eq!((verdict, turns), (Verdict::Right, Some(9.5 - PAST_TURNS)));

    let mut told_only = scene.clone();
    told_only.correction.part = 0.0;
    assert_eq!(judged(&(told_only, seen.clone())).0, Verdict::Missed);

    // It walks on, and is stopped for after all: that is when it was seen to be past its limit.
    let stopped = telling(FaultKind::Slip, Some(1), Reaction::Stop, 12.0);
    seen.tellings.push(stopped);
    seen.fault = Some(stopped.told);
    assert_eq!(judged(&(scene.clone(), seen.clone())).1, Some(2.0));
    // It is stopped for all the same, though it is within its limits again.
    seen.tellings[1].is_past = false;
    let (_, turns) = judged(&(scene.clone(), seen.clone()));
    assert_eq!(turns, Some(9.5 - PAST_TURNS));
    // It was for too long.
    seen.stay_turns = 1.7;
    assert_eq!(judged(&(scene, seen)).1, Some(2.0));
}

/// Were it counted late, a loop would be asked to hear an index that does not come any more; were it in time, a crank that stays out
/// for turns would pass for detected.
#[test]
fn a_turn_that_is_not_made_is_not_waited_for() {
    let corrected = telling(FaultKind::Slip, Some(1), Reaction::Correct, 9.5);
    let (scene, mut seen) = slipped(&[corrected]);
    let in_time = |seen: &Seen| judge(&scene, None, seen, (false, false)).in_time;
    assert_eq!(in_time(&seen), Some(false));
    seen.end = Some(place(PAST_TURNS + 0.9));
    assert_eq!(in_time(&seen), None);
    assert_eq!(
        judge(&scene, None, &seen, (false, false)).verdict,
        Verdict::Right
    );
    seen.tellings.clear();
    assert_eq!(
        judge(&scene, None, &seen, (false, false)).verdict,
        Verdict::Moot
    );
    seen.end = Some(place(PAST_TURNS + 1.1));
    assert_eq!(
        judge(&scene, None, &seen, (false, false)).verdict,
        Verdict::Missed
    );
}
