//! Program of a state machine: it makes every step edge from the words of a run.
//!
//! | part of the word | in a run | in a pause |
//! | --- | --- | --- |
//! | edges, 13 bits | how many, 1 or more | 0 |
//! | cycles − 8, 18 bits | from one edge to the next | its length |
//! | DIR, 1 bit | not looked at | taken up 8 cycles after the beginning |
//!
//! Counted from one edge (or the end of a pause) to the next, every way through the program takes 8 cycles
//! and what the word asks for on top; that is where the 8 comes from. An empty FIFO stops the machine at
//! `pull`, between two words: levels stay, nothing is lost, and what comes next is played whole.

use pio::{Program, RP2040_MAX_PROGRAM_SIZE};

/// The program. A machine waits for words at its first instruction.
///
/// STEP is the machine's one OUT pin and its first IN pin, so that it can be inverted; DIR is its side-set
/// pin. OUT shifts to the right.
pub fn step_program() -> Program<{ RP2040_MAX_PROGRAM_SIZE }> {
    pio::pio_asm!(
        ".side_set 1 opt",
        ".wrap_target",
        "word:",
        "    pull block",
        "    out x, 13",
        "    out y, 18",
        "    jmp x-- edges", // leaves x at how many come after the first
        "    out x, 1",
        "    jmp !x backward",
        "forward:",
        "    jmp y-- forward side 1",
        "    jmp word",
        "backward:",
        "    jmp y-- backward side 0",
        "    jmp word",
        "again:",
        "    mov y, isr [3]", // as long as taking up a word
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
