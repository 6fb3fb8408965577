//! The safety lines, the sync output and the lamp: levels that are read and set by the CPU.
//!
//! Inputs are pulled up and read low when all is well, so that a broken wire reads as what stops the
//! machine. All inputs are read in one instant, and all drives are switched by one write: but on only as far as the
//! [`guard`] lets them, which looks after the enable input.

use cophase_core::supervisor::{SafetyInputs, State};
use embassy_rp::pac;

use super::{guard, now_us, pins};

/// Function of a pin that is driven, and read, by the CPU.
const SIO: u8 = 5;

/// What the inputs said at one instant.
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

    /// Whether any drive's alarm is on, or would be if there were one.
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

    /// Whether the button is held down.
    pub const fn start(self) -> bool {
        !self.is_high(pins::START)
    }
}

/// Function of a pin that the first block's machines drive; the second's is the next.
pub(super) const PIO0: u8 = 6;

/// Sets the lines up: drives off before anything else, and the guard before any may be on.
#[cold]
pub fn set_up() {
    for pin in [pins::DRIVE_ENABLE, pins::SYNC, pins::LAMP] {
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

/// What a pin reads that nothing drives.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    /// High.
    Up,
    /// Low.
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

/// Makes a pin one that machines of a PIO block drive.
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

/// Reads all inputs in one instant.
pub fn read() -> Levels {
    Levels(pac::SIO.gpio_in(0).read())
}

/// What the loop is told of the enable and stop inputs. A loss of enable that is over is told once.
pub fn safety_inputs(levels: Levels) -> SafetyInputs {
    SafetyInputs {
        enable: !guard::take_loss(),
        stop: levels.is_high(pins::STOP),
    }
}

/// Switches all drives on or off; on only if the enable input has not gone meanwhile.
pub fn drives(on: bool) {
    guard::permit(on);
}

/// Sets the oscilloscope's trigger.
pub fn sync(high: bool) {
    set(pins::SYNC, high);
}

/// Shows the state on the lamp: a short flash a second in idle, quick blinking in a fault, steady light while
/// drives are on.
pub fn lamp(state: State) {
    let now_us = now_us();
    let on = match state {
        State::Idle => (now_us >> 16) & 15 == 0, // 66 ms in 1.05 s
        State::Fault => (now_us >> 17) & 1 == 0, // 131 ms on, 131 ms off
        _ => true,
    };
    set(pins::LAMP, on);
}

/// Lights the lamp, or not: for an image that has no settings to run on, and no state.
pub fn light(on: bool) {
    set(pins::LAMP, on);
}
