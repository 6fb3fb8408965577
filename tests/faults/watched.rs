//! What a run is judged by: when cranks truly passed a limit, and which of them moved.

use super::{AT_TICK, KINEMATIC, with};

/// A tilt limit, mrad, instead of one that nothing passes.
fn limited(mrad: f64) -> String {
    KINEMATIC.replace(
        "tilt_limit_mrad = 100",
        &format!("tilt_limit_mrad = {mrad}"),
    )
}

/// Were it wrong, a campaign would take the wrong tick for the one in which a fault became dangerous, or the wrong tilt for the
/// largest.
///
/// One crank of three that is e behind tilts the platform by 2/3 e s R/ρ at the phase where s is largest: 1.031 at λ = 0.25.
#[test]
fn a_limit_is_passed_when_the_cranks_pass_it() {
    let mrad = |cycles: f64| {
        2.0 / 3.0 * cycles * 0.02 * std::f64::consts::TAU * 1.031 * 10.0 / 250.0 * 1e3
    };
    let fault = "kind = \"lost-steps\"\naxis = 2\ncycles = 3\n";
    let passed = with(&limited(mrad(2.9)), fault).outcome.watch;
    assert_eq!(passed.past_limit, Some(AT_TICK));
    let (found, expected) = (passed.worst_phase_tilt_mrad, mrad(3.0));
    assert!(
        (found / expected - 1.0).abs() < 0.01,
        "{found}, not {expected}"
    );
    assert!(passed.tilt_mrad <= found * 1.001);
    assert_eq!(
        with(&limited(mrad(3.1)), fault).outcome.watch.past_limit,
        None
    );

    // A walk passes it when it has come so far: two cycles at a turn a second, from the tick's end in which it begins.
    let slip = "kind = \"slip\"\naxis = 0\nrate_deg_per_s = 360\nfor_s = 0.045\n";
    let walked = with(&limited(mrad(2.0)), slip).outcome.watch;
    let past = walked.past_limit.expect("2.25 cycles are slipped");
    assert!((AT_TICK + 78..=AT_TICK + 81).contains(&past), "{past}");
}

/// Were it wrong, an axis that is left running while another stands would go unseen, or one be seen where all stop.
#[test]
fn who_moved_last_is_known() {
    let stuck = with(KINEMATIC, "kind = \"stuck\"\naxis = 1\n")
        .outcome
        .watch;
    assert_eq!(stuck.moved[1], Some(AT_TICK - 1));
    assert!(stuck.moved[0] > Some(AT_TICK + 100));
    assert_eq!(stuck.told_to_move[0], stuck.told_to_move[1]);
    assert!(stuck.ran_alone_ticks > 100 && stuck.ran_alone <= stuck.moved[0]);

    let none = with(KINEMATIC, "kind = \"stop-input\"\n").outcome.watch;
    assert_eq!(none.ran_alone, None);
    // The last step of a stop is made before the last of its way, within what a stop takes to die away.
    let (moved, told) = (none.moved[0].unwrap(), none.told_to_move[0].unwrap());
    assert!(moved <= told && told < moved + 20, "{moved}, {told}");
    assert_eq!(none.moved[0], none.moved[2]);
}
