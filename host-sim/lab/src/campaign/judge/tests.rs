//! Tests of the detection of a crank beyond its limit.

use cophase_scene::file::Lines;
use cophase_scene::library;

use super::*;
use crate::campaign::plan::Plan;
use crate::campaign::response::Response;
use crate::campaign::run;
use crate::campaign::watch::{FaultEvent, Place};

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

fn fault_event(kind: FaultKind, axis: Option<usize>) -> FaultEvent {
    FaultEvent {
        reported: ReportedFault { kind, axis },
        place: place(10.1),
        turns: 10.1,
    }
}

fn responded(response: Response, turns: f64) -> Responded {
    Responded {
        response,
        place: place(turns),
        turns,
        is_beyond_limit: true,
        stay_turns: (turns - BEYOND_TURNS).max(0.0),
        is_hidden: false,
    }
}

/// Default scene in which axis 1 slips beyond its limit at [`BEYOND_TURNS`], stays there, and is reported as a slip. It may stay for 1.1
/// turns.
fn slipped(responses: &[Responded]) -> (Scene, Observation) {
    let mut scene = library::find("default").unwrap().scene();
    scene.fault = vec![FaultAt {
        axis: Some(1),
        rate_deg_per_s: Some(10.0),
        ..FaultAt::new(0.9, FaultName::Slip)
    }];
    let of = |is: fn(Response) -> bool| {
        let found = responses.iter().find(|responded| is(responded.response));
        found.copied()
    };
    let slip = fault_event(FaultKind::Slip, Some(1));
    let observation = Observation {
        injected: Some(place(9.0)),
        beyond_limit: Some(place(BEYOND_TURNS)),
        is_beyond_limit: true,
        stay_turns: 20.0 - BEYOND_TURNS,
        may_stay_turns: 1.1,
        stopped: of(|response| response != Response::Correction),
        corrected: of(|response| response == Response::Correction),
        fault_events: vec![slip],
        reported_faults: vec![slip.reported],
        end: Some(place(20.0)),
        ..Observation::default()
    };
    (scene, observation)
}

fn judged(scene: &Scene, observation: &Observation) -> (Verdict, Option<f64>, Option<bool>) {
    let Judgement {
        verdict,
        turns,
        in_time,
        ..
    } = judge(scene, None, observation, (false, false));
    let rounded = turns.map(|turns| (turns * 1e6).round() / 1e6);
    (verdict, rounded, in_time)
}

/// If this fails, a report alone is a detection, and a loop passes that names the fault while the crank moves on. Or a stop without the
/// right name is no detection, and a name counts more than the outputs.
#[test]
fn a_crank_is_detected_when_the_outputs_stop_it() {
    let (scene, reported) = slipped(&[]);
    assert_eq!(
        judged(&scene, &reported),
        (Verdict::Missed, None, Some(false))
    );
    for response in [Response::Stop, Response::Off] {
        let (scene, stopped) = slipped(&[responded(response, 10.6)]);
        assert_eq!(
            judged(&scene, &stopped),
            (Verdict::Right, Some(0.6), Some(true))
        );
    }
    let (scene, mut late) = slipped(&[responded(Response::Stop, 11.4)]);
    assert_eq!(
        judged(&scene, &late),
        (Verdict::Right, Some(1.4), Some(false))
    );
    late.reported_faults = vec![fault_event(FaultKind::Slip, Some(2)).reported];
    assert_eq!(
        judged(&scene, &late),
        (Verdict::Misnamed, Some(1.4), Some(false))
    );
    late.fault_events.clear();
    assert_eq!(judged(&scene, &late).0, Verdict::Misnamed);
}

/// If this fails, a sufficient correction does not count, and a machine has to stop for an error that it corrects. Or an insufficient
/// correction counts, and a machine may stay beyond its limit without end.
#[test]
fn a_correction_counts_only_if_sufficient() {
    let corrected = responded(Response::Correction, 9.5);
    let (scene, mut observation) = slipped(&[corrected]);
    assert_eq!(judged(&scene, &observation).0, Verdict::Missed);
    observation.is_beyond_limit = false;
    observation.stay_turns = 0.7;
    assert_eq!(
        judged(&scene, &observation),
        (Verdict::Right, Some(-0.5), Some(true))
    );
    // The crank moves on, and is stopped later. It counts as detected beyond its limit from the stop.
    let stopped = responded(Response::Stop, 12.0);
    observation.stopped = Some(stopped);
    assert_eq!(judged(&scene, &observation).1, Some(2.0));
    // The machine is stopped although the cranks are within their limits again.
    observation.stopped = Some(Responded {
        is_beyond_limit: false,
        ..stopped
    });
    assert_eq!(judged(&scene, &observation).1, Some(-0.5));
    // The cranks were beyond their limits for too long.
    observation.stay_turns = 1.7;
    assert_eq!(judged(&scene, &observation).1, Some(2.0));
}

