//! `docs/code-walk.md` names functions that exist, in the files that it links to.

use std::fs;
use std::path::Path;

/// If this fails, a function of the walk was renamed or moved, and a newcomer does not find it.
#[test]
fn functions_of_the_walk_are_in_their_files() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let walk = fs::read_to_string(docs.join("code-walk.md")).unwrap();
    let mut steps = 0;
    for line in walk
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains("](../"))
    {
        let cells: Vec<&str> = line.split(" | ").collect();
        let [_, function, file] = cells[..] else {
            panic!("a step has three cells: {line}");
        };
        let function = function.trim_matches('`');
        let path = file
            .split_once("](")
            .and_then(|(_, rest)| rest.split_once(')'));
        let path = docs.join(path.expect("a link").0);
        let text =
            fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let is_there = ["(", "<"]
            .iter()
            .any(|end| text.contains(&format!("fn {function}{end}")));
        assert!(is_there, "{} has no fn {function}", path.display());
        steps += 1;
    }
    assert!(steps > 20, "both tables were read");
}
