//! A design as a scene: text that `cophase run` accepts.

use host_sim::setup::checked_from_text;

/// Reason why a design is not a scene that can be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("--scene: this design cannot be run: {problem}")]
pub struct NotRunnable {
    /// Problem of the scene, with the key and the fix.
    pub problem: String,
}

/// Returns the scene text of a design, after a check.
///
/// # Errors
/// A run would refuse the scene, for instance for a speed outside the range of scenes.
pub(super) fn runnable(text: String) -> Result<String, NotRunnable> {
    match checked_from_text(&text, None) {
        Ok(_) => Ok(text),
        Err(error) => Err(NotRunnable {
            problem: format!("{}: {}", error.key, error.problem),
        }),
    }
}

/// Aligns the comments behind values in one column.
pub(super) fn aligned(text: &str) -> String {
    const COLUMN: usize = 32;
    let line = |line: &str| match line.split_once(" #") {
        Some((value, comment)) if !value.is_empty() && !line.starts_with('#') => {
            format!("{:COLUMN$} #{comment}\n", value.trim_end())
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// A computed number with seven significant digits, as TOML takes it.
pub(super) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    format!("{rounded}")
}

/// Sentences as comment lines that fit a page.
pub(super) fn comment(text: &str) -> String {
    const WIDTH: usize = 100;
    let mut lines = String::new();
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.chars().count() + word.chars().count() + 1 > WIDTH {
            lines += &line;
            lines.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line += word;
    }
    lines + &line + "\n"
}
