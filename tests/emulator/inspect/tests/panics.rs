//! Functions reached from a root, in firmware that is made here, so that its calls are known.

mod support;

use std::path::Path;

use support::code::{
    CALL_R3, Function, NOP, POP_R4_PC, PUSH_R4_LR, Part, RETURN, Word, firmware, function,
    with_data,
};
use support::{inspect, said};

const PANIC: &str = "_ZN4core9panicking9panic_fmt17h0123456789abcdefE";

fn a_panic() -> Function {
    function(PANIC, &[Part::Is(0xe7fe)]) // b .
}

/// Status, output and errors of a check from `root`.
fn check(functions: &[Function], root: &str, more: &[&str]) -> (i32, String, String) {
    let (_dir, elf) = firmware(functions);
    let arguments = ["panics", elf.to_str().unwrap(), "--root", root];
    said(&inspect(&[&arguments, more].concat(), &[]))
}

#[track_caller]
fn assert_reached(functions: &[Function], lines: &[&str]) {
    let (status, out, err) = check(functions, "root", &[]);
    assert_eq!(status, 1, "{out}{err}");
    let expected = lines.join("\n    ");
    assert!(out.contains(&format!("  REACHED {expected}\n")), "{out}");
}

#[track_caller]
fn assert_free(functions: &[Function]) {
    let (status, out, err) = check(functions, "root", &[]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.contains("  panics: none\n"), "{out}");
}

fn calls(name: &'static str, to: &'static str) -> Function {
    function(name, &[PUSH_R4_LR, Part::Call(to), POP_R4_PC])
}

const REACHED: &str = "core::panicking::panic_fmt, by";

#[test]
fn a_chain_of_calls_is_shown_by_its_shortest_path() {
    let functions = [
        function(
            "root",
            &[PUSH_R4_LR, Part::Call("a"), Part::Call("b"), POP_R4_PC],
        ),
        calls("a", "b"),
        calls("b", "c"),
        calls("c", PANIC),
        a_panic(),
    ];
    assert_reached(&functions, &[REACHED, "root", "b", "c"]);
}

#[test]
fn uncalled_functions_are_ignored() {
    let functions = [
        calls("root", "a"),
        function("a", &[RETURN]),
        calls("c", PANIC),
        a_panic(),
    ];
    assert_free(&functions);
}

#[test]
fn a_jump_into_another_function_is_a_call() {
    for jump in [Part::Jump("a"), Part::JumpIf("a")] {
        let functions = [
            function("root", &[NOP, jump, RETURN]),
            calls("a", PANIC),
            a_panic(),
        ];
        assert_reached(&functions, &[REACHED, "root", "a"]);
    }
}

#[test]
fn a_function_without_an_end_continues_in_the_next() {
    let functions = [function("root", &[NOP, NOP]), calls("a", PANIC), a_panic()];
    assert_reached(&functions, &[REACHED, "root", "a"]);
}

/// If this fails, constants are read as code, and there are calls that do not exist.
#[test]
fn data_that_resemble_a_call_are_not_followed() {
    let bl_to_panic = |offset: u32| (0xf800 | offset >> 1) << 16 | 0xf000;
    // The data are at 0x104, the panic at 0x108.
    let data = [Word::Is(bl_to_panic(0x108 - 0x104 - 4))];
    assert_free(&[with_data("root", &[NOP, RETURN], &data), a_panic()]);
    // The same bytes as code are a call.
    let code = [0xf000, 0xf800].map(Part::Is);
    let functions = [function("root", &[NOP, NOP, code[0], code[1]]), a_panic()];
    assert_reached(&functions, &[REACHED, "root"]);
}

/// ldr r3, [pc, #4]; push {r4, lr}; blx r3; pop {r4, pc}; then the literal.
fn calls_literal(name: &'static str, of: Word) -> Function {
    with_data(
        name,
        &[Part::Is(0x4b01), PUSH_R4_LR, CALL_R3, POP_R4_PC],
        &[of],
    )
}

#[test]
fn a_call_through_a_literal_is_followed() {
    let functions = [
        calls_literal("root", Word::Of("a")),
        calls("a", PANIC),
        a_panic(),
    ];
    assert_reached(&functions, &[REACHED, "root", "a"]);
    assert_free(&[
        calls_literal("root", Word::Of("a")),
        function("a", &[RETURN]),
    ]);
}

#[test]
fn a_function_whose_address_is_held_may_be_called() {
    // The address is loaded and passed on, but never called here.
    let holds = with_data("root", &[Part::Is(0x4b00), RETURN], &[Word::Of("a")]);
    assert_reached(
        &[holds, calls("a", PANIC), a_panic()],
        &[REACHED, "root", "a"],
    );
    // An even number is not the address of a function in Thumb code.
    let even = with_data("root", &[Part::Is(0x4b00), RETURN], &[Word::Is(0x108)]);
    assert_free(&[even, calls("a", PANIC), a_panic()]);
}

