//! Stall: rock that needs more torque than the motor has stops the shaft. The controller stops the machine, and the report states the
//! lack of torque beforehand.

use cophase_lab::chart::breakdown::runs;
use cophase_lab::chart::breakdown::stall::{BROKEN_KN, HOLDING_KN, measure, scene, stands_s};

/// If this fails, the picture shows a stall where there is none, or the controller drives a blocked shaft.
#[test]
fn rock_that_is_too_hard_stops_the_shaft_and_the_machine() {
    let broken = measure(BROKEN_KN).unwrap();
    assert_eq!(broken.stopped_s, None);
    let holding = measure(HOLDING_KN).unwrap();
    let stopped_s = holding.stopped_s.expect("the controller stops");
    let stood_s = stands_s(&holding.actual).expect("the rock holds the shaft");
    assert!(stopped_s < stood_s, "{stopped_s} s, {stood_s} s");
    // The stop also slows the shaft, without any rock. Here the rock is the cause: the commanded speed is still high when the shaft
    // stands.
    let commanded = holding.commanded.iter().find(|(t_s, _)| *t_s >= stood_s);
    assert!(commanded.unwrap().1 > 10.0);
}

/// If this fails, the panel does not use the built-in scene, in which the crusher breaks the rock.
#[test]
fn the_force_is_that_of_the_scene() {
    let text = scene(BROKEN_KN).unwrap();
    assert_eq!(
        text,
        scene(HOLDING_KN)
            .unwrap()
            .replacen("rock_kn = 4000", "rock_kn = 1310", 1)
    );
    assert!(text.contains("rock_kn = 1310") && runs::refusal(&text).is_none());
}
