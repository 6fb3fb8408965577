//! How fast the loop is, as ratios to real time.
//!
//! - `core`: ticks a second of the core alone, running a program at full speed on `N` stepper axes.
//! - `run`: simulated seconds to one on the wall, of the default scene with nobody looking on.
//!
//! divan prints the distribution of each; after that the ratios are measured once more, best of five, and
//! that of `run` is asserted: 1,000 at least. (The best of five is the least disturbed one; on a shared
//! machine the mean says more about its other users.)

use std::hint::black_box;
use std::time::Instant;

use cophase_core::controller::Controller;
use cophase_core::signals::Feedback;
use cophase_core::supervisor::Command;
use divan::Bencher;
use divan::counter::ItemsCount;
use host_sim::scene::file::Scene;
use host_sim::scene::{Checked, library};
use host_sim::sim::simulate;

const LEAST_RATIO: f64 = 1000.0;

/// Ticks in a sample: ten simulated seconds.
const TICKS: u32 = 20_000;

fn main() {
    divan::main();
    if std::env::args().any(|argument| argument == "--test" || argument == "--list") {
        return;
    }
    println!();
    println!("ratio to real time, 2 kHz ticks, best of five");
    println!("  core, 2 axes      {:7.0}", best(ratio_of_core::<2>));
    println!("  core, 4 axes      {:7.0}", best(ratio_of_core::<4>));
    println!("  core, 6 axes      {:7.0}", best(ratio_of_core::<6>));
    let run = best(ratio_of_run);
    println!("  run, default scene{run:7.0}");
    assert!(
        run >= LEAST_RATIO,
        "run is {run:.0} times real time; {LEAST_RATIO} are promised"
    );
}

#[divan::bench(consts = [2, 4, 6])]
fn core<const N: usize>(bencher: Bencher<'_, '_>) {
    bencher
        .counter(ItemsCount::new(TICKS))
        .with_inputs(running::<N>)
        .bench_local_values(|mut controller| play(&mut controller));
}

#[divan::bench]
fn run(bencher: Bencher<'_, '_>) {
    let checked = Checked::new(default_scene(4)).unwrap();
    bencher.bench_local(|| simulate::<4>(&checked, &mut (), |_, _| {}).unwrap());
}

fn default_scene(axes: usize) -> Scene {
    let mut scene = library::SCENES[0].scene();
    scene.axes.count = axes;
    scene.axis.retain(|apart| apart.number < axes);
    scene
}

/// A controller that is up to speed, in the middle of the program.
fn running<const N: usize>() -> Controller<N> {
    let mut scene = default_scene(N);
    scene.axes.index = false; // nobody plays the sensors here
    let mut controller = Checked::new(scene).unwrap().controller().unwrap();
    controller.tick(&Feedback::of(Some(Command::Start)));
    for _ in 0..10 * TICKS / 10 {
        controller.tick(&Feedback::of(None));
    }
    controller
}

fn play<const N: usize>(controller: &mut Controller<N>) {
    for _ in 0..TICKS {
        black_box(controller.tick(&Feedback::of(None)));
    }
}

fn ratio_of_core<const N: usize>() -> f64 {
    let mut controller = running::<N>();
    let began = Instant::now();
    play(&mut controller);
    f64::from(TICKS) / f64::from(controller.tick_hz()) / began.elapsed().as_secs_f64()
}

fn ratio_of_run() -> f64 {
    let checked = Checked::new(default_scene(4)).unwrap();
    let began = Instant::now();
    let outcome = simulate::<4>(&checked, &mut (), |_, _| {}).unwrap();
    outcome.simulated_s() / began.elapsed().as_secs_f64()
}

fn best(ratio: impl Fn() -> f64) -> f64 {
    (0..5).map(|_| ratio()).fold(0.0, f64::max)
}
