//! A crank-rocker with a screw moves its platform by the screw's lead times the rocker's angle. It moves forth faster than back, and as
//! hard as the program requests.

use std::f64::consts::{PI, TAU};

use cophase_files::trace::{Every, Window};
use cophase_tests::{built_in, record};

/// Lengths relative to the rocker's, and the lead of the screw, as in the scene.
const CRANK: f64 = 0.4852094;
const COUPLER: f64 = 1.5402148;
const GROUND: f64 = 1.9279190;
const LEAD_M: f64 = 0.030;

/// Rocker angle, rad, by Freudenstein's equation: the open configuration.
fn rocker_rad(crank_rad: f64) -> f64 {
    let (one, two) = (GROUND / CRANK, GROUND);
    let three = (CRANK * CRANK - COUPLER * COUPLER + 1.0 + GROUND * GROUND) / (2.0 * CRANK);
    let (sin, cos) = crank_rad.sin_cos();
    let a = cos - one - two * cos + three;
    let (b, c) = (-2.0 * sin, one - (two + 1.0) * cos + three);
    let root = (b * b - 4.0 * a * c).sqrt();
    let tangents = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
    let angles = tangents.map(|tangent| 2.0 * tangent.atan());
    // The coupler's end is above the ground line in the open configuration.
    angles.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// If this fails, the simulated linkage differs from the linkage that the scene describes.
#[test]
fn platform_follows_the_rocker_and_holds_its_amax() {
    let run = record(
        &built_in("crank-rocker"),
        Every::Ticks(1),
        Window::FirstMotion,
    );
    assert_eq!(run.report["scene"]["machine"]["mechanism"], "crank-rocker");
    let trace = run.trace();
    let turns: Vec<_> = (0..3)
        .map(|axis| trace.axis("actual_turns", axis))
        .collect();
    let (z_m, t_s) = (trace.column("z_m"), trace.column("t_s"));
    // The crank's pin is farthest from its pivot where crank and coupler are in line: law of cosines.
    let reach = CRANK + COUPLER;
    let stretched = ((reach * reach + GROUND * GROUND - 1.0) / (2.0 * reach * GROUND)).acos();
    let folded_reach = COUPLER - CRANK;
    let folded = PI
        + ((folded_reach * folded_reach + GROUND * GROUND - 1.0) / (2.0 * folded_reach * GROUND))
            .acos();
    for row in 0..trace.rows() {
        let height_m =
            |turns: f64| LEAD_M / TAU * (rocker_rad(folded) - rocker_rad(stretched + turns * TAU));
        let mean_m = turns.iter().map(|turns| height_m(turns[row])).sum::<f64>() / 3.0;
        assert!(
            (z_m[row] - mean_m).abs() < 2e-9,
            "row {row}: {} m, not {mean_m}",
            z_m[row]
        );
    }

    let requested = trace.column("amax_requested_mps2");
    let top_mps2 = 9.80665;
    let hold: Vec<usize> = (0..trace.rows())
        .filter(|&row| (requested[row] - top_mps2).abs() < 1e-3)
        .collect();
    // The shaft reaches its speed in the first fifth of a second.
    let (from, to) = (hold[400], hold[hold.len() - 1]);
    assert!(to > from + 600, "{from} to {to}");
    let high = z_m[from..to].iter().copied().fold(f64::MIN, f64::max);
    let low = z_m[from..to].iter().copied().fold(f64::MAX, f64::min);
    // 60° of a turn. A tick beside the dead centre is 1.6°.
    assert!(
        ((high - low) / (LEAD_M / 6.0) - 1.0).abs() < 3e-4,
        "stroke {} m",
        high - low
    );
    // The greatest acceleration of the hold, in either direction. Half a tick beside its peak it is 1e-4 less.
    let accel = trace.column("accel_mps2");
    let max = accel[from..to].iter().map(|a| a.abs()).fold(0.0, f64::max);
    assert!(
        (max / top_mps2 - 1.0).abs() < 1e-3,
        "{max} m/s² of {top_mps2}"
    );
    // Times from each highest place to the lowest, and back: their ratio is 0.9. Parabolas give the places between ticks.
    let extreme = |up: f64| -> Vec<f64> {
        (from + 1..to)
            .filter(|&row| up * z_m[row] > up * z_m[row - 1] && up * z_m[row] >= up * z_m[row + 1])
            .map(|row| {
                let (before, at, after) = (z_m[row - 1], z_m[row], z_m[row + 1]);
                let beside = 0.5 * (before - after) / (before - 2.0 * at + after);
                t_s[row] + beside * (t_s[row + 1] - t_s[row])
            })
            .collect()
    };
    let (tops, bottoms) = (extreme(1.0), extreme(-1.0));
    let mut ratios = 0;
    for pair in tops.windows(2) {
        let bottom = bottoms.iter().find(|t| (pair[0]..pair[1]).contains(*t));
        let Some(bottom) = bottom else { continue };
        let ratio = (bottom - pair[0]) / (pair[1] - bottom);
        assert!((ratio - 0.9).abs() < 2e-3, "time ratio {ratio}");
        ratios += 1;
    }
    assert!(ratios >= 3, "{ratios} strokes");
}