#[test]
fn a_call_to_an_unknown_target_is_reported() {
    let unknown = "unknown: a call through a register, by";
    let functions = [function("root", &[PUSH_R4_LR, CALL_R3, POP_R4_PC])];
    assert_reached(&functions, &[unknown, "root"]);
    // A literal that another instruction has overwritten is not the callee: movs r3, #1.
    let code = [Part::Is(0x4b01), Part::Is(0x2301), CALL_R3, RETURN];
    let functions = [
        with_data("root", &code, &[Word::Of("a")]),
        function("a", &[RETURN]),
    ];
    assert_reached(&functions, &[unknown, "root"]);
    assert_reached(
        &[calls_literal("root", Word::Is(0x9001))],
        &["unknown: code at 0x00009000, by", "root"],
    );
}

#[test]
fn an_undefined_instruction_is_a_trap_unless_after_a_call() {
    let functions = [function("root", &[NOP, Part::Is(0xde00)])];
    assert_reached(&functions, &["trap: an undefined instruction, by", "root"]);
    let functions = [
        function("root", &[Part::Call("a"), Part::Is(0xde00)]),
        function("a", &[Part::Is(0xe7fe)]),
    ];
    assert_free(&functions);
}

/// adr r1, table; ldr r0, [r1, r0]; mov pc, r0: the code of a `match`.
#[test]
fn a_jump_through_a_table_stays_in_its_function() {
    let table = [Part::Is(0xa101), Part::Is(0x5808), Part::Is(0x4687), RETURN];
    assert_free(&[with_data("root", &table, &[Word::Is(0x107)])]);
    let without_table = [NOP, NOP, Part::Is(0x4687), RETURN];
    let unknown = "unknown: a call through a register, by";
    assert_reached(&[function("root", &without_table)], &[unknown, "root"]);
}

/// Compilers use `bl` inside of a function where no other jump has the range.
#[test]
fn a_far_jump_within_a_function_is_not_recursion() {
    let far = [
        PUSH_R4_LR,
        Part::Is(0xf000),
        Part::Is(0xf801),
        NOP,
        NOP,
        POP_R4_PC,
    ]; // bl to the last
    let (status, out, _) = check(&[function("root", &far)], "root", &[]);
    assert_eq!(status, 0, "{out}");
    assert!(out.contains("stack: at most 8 bytes"), "{out}");
}

#[test]
fn the_stack_is_that_of_the_deepest_path() {
    let functions = [
        // push {r4, lr}; sub sp, #16; bl a; add sp, #16; bl b; pop {r4, pc}
        function(
            "root",
            &[
                PUSH_R4_LR,
                Part::Is(0xb084),
                Part::Call("a"),
                Part::Is(0xb004),
                Part::Call("b"),
                POP_R4_PC,
            ],
        ),
        function("a", &[Part::Is(0xb5f0), Part::Is(0xbdf0)]), // push, pop five: 8 + 16 + 20
        function(
            "b",
            &[
                Part::Is(0xb5f0),
                Part::Is(0xb081),
                Part::Is(0xb001),
                Part::Is(0xbdf0),
            ],
        ), // 8 + 24
    ];
    let (status, out, _) = check(&functions, "root", &[]);
    assert_eq!(status, 0, "{out}");
    assert!(out.contains("functions reached: 3"), "{out}");
    assert!(
        out.contains("stack: at most 44 bytes, of which\n        24 root\n        20 a\n"),
        "{out}"
    );
}

/// push {r4, lr}; ldr r4, [pc]; add sp, r4; …: the code for frames over 508 bytes.
#[test]
fn a_large_frame_comes_from_a_literal() {
    let code = [
        PUSH_R4_LR,
        Part::Is(0x4c01),
        Part::Is(0x44a5),
        Part::Is(0xe7fe),
    ];
    let frame = |word| [with_data("root", &code, &[Word::Is(word)])];
    let (status, out, _) = check(&frame(-1000_i32 as u32), "root", &[]);
    assert!(
        status == 0 && out.contains("stack: at most 1008 bytes"),
        "{out}"
    );
    let unknown = [function("root", &[PUSH_R4_LR, Part::Is(0x44a5), POP_R4_PC])];
    let (_, out, _) = check(&unknown, "root", &[]);
    assert!(
        out.contains("root moves its stack by amounts that are not constant"),
        "{out}"
    );
}

