//! The board: an RP2040 with a 12 MHz crystal, its core at 125 MHz.
//!
//! This module contains hardware access and makes no decisions. [`pins`] is the one table of all pins, [`steps`] plays
//! step edges, and [`index`] times index pulses. [`guard`] switches off the drives when the enable input opens.
//! [`lines`] are the other safety lines and the LED. [`alarm`] runs the loop at its deadlines. [`watchdog`] resets a
//! controller that hangs. [`witness`] detects single faults of the board, by comparing facts that do not depend on each other;
//! [`failure`] is the one way in which such a fault, or a panic, ends. [`systick`] counts cycles. [`sampler`] copies telemetry for the
//! host link, and [`handover`] passes programs to the loop. [`from_ram`] copies the code that runs from RAM before all else, [`flash`] is
//! the flash as memory, and [`log`] writes frames of the log, over RTT.
//!
//! Terms: a *block* is one of the two PIO blocks, a *machine* one of its four state machines. A *cycle* is a clock cycle
//! of the core and the machines, 8 ns. A microsecond is a tick of the timer for the loop's deadlines. Both come from the
//! same crystal, so a microsecond is always 125 cycles.
//!
//! Unsafe code is in this folder, each time with the reason why it is sound. Elsewhere the compiler refuses it, unless the place expects
//! it with a reason: so does `control.rs`, which ensures that an output stays unchanged while hardware reads it.

pub mod alarm;
pub mod failure;
pub mod flash;
pub mod from_ram;
pub mod guard;
pub mod handover;
pub mod index;
pub mod lines;
pub mod log;
pub mod pins;
pub mod sampler;
pub mod steps;
pub mod systick;
pub mod watchdog;
pub mod witness;

use cophase_link::board::{Board as _, Rp2040};

/// Machine of the first block that times index pulses; those before it make steps.
const INDEX_MACHINE: usize = 3;

/// Machine of the second block that switches off the drives.
const GUARD_MACHINE: usize = 3;

/// Cycles per microsecond.
pub const CYCLES_PER_US: u32 = Rp2040::CLOCK_HZ / 1_000_000;

/// Returns true if an instant less than half an hour away has passed, in a tenth of the time of `Instant::now`.
pub fn has_passed(instant: embassy_time::Instant) -> bool {
    now_us().wrapping_sub(instant.as_ticks() as u32) as i32 >= 0
}

/// Lower word of the timer, in microseconds.
fn now_us() -> u32 {
    embassy_rp::pac::TIMER.timerawl().read()
}

/// Relocates an instruction of a program that starts at `origin`: jump addresses are absolute.
const fn relocated(instruction: u16, origin: usize) -> u16 {
    const OPCODE: u16 = 0xE000;
    if instruction & OPCODE == 0 {
        instruction + origin as u16
    } else {
        instruction
    }
}
