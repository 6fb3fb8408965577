//! Copies the code that runs from RAM, so that it never waits for the flash. `from-ram.x`, beside this folder, lists it.

use core::sync::atomic::{Ordering, compiler_fence};

unsafe extern "C" {
    /// Addresses of the code in RAM and in flash, from the linker, in words.
    static mut __from_ram_start: u32;
    static mut __from_ram_end: u32;
    static __from_ram_load: u32;
}

/// Copies the code to RAM. None of it may be called before. So it is copied word by word, as `memcpy` is part of it.
#[cold]
#[inline(never)]
pub fn place() {
    // SAFETY: the addresses are the linker's and aligned to words; nothing else uses that part of RAM.
    unsafe {
        let (mut to, end) = (&raw mut __from_ram_start, &raw mut __from_ram_end);
        let mut from = &raw const __from_ram_load;
        while to < end {
            to.write_volatile(from.read_volatile());
            to = to.add(1);
            from = from.add(1);
        }
    }
    compiler_fence(Ordering::SeqCst);
}

/// Words that [`differs`] compares at a time, some 8,000 cycles.
const SLICE: usize = 128;

/// Compares a slice of the code in RAM with the flash that it was copied from. Returns none behind the last one.
///
/// The flash is read past its cache, so that nothing else loses its place there.
pub fn differs(slice: usize) -> Option<bool> {
    const UNCACHED: usize = 0x0300_0000;
    let (start, end) = (&raw const __from_ram_start, &raw const __from_ram_end);
    let words = (end as usize - start as usize) / size_of::<u32>();
    let first = slice * SLICE;
    if first >= words {
        return None;
    }
    let placed = (&raw const __from_ram_load).map_addr(|address| address | UNCACHED);
    let mut words = first..words.min(first + SLICE);
    // SAFETY: the addresses are the linker's and aligned to words. Nothing writes there any more.
    Some(
        words.any(|word| unsafe {
            start.add(word).read_volatile() != placed.add(word).read_volatile()
        }),
    )
}