#[test]
fn a_function_that_pushes_in_a_loop_has_no_bound() {
    let functions = [function("root", &[PUSH_R4_LR, Part::Is(0xe7fd)])]; // b to the push
    let (_, out, _) = check(&functions, "root", &[]);
    assert!(
        out.contains("stack: no bound, as root moves its stack"),
        "{out}"
    );
}

#[test]
fn recursion_is_walked_once_and_has_no_bound() {
    let functions = [calls("root", "a"), calls("a", "root")];
    let (status, out, _) = check(&functions, "root", &[]);
    assert_eq!(status, 0, "{out}");
    assert!(out.contains("functions reached: 2"), "{out}");
    assert!(
        out.contains("stack: no bound, as root may call itself, directly or through others"),
        "{out}"
    );
}

/// If this fails, a check without anything to check passes.
#[test]
fn a_root_that_is_not_there_is_an_error() {
    let functions = [calls("module::root", "a"), function("a", &[RETURN])];
    let (status, out, err) = check(&functions, "other::root", &[]);
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(err.contains("matches the root `other::root`"), "{err}");
    assert!(err.contains("Names alike: module::root"), "{err}");
    let (_dir, elf) = firmware(&functions);
    let (status, _, err) = said(&inspect(&["panics", elf.to_str().unwrap()], &[]));
    assert_eq!(status, 2);
    assert!(err.contains("give --root NAME"), "{err}");
}

fn allowed(functions: &[Function], text: &str) -> (i32, String, String) {
    let dir = tempfile::tempdir().unwrap();
    let path: &Path = &dir.path().join("allow.toml");
    std::fs::write(path, text).unwrap();
    check(functions, "root", &["--allow", path.to_str().unwrap()])
}

fn entry(from: &str, to: &str, more: &str) -> String {
    format!("[[allow]]\nfrom = \"{from}\"\nto = \"{to}\"\nreason = \"never\"\n{more}\n")
}

#[test]
fn a_call_that_is_allowed_is_not_followed() {
    let functions = [calls("root", "a"), calls("a", PANIC), a_panic()];
    let (status, out, err) = allowed(&functions, &entry("a", "core::panicking::panic_fmt", ""));
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        out.contains("allowed: a → core::panicking::panic_fmt: never"),
        "{out}"
    );
    // The call of another function is not allowed.
    let (status, out, _) = allowed(&functions, &entry("root", "core::panicking::panic_fmt", ""));
    assert_eq!(status, 1);
    assert!(
        out.contains("never met: root → core::panicking::panic_fmt"),
        "{out}"
    );
}

#[test]
fn an_allowed_register_call_goes_to_the_listed_functions() {
    let functions = || {
        [
            function("root", &[PUSH_R4_LR, CALL_R3, POP_R4_PC]),
            calls("a", PANIC),
            function("b", &[PUSH_R4_LR, POP_R4_PC]),
            a_panic(),
        ]
    };
    let (status, out, _) = allowed(&functions(), &entry("root", "unknown", "calls = [\"b\"]"));
    assert_eq!(status, 0, "{out}");
    assert!(out.contains("stack: at most 16 bytes"), "{out}");
    let (status, out, _) = allowed(&functions(), &entry("root", "unknown", "calls = [\"a\"]"));
    assert_eq!(status, 1, "{out}");
    let (status, _, err) = allowed(&functions(), &entry("root", "unknown", "calls = [\"z\"]"));
    assert_eq!(status, 2);
    assert!(err.contains("no function's name matches `z`"), "{err}");
}

#[test]
fn an_entry_needs_a_reason() {
    let functions = [calls("root", PANIC), a_panic()];
    for text in [
        "[[allow]]\nfrom = \"root\"\nto = \"core\"\nreason = \" \"\n",
        "[[allow]]\nfrom = \"root\"\nto = \"core\"\n",
    ] {
        let (status, _, err) = allowed(&functions, text);
        assert_eq!(status, 2, "{err}");
        assert!(err.contains("reason"), "{err}");
    }
}

/// push {r0, r1}; ldr r0, [pc, #4]; str r0, [sp, #4]; pop {r0, pc}; then the address: the thunks of the linker.
#[test]
fn a_thunk_is_followed_to_its_function() {
    let code = [0xb403, 0x4801, 0x9001, 0xbd01].map(Part::Is);
    let thunk = with_data("__Thumbv6MABSLongThunk_a", &code, &[Word::Of("a")]);
    let functions = [
        calls("root", "__Thumbv6MABSLongThunk_a"),
        thunk,
        calls("a", PANIC),
        a_panic(),
    ];
    assert_reached(&functions, &[REACHED, "root", "a"]);
}
