//! Every number of a scene, set to values that no machine has.

use super::edit::set;
use super::{assert_refused, case};

/// Keys that hold a number, and whether 0 is a valid value.
const NUMBERS: &[(&str, bool)] = &[
    ("machine.crank_radius_mm", false),
    ("machine.lambda", false),
    ("machine.load_kg", false),
    ("machine.gravity_mps2", true),
    ("machine.mount_radius_mm", false),
    ("machine.tilt_inertia_kgm2", false),
    ("machine.rod_n_per_um", false),
    ("machine.rod_zeta", true),
    ("frame.mass_kg", false),
    ("frame.tilt_inertia_kgm2", false),
    ("frame.suspension_n_per_mm", false),
    ("frame.suspension_zeta", true),
    ("frame.foundation.mass_kg", false),
    ("frame.foundation.tilt_inertia_kgm2", false),
    ("frame.foundation.ground_n_per_mm", false),
    ("frame.foundation.ground_zeta", true),
    ("control.park_deg", true),
    ("control.settle_s", true),
    ("link.timeout_s", true),
    ("limits.speed_hz", false),
    ("limits.acceleration_hz_per_s", false),
    ("limits.jerk_hz_per_s2", false),
    ("limits.homing_speed_hz", false),
    ("pulse.width_ns", false),
    ("pulse.dir_setup_ns", true),
    ("pulse.dir_hold_ns", true),
    ("axes.offset_deg", true),
    ("axes.index_deg", true),
    ("axes.trim_limit_deg", true),
    ("axes.trim_rate_deg_per_s", false),
    ("axes.rotor_inertia_kgm2", true),
    ("axes.damping_nms", true),
    ("axes.servo.position_gain_per_s", false),
    ("axes.servo.velocity_gain_nms", false),
    ("axes.servo.integral_s", false),
    ("axes.servo.limit_nm", false),
    ("axes.servo.velocity_feed_forward", true),
    ("axes.servo.following_error_deg", false),
    ("axis[0].start_deg", true),
    ("axis[0].trim_deg", true),
    ("axis[0].pull_out_scale", true),
    ("index.width_us", false),
    ("drift.tilt_limit_mrad", false),
    ("drift.warp_limit_deg", false),
    ("drift.common_limit_deg", false),
    ("program[0].amax_g", true),
    ("program[0].ramp_s", true),
    ("program[0].hold_s", true),
    ("command[0].at_s", true),
    ("input[0].at_s", true),
    ("late[0].at_s", true),
    ("late[0].by_us", true),
    ("scope.from_s", true),
    ("scope.to_s", true),
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
