//! The judge of a campaign uses no code of the monitor that it judges.

use std::fs;
use std::path::Path;

/// Names that the judge's sources must not contain: gates and thresholds of the monitor, and its table of reactions.
const OF_THE_MONITOR: [&str; 4] = [
    "cophase_core::monitor",
    "supervisor::reaction",
    "place_gate",
    "Reaction",
];

/// Returns the lines of a source that name something of the monitor.
fn imports(text: &str) -> Vec<&str> {
    // A list in braces may span several lines, and may contain a module name.
    let squeezed: String = text.split_whitespace().collect();
    let listed = |path: &str| {
        let (parent, module) = path.rsplit_once("::").unwrap_or(("", path));
        let list = format!("{parent}::{{");
        let lists = squeezed.split(list.as_str()).skip(1);
        lists
            .filter_map(|rest| rest.split("};").next())
            .any(|list| {
                list.split([',', '{', '}'])
                    .any(|name| name == module || name.starts_with(&format!("{module}::")))
            })
    };
    OF_THE_MONITOR
        .into_iter()
        .filter(|path| squeezed.contains(path) || path.contains("::") && listed(path))
        .collect()
}

fn check(folder: &Path, read: &mut usize) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            check(&path, read);
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let found = imports(&text);
        assert!(found.is_empty(), "{}: {found:?}", path.display());
        *read += 1;
    }
}

/// If this fails, judge and monitor share a definition, and a mistake in it is not detected.
#[test]
fn no_source_of_the_judge_imports_the_monitor() {
    let mut read = 0;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/campaign");
    check(&folder, &mut read);
    assert!(read > 15, "{read} files");
}

/// If this fails, the test above overlooks a way to write an import.
#[test]
fn imports_are_found_however_they_are_written() {
    for text in [
        "use cophase_core::monitor::Modes;",
        "use cophase_core::{\n    monitor::Modes,\n    signals::Telemetry,\n};",
        "use cophase_core::{signals, monitor};",
        "use cophase_core::supervisor::{FaultKind, reaction};",
        "use cophase_core::supervisor::reaction::reaction;",
        "let done = cophase_core :: supervisor :: reaction(kind, true);",
        "use cophase_core::supervisor::{Reaction, State};",
    ] {
        assert!(!imports(text).is_empty(), "{text}");
    }
    assert!(
        imports("use cophase_core::supervisor::{FaultKind, State}; // a reaction, or monitor")
            .is_empty()
    );
}
