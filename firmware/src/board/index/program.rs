//! Program of the state machine that times the changes of six lines.
//!
//! It polls them once in 7 cycles and counts these polls down. When a poll differs from the one before, it outputs both
//! the levels and the count. The next poll then comes 14 cycles later. The count is lowered by two for it, so that it
//! remains a clock. A full FIFO loses a change, not the clock.

use pio::{Program, RP2040_MAX_PROGRAM_SIZE};

/// Cycles from one poll to the next.
pub const POLL_CYCLES: u32 = 7;

/// Cycles from the beginning of a poll to the sampling of the lines.
pub const SAMPLED_AFTER: u32 = 4;

/// Number of bits of the count in the output; the levels are above them.
pub const COUNT_BITS: u32 = 26;

/// Program of the machine. IN shifts to the left; x is scratch, y the last levels, and the OSR the count.
pub fn index_program() -> Program<{ RP2040_MAX_PROGRAM_SIZE }> {
    pio::pio_asm!(
        ".wrap_target",
        "look:",
        "    mov x, osr",
        "    jmp x-- counted",
        "counted:",
        "    mov osr, x",
        "    mov isr, null",
        "    in pins, 6",
        "    mov x, isr",
        "    jmp x!=y changed",
        ".wrap",
        "changed:",
        "    mov y, x",
        "    in osr, 26",
        "    push noblock",
        "    mov x, osr",
        "    jmp x-- also_counted",
        "also_counted:",
        "    mov osr, x",
        "    jmp look",
    )
    .program
}
