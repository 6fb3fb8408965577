//! Errors in the motors, in common settings and per axis.

use super::edit::{append, replace, set, with_line, without};
use super::{assert_all_refused, case};

#[test]
fn invalid_axis_counts_are_refused() {
    let count = |value, wrong, right| {
        case(
            "count",
            set("axes.count", value),
            "axes.count",
            wrong,
            right,
        )
    };
    assert_all_refused(&[
        count("0", "0 is outside", "2 to 6, the motors"),
        count("1", "1 is outside", "2 to 6, the motors"),
        count("7", "7 is outside", "2 to 6, the motors"),
        count("1000000000", "1e9 is outside", "2 to 6, the motors"),
        count(
            "1e9",
            "`1e9` is a number with a fraction or exponent",
            "a whole number, 0 or more",
        ),
        count(
            "3.5",
            "`3.5` is a number with a fraction",
            "such as `count = 4`",
        ),
        count("-3", "`-3` is negative", "a whole number, 0 or more"),
        count("\"3\"", "`\"3\"` is text", "write 3, without quotes"),
        count(
            "99999999999999999999",
            "is too large",
            "such as `count = 4`",
        ),
    ]);
}

#[test]
fn invalid_common_axis_keys_are_refused() {
    let key = |name, path, value, wrong, right| case(name, set(path, value), path, wrong, right);
    assert_all_refused(&[
        key(
            "steps with a fraction",
            "axes.steps_per_turn",
            "1066.6667",
            "a number with a fraction",
            "gear = [motor turns, crank turns]",
        ),
        key(
            "ratio of nothing",
            "axes.ratio",
            "[0, 1]",
            "numerator 0 is outside",
            "1 to 1000",
        ),
        key(
            "ratio over nothing",
            "axes.ratio",
            "[1, 0]",
            "denominator 0 is outside",
            "1 to 1000",
        ),
        key(
            "a ratio of three",
            "axes.ratio",
            "[1, 1, 9]",
            "`[1, 1, 9]` has 3 in it",
            "a list of two numbers",
        ),
        key(
            "ratio under a platform",
            "axes.ratio",
            "[36, 20]",
            "the cranks of one platform make the master's own turns",
            "gear = [motor turns, crank turns]",
        ),
        key(
            "drive",
            "axes.drive",
            "\"steper\"",
            "\"steper\" is none of its values",
            "did you mean \"stepper\"?",
        ),
    ]);
}

#[test]
fn invalid_pull_out_curves_are_refused() {
    let pull_out = |name, points, key, wrong, right| {
        case(name, set("axes.pull_out", points), key, wrong, right)
    };
    assert_all_refused(&[
        pull_out(
            "out of order",
            "[[0, 20], [10, 9], [5, 11]]",
            "axes.pull_out[2]",
            "5 rev/s is not above the point before, 10 rev/s",
            "from the lowest speed up",
        ),
        pull_out(
            "negative",
            "[[0, -20]]",
            "axes.pull_out[0]",
            "-20 N·m is outside",
            "0 to 100000",
        ),
        pull_out(
            "half a point",
            "[[0, 20], [5]]",
            "axes.pull_out[1]",
            "`[5]` has 1 in it",
            "a list of two numbers belongs; such as `[0, 5.0]`",
        ),
        pull_out(
            "a point of three",
            "[[0, 20], [5, 18, 99]]",
            "axes.pull_out[1]",
            "`[5, 18, 99]` has 3 in it",
            "a list of two numbers belongs; such as `[0, 5.0]`",
        ),
        pull_out(
            "decimal commas",
            "[[0, 20,5], [5, 18,5]]",
            "axes.pull_out[0]",
            "`[0, 20,5]` has 3 in it",
            "a list of two numbers",
        ),
        pull_out(
            "no number",
            "[[0, 20], [nan, 3]]",
            "axes.pull_out[1]",
            "NaN is not a finite number",
            "0 to 600 rev/s",
        ),
        case(
            "torque requested and not given",
            without("axes.pull_out").replace("\"auto\"", "\"quasi-static\""),
            "axes.pull_out",
            "missing; fidelity = \"quasi-static\" compares torques",
            "[[speed_hz, torque_nm], …]",
        ),
    ]);
}

