//! Numbers whose range other keys decide, set to values that no machine has. Tests of the reader do the same with all others.

use super::edit::set;
use super::{assert_refused, case};

/// Keys, and whether 0 is a valid value.
const NUMBERS: &[(&str, bool)] = &[
    ("machine.lambda", false),
    ("link.timeout_s", true),
    ("limits.acceleration_hz_per_s", false),
    ("limits.jerk_hz_per_s2", false),
    ("limits.homing_speed_hz", false),
    ("program[0].amax_g", true),
    ("program[0].ramp_s", true),
    ("program[0].hold_s", true),
];

#[test]
fn non_finite_and_extreme_numbers_are_refused() {
    for &(key, zero) in NUMBERS {
        for value in ["nan", "inf", "-inf"] {
            let right = "finite number; give one from";
            assert_refused(&case(key, set(key, value), key, "is not a", right));
        }
        let tiny: &[&str] = if zero { &[] } else { &["0", "-0.0", "1e-300"] };
        for value in ["1e300", "-1e300"].iter().chain(tiny) {
            assert_refused(&case(key, set(key, value), key, " is outside ", " to "));
        }
    }
}
