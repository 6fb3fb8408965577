//! Errors in the limits of the shaft, the loop and the step lines.

use super::edit::{before, replace, set};
use super::{assert_all_refused, case};

#[test]
fn invalid_forbidden_bands_are_refused() {
    let band = |name, bands: &str, key, wrong, right| {
        case(
            name,
            set("limits.band", &format!("[{bands}]")),
            key,
            wrong,
            right,
        )
    };
    assert_all_refused(&[
        band(
            "all speeds",
            "{ from_hz = 0, to_hz = 100 }",
            "limits.band[0]",
            "covers all speeds from limits.homing_speed_hz = 1 to limits.speed_hz = 20",
            "begin above the one and end below the other",
        ),
        band(
            "over the homing speed",
            "{ from_hz = 0.5, to_hz = 3 }",
            "limits.band[0].from_hz",
            "covers the homing speed, limits.homing_speed_hz = 1",
            "begin above that",
        ),
        band(
            "over the top",
            "{ from_hz = 5, to_hz = 20 }",
            "limits.band[0].to_hz",
            "not below limits.speed_hz = 20",
            "lower its upper edge",
        ),
        band(
            "upside down",
            "{ from_hz = 8, to_hz = 6 }",
            "limits.band[0].to_hz",
            "6 rev/s, is not above its lower edge, 8 rev/s",
            "swap",
        ),
        band(
            "empty",
            "{ from_hz = 8, to_hz = 8 }",
            "limits.band[0].to_hz",
            "not above its lower edge",
            "part them",
        ),
        band(
            "overlapping",
            "{ from_hz = 5, to_hz = 7 }, { from_hz = 6, to_hz = 8 }",
            "limits.band[1].from_hz",
            "begins at 6 rev/s, inside or below",
            "join them",
        ),
        band(
            "out of order",
            "{ from_hz = 8, to_hz = 9 }, { from_hz = 3, to_hz = 4 }",
            "limits.band[1].from_hz",
            "below the band before it",
            "from the lowest up",
        ),
        band(
            "no number",
            "{ from_hz = nan, to_hz = 9 }",
            "limits.band[0].from_hz",
            "NaN is not a finite number",
            "give one",
        ),
        band(
            "five",
            "{ from_hz = 2, to_hz = 3 }, { from_hz = 4, to_hz = 5 }, { from_hz = 6, to_hz = 7 }, { from_hz = 8, to_hz = 9 }, { from_hz = 10, to_hz = 11 }",
            "limits.band",
            "5 bands are more than the 4",
            "join neighbours",
        ),
        band(
            "one edge",
            "{ from_hz = 5 }",
            "limits.band[0].to_hz",
            "missing",
            "such as `to_hz =",
        ),
        band(
            "bare numbers",
            "5, 7",
            "limits.band[0]",
            "`5` is a number, where a table belongs",
            "{ from_hz = 10, to_hz = 12 }",
        ),
        band(
            "edges in rpm",
            "{ from_rpm = 300, to_hz = 9 }",
            "limits.band[0].from_rpm",
            "unknown key",
            "`from_hz`, in rev/s",
        ),
    ]);
}

#[test]
fn invalid_speed_acceleration_and_jerk_limits_are_refused() {
    let key = |name, path, value, wrong, right| case(name, set(path, value), path, wrong, right);
    assert_all_refused(&[
        key(
            "no acceleration",
            "limits.acceleration_hz_per_s",
            "0",
            "0 rev/s² is outside",
            "0.01 to 40000 rev/s²",
        ),
        key(
            "ten minutes to full speed",
            "limits.acceleration_hz_per_s",
            "0.02",
            "would take 1000 s",
            "with a higher acceleration",
        ),
        key(
            "no jerk",
            "limits.jerk_hz_per_s2",
            "0",
            "0 rev/s³ is outside",
            "0.01 to 80000000 rev/s³",
        ),
        key(
            "a blow",
            "limits.jerk_hz_per_s2",
            "1e12",
            "1e12 rev/s³ is outside",
            "0.01 to 80000000 rev/s³",
        ),
        key(
            "a homing speed too fast",
            "limits.homing_speed_hz",
            "15",
            "15 rev/s is outside",
            "0.01 to 10 rev/s",
        ),
        key(
            "a jump within a tick",
            "limits.acceleration_hz_per_s",
            "50000",
            "50000 rev/s² is outside 0.01 to 40000 rev/s²",
            "at most 40000 rev/s², or raise limits.speed_hz or control.tick_hz",
        ),
        case(
            "a fault stop below the usual one",
            before("limits.homing_speed_hz", "stop_jerk_hz_per_s2 = 150"),
            "limits.stop_jerk_hz_per_s2",
            "150 rev/s³ is outside 200 to 80000000 rev/s³, not below the usual one",
            "at least 200 rev/s³, or lower limits.jerk_hz_per_s2",
        ),
        case(
            "homing above the greatest speed",
            set("limits.speed_hz", "2").replace("homing_speed_hz = 1\n", "homing_speed_hz = 3\n"),
            "limits.homing_speed_hz",
            "3 rev/s is outside 0.01 to 2 rev/s",
            "at most 2 rev/s, or raise limits.speed_hz",
        ),
    ]);
}

#[test]
fn invalid_tick_and_pulse_settings_are_refused() {
    let tick = |value, wrong, right| {
        case(
            "tick rate",
            set("control.tick_hz", value),
            "control.tick_hz",
            wrong,
            right,
        )
    };
    assert_all_refused(&[
        tick("3000", "not a whole number of microseconds", "2000, 4000"),
        tick("-2000", "`-2000` is negative", "such as `tick_hz = 2000`"),
        tick(
            "2000.0",
            "`2000.0` is a number with a fraction",
            "such as `tick_hz = 2000`",
        ),
        tick(
            "99999999999",
            "`99999999999` is too large",
            "such as `tick_hz = 2000`",
        ),
        case(
            "steps too fast for the pulse",
            set("pulse.width_ns", "20000"),
            "axes.steps_per_turn",
            "would need 64",
            "give at most 800 steps a turn",
        ),
        case(
            "steps too fast for the tick",
            set("axes.steps_per_turn", "65536"),
            "axes.steps_per_turn",
            "steps/s",
            "give at most ",
        ),
        case(
            "turning round too long",
            replace("_ns = 5000", "_ns = 99000"),
            "pulse.dir_setup_ns",
            "over a quarter of a tick",
            "shorten dir_setup_ns",
        ),
        case(
            "a host that is lost at once",
            set("link.timeout_s", "0.01"),
            "link.timeout_s",
            "0.01 s is outside",
            "0.1 to 60",
        ),
        case(
            "a level that is none",
            set("wiring.step", "\"up\""),
            "wiring.step",
            "is none of its values",
            "\"high\"",
        ),
        case(
            "an index filter of over a quarter of a tick",
            set("index.width_us", "100").replace("tick_hz = 2000", "tick_hz = 4000"),
            "index.width_us",
            "100 µs is outside 0.1 to 62.5 µs, a quarter of a tick",
            "give at most 62.5 µs, or lower control.tick_hz",
        ),
        case(
            "a period for a rate",
            before("control.tick_hz", "tick_us = 500"),
            "control.tick_us",
            "unknown key",
            "`tick_hz`, in Hz",
        ),
    ]);
}
