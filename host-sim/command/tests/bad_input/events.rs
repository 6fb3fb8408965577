//! Errors in the timed events of a scene, and in its window.

use super::edit::{append, set, without};
use super::{assert_all_refused, case};

#[test]
fn invalid_commands_inputs_and_delays_are_refused() {
    let key = |name, path, value, wrong, right| case(name, set(path, value), path, wrong, right);
    assert_all_refused(&[
        key(
            "no such command",
            "command[0].do",
            "\"jump\"",
            "\"jump\" is none of its values",
            "\"start\", \"stop\", \"hold\", \"resume\", \"reset\"",
        ),
        case(
            "to do what?",
            without("command[0].do"),
            "command[0].do",
            "missing",
            "give it",
        ),
        key(
            "no such line",
            "input[0].line",
            "\"enabel\"",
            "\"enabel\" is none of its values",
            "did you mean \"enable\"?",
        ),
        key(
            "a level for a truth",
            "input[0].active",
            "1",
            "`1` is a number",
            "true or false belongs",
        ),
        key(
            "when?",
            "late[0].at_s",
            "nan",
            "NaN is not a finite number",
            "0 to 1000000 s",
        ),
    ]);
}

#[test]
fn invalid_scope_windows_are_refused() {
    assert_all_refused(&[
        case(
            "upside down",
            set("scope.to_s", "0.2"),
            "scope.to_s",
            "0.2 is not after scope.from_s = 0.5",
            "swap",
        ),
        case(
            "no end",
            without("scope.to_s"),
            "scope.to_s",
            "missing",
            "give it",
        ),
        case(
            "two of them",
            append("[scope]\nfrom_s = 0\n"),
            "scope",
            "given before",
            "keep one of the two",
        ),
    ]);
}

#[test]
fn an_unknown_model_level_is_refused() {
    assert_all_refused(&[case(
        "a model level that is not there",
        set("fidelity", "\"perfect\""),
        "fidelity",
        "\"perfect\" is none of its values",
        "give one of \"auto\", \"kinematic\"",
    )]);
}
