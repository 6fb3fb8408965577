//! Starts the machines of both blocks at one instant.
//!
//! A block's machines start in the cycle in which its control register is written. Two consecutive stores write the two
//! registers. They run from RAM with interrupts disabled, so that no fetch from flash and no handler can come between.
//!
//! Another master of the bus or a debugger may still delay the stores. The blocks are then apart, and all ticks late.
//! The core's own counter, SysTick, shows this. It counts every cycle and has no other use.

use core::arch::asm;

use cortex_m::peripheral::SYST;
use embassy_rp::pac;

/// Cycles from the first block's start to the second's: a store to these registers takes two.
pub const SKEW: u32 = 2;

/// Cycles from the timer's last reading before its time to the start of both blocks. It takes 36, and may take
/// less than a quarter of a microsecond more.
const MOST_CYCLES: u32 = 64;

/// SysTick's bits.
const COUNT: u32 = 0xFF_FFFF;

/// Starts SysTick.
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

/// Enables the machines of the first and the second block whose bits are set, and no others, when the timer reaches
/// `at_us`. Returns true if that was in time. To be called with interrupts disabled and `at_us` less than 2³¹ µs ahead.
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
        // Count at the last reading before the time. None if the time had passed at the first reading.
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
        // SysTick counts down.
        match before {
            Some(before) => before.wrapping_sub(after) & COUNT,
            None => u32::MAX,
        }
    }
}
