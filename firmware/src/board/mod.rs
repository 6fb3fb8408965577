//! The board: an RP2040 with a 12 MHz crystal, its core at 125 MHz.
//!
//! What is soldered is here, and nothing that decides: [`pins`] is the one table of where everything is,
//! [`steps`] plays step edges, [`index`] times index pulses, [`lines`] are the safety lines and the lamp,
//! [`watchdog`] restarts a controller that hangs.
//!
//! Words: a *block* is one of the two PIO blocks, a *machine* one of its four state machines. A *cycle* is
//! one of the core's and of the machines' clock, 8 ns; a microsecond is one of the timer that the loop's
//! deadlines are on. Both come from the same crystal: a microsecond is 125 cycles, always.
//!
//! All that is unsafe in the image is in this folder, each time with the reason why it is sound.

pub mod index;
pub mod lines;
pub mod pins;
pub mod steps;
pub mod watchdog;

/// The machine of the first block that times index pulses; those before it make steps.
const INDEX_MACHINE: usize = 3;

/// Cycles to a microsecond.
pub const CYCLES_PER_US: u32 = cophase_core::settings::CLOCK_HZ / 1_000_000;

/// The timer's microseconds, the lower half.
fn now_us() -> u32 {
    embassy_rp::pac::TIMER.timerawl().read()
}
