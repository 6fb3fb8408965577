//! Program of a state machine: it makes every step edge from the words of a run.
//!
//! | part of the word | in a run | in a pause |
//! | --- | --- | --- |
//! | edges, 13 bits | number of edges, 1 or more | 0 |
//! | cycles − 8, 18 bits | from one edge to the next | its length |
//! | DIR, 1 bit | ignored | applied 8 cycles after the beginning |
//!
//! Counted from one edge (or the end of a pause) to the next, every path through the program takes 8 cycles plus the
//! cycles of the word. This is the reason for the 8. An empty FIFO stops the machine at `pull`, between two words.
//! Levels stay, nothing is lost, and the next word is played whole.

use pio::{Program, RP2040_MAX_PROGRAM_SIZE};

/// The program. A machine waits for words at its first instruction.
///
/// STEP is the machine's one OUT pin and its first IN pin, so that it can be inverted. DIR is its side-set pin. OUT
/// shifts to the right.
pub fn step_program() -> Program<{ RP2040_MAX_PROGRAM_SIZE }> {
    pio::pio_asm!(
        ".side_set 1 opt",
        ".wrap_target",
        "word:",
        "    pull block",
        "    out x, 13",
        "    out y, 18",
        "    jmp x-- edges", // x is then the number of edges after the first
        "    out x, 1",
        "    jmp !x backward",
        "forward:",
        "    jmp y-- forward side 1",
        "    jmp word",
        "backward:",
        "    jmp y-- backward side 0",
        "    jmp word",
        "again:",
        "    mov y, isr [3]", // as long as reading a word
        "edges:",
        "    mov isr, y",
        "period:",
        "    jmp y-- period",
        "    mov pins, !pins",
        "    jmp x-- again",
        ".wrap",
    )
    .program
}
