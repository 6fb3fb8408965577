//! Starts the machines of both blocks at one instant.
//!
//! A block's machines start in the cycle in which its control register is written. Two consecutive stores write the two
//! registers. They run from RAM with interrupts disabled, so that no fetch from flash and no handler can come between.
//!
//! Another master of the bus or a debugger may still delay the stores. The blocks are then apart, and all ticks late.
//! The core's own counter shows this ([`systick`]).

use core::arch::asm;

use embassy_rp::pac;

use crate::board::systick;

/// Cycles from the first block's start to the second's: a store to these registers takes two.
pub const SKEW: u32 = 2;

/// Cycles from the timer's last reading before its time to the start of both blocks. It takes 36, and may take
/// less than a quarter of a microsecond more.
const MAX_CYCLES: u32 = 64;

/// Readings of the timer before its time, ten cycles or more each: over 100 µs, more than the wait takes.
const MAX_READINGS: u32 = 1250;

/// Enables the machines of the first and the second block whose bits are set, and no others, when the timer reaches
/// `at_us`. Returns true if that was in time. To be called with interrupts disabled and `at_us` at most 50 µs ahead: the wait for a timer
/// that stands ends, too.
#[must_use]
pub fn release(at_us: u32, first: u8, second: u8) -> bool {
    let timer = pac::TIMER.timerawl().as_ptr();
    let first_ctrl = pac::PIO0.ctrl().as_ptr();
    let second_ctrl = pac::PIO1.ctrl().as_ptr();
    // SAFETY: the addresses are those of the timer, and of the blocks' control registers, in which these values only
    // enable machines.
    let took = unsafe {
        let_go(
            timer.cast(),
            at_us,
            first_ctrl.cast(),
            first.into(),
            second_ctrl.cast(),
            second.into(),
        )
    };
    took <= MAX_CYCLES
}

#[inline(never)]
unsafe extern "C" fn let_go(
    timer: *const u32,
    at_us: u32,
    first_ctrl: *mut u32,
    first: u32,
    second_ctrl: *mut u32,
    second: u32,
) -> u32 {
    // SAFETY: the caller's addresses are those of registers.
    unsafe {
        // Count at the last reading before the time. None if the time had passed at the first reading, or did not come.
        let mut before = None;
        let mut readings = MAX_READINGS;
        loop {
            let now = systick::count();
            if (timer.read_volatile().wrapping_sub(at_us) as i32) >= 0 {
                break;
            }
            before = Some(now);
            readings -= 1;
            if readings == 0 {
                before = None;
                break;
            }
        }
        asm!(
            "str {first}, [{first_ctrl}]",
            "str {second}, [{second_ctrl}]",
            first = in(reg) first,
            first_ctrl = in(reg) first_ctrl,
            second = in(reg) second,
            second_ctrl = in(reg) second_ctrl,
            options(nostack, preserves_flags),
        );
        let after = systick::count();
        match before {
            Some(before) => systick::cycles(before, after),
            None => u32::MAX,
        }
    }
}
