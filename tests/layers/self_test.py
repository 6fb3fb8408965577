"""Mistakes that the check must find, each beside the same crate without it."""
import pathlib
import tempfile

from layers import check
from source import requires_test, tokens

ROWS = '[a-crate]\nrows = [["low", "beside"], ["high"]]\n'
# A sound crate: `high` imports `low`. Cases replace files of it.
SOUND = {
    'src/lib.rs': 'pub mod low;\npub mod high;\nmod beside;\npub use high::High;\npub use low::Low;\n',
    'src/low/mod.rs': 'pub mod inner;\npub struct Low;\nimpl Low { pub fn value(&self) -> u32 { 1 } }\n',
    'src/low/inner.rs': 'use super::Low;\npub fn make() -> Low { Low }\n',
    'src/high.rs': 'use crate::low::{Low, inner};\npub struct High(pub Low);\npub fn make() -> High { High(inner::make()) }\n',
    'src/beside.rs': 'pub struct Beside;\n',
}


def problems(files, layers='', package='[package]\nname = "a-crate"\n'):
    """Problems of a workspace with one crate of these files."""
    with tempfile.TemporaryDirectory() as folder:
        workspace = pathlib.Path(folder).resolve()
        texts = {'Cargo.toml': '[workspace]\nmembers = ["crates/*"]\n', 'layers.toml': layers, 'crates/a/Cargo.toml': package}
        texts |= {f'crates/a/{name}': text for name, text in files.items()}
        for name, text in texts.items():
            file = workspace / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return check(workspace, workspace / 'layers.toml')[0]


def low(text):
    """The sound crate with more in a file of `low`, which must not import `high`."""
    return {**SOUND, 'src/low/inner.rs': SOUND['src/low/inner.rs'] + text}


