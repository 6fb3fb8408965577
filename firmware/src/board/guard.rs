//! The guard: cuts the drives when the enable input goes, without the processor.
//!
//! The second block's fourth machine looks at the enable input and drives DRIVE ENABLE. A loss that lasts is a loss,
//! whatever the processor is doing, be it nothing at all: the line falls, stays low, and a flag says so until the loop
//! has taken note. What is shorter is noise, and nothing comes of it ([`program`] says how long is which).
//!
//! The processor can not make the line high, only let it be: it *holds* it low by the pin's own override, or *permits*
//! what the guard makes of it. So the two need not agree on who was first.
//!
//! The guard begins with a loss, so that nothing is on before the loop has looked.

use embassy_rp::pac;
use embassy_rp::pac::io::vals::Outover;
use pio::{Program, RP2040_MAX_PROGRAM_SIZE};

use super::{GUARD_MACHINE, lines, pins, relocated, steps};

/// The block of the guard's machine.
const BLOCK: usize = 1;

/// Where its program lies, behind that of the steps.
const ORIGIN: usize = steps::PROGRAM_LENGTH;

/// The instruction with which a loss begins, counted from the program's first.
const LOST: u16 = 6;

/// The program. Both JMP PIN and `wait` look at the enable input; SET sets DRIVE ENABLE.
///
/// The line is looked at 32 times, 36 cycles apart, and is lost if it is high each time: from 4 cycles after it
/// went (with the pins' synchroniser) that is 1,117 cycles, or 8.9 µs. One look at a low level, and it all begins anew.
/// Two more instructions, and the line has fallen after 1,157 cycles, 9.3 µs.
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
        "    irq wait 0", // until the loop has taken note
        "    jmp pin lost",
        ".wrap",
    )
    .program
}

/// Lets the guard begin. DRIVE ENABLE is held low from here on, until it is permitted to be high.
#[cold]
pub fn set_up() {
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

/// Lets DRIVE ENABLE be what the guard makes of it, or holds it low.
pub fn permit(on: bool) {
    let ctrl = pac::IO_BANK0.gpio(pins::DRIVE_ENABLE.into()).ctrl();
    ctrl.write(|w| {
        w.set_funcsel(lines::PIO0 + BLOCK as u8);
        w.set_outover(if on { Outover::NORMAL } else { Outover::LOW });
    });
}

/// Whether the enable input went, or is gone. A loss that is over is told once, and DRIVE ENABLE held low with it.
pub fn take_loss() -> bool {
    let flags = pac::PIO1.irq();
    if flags.read().irq() & 1 == 0 {
        return false;
    }
    permit(false);
    flags.write(|w| w.set_irq(1)); // is raised again, within a few cycles, if the line is still high
    true
}
