//! Signals that end the command: files that are not finished are taken away first.

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
            if let Some(signal) = signals.forever().next() {
                host_sim::trace::RunFiles::take_all_away();
                std::process::exit(128 + signal);
            }
        });
    }
}
