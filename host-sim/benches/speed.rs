//! How fast the loop is, as ratios to real time.
//!
//! - `core`: ticks a second of the core alone, running a program at full speed on 2, 4 and 6 stepper axes.
//! - `run`: simulated seconds to one on the wall, of the default scene with nobody looking on;
//! - `rung`: the same of four steppers on the rungs where torque moves the cranks, at the method and the steps a tick
//!   that are chosen when the scene leaves them open.
//!
//! divan prints the distribution of each; after that the ratios are measured once more, best of five, and
//! those with a promise are asserted. (The best of five is the least disturbed one; on a shared
//! machine the mean says more about its other users.)

use std::hint::black_box;
use std::time::Instant;

use cophase_core::controller::Controller;
use cophase_core::signals::Feedback;
use cophase_core::supervisor::Command;
use cophase_methods::Scheme;
use divan::Bencher;
use divan::counter::ItemsCount;
use host_sim::scene::file::Scene;
use host_sim::scene::{Checked, library, load};
use host_sim::sim::simulate;

const LEAST_RATIO: f64 = 1000.0;

/// Rungs where torque moves the cranks, and what is promised of each; of the last, nothing is.
const RUNGS: [(&str, f64); 3] = [("rigid", 200.0), ("phased", 20.0), ("elastic", 0.0)];

/// Ticks in a sample: ten simulated seconds.
const TICKS: u32 = 20_000;

fn main() {
    divan::main();
    if std::env::args().any(|argument| argument == "--test" || argument == "--list") {
        return;
    }
    println!();
    println!("ratio to real time, 2 kHz ticks, best of five");
    println!("  core, 2 axes      {:7.0}", best(|| ratio_of_core(2)));
    println!("  core, 4 axes      {:7.0}", best(|| ratio_of_core(4)));
    println!("  core, 6 axes      {:7.0}", best(|| ratio_of_core(6)));
    let run = best(ratio_of_run);
    println!("  run, default scene{run:7.0}");
    assert!(
        run >= LEAST_RATIO,
        "run is {run:.0} times real time; {LEAST_RATIO} are promised"
    );
    for (rung, least) in RUNGS {
        let checked = on_rung(rung);
        let mut method = None;
        let ratio = best(|| {
            let (ratio, by) = ratio_and_method(&checked);
            method = by;
            ratio
        });
        let (scheme, steps) = method.expect("torque moves its cranks");
        println!("  {rung:17} {ratio:7.0}   {scheme}, {steps} steps a tick");
        assert!(
            ratio >= least,
            "{rung} is {ratio:.0} times real time; {least} are promised"
        );
    }
}

#[divan::bench(args = RUNGS.map(|(rung, _)| rung))]
fn rung(bencher: Bencher<'_, '_>, rung: &str) {
    let checked = on_rung(rung);
    bencher.bench_local(|| simulate(&checked, &mut (), |_, _| {}).unwrap());
}

/// Four steppers of NEMA 34 size: 200 full steps, 8 N·m that fall to 2 at 30 rev/s; a platform of 8 kg on a frame of 60.
fn on_rung(rung: &str) -> Checked {
    let text = format!(
        r#"
        name = "rungs"
        fidelity = "{rung}"
        [machine]
        crank_radius_mm = 10
        lambda = 0.25
        load_kg = 8
        mount_radius_mm = 200
        [frame]
        mass_kg = 60
        suspension_n_per_mm = 300
        [frame.foundation]
        mass_kg = 400
        ground_n_per_mm = 50_000
        [limits]
        speed_hz = 25
        acceleration_hz_per_s = 30
        jerk_hz_per_s2 = 300
        [axes]
        count = 4
        drive = "stepper"
        steps_per_turn = 12800
        rotor_inertia_kgm2 = 1e-3
        friction_nm = 0.05
        damping_nms = 0.1
        pull_out = [[0, 8.0], [5, 7.5], [15, 5.0], [30, 2.0]]
        [[program]]
        amax_g = 15
        ramp_s = 2
        hold_s = 3
        "#
    );
    Checked::new(load::parse(&text).unwrap()).unwrap()
}

fn ratio_and_method(checked: &Checked) -> (f64, Option<(Scheme, u32)>) {
    let began = Instant::now();
    let outcome = simulate(checked, &mut (), |_, _| {}).unwrap();
    let ratio = outcome.simulated_s() / began.elapsed().as_secs_f64();
    assert!(outcome.diverged.is_none() && outcome.fault.is_none());
    (ratio, outcome.method)
}

#[divan::bench(args = [2, 4, 6])]
fn core(bencher: Bencher<'_, '_>, axes: usize) {
    bencher
        .counter(ItemsCount::new(TICKS))
        .with_inputs(|| running(axes))
        .bench_local_values(|mut controller| play(&mut controller));
}

#[divan::bench]
fn run(bencher: Bencher<'_, '_>) {
    let checked = Checked::new(default_scene(4)).unwrap();
    bencher.bench_local(|| simulate(&checked, &mut (), |_, _| {}).unwrap());
}

fn default_scene(axes: usize) -> Scene {
    let mut scene = library::SCENES[0].scene();
    scene.axes.count = axes;
    scene.axis.retain(|apart| apart.number < axes);
    scene
}

/// A controller that is up to speed, in the middle of the program.
fn running(axes: usize) -> Controller {
    let mut scene = default_scene(axes);
    scene.axes.index = false; // nobody plays the sensors here
    let mut controller = Checked::new(scene).unwrap().controller().unwrap();
    controller.tick(&Feedback::of(Some(Command::Start)));
    for _ in 0..10 * TICKS / 10 {
        controller.tick(&Feedback::of(None));
    }
    controller
}

fn play(controller: &mut Controller) {
    for _ in 0..TICKS {
        black_box(controller.tick(&Feedback::of(None)));
    }
}

fn ratio_of_core(axes: usize) -> f64 {
    let mut controller = running(axes);
    let began = Instant::now();
    play(&mut controller);
    f64::from(TICKS) / f64::from(controller.tick_hz()) / began.elapsed().as_secs_f64()
}

fn ratio_of_run() -> f64 {
    ratio_and_method(&Checked::new(default_scene(4)).unwrap()).0
}

fn best(mut ratio: impl FnMut() -> f64) -> f64 {
    (0..5).map(|_| ratio()).fold(0.0, f64::max)
}
