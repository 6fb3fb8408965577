//! Names of functions: matching by a pattern, and recognition of panics.
//!
//! Rust's two manglings write generic functions differently: `Controller<_>::tick` or
//! `<Controller<4>>::tick`. Here a *plain* name has no generic arguments, `Controller::tick`, and both
//! patterns and names are compared as plain ones.

/// The name without generic arguments, and without the angles around the type of an inherent `impl`.
///
/// The type and the trait of a trait's `impl` stay: `<Board as Io>::read`.
pub fn plain(name: &str) -> String {
    let mut out = String::new();
    let mut chars = name.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        if c != '<' {
            out.push(c);
            continue;
        }
        let Some(inside) = angles(&name[at..]) else {
            out.push(c); // an operator, or not a Rust name
            continue;
        };
        while chars
            .next_if(|&(i, _)| i <= at + 1 + inside.len())
            .is_some()
        {}
        let generic = name[..at].ends_with(|before: char| {
            before.is_alphanumeric() || matches!(before, '_' | ':' | '}')
        });
        if let Some(implemented) = inside.strip_prefix("impl ") {
            // The older mangling names an impl by its module. That name is not part of a path.
            out = match implemented.split_once(" for ") {
                Some((of, to)) => format!("<{} as {}>", plain(to), plain(of)),
                None => plain(implemented),
            };
        } else if generic {
            let trimmed = out.trim_end_matches("::").len();
            out.truncate(trimmed);
        } else if inside.contains(" as ") {
            out.push_str(&format!("<{}>", plain(inside)));
        } else {
            out.push_str(&plain(inside));
        }
    }
    out
}

/// Text between an opening angle and the one that closes it; `->` closes nothing.
fn angles(text: &str) -> Option<&str> {
    let mut depth = 0;
    let mut before = ' ';
    for (i, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if before != '-' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(&text[1..i]);
        }
        before = c;
    }
    None
}

/// Matches a pattern with a function's name: its path, or a part of it from the beginning of one segment to
/// the end of another. So a function's closures are matched with it.
pub fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (plain(pattern), plain(name));
    if pattern.is_empty() {
        return false;
    }
    let part_of_segment = |c: char| c.is_alphanumeric() || c == '_';
    name.match_indices(&pattern).any(|(at, found)| {
        let before = name[..at].chars().next_back();
        let after = name[at + found.len()..].chars().next();
        !before.is_some_and(part_of_segment) && !after.is_some_and(part_of_segment)
    })
}

/// Paths below which every function is a panic, or belongs to one.
const PANIC_PATHS: [&str; 5] = [
    "core::panicking",
    "core::panic",
    "std::panicking",
    "defmt::export::panic",
    "defmt::panic",
];

/// Primitive types that have functions of their own.
const PRIMITIVES: [&str; 17] = [
    "bool", "char", "f32", "f64", "i128", "i16", "i32", "i64", "i8", "isize", "str", "u128", "u16",
    "u32", "u64", "u8", "usize",
];

/// Functions that do not return, by their symbols.
const TRAPS: [&str; 9] = [
    "rust_begin_unwind",
    "rust_panic",
    "_defmt_panic",
    "__aeabi_idiv0",
    "__aeabi_ldiv0",
    "__udf",
    "abort",
    "cortex_m::asm::udf",
    "core::intrinsics::abort",
];

/// Recognizes functions that the linker inserts between two that are too far from each other for a jump.
pub fn is_thunk(name: &str) -> bool {
    name.starts_with("__Thumbv6M")
}

/// Recognizes functions that a panic consists of, and traps.
pub fn is_panic(name: &str) -> bool {
    let plain = plain(name);
    let path = plain.trim_start_matches("__rustc::");
    let below = |root: &&str| {
        path.strip_prefix(*root)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
    };
    // In the libraries of the language, a function with such a name only panics: unwrap_failed,
    // slice_index_fail, panic_already_borrowed, panic_const_div_by_zero, …
    let last = path.rsplit("::").next().unwrap_or(path);
    // Impls for types like [T], str or u32 are named by the type alone.
    let first = path.split("::").next().unwrap_or(path);
    let of_language = path.contains("::")
        && (first == "core"
            || first == "alloc"
            || first.starts_with('[')
            || PRIMITIVES.contains(&first));
    let by_name = last.contains("panic") || last.contains("_fail") || last == "handle_alloc_error";
    PANIC_PATHS.iter().any(below) || TRAPS.contains(&path) || of_language && by_name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_have_no_generic_arguments() {
        for (name, expected) in [
            ("a::b", "a::b"),
            ("a::Controller<_>::tick", "a::Controller::tick"),
            ("<a::Controller<4>>::tick", "a::Controller::tick"),
            (
                "<a::C<heapless::Vec<u8, 4>>>::f::<u8>::{closure#0}",
                "a::C::f::{closure#0}",
            ),
            (
                "<a::Board<4> as b::Io<4>>::read",
                "<a::Board as b::Io>::read",
            ),
            ("a::run::<4, <T as b::Io>::X>", "a::run"),
            ("a::call::<fn(u8) -> u8>::it", "a::call::it"),
            ("a::<impl b::Settings<N>>::check", "b::Settings::check"),
            (
                "a::<impl b::Io<4> for c::Board<4>>::read",
                "<c::Board as b::Io>::read",
            ),
            ("__aeabi_memcpy", "__aeabi_memcpy"),
            ("odd < name", "odd < name"),
        ] {
            assert_eq!(plain(name), expected, "{name}");
        }
    }

    #[test]
    fn patterns_match_whole_segments() {
        let name = "<cophase_core::controller::Controller<4>>::tick::{closure#0}";
        for pattern in [
            "cophase_core::controller::Controller<_>::tick",
            "controller::Controller::tick",
            "tick",
        ] {
            assert!(matches(pattern, name), "{pattern}");
        }
        for pattern in [
            "",
            "tic",
            "roller::Controller",
            "Controller::late",
            "Controller::ticks",
        ] {
            assert!(!matches(pattern, name), "{pattern}");
        }
        assert!(matches("Io>::read", "<board::Board<4> as Io<4>>::read"));
    }

    /// If this fails, a panic is walked through as if it returned, or a function is taken for one.
    #[test]
    fn panics_are_known_by_their_names() {
        for name in [
            "core::panicking::panic_fmt",
            "core::panicking::panic_const::panic_const_div_by_zero",
            "__rustc::rust_begin_unwind",
            "core::result::unwrap_failed",
            "core::option::expect_failed",
            "core::slice::index::slice_end_index_len_fail",
            "core::str::slice_error_fail_rt",
            "core::cell::panic_already_borrowed",
            "<str>::slice_fail",
            "<[u8]>::copy_from_slice::len_mismatch_fail",
            "core::slice::<impl [T]>::copy_from_slice::len_mismatch_fail",
            "_defmt_panic",
            "defmt::export::panic",
            "__aeabi_ldiv0",
        ] {
            assert!(is_panic(name), "{name}");
        }
        for name in [
            "core::slice::memchr::memchr",
            "core::panic_free::f",
            "cophase_core::supervisor::fault::Fault::new",
            "own::open_failed",
            "main",
        ] {
            assert!(!is_panic(name), "{name}");
        }
    }
}
