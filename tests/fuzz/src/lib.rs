//! The loop under arbitrary feedback.
//!
//! An input is one tick of feedback; a *case* is a machine and [`TICKS`] of them in a row, both read from bytes by a
//! [`Script`]. Feedback that is random throughout never completes homing. So a script determines the disturbances of
//! an otherwise sound `Machine`, their duration, and the stretches of random feedback. `Watch` checks the conditions
//! that must hold for any feedback.
#![forbid(unsafe_code)]

mod draw;
mod machine;
mod script;
mod watch;

pub use script::Script;
pub use watch::Reached;

use machine::Machine;
use watch::Watch;

/// Ticks of a case: enough to home at the slowest, run, stop and start again.
pub const TICKS: u32 = 5000;

/// Plays the case of some bytes on a machine of `count` axes.
///
/// # Panics
/// If the loop panics, or a condition fails.
pub fn play(count: usize, bytes: &[u8]) -> Reached {
    let mut script = Script::new(bytes);
    let mut drawn = (0..100).map(|_| {
        let settings = draw::settings(count, &mut script);
        Some((draw::controller(&settings, &mut script)?, settings))
    });
    let (mut controller, settings) = drawn
        .find_map(|drawn| drawn)
        .expect("of a hundred machines one is accepted");
    let mut machine = Machine::new(&settings);
    let mut watch = Watch::new(&settings);
    while watch.reached().ticks < TICKS {
        machine.disturb(&mut script, &mut controller);
        let left = TICKS - watch.reached().ticks;
        for _ in 0..machine.quiet_ticks(&mut script).min(left) {
            let feedback = machine.feedback(&mut script);
            let output = controller.tick(&feedback);
            watch.check(&feedback, output);
            machine.play(output);
        }
    }
    watch.reached()
}
