//! A refusal names key, problem and fix.

use std::path::Path;

use super::files::no_number;

/// Words with which a message states the fix, or the correct value.
const FIXES: [&str; 18] = [
    "give",
    "leave",
    "list ",
    "let ",
    "raise",
    "lower",
    "set ",
    "shorten",
    "swap",
    "is outside",
    "join",
    "use ",
    "part ",
    "at most",
    "start from",
    "put ",
    "damp",
    "or more",
];

/// Checks the lines that a refused scene prints.
pub fn check(err: &str, scene: &Path) -> Result<(), String> {
    let documented = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes.md");
    let documented = std::fs::read_to_string(documented).map_err(|error| error.to_string())?;
    let start = format!("cophase: {}", scene.display());
    // The duration of a run may be printed before the run is refused.
    let mut lines = err
        .lines()
        .filter(|line| !line.contains(" takes about "))
        .peekable();
    if lines.peek().is_none() {
        return Err("refused without a word".to_owned());
    }
    for line in lines {
        let wrong = |what: &str| Err(format!("a refusal {what}: {line}"));
        let Some(rest) = line.strip_prefix(&start) else {
            return wrong("does not name the file");
        };
        // The form is ":12: axes.ratio: problem". The line is left out where it is not available.
        let mut parts = rest.trim_start_matches(':').splitn(3, ": ");
        let mut key = parts.next().unwrap_or_default().trim();
        if key.is_empty() || key.bytes().all(|byte| byte.is_ascii_digit()) {
            key = parts.next().unwrap_or_default();
        }
        let problem = rest
            .split_once(&format!("{key}: "))
            .map_or("", |(_, problem)| problem);
        let path = key.split(' ').next().unwrap_or_default();
        let name = path.rsplit('.').next().unwrap_or_default();
        let name = name.split('[').next().unwrap_or_default();
        if name.is_empty() || !documented.contains(name) {
            return wrong("has a key that is not documented");
        }
        if !FIXES.iter().any(|fix| problem.contains(fix)) {
            return wrong("says nothing of what would be right");
        }
        no_number("a refusal", problem)?;
    }
    Ok(())
}
