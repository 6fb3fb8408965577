//! The list of published figures. Each is within its tolerance, and the test that it names exists.

use std::path::Path;

use cophase_lab::reproduced::{Tolerance, sections, write_page};

/// If this fails, `docs/reproduced.md` claims a figure that is not reached.
#[test]
fn figures_are_within_their_tolerances() {
    let mut compared = 0;
    for section in sections().unwrap() {
        for figure in &section.figures {
            assert_eq!(figure.published.len(), figure.ours.len(), "{figure:?}");
            assert!(
                figure.ours.iter().all(|ours| ours.is_finite()),
                "{figure:?}"
            );
            assert!(figure.is_within(), "{}: {figure:?}", section.title);
            let has_reason = !figure.note.is_empty();
            assert!(
                figure.tolerance != Tolerance::NotReproduced || has_reason,
                "{figure:?} has no reason"
            );
            compared += figure.ours.len();
        }
    }
    assert!(compared > 100, "{compared} values");
}

/// If this fails, the page names a test that was renamed or removed.
#[test]
fn named_tests_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for section in sections().unwrap() {
        for figure in &section.figures {
            let (file, name) = figure.test;
            let text = std::fs::read_to_string(root.join(file)).unwrap();
            assert!(text.contains(&format!("fn {name}()")), "{file}: {name}");
        }
    }
}

/// If this fails, the committed page differs from the command's output. To write it again:
/// `cophase reproduced --out docs/reproduced.md`.
#[test]
fn the_page_is_up_to_date() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reproduced.md");
    let committed = std::fs::read_to_string(page).unwrap();
    assert_eq!(write_page(&sections().unwrap()), committed);
}
