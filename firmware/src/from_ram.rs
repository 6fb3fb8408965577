//! What runs from RAM, so that it never waits for the flash: `from-ram.x`, beside this folder, has the list.

use core::sync::atomic::{Ordering, compiler_fence};

unsafe extern "C" {
    /// Where it belongs, and where in the flash it lies: the linker's, in words.
    static mut __from_ram_start: u32;
    static mut __from_ram_end: u32;
    static __from_ram_load: u32;
}

/// Puts it there. Nothing of it may be called before; hence word by word, and not by `memcpy`, which is among it.
pub fn place() {
    // SAFETY: the linker's addresses, of words; nothing else knows that part of RAM.
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
