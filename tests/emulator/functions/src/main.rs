//! Elementary functions, one C symbol each, for `measure.mjs` to call in the RP2040 emulator.
//!
//! A *candidate* takes and gives integers: the bits of its own format. Its symbol begins with its function (`root_`, `sine_`,
//! `arctangent_`, `inverse_root_`, `product_`) and ends with its source; `measure.mjs` knows the format of each, and counts
//! cycles and errors. Nothing here is started: there is no reset, no board.
//!
//! On a host this crate is empty, so that the workspace builds with no target installed.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod arctangents;
#[cfg(target_os = "none")]
mod inverse_roots;
#[cfg(target_os = "none")]
mod roots;
#[cfg(target_os = "none")]
mod sines;
#[cfg(target_os = "none")]
mod tables;

/// A call that does nothing; its cycles are subtracted from every other's.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn empty() {}

/// Destination of a candidate that panics; the emulator watches for it.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn panicked() -> ! {
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(target_os = "none")]
#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo) -> ! {
    panicked()
}

/// Two results of 32 bits, in the two registers that a call gives back: the first in r0.
#[cfg(target_os = "none")]
const fn pair(first: u32, second: u32) -> u64 {
    first as u64 | (second as u64) << 32
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "this is for the board: tests/emulator/functions/measure.mjs calls it in the emulator"
    );
}
