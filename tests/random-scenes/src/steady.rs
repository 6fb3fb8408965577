//! Scenes for measuring what a platform does: cranks in phase on the kinematic level, at several steady speeds.
//!
//! They have every key that can part the motion of the cranks from the figures that a run prints: mechanism and lengths, gears and steps of
//! each axis, limits, forbidden bands, the program. Nothing moves a crank away from the others on purpose.

use std::f64::consts::TAU;

use cophase_scene::file::{
    Drift, Fidelity, Limits, Method, Noise, Questions, Scene, Segment, Shape,
};
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::mechanism::{AnyMechanism, Mechanism};

use crate::basis::Kinds;
use crate::random_scene::RandomScene;
use crate::source::{Source, at_most};
use crate::tables::scene_and_table;
use crate::{axes, machine};

/// Turns of the cranks at a level, at least.
const TURNS: f64 = 6.0;

/// Largest number of ticks at a level. Very slow shafts make fewer turns.
const TICKS: f64 = 60_000.0;

/// Greatest level that a program can ask for, m/s².
const MAX_MPS2: f64 = 10_000.0;

/// Draws a scene with cranks under a platform.
///
/// In some scenes an axis makes other than one turn per turn of the master. Such a scene must be refused.
///
/// # Panics
/// Never: every scene can be written as TOML.
pub fn steady(seed: u64) -> RandomScene {
    let kinds = Kinds {
        disturbed: false,
        has_questions: false,
    };
    let source = &mut Source::new(seed);
    let mut scene = loop {
        let (scene, _) = scene_and_table(source, kinds, seed);
        if scene.machine.is_some() {
            break scene;
        }
    };
    scene.fidelity = Fidelity::Kinematic;
    scene.questions = Questions::default();
    scene.method = Method::default();
    scene.noise = Noise::default();
    // A monitor that stops no machine.
    scene.drift = Drift {
        tilt_limit_mrad: 100.0,
        warp_limit_deg: 90.0,
        common_limit_deg: 180.0,
        ..Drift::default()
    };
    for own in &mut scene.axis {
        own.offset_deg = None;
        own.trim_deg = 0.0;
        own.start_deg = 0.0;
        let (motor, crank) = scene.axes.gear;
        // Motors make fewer steps behind such a gear, which their drives can make as well.
        own.gear = source.maybe(40, |source| {
            (motor, (crank + 1 + source.below(5) as u32).min(1000))
        });
    }
    scene.program = program(source, &scene);
    if source.percent(15) {
        turn_otherwise(source, &mut scene);
    }
    RandomScene {
        text: toml::to_string(&scene).expect("a scene can be written as TOML"),
        table: None,
    }
}

/// Levels that are held for some turns.
fn program(source: &mut Source, scene: &Scene) -> Vec<Segment> {
    let machine = scene.machine.as_ref().expect("cranks under a platform");
    let mechanism = machine::mechanism(machine);
    let ticks_hz = f64::from(scene.control.tick_hz);
    let turns_s = TURNS / scene.limits.speed_hz;
    let count = if turns_s * ticks_hz > 0.1 * TICKS {
        1
    } else {
        2 + source.below(2)
    };
    let levels = (0..count).map(|_| level(source, &mechanism, &scene.limits, TICKS / ticks_hz));
    let levels: Vec<Segment> = levels.collect();
    if !source.percent(10) {
        return levels;
    }
    vec![Segment {
        repeat: Some(1 + source.below(2) as u32),
        segments: Some(levels),
        ..Segment::default()
    }]
}

fn level(
    source: &mut Source,
    mechanism: &AnyMechanism,
    limits: &Limits,
    longest_s: f64,
) -> Segment {
    let part = if source.percent(30) {
        1.0
    } else {
        source.log_between(0.15, 1.0)
    };
    let hz = part * limits.speed_hz;
    let amax_mps2 = mechanism.amax_mps2(hz * TAU).min(MAX_MPS2);
    // The shaft reaches any speed within this time.
    let acceleration = limits.acceleration_hz_per_s;
    let reach_s =
        2.0 * (limits.speed_hz / acceleration + 2.0 * acceleration / limits.jerk_hz_per_s2);
    let ramp_s = source.usual((0.05, 1.0), (1e-3, 2.0));
    Segment {
        amax_g: Some(at_most(amax_mps2 / STANDARD_GRAVITY_MPS2)),
        ramp_s: Some(ramp_s),
        hold_s: Some(reach_s + (TURNS / hz).max(0.2).min(longest_s)),
        shape: source.maybe(40, |source| source.one_of(&[Shape::Smooth, Shape::Linear])),
        ..Segment::default()
    }
}

/// Gives all axes, or one, a ratio other than 1.
fn turn_otherwise(source: &mut Source, scene: &mut Scene) {
    let ratio = loop {
        let (axis, master) = (axes::part(source), axes::part(source));
        if axis != master {
            break (axis, master);
        }
    };
    let own = source.below(scene.axes.count);
    match scene.axis.get_mut(own) {
        Some(own) => own.ratio = Some(ratio),
        None => scene.axes.ratio = ratio,
    }
}
