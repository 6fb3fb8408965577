//! The loop on a machine whose frame moves. It is compared with the model level below, and with the vibration theory of two masses.

use std::f64::consts::TAU;

use cophase_core::supervisor::State;
use cophase_files::report::summary;
use cophase_files::trace::{Every, Window};
use cophase_tests::{SceneBuilder, bench_scene, record};
use host_sim::sim::{Moment, Observer, simulate};
use num_complex::Complex;

/// A light platform on three heavy rotors. The platform's torque hardly changes their speed. The frame has 20 kg, the foundation 100
/// kg.
fn on_frame(amax_g: f64, hold_s: f64) -> SceneBuilder {
    bench_scene()
        .with(
            r#"
fidelity = "elastic"
machine = { crank_radius_mm = 5, load_kg = 1, mount_radius_mm = 200 }
limits = { speed_hz = 40, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600, homing_speed_hz = 5 }
[frame]
mass_kg = 20
suspension_n_per_mm = 120
suspension_zeta = 0.05
foundation = { mass_kg = 100, ground_n_per_mm = 20_000, ground_zeta = 0.1 }
[axes]
drive = "servo"
steps_per_turn = 8192
rotor_inertia_kgm2 = 0.1
servo = { position_gain_per_s = 50, velocity_gain_nms = 10 }
"#,
        )
        .program([(amax_g, 0.5, hold_s)])
}

/// Acceleration, g, at which a crank of 5 mm with λ = 0.25 turns at `speed_hz` rev/s.
fn amax_g(speed_hz: f64) -> f64 {
    0.005 * (TAU * speed_hz).powi(2) * 1.25 / 9.80665
}

/// Motion of the frame at constant speed: turns of crank 0, heave in m, force on the ground in N.
#[derive(Default)]
struct Recorded(Vec<(f64, f64, f64)>);

impl Observer for Recorded {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        if telemetry.state == State::Run && telemetry.motion.acceleration == 0 {
            let frame = moment.machine.frame().expect("its frame moves");
            let turns = moment.actual_turns[0];
            self.0.push((turns, frame.place[0], frame.ground_n));
        }
    }
}

/// First harmonic, over the crank's turn, of the quantity that `pick` selects in the last 40 turns. Under the Hann window, means and
/// other harmonics contribute at most 1e-5 of their size (its spectrum falls as the cube of 40).
fn first_harmonic(recorded: &Recorded, pick: impl Fn(&(f64, f64, f64)) -> f64) -> f64 {
    let end = recorded.0.last().expect("it has turned evenly").0;
    let (mut sum, mut weights) = (Complex::new(0.0, 0.0), 0.0);
    for moment in recorded.0.iter().filter(|moment| moment.0 > end - 40.0) {
        let weight = 1.0 - (TAU * (end - moment.0) / 40.0).cos();
        sum += Complex::from_polar(weight * pick(moment), -TAU * moment.0);
        weights += weight;
    }
    2.0 * (sum / weights).norm()
}

/// If this fails, a frame resonates at another frequency or amplitude than theory gives, and the force on the ground is wrong.
///
/// The platform moves against the frame with R cos ωt, and harmonics from the second on. For the frame this is the force m R ω² on
/// frame and platform together. They stand on the suspension (k₁, c₁), on the block, on the ground (k₂, c₂). The platform's torque
/// makes the cranks turn unevenly, by m R² / 2NJ = 4e-5 of their speed. The force's amplitude changes with the speed, and the frame's
/// amplitude at resonance by up to 1/2ζ = 10 times twice that: 1e-3.
#[test]
fn frame_response_matches_the_two_mass_theory() {
    let (m, frame, block) = (1.0, 20.0, 100.0);
    let (k1, k2) = (120e3, 20e6);
    let c1 = 2.0 * 0.05 * f64::sqrt(k1 * (m + frame));
    let c2 = 2.0 * 0.1 * f64::sqrt(k2 * (m + frame + block));
    // √(k₁ / (m + frame)) is 12.0 Hz.
    for speed_hz in [8.0, 12.0, 20.0] {
        let checked = on_frame(amax_g(speed_hz), 5.0).checked();
        let mut recorded = Recorded::default();
        let outcome = simulate(&checked, &mut recorded, |_, _| {}).expect("it runs");
        let said = summary(&checked, &outcome, None, 1.0);
        assert!(
            said.contains("The frame went at most") && said.contains("Greatest motor torque"),
            "{said}"
        );
        let omega = TAU * speed_hz;
        let spring = |k: f64, c: f64| Complex::new(k, omega * c);
        let (s1, s2) = (spring(k1, c1), spring(k2, c2));
        let upper = s1 - omega * omega * (m + frame);
        let lower = s1 + s2 - omega * omega * block;
        let force = Complex::new(m * 0.005 * omega * omega, 0.0);
        let heave = force / (upper - s1 * s1 / lower);
        let ground = s2 * s1 / lower * heave;
        for (what, found, right) in [
            (
                "heave",
                first_harmonic(&recorded, |moment| moment.1),
                heave.norm(),
            ),
            (
                "ground",
                first_harmonic(&recorded, |moment| moment.2),
                ground.norm(),
            ),
        ] {
            let off = (found / right - 1.0).abs();
            println!("{what} at {speed_hz} rev/s: {found:.6e}, theory {right:.6e}, off {off:.1e}");
            assert!(
                off < 1e-3,
                "{what} at {speed_hz} rev/s: {found}, not {right}"
            );
        }
    }
}