# Code that makes `low` import `high`, which imports `low`.
UPWARD = {
    'use': 'use crate::high::High;\n',
    'use of a module': 'use crate::high;\n',
    'use of all of a module': 'use crate::high::*;\n',
    'use with another name': 'use crate::high::High as Other;\n',
    'public use': 'pub use crate::high::High;\n',
    'use in a function': 'fn f() { use crate::high::make; make(); }\n',
    'nested use': 'use crate::{beside::Beside, high::{self, High}};\n',
    'deeply nested use': 'use crate::{beside::{Beside}, low::{Low as L, inner as i}, high::{High}};\n',
    'nested use over lines': 'use crate::{\n    beside::Beside, // of no row above\n    high::High,\n};\n',
    'path in code': 'fn f() { let _ = crate::high::make(); }\n',
    'path in a type': 'fn f(_: &crate::high::High) {}\n',
    'path with arguments': 'fn f() -> Vec<crate::high::High> { Vec::<crate::high::High>::new() }\n',
    'path in a macro': 'macro_rules! m { () => { $crate::high::make() } }\n',
    'path in a macro call': 'fn f() { assert!(matches!(1, crate::high::LIMIT)); }\n',
    'path in an attribute of an item that is no test': '#[cfg(any(test, feature = "x"))]\nuse crate::high::High;\n',
    'super': 'use super::super::high::High;\n',
    'super in code': 'fn f() { super::super::high::make(); }\n',
    'super in a nested use': 'use super::super::{beside::Beside, high::High};\n',
    'super in a module within': 'mod m { use super::super::super::high::High; }\n',
    'path within a module within': 'mod m { fn f() { crate::high::make(); } }\n',
    'name of a root that re-exports it': 'use crate::High;\n',
    'name of a root in code': 'fn f(_: crate::High) {}\n',
    'name of a root by super': 'use super::super::High;\n',
    'all of a root': 'use crate::*;\nfn f(_: High) {}\n',
    'after a lifetime and a character': "fn f<'a>(_: &'a str) -> char { '\"' }\nuse crate::high::High;\nconst Q: char = '\"';\n",
    'after a string with a comment in it': 'const S: &str = "/* // ";\nuse crate::high::High;\n',
    'after a raw string': 'const S: &str = r#"quotation mark: " "#;\nuse crate::high::High;\n',
    'after nested comments': '/* a /* b */ " */\nuse crate::high::High;\n',
    'after tests': '#[cfg(test)]\nmod tests { fn f() { let x = "}"; } }\nuse crate::high::High;\n',
    'after a test of one line': '#[cfg(test)]\nmod tests;\nuse crate::high::High;\n',
    'after a field of tests': 'struct S { #[cfg(test)] a: (u8, u8), b: u8 }\nuse crate::high::High;\n',
    'field after one of tests': 'struct S { #[cfg(test)] a: (u8, u8), b: crate::high::High }\n',
    'in an impl of an array': 'impl Trait<crate::high::High> for [Low; 3] {}\n',
    'inherent impl': 'impl crate::high::High { fn more(&self) {} }\n',
    'inherent impl of a name from a root': 'impl<T: Clone> crate::High {}\n',
    'impl of a trait': 'impl Clone for crate::high::High { fn clone(&self) -> Self { loop {} } }\n',
    'impl of a trait from above': 'impl crate::high::Trait<u8> for Low {}\n',
    'condition of an impl': 'impl<T> Trait for T where T: Into<crate::high::High> {}\n',
}
# Code of `low` that imports nothing from above.
DOWNWARD = {
    'comment': '// use crate::high::High;\n',
    'documentation': '/// See [`crate::high::High`].\nfn f() {}\n',
    'block comment': '/* use crate::high::High; /* nested */ crate::high::make() */\n',
    'string': 'const S: &str = "crate::high::High \\" crate::high";\n',
    'raw string': 'const S: &str = r#"crate::high"High"#;\n',
    'bytes': 'const S: &[u8] = b"crate::high::High";\n',
    'tests': '#[cfg(test)]\nmod tests { use crate::high::High; }\n',
    'use of tests': '#[cfg(test)]\nuse crate::high::{High, make};\n',
    'function of tests': '#[test]\nfn f() { crate::high::make(); }\n',
    'tests with a feature': '#[cfg(all(test, feature = "x"))]\nmod tests { use crate::high::High; }\n',
    'field of tests': 'struct S { #[cfg(test)] a: crate::high::High, b: u8 }\n',
    'own folder': 'use crate::low::Low as Mine;\nuse super::*;\nuse self::super::Low as Other;\n',
    'visibility': 'pub(in crate::low) fn f() {}\n',
    'folder of its row': 'use crate::beside::Beside;\n',
    'name from a root of its own folder': 'use crate::Low as Mine;\n',
    'another crate': 'use high::High;\nfn f() { other::high::make(); }\n',
    'a module within of the same name': 'mod high { pub struct High; }\nuse high::High;\n',
    'all of a root, without names from above': 'use crate::*;\nfn f(_: Beside) {}\n',
    'impl of an own type': 'impl Low { fn more(&self) {} }\nimpl Clone for Low { fn clone(&self) -> Self { Low } }\n',
    'impl Trait in a type': 'fn f(_: impl Clone) -> impl Iterator<Item = u8> + use<> { 0..1 }\n',
}


def finds(files, text, layers=ROWS):
    found = problems(files, layers)
    assert any(text in one for one in found), (text, found)