#[test]
fn invalid_keys_of_one_axis_are_refused() {
    let key = |name, path, value, wrong, right| case(name, set(path, value), path, wrong, right);
    let own = |name, line: &str, key, wrong, right| {
        case(name, with_line("axis[1].reversed", line), key, wrong, right)
    };
    assert_all_refused(&[
        key(
            "no such axis",
            "axis[1].number",
            "3",
            "there is no axis 3",
            "0 to 2",
        ),
        key(
            "twice the same",
            "axis[1].number",
            "1",
            "axis 1 has an [[axis]] of its own already",
            "put both into one",
        ),
        key(
            "before the first",
            "axis[0].number",
            "-1",
            "`-1` is negative",
            "a whole number, 0 or more",
        ),
        key(
            "trim beyond its limit",
            "axis[0].trim_deg",
            "6",
            "6° is outside -5 to 5°",
            "raise axes.trim_limit_deg",
        ),
        // The message has the key as written in the file, and the entry's place: axis 2 is the second
        // entry, with index 1.
        own(
            "own ratio of three",
            "ratio = [1, 1, 1]",
            "axis[1].ratio",
            "has 3 in it",
            "a list of two numbers",
        ),
        own(
            "own ratio",
            "ratio = [0, 1]",
            "axis[1].ratio",
            "numerator 0 is outside",
            "1 to 1000",
        ),
        own(
            "own gear of three",
            "gear = [1, 1, 1]",
            "axis[1].gear",
            "has 3 in it",
            "a list of two numbers",
        ),
        own(
            "own gear of nothing",
            "gear = [0, 1]",
            "axis[1].gear",
            "motor turns 0 is outside 1 to 1000",
            "[57, 11] of a belt",
        ),
        own(
            "own gear with too many steps",
            "gear = [1000, 1]",
            "axis[1].gear",
            "steps per turn of the crank, outside 4 to 1048576",
            "change axes.steps_per_turn",
        ),
        case(
            "a list of the common ones",
            replace("[axes]", "[[axes]]"),
            "axes",
            "is a list here",
            "write [axes], once",
        ),
        case(
            "one for all",
            append("[axes.axis]\nnumber = 0\n"),
            "axes.axis",
            "unknown key",
            "known here: count, drive",
        ),
    ]);
}

/// Keys of a stepper that have no effect are refused.
#[test]
fn torque_keys_without_effect_are_refused() {
    assert_all_refused(&[
        case(
            "microsteps that are no whole number",
            set("axes.steps_per_turn", "3201"),
            "axes.steps_per_turn",
            "3201 is not a whole number of microsteps",
            "axes.full_steps_per_turn = 200",
        ),
        case(
            "the torque of servos",
            set("axes.drive", "\"servo\""),
            "axes.pull_out",
            "no axis here is a stepper",
            "leave it out",
        ),
        case(
            "speeds of a motor in rpm",
            set("axes.pull_out", "[[0, 20], [1260, 15]]"),
            "axes.pull_out[1]",
            "1260",
            "1260 rpm would be 21 rev/s",
        ),
        case(
            "torque before speed",
            set("axes.pull_out", "[[20, 0], [18, 10], [15, 20]]"),
            "axes.pull_out[1]",
            "18 rev/s is not above the point before, 20 rev/s",
            "write [[0, 20], [10, 18], [20, 15]]",
        ),
        case(
            "a position loop of steppers",
            replace("drive = \"pulse-servo\"\n", ""),
            "axes.servo",
            "no axis here is one",
            "leave it out",
        ),
        case(
            "damping by the drives of servos",
            without("axes.pull_out")
                .replace("drive = \"stepper\"", "drive = \"pulse-servo\"")
                .replace("damping_nms = 0\n", "damping_nms = 0.1\n"),
            "axes.damping_nms",
            "no axis here is a stepper",
            "leave it out",
        ),
        case(
            "a weaker servo",
            replace(
                "pull_out_scale = 1\n",
                "pull_out_scale = 0.4\ndrive = \"pulse-servo\"\n",
            ),
            "axis[0].pull_out_scale",
            "this axis has none",
            "leave it out",
        ),
        case(
            "a weaker motor of unknown torque",
            without("axes.pull_out").replace("pull_out_scale = 1\n", "pull_out_scale = 0.4\n"),
            "axis[0].pull_out_scale",
            "scales nothing",
            "[[speed_hz, torque_nm], …]",
        ),
    ]);
}
