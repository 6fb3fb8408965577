//! The board: an RP2040 with a 12 MHz crystal, its core at 125 MHz.
//!
//! What is soldered is here, and nothing that decides: [`pins`] is the one table of where everything is,
//! [`steps`] plays step edges, [`index`] times index pulses, [`guard`] cuts the drives when the enable input goes,
//! [`lines`] are the other safety lines and the lamp, [`alarm`] runs the loop at its deadlines, [`watchdog`] restarts a controller that hangs.
//!
//! Words: a *block* is one of the two PIO blocks, a *machine* one of its four state machines. A *cycle* is
//! one of the core's and of the machines' clock, 8 ns; a microsecond is one of the timer that the loop's
//! deadlines are on. Both come from the same crystal: a microsecond is 125 cycles, always.
//!
//! All that is unsafe in the image is in this folder, each time with the reason why it is sound.

pub mod alarm;
pub mod guard;
pub mod index;
pub mod lines;
pub mod pins;
pub mod steps;
pub mod watchdog;

/// The machine of the first block that times index pulses; those before it make steps.
const INDEX_MACHINE: usize = 3;

/// The machine of the second block that cuts the drives.
const GUARD_MACHINE: usize = 3;

/// Cycles to a microsecond.
pub const CYCLES_PER_US: u32 = cophase_core::settings::CLOCK_HZ / 1_000_000;

/// Whether an instant less than half an hour away has come: a tenth of what asking for the time costs.
pub fn is_past(instant: embassy_time::Instant) -> bool {
    now_us().wrapping_sub(instant.as_ticks() as u32) as i32 >= 0
}

/// The timer's microseconds, the lower half.
fn now_us() -> u32 {
    embassy_rp::pac::TIMER.timerawl().read()
}

/// An instruction of a program that does not lie at the beginning: a jump's address is counted from there.
const fn relocated(instruction: u16, origin: usize) -> u16 {
    const OPCODE: u16 = 0xE000;
    if instruction & OPCODE == 0 {
        instruction + origin as u16
    } else {
        instruction
    }
}
