//! Version of the command that writes a file: its release, and the commit from which it was built.

use std::sync::OnceLock;

/// Release of this package and of the command.
pub const RELEASE: &str = env!("CARGO_PKG_VERSION");

static COMMIT: OnceLock<&str> = OnceLock::new();

/// Sets the commit of this process's command. It is called once, at its start: only the command itself is compiled again for each commit.
pub fn set_commit(commit: &'static str) {
    // A second call has the same value.
    let _ = COMMIT.set(commit);
}

/// Returns the commit of the command; `unknown` outside the command, or if it was built outside a repository.
pub fn commit() -> &'static str {
    COMMIT.get().copied().unwrap_or("unknown")
}
