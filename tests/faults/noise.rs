//! `[noise]` has the size that the scene gives, and is the same for the same seed.

use cophase_files::trace::{Every, Window};
use cophase_tests::record;

use super::samples::readings;
use super::{Checked, kinematic, observe, phased};

/// A hold of 40 turns. No noise of these sizes trips a limit in it.
fn long(noise: &str) -> Checked {
    // The flags are not where cranks stand at power-up. With noise, some cranks there would pass a flag and others would not.
    kinematic()
        .program([(2.5, 0.1, 8.0)])
        .set("axes.index_deg", 40)
        .with(&format!("[noise]\n{noise}\n"))
        .checked()
}

/// Mean and deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (mean, square.sqrt())
}

/// Asserts that values have that deviation about 0. With n draws, a mean is off by σ/√n and a deviation by σ/√2n. Four of those
/// are exceeded once in 10,000 seeds.
#[track_caller]
fn assert_normal(values: &[f64], sigma: f64) {
    let n = values.len() as f64;
    let (mean, found) = spread(values);
    assert!(mean.abs() < 4.0 * sigma / n.sqrt(), "mean {mean}");
    let off = (found / sigma - 1.0).abs();
    assert!(off < 4.0 / (2.0 * n).sqrt(), "{found}, not {sigma}");
}

/// If this fails, a run with noise cannot be repeated, or another seed gives the same noise.
#[test]
fn seed_decides_the_noise() {
    let noise = "index_deg = 0.05\nindex_us = 2\nencoder_counts = 1.5\nload_nm = 0.5";
    let noisy = phased().with(&format!("[noise]\n{noise}\n"));
    let seeded = |seed| noisy.clone().set("noise.seed", seed).checked();
    let run = |seed: i64| record(&seeded(seed), Every::Ticks(1), Window::All);
    let (one, again, other) = (run(5), run(5), run(6));
    assert!(one.csv == again.csv && one.vcd == again.vcd);
    assert_eq!(one.lasting_report(false), again.lasting_report(false));
    assert!(one.csv != other.csv && one.vcd != other.vcd);
}

/// If this fails, the noise of index edges is larger or smaller than the scene gives, in place or in time.
#[test]
fn index_edges_are_off_by_the_requested_noise() {
    let plain = observe(&long(""));
    for (seed, noise, sigma_us) in [
        // Speed is 7 rev/s, or whatever it truly is in the hold. There, an edge that is off by a place is off by a time.
        (1, "index_deg = 0.3", None),
        (2, "index_us = 20", Some(20.0)),
    ] {
        let noisy = observe(&long(&format!("seed = {seed}\n{noise}")));
        let mut off = Vec::new();
        for axis in 0..3 {
            let (plain, noisy) = (plain.rises_us(axis), noisy.rises_us(axis));
            assert_eq!(plain.len(), noisy.len(), "no pulse is lost or doubled");
            // In the hold, a turn always takes the same time.
            let turns = 10..plain.len() - 6;
            off.extend(turns.clone().map(|turn| noisy[turn] - plain[turn]));
        }
        let turn_us = {
            let rises = plain.rises_us(0);
            rises[31] - rises[30]
        };
        assert!(off.len() > 100);
        assert_normal(&off, sigma_us.unwrap_or(0.3 / 360.0 * turn_us));
    }
}

/// If this fails, encoders are all off alike, or one sensor's noise changes with another's.
#[test]
fn encoders_are_off_by_the_requested_noise() {
    let checked = long("seed = 3\nencoder_counts = 30");
    let said = readings(&checked, 0..4000);
    let of = |axis: usize| -> Vec<f64> {
        said.iter()
            .map(|feedback| f64::from(feedback.encoder[axis]))
            .collect()
    };
    for axis in 0..3 {
        assert_normal(&of(axis), 30.0);
    }
    let product: Vec<f64> = of(0).iter().zip(of(1)).map(|(a, b)| a * b).collect();
    // For two independent sensors the mean product is off 0 by σ²/√n.
    assert!(spread(&product).0.abs() < 4.0 * 900.0 / 4000.0_f64.sqrt());
    let both = long("seed = 3\nencoder_counts = 30\nindex_us = 5");
    for (one, other) in said.iter().zip(readings(&both, 0..4000)) {
        assert_eq!(one.encoder, other.encoder);
    }
}

/// If this fails, a load that changes every tick shakes no crank, or shakes all cranks alike.
#[test]
fn load_noise_acts_on_each_crank_independently() {
    let plain = observe(&phased().checked());
    let noisy = observe(&phased().set("noise.load_nm", 2).checked());
    let off = |axis: usize| -> Vec<f64> {
        let ticks = 400..1200;
        let off = |tick| noisy.ahead(axis, tick) - plain.ahead(axis, tick);
        ticks.map(off).collect()
    };
    let (_, deviation) = spread(&off(0));
    // A spring of 1000 N·m/rad under 2 N·m at rest is off by 2 mrad. Inertia takes most of a load that changes every tick. The
    // load excites the crank near its own frequency instead.
    let still = 2.0 / 1000.0 / std::f64::consts::TAU;
    assert!(
        (0.05 * still..5.0 * still).contains(&deviation),
        "{deviation}"
    );
    assert!(off(0) != off(1));
}
