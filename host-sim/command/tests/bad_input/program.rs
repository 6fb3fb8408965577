//! Errors in amax(t): levels, times, and repeated blocks.

use super::edit::{append, program, rename, set, without};
use super::{assert_all_refused, case};

#[test]
fn unreachable_levels_are_refused() {
    let level = |name, value, wrong, right| {
        case(
            name,
            set("program[1].amax_g", value),
            "program[1].amax_g",
            wrong,
            right,
        )
    };
    assert_all_refused(&[
        case(
            "at once, and never",
            set("program[1].amax_g", "190").replace(
                "ramp_s = 0.5\nhold_s = 0.2\nshape",
                "ramp_s = 0\nhold_s = 0.2\nshape",
            ),
            "program[1].amax_g",
            "190 g (1863.26 m/s²) needs 42.606 rev/s, over limits.speed_hz = 20",
            "give at most 41.86 g, or raise limits.speed_hz",
        ),
        level(
            "a hundredth more than can be",
            "41.87",
            "41.87 g",
            "give at most 41.86 g",
        ),
        level(
            "beyond any machine",
            "2000",
            "2000 g is outside",
            "0 to 1019.7 g",
        ),
        level("negative", "-5", "-5 g is outside", "0 to 1019.7 g"),
        level(
            "no number",
            "nan",
            "NaN is not a finite number",
            "from 0 to 1019.7 g",
        ),
        level(
            "words",
            "\"high\"",
            "`\"high\"` is text, where a number belongs",
            "such as `amax_g =",
        ),
    ]);
}

#[test]
fn invalid_ramp_and_hold_times_are_refused() {
    let key = |name, path, value, wrong, right| case(name, set(path, value), path, wrong, right);
    assert_all_refused(&[
        key(
            "ramp backwards",
            "program[0].ramp_s",
            "-1",
            "-1 s is outside",
            "0 to 100000 s",
        ),
        key(
            "ramp of a day and more",
            "program[0].ramp_s",
            "100001",
            "100001 s is outside",
            "0 to 100000 s",
        ),
        key(
            "hold backwards",
            "program[1].hold_s",
            "-0.1",
            "-0.1 s is outside",
            "0 to 1000000 s",
        ),
        key(
            "hold for ever",
            "program[1].hold_s",
            "inf",
            "inf is not a finite number",
            "0 to 1000000 s",
        ),
        case(
            "no time",
            program("[[program]]\namax_g = 5\n"),
            "program[0].ramp_s",
            "takes no time at all",
            "a ramp_s or a hold_s",
        ),
        case(
            "less than a tick",
            program("[[program]]\namax_g = 5\nhold_s = 1e-9\n"),
            "program[0].ramp_s",
            "takes no time at all",
            "at least one tick",
        ),
        key(
            "shape",
            "program[1].shape",
            "\"round\"",
            "\"round\" is none of its values",
            "\"linear\", \"smooth\"",
        ),
    ]);
}

#[test]
fn entries_neither_level_nor_block_are_refused() {
    let block = |name, text: &str, key, wrong, right| {
        case(
            name,
            program(&format!("[[program]]\n{text}\n")),
            key,
            wrong,
            right,
        )
    };
    let level = "segments = [{ amax_g = 5, ramp_s = 1 }]";
    assert_all_refused(&[
        case("none", program(""), "program", "missing", "[[program]]"),
        case(
            "empty",
            format!("program = []\n{}", program("")),
            "program",
            "no segments",
            "give at least one",
        ),
        case(
            "one table",
            program("[program]\namax_g = 5\nramp_s = 1\n"),
            "program",
            "is a table, where a list of tables belongs",
            "write [[program]]",
        ),
        case(
            "a table in lists",
            format!("program = 5\n{}", program("")),
            "program",
            "`5` is a number, where a list belongs",
            "[[program]]",
        ),
        case(
            "misspelt",
            program("").clone() + "[[programme]]\namax_g = 5\nramp_s = 1\n",
            "programme",
            "unknown key",
            "`program`",
        ),
        case(
            "no level",
            without("program[0].amax_g"),
            "program[0].amax_g",
            "missing",
            "give the level",
        ),
        block(
            "never",
            &format!("repeat = 0\n{level}"),
            "program[0].repeat",
            "0 is outside",
            "1 to 65535",
        ),
        block(
            "too often",
            &format!("repeat = 70000\n{level}"),
            "program[0].repeat",
            "70000 is outside",
            "1 to 65535",
        ),
        block(
            "half",
            &format!("repeat = 1.5\n{level}"),
            "program[0].repeat",
            "`1.5` is a number with a fraction",
            "a whole number",
        ),
        block(
            "nothing to repeat",
            "repeat = 3",
            "program[0].segments",
            "missing",
            "give the block",
        ),
        block(
            "nothing in it",
            "repeat = 3\nsegments = []",
            "program[0].segments",
            "is empty",
            "at least one segment",
        ),
        block(
            "how often?",
            level,
            "program[0].repeat",
            "missing",
            "how often",
        ),
        block(
            "both",
            &format!("amax_g = 5\nrepeat = 3\n{level}"),
            "program[0].amax_g",
            "given together with a block",
            "split it in two",
        ),
        block(
            "block with a time",
            &format!("hold_s = 5\nrepeat = 3\n{level}"),
            "program[0].hold_s",
            "belongs to a level",
            "put it into the block's segments",
        ),
        block(
            "ten years and more",
            "repeat = 65535\nsegments = [{ amax_g = 5, hold_s = 1e6 }]",
            "program[0].repeat",
            "more than 10 years",
            "fewer repeats",
        ),
        case(
            "deep inside",
            rename("program[2].segments", "segment"),
            "program[2].segment",
            "unknown key",
            "`segments`",
        ),
        block(
            "deeper inside",
            "repeat = 2\nsegments = [{ repeat = 2, segments = [{ amax_g = 5, ramp_ms = 1 }] }]",
            "program[0].segments[0].segments[0].ramp_ms",
            "unknown key",
            "`ramp_s`, in s",
        ),
    ]);
}

#[test]
fn programs_that_are_too_large_are_refused() {
    fn nested(depth: usize) -> String {
        (0..depth).fold("{ amax_g = 5, ramp_s = 1 }".to_owned(), |inner, _| {
            format!("{{ repeat = 2, segments = [{inner}] }}")
        })
    }
    let deep = |depth| {
        append(&format!(
            "[[program]]\nrepeat = 2\nsegments = [{}]\n",
            nested(depth)
        ))
    };
    assert_all_refused(&[
        case(
            "200 segments",
            program(&"[[program]]\namax_g = 5\nramp_s = 1\n".repeat(200)),
            "program[128]",
            "129 entries, repeats included, are more than the 128",
            "use repeat blocks",
        ),
        case(
            "9 deep",
            deep(9),
            "program[3].segments[0].segments[0].segments[0].segments[0].segments[0].segments[0].segments[0].segments[0].segments",
            "nested more than 8 deep",
            "write some of them out",
        ),
        // The TOML parser has a nesting limit of its own, which prevents a stack overflow.
        case(
            "1000 deep",
            deep(1000),
            "program[3].segments",
            "nested too deep",
            "8 deep at most",
        ),
        case(
            "100,000 lists",
            append(&format!("x = {}\n", "[".repeat(100_000))),
            "scope.x",
            "nested too deep",
            "8 deep at most",
        ),
    ]);
}
