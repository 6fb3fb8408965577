//! Tests that ticks of a preview equal those of native runs, bit for bit.
//!
//! On the same model level, every tick is equal. On the scene's own model level, which `cophase run` takes, homing and parking last a
//! little longer or shorter, because cranks that torque moves have small phase errors. The program begins at the speed that homing has
//! reached. Once the shaft has caught up, its ticks are equal, up to the first fault that the run latches by itself. Faults, noise and
//! late deadlines of scenes are left out on both sides.

mod support;

use std::f64::consts::TAU;

use cophase_core::mechanism::Mechanism;
use cophase_core::supervisor::State;
use cophase_core::units::{ONE_TURN, Turns};
use cophase_random_scenes::{Kinds, draw};
use cophase_scene::file::Noise;
use cophase_scene::{library, load};
use host_sim::checked::Checked;
use host_sim::model_level;
use host_sim::setup;
use host_sim::sim::{Moment, Observer, simulate};

/// The channel of the state.
const STATE_CHANNEL: usize = cophase_scope_wasm::CHANNELS - 1;

/// Time in which the shaft catches up with a program, s. The scene `screen` ramps up as fast as its limits allow.
const CATCHES_UP_S: f64 = 2.0;

/// Seeds of random scenes.
const SEEDS: std::ops::Range<u64> = 0..40;

/// Ticks of a run, each with amax requested and commanded, speed, and state.
struct Ticks {
    ticks: Vec<[f64; 4]>,
    has_fault: bool,
    mechanism: cophase_core::mechanism::AnyMechanism,
    tick_hz: f64,
}

impl Observer for Ticks {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        self.has_fault |= telemetry.fault.is_some();
        let speed: Turns = telemetry.motion.speed;
        let hz = speed.to_bits() as f64 / ONE_TURN as f64 * self.tick_hz;
        self.ticks.push([
            telemetry.amax_requested.to_num(),
            self.mechanism.amax(speed).to_num(),
            hz * TAU,
            f64::from(telemetry.state as u8),
        ]);
    }
}

/// Runs a scene on one of its model levels.
fn run(checked: &Checked) -> Ticks {
    let mut ticks = Ticks {
        ticks: Vec::new(),
        has_fault: false,
        mechanism: checked.settings.mechanism(),
        tick_hz: checked.settings.tick_hz.into(),
    };
    simulate(checked, &mut ticks, |_, _| {}).expect("the scene runs");
    ticks
}

/// Returns a scene with an undisturbed machine.
fn quiet(text: &str) -> Checked {
    let mut scene = load::parse(text).expect("the scene is well-formed");
    scene.fault.clear();
    scene.late.clear();
    scene.noise = Noise::default();
    Checked::new(scene).expect("the scene is accepted")
}

/// Returns the same scene on the lowest model level that it has.
fn lowest(checked: &Checked) -> Checked {
    let level = model_level::available(checked)[0];
    checked.on(level).expect("an available model level")
}

/// Returns the ticks of a preview.
fn ticks_of(name: &str, previewed: &support::Previewed) -> Vec<[f64; 4]> {
    assert_eq!(
        previewed.answer["mistakes"],
        serde_json::json!([]),
        "{name}"
    );
    let one = |row: &[f64], channel: usize| {
        let [low, high] = [row[2 + 2 * channel], row[3 + 2 * channel]];
        assert_eq!(low.to_bits(), high.to_bits(), "{name}: one tick in a row");
        low
    };
    let rows = previewed.rows.iter();
    rows.map(|row| {
        [
            one(row, 0),
            one(row, 1),
            one(row, 2),
            one(row, STATE_CHANNEL),
        ]
    })
    .collect()
}

/// Asserts that ticks are equal bit for bit.
fn assert_equal(name: &str, there: &[[f64; 4]], here: &[[f64; 4]]) {
    let bits = |tick: &[f64; 4]| tick.map(f64::to_bits);
    let different = there.iter().zip(here).position(|(a, b)| bits(a) != bits(b));
    if let Some(tick) = different {
        let (there, here) = (there[tick], here[tick]);
        panic!("{name}: tick {tick}: {there:?} in the browser, {here:?} here");
    }
    assert_eq!(there.len(), here.len(), "{name}: ticks");
}

/// Returns the ticks in which the program is played.
fn program(ticks: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let run = f64::from(State::Run as u8);
    ticks
        .iter()
        .filter(|tick| tick[3] == run)
        .copied()
        .collect()
}

#[test]
fn built_in_scenes_have_the_ticks_of_native_runs() {
    let texts: Vec<&str> = library::SCENES.iter().map(|scene| scene.text).collect();
    let Some(previews) = support::preview(&texts) else {
        return;
    };
    for (built_in, previewed) in library::SCENES.iter().zip(&previews) {
        let name = built_in.name;
        let there = ticks_of(name, previewed);
        let checked = quiet(built_in.text);
        assert_equal(name, &there, &run(&lowest(&checked)).ticks);

        let own = run(&checked);
        let (mut there, here) = (program(&there), program(&own.ticks));
        assert!(here.len() > 1000, "{name} runs");
        // One motor of this scene is too weak for its bearing.
        assert_eq!(own.has_fault, name == "lost-steps", "{name}");
        if own.has_fault {
            there.truncate(here.len());
        }
        let caught_up = there.iter().zip(&here).position(|(a, b)| a == b);
        let caught_up = caught_up.expect("some ticks are equal");
        let max = CATCHES_UP_S * f64::from(checked.settings.tick_hz);
        assert!(caught_up as f64 <= max, "{name}: after {caught_up} ticks");
        assert_equal(name, &there[caught_up..], &here[caught_up..]);
    }
}

#[test]
fn random_scenes_have_the_ticks_of_native_runs() {
    let drawn: Vec<_> = SEEDS
        .map(|seed| draw(seed, Kinds::ALL))
        // A text without a folder has no tables in files.
        .filter(|drawn| drawn.table.is_none())
        .filter(|drawn| setup::checked_from_text(&drawn.text, None).is_ok())
        .collect();
    assert!(drawn.len() > 20, "most random scenes are accepted");
    let texts: Vec<&str> = drawn.iter().map(|drawn| drawn.text.as_str()).collect();
    let Some(previews) = support::preview(&texts) else {
        return;
    };
    for (drawn, previewed) in drawn.iter().zip(&previews) {
        let native = run(&lowest(&quiet(&drawn.text)));
        assert_equal(
            &drawn.text,
            &ticks_of(&drawn.text, previewed),
            &native.ticks,
        );
    }
}
