//! Letting the machines of both blocks go at one instant.
//!
//! A block's machines begin in the cycle in which its control register is written; two registers are written
//! by two stores, one behind the other. They run from RAM with interrupts shut off, so that nothing can come
//! between: no fetch from flash, no handler.
//!
//! Should something hold them up all the same (another master of the bus, a debugger), blocks are apart, and all
//! ticks late. The core's own counter, SysTick, tells: it counts every cycle, and is for nothing else.

use core::arch::asm;

use cortex_m::peripheral::SYST;
use embassy_rp::pac;

/// Cycles from the first block's beginning to the second's: a store to these registers takes two.
pub const SKEW: u32 = 2;

/// From the timer's last look before its time to both blocks let go, cycles: it takes 36, and may not take more by a
/// quarter of a microsecond.
const MOST_CYCLES: u32 = 64;

/// SysTick's bits.
const COUNT: u32 = 0xFF_FFFF;

/// Lets SysTick count.
#[cold]
pub fn set_up() {
    const ENABLE: u32 = 1;
    const CORE_CLOCK: u32 = 1 << 2;
    // SAFETY: nothing else uses SysTick; it raises no exception.
    unsafe {
        (*SYST::PTR).rvr.write(COUNT);
        (*SYST::PTR).cvr.write(0);
        (*SYST::PTR).csr.write(ENABLE | CORE_CLOCK);
    }
}

/// Enables, when the timer comes to `at_us`, those machines of the first and the second block whose bits are
/// set, and no others; says whether that was in time. To be called with interrupts shut off and `at_us` less than
/// 2³¹ µs ahead.
#[must_use]
pub fn release(at_us: u32, first: u8, second: u8) -> bool {
    let timer = pac::TIMER.timerawl().as_ptr();
    let first_ctrl = pac::PIO0.ctrl().as_ptr();
    let second_ctrl = pac::PIO1.ctrl().as_ptr();
    // SAFETY: the addresses are those of the timer, and of the blocks' control registers, in which these
    // values do nothing but enable.
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
    took <= MOST_CYCLES
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
    // SAFETY: the caller's addresses are those of registers, and SysTick's is its own.
    unsafe {
        let counter = (&raw const (*SYST::PTR).cvr).cast::<u32>();
        // When the timer was not there yet; never, if it was from the first look on.
        let mut before = None;
        loop {
            let now = counter.read_volatile();
            if (timer.read_volatile().wrapping_sub(at_us) as i32) >= 0 {
                break;
            }
            before = Some(now);
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
        let after = counter.read_volatile();
        // It counts down.
        match before {
            Some(before) => before.wrapping_sub(after) & COUNT,
            None => u32::MAX,
        }
    }
}
