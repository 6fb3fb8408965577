//! Phase differences of cranks at a steady speed: servos with cross-coupling and steppers with index correction, each with noise and
//! uneven load.
//!
//! The default is a short time. This runs ten minutes of each, as in docs/faults.md:
//!
//!     COPHASE_STEADY_S=600 cargo test --release -p cophase-tests spread -- --nocapture

use cophase_core::supervisor::State;
use cophase_tests::{SceneBuilder, bench_scene};
use host_sim::sim::{Moment, Observer, simulate};

/// Returns the scene of both machines. It has four cranks at 60 rev/s with different bearings, and two of them turn the other way.
fn machine(axes: &str, noise: &str) -> SceneBuilder {
    bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { crank_radius_mm = 5, load_kg = 6, platform = "above", mount_radius_mm = 200 }
limits = { speed_hz = 62, jerk_hz_per_s2 = 400 }
axes = { count = 4, rotor_inertia_kgm2 = 1e-3, friction_nm = 0.2 }
axis = [
  { number = 1, reversed = true, friction_nm = 0.4, start_deg = 1.5 },
  { number = 3, reversed = true, friction_nm = 0.1, start_deg = -1 },
]
noise = { seed = 7, index_deg = 0.05, index_us = 1, load_nm = 0.1 }
correction = { gain = 0.25 }
"#,
        )
        .program([(90.6, 3.0, steady_s())])
        .with(axes)
        .with(noise)
}

fn steady_s() -> f64 {
    let requested = std::env::var("COPHASE_STEADY_S").ok();
    requested.map_or(10.0, |requested| requested.parse().expect("seconds"))
}

/// Phase differences of cranks at a steady speed, degrees.
#[derive(Default)]
struct Steady {
    worst_deg: f64,
    squares: f64,
    ticks: u32,
}

impl Steady {
    fn rms_deg(&self) -> f64 {
        (self.squares / f64::from(self.ticks)).sqrt()
    }
}

impl Observer for Steady {
    fn tick(&mut self, moment: &Moment<'_>) {
        // The measurement starts when the ramp is over.
        if moment.telemetry.state != State::Run || moment.telemetry.program_ticks < 6_500 {
            return;
        }
        let off = |i: usize| (moment.actual_turns[i] - moment.aim_turns[i]) * 360.0;
        let offs = [off(0), off(1), off(2), off(3)];
        let max = offs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let spread = max - offs.iter().copied().fold(f64::INFINITY, f64::min);
        self.worst_deg = self.worst_deg.max(spread);
        self.squares += spread * spread;
        self.ticks += 1;
    }
}

fn run(machine: &SceneBuilder) -> Steady {
    let mut steady = Steady::default();
    let outcome = simulate(&machine.checked(), &mut steady, |_, _| {}).unwrap();
    assert_eq!((outcome.fault, outcome.diverged.as_deref()), (None, None));
    let top_hz = outcome.record.figures.speed_top_hz;
    assert!((top_hz - 60.0).abs() < 0.1, "{top_hz} rev/s");
    assert!(f64::from(steady.ticks) > 0.9 * 2000.0 * steady_s());
    steady
}

/// If this fails, the coupling is too weak, or adds the noise of the index, and the cranks are further apart than documented.
#[test]
fn servos_stay_together_within_a_twentieth_of_a_degree() {
    let servos = r#"
axes = { drive = "servo", encoder = true, steps_per_turn = 32768, servo = { position_gain_per_s = 120, velocity_gain_nms = 1.0 } }
fault = [{ at_s = 8, kind = "load-step", axis = 2, torque_nm = 1, for_s = 2 }]
"#;
    let servos = machine(servos, "noise.encoder_counts = 1");
    let alone = run(&servos.clone().set("correction.couple", false));
    let steady = run(&servos.set("correction.couple", true));
    println!(
        "servos, {} s at 60 rev/s: {:.3}° at most, {:.4}° rms; uncoupled {:.3}°, {:.4}°",
        steady_s(),
        steady.worst_deg,
        steady.rms_deg(),
        alone.worst_deg,
        alone.rms_deg()
    );
    assert!(steady.rms_deg() <= 0.05);
    // The coupling reduces the effect of the load while it comes and goes. Index correction removes a lasting error in both runs.
    assert!(steady.worst_deg < 0.5 * alone.worst_deg);
}

/// If this fails, the correction is unsteady, or homing leaves errors that it should correct. Steppers are then further apart than a
/// microstep.
#[test]
fn steppers_stay_together_within_a_microstep() {
    let steppers = "axes = { damping_nms = 0.3, pull_out = [[0, 30.0], [62, 22.0]] }";
    let steady = run(&machine(steppers, ""));
    println!(
        "steppers, {} s at 60 rev/s: {:.3}° at most, {:.4}° rms; a microstep is 0.1125°",
        steady_s(),
        steady.worst_deg,
        steady.rms_deg()
    );
    assert!(steady.rms_deg() <= 360.0 / 3200.0);
}
