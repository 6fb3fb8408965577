//! Tests of the bounds of a preview, and of the disturbances that it leaves out.

use cophase_files::trace::Envelope;
use cophase_scene::library;
use cophase_scope_wasm::{Answer, compute};

const TICK_HZ: f64 = 2000.0;

/// Returns the text of the built-in scene `default`, with one part replaced.
fn default_with(from: &str, to: &str) -> String {
    let text = library::find("default").expect("a built-in scene").text;
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

fn whole(text: &str) -> (Answer, Envelope) {
    compute(text, 1500, u64::MAX, |_, _| {})
}

/// If this fails, a page computes a program of months and never shows it.
#[test]
fn a_long_program_reports_progress_and_is_cut_off() {
    const MAX_TICKS: u64 = 200_000;
    let mut reports = Vec::new();
    let text = default_with("hold_s = 6", "hold_s = 1e6");
    let (answer, envelope) = compute(&text, 300, MAX_TICKS, |preview, expected_ticks| {
        let (_, last_s) = preview.envelope().span().expect("rows");
        // The first output is played from the second deadline on.
        assert_eq!(last_s, (preview.ticks + 1) as f64 / TICK_HZ);
        reports.push((preview.ticks, expected_ticks));
    });
    let scene = answer.scene.expect("the text has no mistakes");
    assert!(scene.ended.is_cut_off);
    assert_eq!(scene.ended.state, "run");
    let (_, last_s) = envelope.span().expect("rows");
    assert!(
        (last_s * TICK_HZ - MAX_TICKS as f64).abs() < 4.0,
        "{last_s} s"
    );
    assert_eq!(scene.previewed_s, last_s);
    assert!(envelope.buckets() <= 300);
    assert!(scene.program_s > 1e6 && scene.expected_s > scene.program_s);
    assert!(reports.len() >= 2, "{reports:?}");
    assert!(reports.is_sorted());
    assert!(
        reports
            .iter()
            .all(|&(_, expected)| expected as f64 > 1e6 * TICK_HZ)
    );
}

/// If this fails, the scene's own faults stop the machine of the preview, which must be undisturbed.
#[test]
fn faults_are_left_out() {
    let undisturbed = library::find("default").expect("a built-in scene").text;
    let fault = "\n[[fault]]\nat_s = 20\nkind = \"stuck\"\naxis = 1\n";
    let (answer, envelope) = whole(&format!("{undisturbed}{fault}"));
    let ended = answer.scene.expect("the text has no mistakes").ended;
    assert_eq!(
        (ended.state, ended.fault, ended.is_cut_off),
        ("parked", None, false)
    );
    let (_, expected) = whole(undisturbed);
    assert!(envelope.rows().eq(expected.rows()));
}

/// The limits that the page draws equal the scene's own numbers: amax at the greatest speed is 4 π² r f² (1 + λ).
#[test]
fn limits_are_those_of_the_scene() {
    let (answer, _) = whole(library::find("default").expect("a built-in scene").text);
    let limits = answer.scene.expect("the text has no mistakes").limits;
    let turn = 2.0 * std::f64::consts::PI;
    assert_eq!(limits.speed_rad_s, 22.0 * turn);
    assert_eq!(limits.bands_rad_s, [(10.0 * turn, 12.0 * turn)]);
    assert_eq!(limits.acceleration_rad_s2, 25.0 * turn);
    let amax_mps2 = (22.0 * turn).powi(2) * 0.010 * 1.25;
    let error = (limits.amax_mps2 / amax_mps2 - 1.0).abs();
    assert!(error < 1e-6, "{} and {amax_mps2} m/s²", limits.amax_mps2);
}
