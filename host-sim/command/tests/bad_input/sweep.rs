//! Every number of a scene, set to values that no machine has.

use cophase_scene::keys::SECTIONS;

use super::edit::{BASE, set};
use super::{assert_refused, case};

/// Keys without a row that hold a number, and whether 0 is a valid value.
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
    ("link.timeout_s", true),
    ("limits.speed_hz", false),
    ("limits.acceleration_hz_per_s", false),
    ("limits.jerk_hz_per_s2", false),
    ("limits.homing_speed_hz", false),
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

/// Returns the base scene with a line in a table, in the place of its line about a key.
fn with_row(table: &str, name: &str, line: &str) -> String {
    let heading = format!("[{table}]");
    let mut is_inside = false;
    let mut text = String::new();
    for own in BASE.lines() {
        if own.starts_with('[') {
            is_inside = own == heading;
        }
        if !(is_inside && own.starts_with(&format!("{name} = "))) {
            text.push_str(&format!("{own}\n"));
        }
        if own == heading {
            text.push_str(&format!("{line}\n"));
        }
    }
    text
}

#[test]
fn a_number_outside_the_range_of_its_row_is_refused() {
    for (section, row) in SECTIONS
        .iter()
        .flat_map(|section| section.keys.iter().map(move |row| (section, row)))
    {
        let with = |value: &str| {
            let line = format!("{} = {value}", row.name());
            with_row(section.name, row.name(), &line)
        };
        let beyond = match row.is_whole {
            true => [row.low - 1.0, row.high + 1.0, 0.0, 1e9].map(|value| value.to_string()),
            false => [
                row.low - 0.01 * row.low.abs().max(0.01),
                row.high * 1.01,
                -1e300,
                1e300,
            ]
            .map(|value| format!("{value:?}")),
        };
        for value in beyond {
            let text = with(&value);
            assert_refused(&case(row.path, text, row.path, " is outside ", "; give "));
        }
        if !row.is_whole {
            for value in ["nan", "inf", "-inf"] {
                let right = "finite number; give one from";
                assert_refused(&case(row.path, with(value), row.path, "is not a", right));
            }
        }
    }
}

#[test]
fn text_where_a_row_has_a_number_is_refused_with_its_default_as_an_example() {
    for row in SECTIONS.iter().flat_map(|section| section.keys) {
        let (table, name) = row.path.rsplit_once('.').unwrap();
        let text = with_row(table, name, &format!("{name} = \"much\""));
        let right = format!("such as `{name} = {}`", row.default).leak();
        assert_refused(&case(row.path, text, row.path, "`\"much\"` is text", right));
    }
}

#[test]
fn a_misspelt_key_of_a_row_is_refused_with_its_right_name() {
    for row in SECTIONS.iter().flat_map(|section| section.keys) {
        let (table, name) = row.path.rsplit_once('.').unwrap();
        let path = format!("{}x", row.path).leak();
        let text = with_row(table, name, &format!("{name}x = 1"));
        let right = format!("did you mean `{name}`").leak();
        assert_refused(&case(row.path, text, path, "unknown key", right));
    }
}
