//! Signals that end the command. Unfinished files are removed first.

use std::sync::atomic::{AtomicBool, Ordering};

/// True while a command ends its work by itself at the first SIGINT.
static IS_CAUGHT: AtomicBool = AtomicBool::new(false);
/// True once this SIGINT has arrived.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Catches the first SIGINT, which then does not end the process. The next one does. Returns a function that is true
/// once the first one has arrived.
pub(crate) fn catch_interrupt() -> impl Fn() -> bool {
    IS_CAUGHT.store(true, Ordering::SeqCst);
    || IS_INTERRUPTED.load(Ordering::SeqCst)
}

/// Removes unfinished files when SIGINT or SIGTERM arrives, and ends the process with status 128 + signal: 130 or 143.
///
/// On systems other than Unix, it does nothing, and a command that is ended leaves hidden `.part` files.
pub fn clean_up_on_signals() {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGINT, SIGTERM};
        use signal_hook::iterator::Signals;

        // The command also runs without this thread.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
            return;
        };
        std::thread::spawn(move || {
            for signal in signals.forever() {
                let is_caught = signal == SIGINT && IS_CAUGHT.load(Ordering::SeqCst);
                if is_caught && !IS_INTERRUPTED.swap(true, Ordering::SeqCst) {
                    continue;
                }
                cophase_files::trace::RunFiles::take_all_away();
                std::process::exit(128 + signal);
            }
        });
    }
}
