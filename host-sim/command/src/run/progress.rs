//! Progress of a run.

use indicatif::{ProgressBar, ProgressStyle};

/// Creates a progress bar. It shows on a terminal only, and only in a long run.
pub(super) fn progress_bar(quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    // indicatif draws to stderr, and only if that is a terminal.
    let style =
        ProgressStyle::with_template("{wide_bar} {percent:>3} %  {elapsed} gone, {eta} to go");
    ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
