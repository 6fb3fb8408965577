//! Errors in injected faults. Each kind takes its own values, and is possible only on axes and
//! machines that can show it.

use super::edit::{append, replace};
use super::{Case, assert_all_refused, case};

/// Returns the base scene with a fault that has these lines.
fn with(
    name: &'static str,
    lines: &str,
    key: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Case {
    let lines = format!("[[fault]]\nat_s = 1\n{lines}\n");
    case(name, append(&lines), key, wrong, right)
}

#[test]
fn unknown_kinds_and_missing_fault_keys_are_refused() {
    assert_all_refused(&[
        with(
            "no such kind",
            "kind = \"lost-step\"",
            "fault[0].kind",
            "is none of its values",
            "did you mean \"lost-steps\"?",
        ),
        with("what?", "axis = 0", "fault[0].kind", "missing", "give it"),
        with(
            "where?",
            "kind = \"slip\"\nrate_deg_per_s = 3",
            "fault[0].axis",
            "missing",
            "the number of the axis",
        ),
        with(
            "how fast?",
            "kind = \"slip\"\naxis = 1",
            "fault[0].rate_deg_per_s",
            "missing",
            "positive behind",
        ),
        with(
            "which lines?",
            "kind = \"swapped-wiring\"\naxis = 1\nwith = 0",
            "fault[0].lines",
            "missing",
            "\"drive\" or \"sensors\"",
        ),
        with(
            "another kind's number",
            "kind = \"slip\"\naxis = 1\nrate_deg_per_s = 3\ncycles = 2",
            "fault[0].cycles",
            "\"slip\" takes no cycles",
            "axis, rate_deg_per_s, for_s",
        ),
        with(
            "an axis for all",
            "kind = \"overrun\"\naxis = 1",
            "fault[0].axis",
            "\"overrun\" takes no axis",
            "it takes count",
        ),
        with(
            "steps that come back",
            "kind = \"lost-steps\"\naxis = 1\nfor_s = 1",
            "fault[0].for_s",
            "takes no for_s",
            "axis, cycles",
        ),
        with(
            "an unknown key",
            "kind = \"stuck\"\naxis = 1\nuntil_s = 1",
            "fault[0].until_s",
            "unknown key",
            "at_s",
        ),
    ]);
}

#[test]
fn fault_values_out_of_range_are_refused() {
    let number = |name, lines: &str, key, wrong, right| with(name, lines, key, wrong, right);
    assert_all_refused(&[
        number(
            "no cycles",
            "kind = \"lost-steps\"\naxis = 1\ncycles = 0",
            "fault[0].cycles",
            "0 is no fault",
            "-10000 to 10000",
        ),
        number(
            "not a rate",
            "kind = \"slip\"\naxis = 1\nrate_deg_per_s = nan",
            "fault[0].rate_deg_per_s",
            "is not a finite number",
            "give one from",
        ),
        number(
            "an endless torque",
            "kind = \"load-step\"\naxis = 1\ntorque_nm = inf",
            "fault[0].torque_nm",
            "is not a finite number",
            "give one from",
        ),
    ]);
    let at = |value| {
        let text = format!("[[fault]]\nat_s = {value}\nkind = \"stuck\"\naxis = 0\n");
        case(
            "when?",
            append(&text),
            "fault[0].at_s",
            "",
            "0 to 1000000 s",
        )
    };
    assert_all_refused(&["-1", "nan", "1e12"].map(at));
}

#[test]
fn faults_that_the_machine_cannot_have_are_refused() {
    let model_level = |name, model_level: &str, lines: &str, key, wrong, right| {
        let text = replace(
            "fidelity = \"auto\"",
            &format!("fidelity = \"{model_level}\""),
        );
        let text = format!("{text}\n[[fault]]\nat_s = 1\n{lines}\n");
        case(name, text, key, wrong, right)
    };
    assert_all_refused(&[
        with(
            "no such axis",
            "kind = \"stuck\"\naxis = 3",
            "fault[0].axis",
            "there is no axis 3",
            "0 to 2",
        ),
        with(
            "with itself",
            "kind = \"swapped-wiring\"\naxis = 1\nwith = 1\nlines = \"sensors\"",
            "fault[0].with",
            "1 is the fault's `axis` itself",
            "the other axis",
        ),
        with(
            "no encoder",
            "kind = \"encoder-glitch\"\naxis = 1\ncounts = 5",
            "fault[0].kind",
            "no encoder is read",
            "axes.encoder = true",
        ),
        model_level(
            "one shaft",
            "rigid",
            "kind = \"stuck\"\naxis = 1",
            "fidelity",
            "stuck has them at others",
            "let it be \"phased\"",
        ),
        model_level(
            "no torque",
            "kinematic",
            "kind = \"load-step\"\naxis = 1\ntorque_nm = 2",
            "fault[0].kind",
            "torque moves no cranks",
            "let fidelity be \"phased\"",
        ),
    ]);
}

#[test]
fn invalid_noise_values_are_refused() {
    let key = |key, line: &str, wrong, right| {
        case(
            key,
            append(&format!("[noise]\n{line}\n")),
            key,
            wrong,
            right,
        )
    };
    assert_all_refused(&[
        key(
            "noise.index_us",
            "index_us = nan",
            "NaN is not",
            "0 to 50 µs",
        ),
        key(
            "noise.encoder_counts",
            "encoder_counts = 3",
            "none is read",
            "axes.encoder = true",
        ),
        key(
            "noise.load_nm",
            "load_nm = inf",
            "is not a finite number",
            "0 to 1000",
        ),
        key("noise.seed", "seed = -3", "`-3` is negative", "0 or more"),
        key(
            "noise.index_mm",
            "index_mm = 3",
            "unknown key",
            "`index_us`",
        ),
    ]);
}
