//! Guard: switches off the drives when the enable input opens, without the processor (stop category 0).
//!
//! The fourth machine of the second block polls the enable input and drives DRIVE ENABLE. When a loss of the enable input
//! lasts, the line falls and stays low, even if the processor hangs. A flag reports the loss until the loop has read it.
//! A shorter pulse is noise and has no effect ([`program`] states the times).
//!
//! The processor cannot make the line high. It *holds* it low by the pin's own override, or *permits* the level of the
//! guard. So the order of the two does not matter.
//!
//! The guard starts with a loss, so that no drive is on before the first tick of the loop.

use core::sync::atomic::{AtomicBool, Ordering};

use embassy_rp::pac;
use embassy_rp::pac::io::vals::Outover;
use pio::{Program, RP2040_MAX_PROGRAM_SIZE};

use super::{GUARD_MACHINE, lines, pins, relocated, steps};

/// Block of the guard's machine.
const BLOCK: usize = 1;

/// Address of its program, behind that of the steps.
const ORIGIN: usize = steps::PROGRAM_LENGTH;

/// Number of the instruction that begins a loss, counted from the first of the program.
const LOST: u16 = 6;

/// Program of the guard. Both JMP PIN and `wait` read the enable input; SET sets DRIVE ENABLE.
///
/// The program polls the line 32 times, 36 cycles apart, and detects a loss if it is high each time. From 4 cycles after
/// the line opens (with the pins' synchroniser) this takes 1,117 cycles, or 8.9 µs. A single poll of a low level restarts
/// the count. After two more instructions DRIVE ENABLE has fallen: after 1,157 cycles, 9.3 µs.
fn program() -> Program<{ RP2040_MAX_PROGRAM_SIZE }> {
    pio::pio_asm!(
        ".wrap_target",
        "well:",
        "    set pins, 1",
        "    wait 1 pin 0",
        "    set x, 31",
        "look:",
        "    jmp pin gone [17]",
        "    jmp well",
        "gone:",
        "    jmp x-- look [17]",
        "lost:",
        "    set pins, 0",
        "    irq wait 0", // until the loop has read the flag
        "    jmp pin lost",
        ".wrap",
    )
    .program
}

/// DRIVE ENABLE is low while the drives are on.
static IS_INVERTED: AtomicBool = AtomicBool::new(false);

/// Starts the guard. DRIVE ENABLE is driven from here on, and the drives are held off until they are permitted.
#[cold]
pub fn set_up(is_inverted: bool) {
    IS_INVERTED.store(is_inverted, Ordering::Relaxed);
    let program = program();
    let block = pac::PIO1;
    for (slot, &instruction) in program.code.iter().enumerate() {
        let memory = block.instr_mem(ORIGIN + slot);
        memory.write(|w| w.set_instr_mem(relocated(instruction, ORIGIN)));
    }
    let sm = block.sm(GUARD_MACHINE);
    sm.clkdiv().write(|w| w.set_int(1));
    sm.execctrl().write(|w| {
        w.set_jmp_pin(pins::ENABLE);
        w.set_wrap_bottom(program.wrap.target + ORIGIN as u8);
        w.set_wrap_top(program.wrap.source + ORIGIN as u8);
    });
    sm.pinctrl().write(|w| {
        w.set_in_base(pins::ENABLE);
        w.set_set_base(pins::DRIVE_ENABLE);
        w.set_set_count(1);
    });
    const SET_PINS_0: u16 = 0xE000;
    const SET_PINDIRS_1: u16 = 0xE081;
    const JMP: u16 = 0;
    for instruction in [SET_PINS_0, SET_PINDIRS_1, JMP | (ORIGIN as u16 + LOST)] {
        sm.instr().write(|w| w.set_instr(instruction));
    }
    permit(false);
    block
        .ctrl()
        .modify(|w| w.set_sm_enable(w.sm_enable() | 1 << GUARD_MACHINE));
}

/// Permits the guard's level on DRIVE ENABLE, or holds the drives off.
pub fn permit(on: bool) {
    let is_inverted = IS_INVERTED.load(Ordering::Relaxed);
    let level = match (on, is_inverted) {
        (true, false) => Outover::NORMAL,
        (true, true) => Outover::INVERT,
        (false, false) => Outover::LOW,
        (false, true) => Outover::HIGH,
    };
    let ctrl = pac::IO_BANK0.gpio(pins::DRIVE_ENABLE.into()).ctrl();
    ctrl.write(|w| {
        w.set_funcsel(lines::PIO0 + BLOCK as u8);
        w.set_outover(level);
    });
}

/// Returns true if the enable input opened or is open. A loss that is over is reported once, and DRIVE ENABLE is then
/// held low.
pub fn take_loss() -> bool {
    let flags = pac::PIO1.irq();
    if flags.read().irq() & 1 == 0 {
        return false;
    }
    permit(false);
    flags.write(|w| w.set_irq(1)); // The flag rises again within a few cycles if the line is still high.
    true
}
