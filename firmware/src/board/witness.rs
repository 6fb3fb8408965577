//! Witnesses: single faults of the board, detected by comparing two facts that do not depend on each other.
//!
//! | witness | compares | when |
//! | --- | --- | --- |
//! | guard | level of ENABLE, and the guard's report of its loss | each tick |
//! | clock | time of the timer, and cycles of the step hardware | each tick, and every 8.4 ms without the timer |
//! | stack | words at its end, and what was written there at power-up; its pointer, and its end | each tick |
//! | settings | checksums of the settings in use (`Controller::check_settings`) | each tick |
//! | code | code in RAM, and the flash that it was copied from | in the time that the loop leaves |
//!
//! A disagreement ends in [`fail`]: the drives are off at once, and the controller restarts. `docs/safety.md` lists the faults, and what
//! no witness can detect.

use core::arch::asm;
use core::sync::atomic::{AtomicU32, Ordering};

use cophase_core::supervisor::SafetyInputs;
use cophase_link::board::{Board as _, Rp2040};
use cortex_m_rt::exception;
use embassy_time::{Duration, Timer};

use super::failure::{Failure, fail};
use super::lines::Levels;
use super::{CYCLES_PER_US, from_ram, lines, now_us, systick};

/// Prepares the witnesses of each tick but the canary. To be called once.
#[cold]
pub fn set_up() {
    systick::set_up();
    while set_min_difference().is_none() {}
}

/// Compares what can be compared within a few cycles. `levels` were read before `inputs` were taken from them.
#[inline(always)]
pub fn check(levels: Levels, inputs: SafetyInputs) {
    guard(levels, inputs);
    stack();
    clock();
}

/// Checks that the guard reports a loss of ENABLE which has lasted for a tick. It needs 10 µs for that.
#[inline(always)]
fn guard(levels: Levels, inputs: SafetyInputs) {
    if levels.is_enable_lost() && inputs.enable && !lines::has_enable_edge() {
        fail(Failure::Guard);
    }
}

unsafe extern "C" {
    /// End of the stack, from the linker: the lowest address of RAM that no static has. The canary is there, two words with this address.
    static mut _stack_end: [usize; 2];
}

/// Writes the canary. To be called first of all: little of the stack is in use then, and power-up takes the most.
#[cold]
pub fn set_canary() {
    let end = &raw mut _stack_end;
    // SAFETY: nothing else uses these words unless the stack runs over its end.
    unsafe { end.write_volatile([end as usize; 2]) };
}

/// Checks that the stack has not run over its end: not now, by its pointer; and not before, by the canary.
#[inline(always)]
fn stack() {
    let end = &raw const _stack_end;
    let pointer: usize;
    // SAFETY: this reads the stack pointer, and the canary.
    let [first, second] = unsafe {
        asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags));
        end.read_volatile()
    };
    if first != end as usize || second != end as usize || pointer <= end as usize {
        fail(Failure::Stack);
    }
}

/// Greatest change of the difference between timer and step hardware, µs. It is less than the lead with which words are submitted, so a
/// rate that is slightly wrong is detected before a tick underruns.
const MAX_DIFFERENCE_US: u32 = 8;

/// The same in cycles.
const MAX_DIFFERENCE: u32 = MAX_DIFFERENCE_US * CYCLES_PER_US;

const _: () = assert!(MAX_DIFFERENCE_US < Rp2040::MIN_LEAD_US);

/// Longest reading of both clocks, cycles. If something came between, the reading says nothing.
const MAX_READING: u32 = 64;

/// Least difference between timer and step hardware: that at power-up, less the greatest change.
static MIN: AtomicU32 = AtomicU32::new(0);

/// Time of the timer, in cycles, less the cycles of the step hardware. It is constant modulo the period of SysTick, which counts down.
#[inline(always)]
fn difference() -> Option<u32> {
    let before = systick::count();
    let us = now_us();
    let after = systick::count();
    let is_whole = systick::cycles(before, after) <= MAX_READING;
    is_whole.then(|| us.wrapping_mul(CYCLES_PER_US).wrapping_add(after))
}

#[cold]
fn set_min_difference() -> Option<()> {
    let min = difference()?.wrapping_sub(MAX_DIFFERENCE);
    MIN.store(min, Ordering::Relaxed);
    Some(())
}

/// Checks that timer and step hardware count the same time.
#[inline(always)]
fn clock() {
    let Some(now) = difference() else {
        return;
    };
    let above = now.wrapping_sub(MIN.load(Ordering::Relaxed));
    if above & systick::COUNT > 2 * MAX_DIFFERENCE {
        fail(Failure::Clock);
    }
}

/// Checks the timer without it: the loop does not run if the timer stands.
///
/// At exceptions SysTick has the same count. If the timer stopped at an exception, the difference stays, and only its time shows this.
#[inline(never)] // Interrupt handlers by their own names are in the flash.
fn clock_without_timer() {
    static BEFORE_US: AtomicU32 = AtomicU32::new(0);
    let now_us = now_us();
    let before_us = BEFORE_US.load(Ordering::Relaxed);
    BEFORE_US.store(now_us, Ordering::Relaxed);
    // Two exceptions come together if the first had to wait for a period.
    if now_us.wrapping_sub(before_us) <= 2 * MAX_DIFFERENCE_US && timer_stands() {
        fail(Failure::Clock);
    }
    clock();
}

/// Returns true if the timer does not count for 2 µs or more.
fn timer_stands() -> bool {
    const CYCLES: u32 = 2 * CYCLES_PER_US + MAX_READING;
    let (us, from) = (now_us(), systick::count());
    while systick::cycles(from, systick::count()) < CYCLES {}
    now_us() == us
}

#[exception]
fn SysTick() {
    clock_without_timer();
}

/// Time between two slices of the code.
const SLICES: Duration = Duration::from_millis(4);

/// Task that compares the code in RAM with the flash, slice by slice and again and again.
#[embassy_executor::task]
pub async fn code() -> ! {
    loop {
        let mut slice = 0;
        while let Some(differs) = from_ram::differs(slice) {
            if differs {
                fail(Failure::Code);
            }
            slice += 1;
            // No ticker, which would catch up without a pause after interrupts were disabled for long.
            Timer::after(SLICES).await;
        }
    }
}
