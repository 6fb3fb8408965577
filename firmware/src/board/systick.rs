//! SysTick: counts the cycles of the core, which are those of the step machines, and raises an exception once a period.
//!
//! It is independent of the timer. The timer counts what the watchdog's tick generator makes of the crystal, SysTick the multiplied clock.

use cortex_m::peripheral::{SCB, SYST};

/// The counter's bits. It counts down to 0 in 8.4 ms and begins again here, so differences are taken modulo this and 1.
pub const COUNT: u32 = 0xF_FFFF;

/// Starts the counter. Its exception waits for every interrupt, so that it delays no tick. [`witness`](super::witness) handles it.
#[cold]
pub fn set_up() {
    const ENABLE: u32 = 1;
    const RAISE: u32 = 1 << 1;
    const CORE_CLOCK: u32 = 1 << 2;
    const LOWEST: u32 = 0xC0 << 24;
    // SAFETY: nothing else uses SysTick, or the register of its priority.
    unsafe {
        let [_, shpr3] = &(*SCB::PTR).shpr;
        shpr3.write(LOWEST);
        (*SYST::PTR).rvr.write(COUNT);
        (*SYST::PTR).cvr.write(0);
        (*SYST::PTR).csr.write(ENABLE | RAISE | CORE_CLOCK);
    }
}

/// The counter.
#[inline(always)]
pub fn count() -> u32 {
    SYST::get_current()
}

/// Cycles from one count to a later one, less than a period.
#[inline(always)]
pub const fn cycles(from: u32, to: u32) -> u32 {
    from.wrapping_sub(to) & COUNT
}