/// If this fails, a short stay beyond the limit counts as late, and a loop has to detect a crank that comes back before its index shows
/// it. Or a stay counts as in time whatever its length, and a crank that stays beyond its limit for turns passes.
#[test]
fn a_crank_that_does_not_stay_beyond_its_limit_need_not_be_detected() {
    let (scene, mut observation) = slipped(&[responded(Response::Correction, 9.5)]);
    assert_eq!(judged(&scene, &observation).2, Some(false));
    observation.stay_turns = 1.05;
    assert_eq!(judged(&scene, &observation), (Verdict::Right, None, None));
    observation.fault_events.clear();
    assert_eq!(judged(&scene, &observation).0, Verdict::Moot);
    observation.stay_turns = 1.15;
    assert_eq!(judged(&scene, &observation).0, Verdict::Missed);
}

/// If this fails, only reports count, and a controller that stops without a report causes no false trip.
#[test]
fn a_stop_before_the_fault_is_a_false_trip() {
    let (scene, mut observation) = slipped(&[responded(Response::Stop, 10.6)]);
    observation.stopped_early = true;
    assert_eq!(judged(&scene, &observation).0, Verdict::FalseTrip);
}

/// If this fails, a late detection counts as not decidable although sensors showed the fault, or as late although none did.
#[test]
fn a_late_detection_is_not_decidable_if_no_index_showed_the_crank_beyond_its_limit() {
    let late = responded(Response::Stop, 11.4);
    let hidden = Responded {
        is_hidden: true,
        ..late
    };
    let (scene, mut observation) = slipped(&[late]);
    assert_eq!(judged(&scene, &observation).2, Some(false));
    // What counts is the time of the detection, and not the end of the run.
    observation.is_hidden = true;
    assert_eq!(judged(&scene, &observation).2, Some(false));
    let (scene, observation) = slipped(&[hidden]);
    assert_eq!(
        judged(&scene, &observation),
        (Verdict::NotDecidable, Some(1.4), None)
    );
    let (scene, in_time) = slipped(&[Responded {
        stay_turns: 0.6,
        ..hidden
    }]);
    assert_eq!(
        judged(&scene, &in_time),
        (Verdict::Right, Some(1.4), Some(true))
    );
    let (scene, mut missed) = slipped(&[]);
    missed.is_hidden = true;
    assert_eq!(judged(&scene, &missed), (Verdict::NotDecidable, None, None));
}

/// If this fails, a crank that an index alone shows within its limits counts as late: one that gains a whole turn, or one that turns back. Or
/// any crank that runs away or turns back counts as not decidable.
#[test]
fn whole_turns_and_turning_back_are_not_decidable_by_an_index_alone() {
    let judged = |change: &dyn Fn(&mut Scene)| {
        // A crank gains a turn and 4 degrees in a sixth of a turn.
        let mut case = Plan::new(332_297_142, None).unwrap().case(4257);
        change(&mut case.scene);
        let row = run(&case, false).unwrap();
        (row.verdict, row.in_time)
    };
    assert_eq!(judged(&|_| ()), (Verdict::NotDecidable, None));
    let for_good = |scene: &mut Scene| scene.fault[0].for_s = None;
    assert_eq!(judged(&for_good), (Verdict::Right, Some(true)));

    let turns_back = |scene: &mut Scene, index_deg: f64| {
        for own in &mut scene.axis {
            own.index_deg = Some(index_deg);
            own.start_deg = 0.0;
            own.reversed = own.number == 3;
        }
        scene.correction.prove_wiring = true;
        scene.fault = vec![FaultAt {
            axis: Some(2),
            with: Some(3),
            lines: Some(Lines::Drive),
            ..FaultAt::new(0.0, FaultName::SwappedWiring)
        }];
    };
    // The middle of each flag, which is 6 degrees long, is at a dead centre.
    let at_dead_centre = judged(&|scene| turns_back(scene, -3.0));
    assert_eq!(at_dead_centre, (Verdict::NotDecidable, None));
    let elsewhere = judged(&|scene| turns_back(scene, 40.0));
    assert_eq!(elsewhere, (Verdict::Right, Some(true)));
}
