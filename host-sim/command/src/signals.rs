//! Signals that end the command: files that are not finished are taken away first.

use std::sync::atomic::{AtomicBool, Ordering};

/// True while a command ends its work by itself at the first SIGINT.
static IS_CAUGHT: AtomicBool = AtomicBool::new(false);
/// True once that has come.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on the first SIGINT ends no process. Returns whether it has come; the next one ends the process.
pub(crate) fn catch_interrupt() -> impl Fn() -> bool {
    IS_CAUGHT.store(true, Ordering::SeqCst);
    || IS_INTERRUPTED.load(Ordering::SeqCst)
}

/// Takes unfinished files away when SIGINT or SIGTERM comes, and ends the process with status 128 + signal: 130 or 143.
///
/// Elsewhere than on Unix it does nothing, and a command that is ended leaves hidden `.part` files.
pub fn clean_up_on_signals() {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGINT, SIGTERM};
        use signal_hook::iterator::Signals;

        // A command without this thread runs as well.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
            return;
        };
        std::thread::spawn(move || {
            for signal in signals.forever() {
                let is_caught = signal == SIGINT && IS_CAUGHT.load(Ordering::SeqCst);
                if is_caught && !IS_INTERRUPTED.swap(true, Ordering::SeqCst) {
                    continue;
                }
                host_sim::trace::RunFiles::take_all_away();
                std::process::exit(128 + signal);
            }
        });
    }
}