/// If this fails, the elastic level and the phased level below it disagree where their assumptions coincide. A frame of 1000 t on
/// 1e12 N/m moves 1e-9 m under a kilonewton. The effect on cranks and platform is below a trace's last digits, 1e-9 turns and 1 nm.
#[test]
fn rigid_frame_matches_the_phased_level() {
    let elastic = on_frame(amax_g(20.0), 0.2)
        .with("frame = { mass_kg = 1e6, suspension_n_per_mm = 1e9 }")
        .with("frame.foundation = { mass_kg = 1e6, ground_n_per_mm = 1e9 }");
    let phased = elastic.clone().set("fidelity", "phased");
    let [elastic, phased] = [(elastic, true), (phased, false)].map(|(machine, on_frame)| {
        let run = record(&machine.checked(), Every::Ticks(1), Window::FirstMotion);
        assert_eq!(run.report["frame"].is_object(), on_frame);
        assert!(run.report["axes"][0]["torque_worst_nm"].as_f64() > Some(0.0));
        run.trace()
    });
    for (column, max) in [
        ("actual_turns_1", 2e-9),
        ("z_m", 3e-9),
        ("tilt_x_mrad", 2e-5),
    ] {
        let pairs = elastic.column(column).iter().zip(phased.column(column));
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= max, "{column}: {worst}");
    }
}

/// If this fails, rods as springs lower the platform by another length than statics gives, or the platform diverges at speed.
///
/// The rods are short by F / N k. At rest F is the weight. In motion it is up to m (g + amax), plus the share of 30 rev/s, at 0.14 of
/// the rods' mode: 2 %, and as much again for harmonics.
#[test]
fn elastic_rods_deflect_as_statics_predicts() {
    let quasi_static = on_frame(amax_g(30.0), 0.2)
        .set("fidelity", "phased")
        .with("machine = { load_kg = 8, rod_n_per_um = 5, rod_zeta = 0.1 }");
    let elastic = quasi_static.clone().set("machine.rods", "elastic");
    let [quasi_static, elastic] = [quasi_static, elastic]
        .map(|machine| record(&machine.checked(), Every::Ticks(1), Window::FirstMotion).trace());
    let short: Vec<f64> = quasi_static
        .column("z_m")
        .iter()
        .zip(elastic.column("z_m"))
        .map(|(quasi_static, elastic)| quasi_static - elastic)
        .collect();
    let at_rest = 8.0 * 9.80665 / (3.0 * 5e6);
    let last = short.last().expect("a run has rows");
    // A trace has a resolution of nanometres.
    assert!((last - at_rest).abs() < 2e-9, "{last}, not {at_rest}");
    let worst = short
        .iter()
        .fold(0.0, |max: f64, short| max.max(short.abs()));
    let bound = at_rest * (1.0 + amax_g(30.0));
    assert!(worst < 1.04 * bound, "{worst}, not within {bound}");
    assert!(worst > 0.5 * bound, "{worst}: where is the load? {bound}");
}

/// If this fails, a machine stands on a frame that the scene does not describe. Or a method advances it that takes an integral for a
/// speed.
#[test]
fn missing_frame_and_unsuitable_methods_are_refused() {
    let machine = on_frame(5.0, 5.0);
    let said = machine.clone().without("frame").refused();
    assert!(
        said.contains("frame.mass_kg") && said.contains("phased"),
        "{said}"
    );
    let integral = machine.clone().set("axes.servo.integral_s", 0.1);
    integral.checked();
    for name in ["symplectic-euler", "velocity-verlet"] {
        machine.clone().set("method.name", name).checked();
        let said = integral.clone().set("method.name", name).refused();
        assert!(
            said.contains("method.name") && said.contains("integral_s"),
            "{said}"
        );
    }
}

/// If this fails, a method that only damping keeps stable is accepted for a frame without damping. The rotors' drives damp their own
/// mode well, but the frame swings up by metres.
#[test]
fn explicit_euler_is_refused_for_an_undamped_frame() {
    let undamped = on_frame(3.6, 5.0).set("frame.suspension_zeta", 0);
    let euler = "method = { name = \"explicit-euler\", steps_per_tick = 4 }";
    let said = undamped.clone().with(euler).refused();
    assert!(
        said.contains("explicit Euler is unstable at any step with a mode of"),
        "{said}"
    );
    // RK4 damps it a little.
    undamped.checked();
}