def circles():
    for name, code in UPWARD.items():
        found = problems(low(code))
        assert len(found) == 1 and 'a circle of 2 folders: high, low' in found[0], (name, found)
        assert 'crates/a/src/low/inner.rs:' in found[0], (name, found)
    for name, code in DOWNWARD.items():
        assert problems(low(code)) == [], (name, problems(low(code)))
    # The line is that of the code.
    finds(low('\n\n/* a\n b */\nfn f(_: crate::high::High) {}\n'), 'src/low/inner.rs:7: crate::high::High', '')
    # Three folders, of which no two import each other.
    three = {**SOUND, 'src/low/inner.rs': 'use crate::beside::Beside;\n', 'src/beside.rs': 'use crate::high::High;\n'}
    finds(three, 'a circle of 3 folders: beside, high, low', '')
    # A folder and an item of the root that uses it.
    root = {**SOUND, 'src/lib.rs': SOUND['src/lib.rs'] + 'pub struct Whole(beside::Beside);\n'}
    assert problems(root) == []
    finds({**root, 'src/beside.rs': 'use crate::Whole;\npub struct Beside;\n'}, 'a circle of 2 folders: beside, the root', '')
    constant = {**SOUND, 'src/lib.rs': SOUND['src/lib.rs'] + 'const C: u8 = 1;\n', 'src/low/inner.rs': 'use crate::C;\n'}
    assert problems(constant) == [], 'a root that only re-exports the folder'
    # Files elsewhere, and in modules within.
    path = {**SOUND, 'src/lib.rs': 'mod low;\nmod high;\n#[path = "elsewhere/x.rs"]\nmod beside;\n', 'src/elsewhere/x.rs': 'use crate::high::High;\n'}
    finds({**path, 'src/low/inner.rs': 'use crate::beside::X;\n'}, 'a circle of 3 folders', '')
    inline = {**SOUND, 'src/low/inner.rs': 'mod within { mod file; }\n', 'src/low/inner/within/file.rs': 'use crate::high::High;\n'}
    finds(inline, 'a circle of 2 folders: high, low', '')
    finds({**SOUND, 'src/beside.rs': 'mod absent;\n'}, 'src/beside.rs: mod absent has no file', '')
    # An exported macro is named by the root, and is of the folder that defines it.
    macro = {**SOUND, 'src/high.rs': SOUND['src/high.rs'] + '#[macro_export]\nmacro_rules! above { () => {} }\n'}
    assert problems(macro) == []
    finds({**macro, 'src/low/inner.rs': 'fn f() { crate::above!(); }\nuse crate::above;\n'}, 'a circle of 2 folders: high, low', '')


def methods():
    """A method that a folder adds to the type of a lower one."""
    added = {**SOUND, 'src/high.rs': SOUND['src/high.rs'] + 'impl Low { pub fn raised(&self) -> High { High(Low) } fn value_of() {} }\n'}
    assert problems(added, ROWS) == []
    by_folder = 'Low::raised, a method from there'
    for call in ('self.raised();', 'Low.raised();', 'Low::raised(&Low);', 'Self::raised(self);', 'let f = [Low].map(|low| low.raised());'):
        finds({**added, 'src/low/inner.rs': f'use super::Low;\nimpl Low {{ fn f(&self) {{ {call} }} }}\n'}, by_folder, ROWS)
    other = 'pub struct Other;\nimpl Other { fn raised(&self) {} fn f(&self) { self.raised(); } }\n'
    assert problems({**added, 'src/low/inner.rs': other}, ROWS) == [], 'another method of this name'
    iterator = {**SOUND, 'src/high.rs': SOUND['src/high.rs'] + 'impl Iterator for Low { type Item = u8; fn next(&mut self) -> Option<u8> { None } }\n'}
    assert problems({**iterator, 'src/low/inner.rs': 'fn f(mut all: Vec<u8>) { all.iter().next(); }\n'}, ROWS) == [], 'a method of a trait'
    of_trait = {**SOUND, 'src/high.rs': SOUND['src/high.rs'] + 'trait Raise { fn raised(&self); }\nimpl Raise for Low { fn raised(&self) {} }\n'}
    assert problems(of_trait, ROWS) == []


