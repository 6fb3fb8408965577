//! Safety lines, sync output and LED: levels that the CPU reads and sets.
//!
//! Inputs are pulled up and read low in normal operation, so that a broken wire stops the machine. All inputs are read at
//! one instant, and one write switches all drives. They are on only if the [`guard`], which polls the enable input,
//! permits it.

use cophase_core::supervisor::{SafetyInputs, State};
use embassy_rp::pac;

use super::{guard, now_us, pins};

/// Function of a pin that the CPU drives and reads.
const SIO: u8 = 5;

/// Levels of all inputs at one instant.
#[derive(Clone, Copy)]
pub struct Levels(u32);

impl Levels {
    const fn is_high(self, pin: u8) -> bool {
        self.0 & 1 << pin != 0
    }

    /// Alarm of an axis's drive.
    pub fn alarm(self, axis: usize) -> bool {
        pins::ALARM.get(axis).is_some_and(|&pin| self.is_high(pin))
    }

    /// True if any alarm input is active, also of axes that the machine does not have.
    pub const fn any_alarm(self) -> bool {
        const ALARMS: u32 = {
            let (mut mask, mut axis) = (0, 0);
            while axis < pins::ALARM.len() {
                mask |= 1 << pins::ALARM[axis];
                axis += 1;
            }
            mask
        };
        self.0 & ALARMS != 0
    }

    /// Level of an axis's index sensor.
    pub fn index(self, axis: usize) -> bool {
        axis < pins::AXES && self.is_high(pins::INDEX + axis as u8)
    }

    /// True while the button is held down.
    pub const fn start(self) -> bool {
        !self.is_high(pins::START)
    }
}

/// Function of a pin that the machines of the first block drive; the next number is the second block's.
pub(super) const PIO0: u8 = 6;

/// Sets up the lines: first switches the drives off, and starts the guard before any drive may be on.
#[cold]
pub fn set_up() {
    for pin in [pins::DRIVE_ENABLE, pins::SYNC, pins::LED] {
        output(pin);
    }
    let inputs = [pins::ENABLE, pins::STOP, pins::START];
    for pin in inputs.into_iter().chain(pins::ALARM) {
        input(pin, Pull::Up);
    }
    guard::set_up();
}

fn output(pin: u8) {
    set(pin, false);
    pac::SIO.gpio_oe(0).value_set().write_value(1 << pin);
    pac::IO_BANK0
        .gpio(pin.into())
        .ctrl()
        .write(|w| w.set_funcsel(SIO));
}

/// Level of a pin that nothing drives.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    /// Pulled high.
    Up,
    /// Pulled low.
    Down,
}

/// Makes a pin an input.
pub fn input(pin: u8, pull: Pull) {
    pac::PADS_BANK0.gpio(pin.into()).modify(|w| {
        w.set_ie(true);
        w.set_od(true);
        w.set_pue(pull == Pull::Up);
        w.set_pde(pull == Pull::Down);
        w.set_schmitt(true);
    });
    let ctrl = pac::IO_BANK0.gpio(pin.into()).ctrl();
    ctrl.write(|w| w.set_funcsel(SIO));
}

/// Makes a pin an output of a PIO block.
#[cold]
pub fn give_to_block(pin: u8, block: usize) {
    pac::PADS_BANK0.gpio(pin.into()).modify(|w| {
        w.set_ie(true);
        w.set_od(false);
        w.set_pue(false);
        w.set_pde(false);
    });
    let ctrl = pac::IO_BANK0.gpio(pin.into()).ctrl();
    ctrl.write(|w| w.set_funcsel(PIO0 + block as u8));
}

fn set(pin: u8, high: bool) {
    let out = pac::SIO.gpio_out(0);
    if high {
        out.value_set().write_value(1 << pin);
    } else {
        out.value_clr().write_value(1 << pin);
    }
}

/// Reads all inputs at one instant.
pub fn read() -> Levels {
    Levels(pac::SIO.gpio_in(0).read())
}

/// Enable and stop inputs for the loop. A loss of the enable input that is over is reported once.
pub fn safety_inputs(levels: Levels) -> SafetyInputs {
    SafetyInputs {
        enable: !guard::take_loss(),
        stop: levels.is_high(pins::STOP),
    }
}

/// Switches all drives on or off; on only if the enable input has not opened meanwhile.
pub fn drives(on: bool) {
    guard::permit(on);
}

/// Sets the trigger output for an oscilloscope.
pub fn sync(high: bool) {
    set(pins::SYNC, high);
}

/// Shows the state on the LED: a short flash a second in idle, quick blinking in a fault, steady light while drives are
/// on.
pub fn led(state: State) {
    let now_us = now_us();
    let on = match state {
        State::Idle => (now_us >> 16) & 15 == 0, // 66 ms in 1.05 s
        State::Fault => (now_us >> 17) & 1 == 0, // 131 ms on, 131 ms off
        _ => true,
    };
    set(pins::LED, on);
}

/// Switches the LED on or off, for firmware without settings, which has no state.
pub fn light(on: bool) {
    set(pins::LED, on);
}
