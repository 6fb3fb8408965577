//! A crank-rocker whose dead centres lie on two branches. It can be synthesized. It is refused by name, and accepted from a higher
//! time ratio on.

use assert_cmd::Command;
use cophase_lab::chart::breakdown::branch;

/// Swing of the assembled linkage, degrees, by the law of cosines in the triangles of the two dead centres. The triangles have the
/// sides ground, rocker and coupler ± crank. Lengths are by the source's formulas 4, 14 and 16 to 18.
fn swing_by_triangles_deg(time_ratio: f64) -> f64 {
    let theta = std::f64::consts::PI * (1.0 - time_ratio) / (1.0 + time_ratio);
    let half_swing = 30_f64.to_radians();
    let scale = 2.0 * half_swing.sin() / theta.sin();
    let extended = scale * (half_swing + theta).sin();
    let folded = scale * half_swing.sin();
    let ground = extended.hypot(1.0);
    let at_rocker_pivot = |reach: f64| {
        let cosine = (ground * ground + 1.0 - reach * reach) / (2.0 * ground);
        cosine.acos().to_degrees()
    };
    (at_rocker_pivot(extended) - at_rocker_pivot(folded)).abs()
}

/// If this fails, a linkage whose rocker swings less than requested is drawn as correct, or is not refused.
#[test]
fn linkages_with_dead_centres_on_two_branches_are_refused() {
    // These swings are calculated independently of this project, to half a unit of the last digit.
    for (time_ratio, swing_deg) in [(0.6, 47.59), (0.7, 58.28)] {
        let facts = branch::measure(time_ratio).unwrap();
        assert!((facts.swing_deg - swing_deg).abs() <= 5e-3, "{facts:?}");
        let by_triangles = swing_by_triangles_deg(time_ratio);
        assert!((facts.swing_deg - by_triangles).abs() < 1e-9, "{facts:?}");
        assert!(facts.is_refused());
        let refused = Command::cargo_bin("cophase")
            .expect("the command is built")
            .args(["design", "crank-rocker", "--swing-deg", "60"])
            .args([
                "--pressure-deg",
                "0",
                "--time-ratio",
                &time_ratio.to_string(),
            ])
            .output()
            .expect("it runs");
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        let message = String::from_utf8(refused.stderr).unwrap();
        assert!(
            message.contains("--time-ratio") && message.contains("two branches"),
            "{message}"
        );
    }
    for time_ratio in [0.75, 0.9] {
        let facts = branch::measure(time_ratio).unwrap();
        assert!(
            (facts.swing_deg - branch::SWING_DEG).abs() < 1e-6,
            "{facts:?}"
        );
        // With a pressure angle of 0 at the extended dead centre, the pressure angle at the folded one is swing + theta (source,
        // formula 6).
        let theta_deg = 180.0 * (1.0 - time_ratio) / (1.0 + time_ratio);
        let folded_deg = facts.folded_pressure_deg.expect("it is accepted");
        assert!((folded_deg - (60.0 + theta_deg)).abs() < 1e-6, "{facts:?}");
    }
}
