//! Letting the machines of both blocks go at one instant.
//!
//! A block's machines begin in the cycle in which its control register is written; two registers are written
//! by two stores, one behind the other. They run from RAM with interrupts shut off, so that nothing can come
//! between: no fetch from flash, no handler.

use core::arch::asm;

use embassy_rp::pac;

/// Cycles from the first block's beginning to the second's: a store to these registers takes two.
pub const SKEW: u32 = 2;

/// Enables, when the timer comes to `at_us`, those machines of the first and the second block whose bits are
/// set, and no others. To be called with interrupts shut off and `at_us` less than 2³¹ µs ahead.
pub fn release(at_us: u32, first: u8, second: u8) {
    let timer = pac::TIMER.timerawl().as_ptr();
    let first_ctrl = pac::PIO0.ctrl().as_ptr();
    let second_ctrl = pac::PIO1.ctrl().as_ptr();
    // SAFETY: the addresses are those of the timer, and of the blocks' control registers, in which these
    // values do nothing but enable.
    unsafe {
        release_from_ram(
            timer.cast(),
            at_us,
            first_ctrl.cast(),
            first.into(),
            second_ctrl.cast(),
            second.into(),
        );
    }
}

#[unsafe(link_section = ".data.release")]
#[inline(never)]
unsafe extern "C" fn release_from_ram(
    timer: *const u32,
    at_us: u32,
    first_ctrl: *mut u32,
    first: u32,
    second_ctrl: *mut u32,
    second: u32,
) {
    // SAFETY: the caller's addresses are those of registers.
    unsafe {
        while (timer.read_volatile().wrapping_sub(at_us) as i32) < 0 {}
        asm!(
            "str {first}, [{first_ctrl}]",
            "str {second}, [{second_ctrl}]",
            first = in(reg) first,
            first_ctrl = in(reg) first_ctrl,
            second = in(reg) second,
            second_ctrl = in(reg) second_ctrl,
            options(nostack, preserves_flags),
        );
    }
}
