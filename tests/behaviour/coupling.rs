//! Cross-coupled servos: the machine itself is compared with the properties of the gains that are derived from a scene.
//!
//! The machine has three servos on the phased model level, and each crank has its own rotor. The loop, its encoders and delays are
//! the real ones.

use cophase_core::settings::CorrectionSettings;
use cophase_tests::bench_scene;
use host_sim::checked::Checked;
use host_sim::drives::coupling::{APART, Gains};
use host_sim::setup::servos;
use host_sim::sim::{Moment, Observer, simulate};

const TICK_HZ: f64 = 2000.0;

const COUPLED: &str = "correction.couple = true";

/// A machine at 20 rev/s. The load on crank 1 is raised by a step, or for a moment.
fn machine(correction: &str, load: &str) -> Checked {
    bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { crank_radius_mm = 5, load_kg = 6, platform = "above", mount_radius_mm = 200 }
limits = { speed_hz = 30, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600 }
drift = { tilt_limit_mrad = 20 }
[axes]
drive = "servo"
encoder = true
steps_per_turn = 65536
rotor_inertia_kgm2 = 1e-3
servo = { position_gain_per_s = 120, velocity_gain_nms = 1.0 }
"#,
        )
        .program([(10.0, 0.5, 2.0)])
        .with(correction)
        .with(&format!(
            "fault = [{{ at_s = 2.2, kind = \"load-step\", axis = 1, {load} }}]"
        ))
        .checked()
}

/// Errors of the cranks, degrees, tick by tick from the tick of the load step.
struct Errors(Vec<[f64; 3]>);

impl Observer for Errors {
    fn tick(&mut self, moment: &Moment<'_>) {
        if moment.start_ns >= 2_200_000_000 && self.0.len() < 2000 {
            let error = |i: usize| (moment.actual_turns[i] - moment.command_turns[i]) * 360.0;
            self.0.push(std::array::from_fn(error));
        }
    }
}

fn errors(checked: &Checked) -> Vec<[f64; 3]> {
    let mut errors = Errors(Vec::new());
    let outcome = simulate(checked, &mut errors, |_, _| {}).unwrap();
    assert_eq!(outcome.diverged, None);
    errors.0
}

fn spread(error: &[f64; 3]) -> f64 {
    let max = error.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    max - error.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The gains that the scene derives, and the gains that the core receives.
fn derived() -> (Gains, CorrectionSettings) {
    let checked = machine(COUPLED, "torque_nm = 1");
    let gains = servos(&checked.scene, &*checked.machine)
        .unwrap()
        .gains()
        .unwrap();
    (gains, checked.settings.correction)
}

/// If this fails, the derivation is wrong, or the loop is slower than it states. The coupling then swings at other gains than its
/// margin shows.
#[test]
fn coupling_oscillates_beyond_its_gain_margin() {
    let (gains, reported) = derived();
    assert_eq!(
        (reported.coupling, reported.coupling_per_s),
        (gains.proportional, gains.per_s)
    );
    assert!(gains.gain_margin >= 1.0 / (1.0 - APART), "{gains:?}");
    let swings = |times: f64| {
        let correction = format!(
            "correction = {{ coupling = {}, coupling_per_s = {} }}",
            gains.proportional * times,
            gains.per_s * times
        );
        let errors = errors(&machine(&correction, "torque_nm = 1, for_s = 0.02"));
        // An oscillation that has decayed is below a hundredth of a degree. A machine that swings so far that it is stopped has no
        // such moments.
        let late = errors.get(1500..).filter(|late| !late.is_empty());
        late.is_none_or(|late| late.iter().any(|error| spread(error) > 0.1))
    };
    let (mut inside, mut outside) = (1.0, 1.5 * gains.gain_margin);
    assert!(!swings(inside), "at its own gains");
    assert!(swings(outside), "far beyond its margin");
    while outside - inside > 0.02 * inside {
        let times = f64::midpoint(inside, outside);
        if swings(times) {
            outside = times;
        } else {
            inside = times;
        }
    }
    println!(
        "margin {:.2}, swings at {inside:.2} times its gains; {gains:?}",
        gains.gain_margin
    );
    // The derivation assumes the worst inertia. No crank has that inertia all around the turn.
    let part = inside / gains.gain_margin;
    assert!((0.9..1.4).contains(&part), "{part} of the margin");
}

/// If this fails, the other cranks do not wait. A crank that is held up is then left behind until its own drive has brought it
/// back, and under a lasting load it stays behind.
#[test]
fn coupled_axes_wait_for_a_delayed_axis() {
    let alone = errors(&machine("", "torque_nm = 3"));
    let coupled = errors(&machine(COUPLED, "torque_nm = 3"));
    let worst = |errors: &[[f64; 3]]| errors.iter().map(spread).fold(0.0, f64::max);
    // A turn takes 100 ticks.
    let (lasting, held) = (worst(&alone[1500..2000]), worst(&coupled[1500..2000]));
    println!("3 N·m on one: lasting spread {lasting:.3}° alone, {held:.4}° coupled");
    // 3 N·m over 120 N·m/rad.
    let stiffness_deg = (3.0_f64 / 120.0).to_degrees();
    assert!((lasting / stiffness_deg - 1.0).abs() < 0.3, "{lasting}");
    assert!(held < 0.05 * lasting, "{held} of {lasting}");
    let others = |errors: &[[f64; 3]], tick: usize| f64::midpoint(errors[tick][0], errors[tick][2]);
    // While the drive brings that crank back, the others are behind their uncoupled phase.
    let tick = (0.03 * TICK_HZ) as usize;
    let waited = others(&coupled, tick) - others(&alone, tick);
    assert!(waited < -0.1 * stiffness_deg, "{waited}");
}