def layers():
    assert problems(SOUND, ROWS) == []
    one_way = {**SOUND, 'src/high.rs': 'pub struct High;\npub trait Trait {}\npub fn make() -> High { High }\n'}
    for name, code in UPWARD.items():
        files = {**one_way, 'src/low/inner.rs': SOUND['src/low/inner.rs'] + code}
        assert problems(files) == [], (name, problems(files))  # without layers it is no mistake
        found = problems(files, ROWS)
        assert found and all('high is above low' in one for one in found), (name, found)
    for name, code in DOWNWARD.items():
        files = {**one_way, 'src/low/inner.rs': SOUND['src/low/inner.rs'] + code}
        assert problems(files, ROWS) == [], (name, problems(files, ROWS))
    # The type may be known by its import, or by that of a whole module.
    for code in ('use crate::high::High;\nimpl High {}\n', 'use crate::high::*;\nimpl High {}\n', 'use crate::{High as Other};\nimpl Drop for Other {}\n',
                 'use crate::high::High;\nimpl<T: Into<u8>> High {}\n', 'use crate::high::{self};\nimpl high::High {}\n'):
        finds({**one_way, 'src/low/inner.rs': code}, ': impl for ')
    assert problems({**SOUND, 'src/high.rs': SOUND['src/high.rs'] + 'impl Low {}\nimpl Drop for Low {}\n'}, ROWS) == []
    # Two folders of a row may import each other one way, and not both ways.
    beside = {**SOUND, 'src/beside.rs': 'use crate::low::Low;\n'}
    assert problems(beside, ROWS) == []
    finds({**beside, 'src/low/inner.rs': 'use crate::beside::B;\n'}, 'a circle of 2 folders: beside, low')
    # The list itself.
    finds(SOUND, 'has no row for its folder beside', '[a-crate]\nrows = [["low"], ["high"]]\n')
    finds(SOUND, 'has no folder lower', '[a-crate]\nrows = [["low", "lower", "beside"], ["high"]]\n')
    finds(SOUND, 'has low twice', '[a-crate]\nrows = [["low", "beside"], ["high", "low"]]\n')
    finds(SOUND, 'there is no crate b-crate', '[b-crate]\nrows = []\n')


def targets():
    """All programs of a package are read, and tests wholly."""
    program = {'{}main.rs': 'mod a;\nmod b;\n', '{}a.rs': 'use crate::b::B;\npub struct A;\n', '{}b.rs': '#[test]\nfn f() { crate::a::A; }\n'}
    inside = {place: {name.format(place): text for name, text in program.items()} for place in ('src/', 'tests/x/', 'elsewhere/')}
    assert problems({**inside['src/']}) == [], 'the test of a program'
    finds({**SOUND, **inside['tests/x/']}, 'tests/x/main.rs: a circle of 2 folders: a, b', '')
    named = '[package]\nname = "a-crate"\n[[test]]\nname = "x"\npath = "elsewhere/main.rs"\n'
    found = problems({**SOUND, **inside['elsewhere/']}, '', named)
    assert len(found) == 1 and 'elsewhere/main.rs: a circle' in found[0], found
    library = '[package]\nname = "a-crate"\n[lib]\npath = "own/lib.rs"\n'
    moved = {name.replace('src/', 'own/'): text for name, text in low(UPWARD['use']).items()}
    assert len(problems(moved, '', library)) == 1


def reading():
    texts = [token.text for token in tokens("fn f<'a>(c: &'a [u8; 0x1F]) { b'\\''; 1.5e3; 0..n; x.0.y; r#type; \"\\\\\" }")]
    assert texts == ['fn', 'f', '<', "'a", '>', '(', 'c', ':', '&', "'a", '[', 'u8', ';', '0x1F', ']', ')', '{', "b'\\''", ';', '1.5e3', ';', '0', '.', '.', 'n', ';', 'x', '.', '0', '.', 'y', ';', 'type', ';', '"\\\\"', '}'], texts
    for condition, expected in (('test', True), ('all(unix,test)', True), ('any(test,unix)', False), ('not(test)', False), ('all(any(test,unix),all(a,test))', True), ('feature="test"', False)):
        assert requires_test(condition) == expected, condition


def run():
    """Runs all tests; 0 if they pass."""
    parts = (reading, circles, methods, layers, targets)
    for part in parts:
        part()
    print(f'{len(UPWARD)} ways to import are found, {len(DOWNWARD)} that look alike are not; {len(parts)} parts pass')
    return 0
