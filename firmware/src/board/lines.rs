//! Safety lines, sync output and LED: levels that the CPU reads and sets.
//!
//! All inputs are read at one instant, and one write switches all drives. They are on only if the [`guard`], which polls
//! the enable input, permits it.
//!
//! A line whose settings have another active level than [`WiringSettings::DEFAULT`] is inverted where it enters or leaves
//! the chip, by the pin's own override. So is DIR of an axis that is reversed. So the rest of the firmware has the default levels only.
//!
//! ALARM and STOP are *latched*: the chip notes their edges by itself, so that a pulse between two readings is not lost. Either edge shows
//! that the line was active since the last reading, whatever its active level is. Edges of ENABLE are noted as well: without one, the line
//! had its level all the time since the last reading.

use core::sync::atomic::{AtomicBool, Ordering};

use cophase_core::settings::{InputWiring, WiringSettings};
use cophase_core::supervisor::{SafetyInputs, State};
use cophase_core::units::AxisSet;
use cophase_link::message::{Inputs, Output};
use embassy_rp::pac;
use embassy_rp::pac::io::regs::Int;
use embassy_rp::pac::io::vals::{Inover, Outover};

use super::{guard, now_us, pins};

/// Function of a pin that the CPU drives and reads.
const SIO: u8 = 5;

/// An output is held for bring-up.
static IS_HELD: AtomicBool = AtomicBool::new(false);

/// DRIVE ENABLE is held active for bring-up.
static IS_ENABLE_HELD: AtomicBool = AtomicBool::new(false);

/// Alarm inputs of a machine, a bit each. They are variables, as a table of constants would be in the flash.
pub struct AlarmInputs {
    of_axes: [u32; pins::AXES],
    all: u32,
}

impl AlarmInputs {
    /// Alarm inputs of the given number of axes, from the board's axis `first` on.
    #[cold]
    pub fn new(first: usize, axes: usize) -> Self {
        let mut of_axes = [0; pins::AXES];
        let pins = pins::ALARM.iter().skip(first).take(axes);
        for (input, pin) in of_axes.iter_mut().zip(pins) {
            *input = 1 << pin;
        }
        let all = of_axes.iter().fold(0, |all, input| all | input);
        Self { of_axes, all }
    }
}

/// Levels of all inputs at one instant.
#[derive(Clone, Copy)]
pub struct Levels(u32);

impl Levels {
    const fn is_high(self, pin: u8) -> bool {
        self.0 & 1 << pin != 0
    }

    /// Alarm of an axis's drive.
    #[cold]
    fn alarm(self, axis: usize) -> bool {
        pins::ALARM.get(axis).is_some_and(|&pin| self.is_high(pin))
    }

    /// Axes whose drives give an alarm; in most ticks there is none.
    #[inline(always)]
    pub fn alarms(self, inputs: &AlarmInputs) -> AxisSet {
        let mut alarms = 0;
        if self.0 & inputs.all != 0 {
            for (axis, input) in inputs.of_axes.iter().enumerate() {
                alarms |= AxisSet::from(self.0 & input != 0) << axis;
            }
        }
        alarms
    }

    /// Level of an axis's index sensor.
    pub fn index(self, axis: usize) -> bool {
        axis < pins::AXES && self.is_high(pins::INDEX + axis as u8)
    }

    /// True if ENABLE was open at the last two readings and all the time between them.
    pub const fn is_enable_lost(self) -> bool {
        self.is_high(pins::ENABLE)
    }

    /// True while the button is held down.
    pub const fn start(self) -> bool {
        !self.is_high(pins::START)
    }
}

/// Function of a pin that the machines of the first block drive; the next number is the second block's.
pub(super) const PIO0: u8 = 6;

/// Wiring for which the firmware's own levels are those of the lines.
const DEFAULT: WiringSettings = WiringSettings::DEFAULT;

/// Sets up the LED.
#[cold]
pub fn set_up_led() {
    output(pins::LED);
}

/// Sets up the lines. No output is driven before, as its active level is not known.
#[cold]
pub fn set_up(wiring: &WiringSettings) {
    output(pins::SYNC);
    input(pins::ENABLE, wiring.enable, DEFAULT.enable, Pull::Up);
    input(pins::STOP, wiring.stop, DEFAULT.stop, Pull::Up);
    input(pins::START, wiring.start, DEFAULT.start, Pull::Up);
    for pin in pins::ALARM {
        input(pin, wiring.alarm, DEFAULT.alarm, Pull::Up);
    }
    for axis in 0..pins::AXES as u8 {
        input(pins::INDEX + axis, wiring.index, DEFAULT.index, Pull::Down);
    }
    guard::set_up(wiring.drive_enable != DEFAULT.drive_enable);
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
enum Pull {
    /// Pulled high.
    Up,
    /// Pulled low.
    Down,
}

/// Makes a pin an input. With the wiring `default` it is pulled to `pull`.
fn input(pin: u8, wiring: InputWiring, default: InputWiring, pull: Pull) {
    let is_inverted = wiring.active != default.active;
    let is_pulled = |to: Pull| wiring.has_pull && (pull == to) != is_inverted;
    pac::PADS_BANK0.gpio(pin.into()).modify(|w| {
        w.set_ie(true);
        w.set_od(true);
        w.set_pue(is_pulled(Pull::Up));
        w.set_pde(is_pulled(Pull::Down));
        w.set_schmitt(true);
    });
    let ctrl = pac::IO_BANK0.gpio(pin.into()).ctrl();
    ctrl.write(|w| {
        w.set_funcsel(SIO);
        w.set_inover(Inover::from_bits(is_inverted.into()));
    });
}

/// Drives STEP and DIR of an axis that does not move, so that the drive does not count noise as steps.
#[cold]
pub fn rest(axis: usize, wiring: &WiringSettings) {
    let is_inverted = wiring.step != DEFAULT.step;
    for (pins, is_inverted) in [(pins::STEP, is_inverted), (pins::DIR, false)] {
        let Some(&pin) = pins.get(axis) else {
            continue;
        };
        output(pin);
        pac::IO_BANK0.gpio(pin.into()).ctrl().modify(|w| {
            w.set_outover(Outover::from_bits(is_inverted.into()));
            w.set_inover(Inover::from_bits(is_inverted.into()));
        });
    }
}

/// Makes a pin an output of a PIO block, which reads its own output. It is inverted outside the chip if `is_inverted`.
#[cold]
pub fn give_to_block(pin: u8, block: usize, is_inverted: bool) {
    pac::PADS_BANK0.gpio(pin.into()).modify(|w| {
        w.set_ie(true);
        w.set_od(false);
        w.set_pue(false);
        w.set_pde(false);
    });
    let ctrl = pac::IO_BANK0.gpio(pin.into()).ctrl();
    ctrl.write(|w| {
        w.set_funcsel(PIO0 + block as u8);
        w.set_outover(Outover::from_bits(is_inverted.into()));
        w.set_inover(Inover::from_bits(is_inverted.into()));
    });
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

/// Registers that note edges have four bits a pin, and eight pins each.
const PINS_OF_REGISTER: u8 = 8;

/// Both edges of a pin in its register.
const EDGES: u32 = 0b1100;

/// Pins whose edges are noted: ENABLE, STOP and the alarms.
const LATCHED: usize = pins::AXES + 2;

/// Bits of both edges of these pins in a register.
const fn latched(register: u8) -> u32 {
    let (mut bits, mut i) = (0, 0);
    while i < LATCHED {
        let pin = match i {
            0 => pins::ENABLE,
            1 => pins::STOP,
            axis => pins::ALARM[axis - 2],
        };
        if pin / PINS_OF_REGISTER == register {
            bits |= EDGES << (pin % PINS_OF_REGISTER * 4);
        }
        i += 1;
    }
    bits
}

/// Registers of these pins, and their bits there.
const LATCHES: [(u8, u32); 2] = [(2, latched(2)), (3, latched(3))];

const _: () = {
    let count = LATCHES[0].1.count_ones() + LATCHES[1].1.count_ones();
    assert!(
        count as usize == 2 * LATCHED,
        "every pin whose edges are noted has a register"
    );
};

/// Reads all inputs as [`read`] does. A latched line reads active also if it was so at any time since the last call. ENABLE reads open only
/// if it was so all the time.
#[inline(always)]
pub fn read_latched() -> Levels {
    let levels = read();
    let [(first, of_first), (second, of_second)] = LATCHES;
    let bank = pac::IO_BANK0;
    let edges = [
        bank.intr(first.into()).read().0 & of_first,
        bank.intr(second.into()).read().0 & of_second,
    ];
    if edges[0] | edges[1] == 0 {
        return levels;
    }
    add_edges(levels, edges)
}

/// Adds lines with edges to those that are active, takes ENABLE from them, and clears what was noted. An edge that comes between reading
/// and clearing is that of a line which is reported now.
#[inline(never)] // seldom
fn add_edges(Levels(levels): Levels, edges: [u32; 2]) -> Levels {
    let [(first, _), (second, _)] = LATCHES;
    let [of_first, of_second] = edges;
    let changed = clear_edges(first, of_first) | clear_edges(second, of_second);
    const ENABLE: u32 = 1 << pins::ENABLE;
    Levels((levels | changed) & !(changed & ENABLE))
}

/// Clears edges that a register has noted; returns their pins.
#[inline(always)] // The number of the register is then a constant, and needs no check.
fn clear_edges(register: u8, edges: u32) -> u32 {
    pac::IO_BANK0.intr(register.into()).write_value(Int(edges));
    let mut changed = 0;
    let mut rest = edges;
    let mut bit = 1 << (register * PINS_OF_REGISTER);
    while rest != 0 {
        if rest & EDGES != 0 {
            changed |= bit;
        }
        rest >>= 4;
        bit <<= 1;
    }
    changed
}

/// True if ENABLE had an edge since the last reading of the latched lines. The edge of a line that changed in that very reading may be
/// noted only now.
#[inline(never)] // seldom
pub fn has_enable_edge() -> bool {
    const REGISTER: u8 = pins::ENABLE / PINS_OF_REGISTER;
    const BITS: u32 = EDGES << (pins::ENABLE % PINS_OF_REGISTER * 4);
    pac::IO_BANK0.intr(REGISTER.into()).read().0 & BITS != 0
}

/// Enable and stop inputs for the loop. A loss of the enable input that is over is reported once.
pub fn safety_inputs(levels: Levels) -> SafetyInputs {
    SafetyInputs {
        enable: !guard::take_loss(),
        stop: levels.is_high(pins::STOP),
    }
}

/// Switches all drives on or off for a state. They are on only if the enable input has not opened meanwhile. Outputs
/// are held in idle only.
pub fn drives(on: bool, state: State) {
    if state != State::Idle && IS_HELD.load(Ordering::Relaxed) {
        release();
    }
    guard::permit(on || IS_ENABLE_HELD.load(Ordering::Relaxed));
}

/// Switches all drives off at once, even if an output is held.
pub fn cut_drives() {
    guard::permit(false);
}

/// Inputs as a host sees them, of the first `axes` axes.
#[cold]
pub fn inputs(axes: usize) -> Inputs {
    let levels = read();
    let set = |is_active: fn(Levels, usize) -> bool| {
        let axes = (0..axes.min(pins::AXES)).filter(|&axis| is_active(levels, axis));
        axes.fold(0, |set, axis| set | 1 << axis)
    };
    Inputs {
        index: set(Levels::index),
        alarm: set(Levels::alarm),
        enable: !levels.is_high(pins::ENABLE),
        stop: levels.is_high(pins::STOP),
        start: levels.start(),
    }
}

/// Holds an output active or not for bring-up, and releases the one that was held. The drives are off, and nothing
/// moves.
#[cold]
pub fn hold(output: Option<(Output, bool)>) {
    release();
    let Some((output, is_active)) = output else {
        return;
    };
    IS_HELD.store(true, Ordering::Relaxed);
    let pin = match output {
        Output::DriveEnable => {
            IS_ENABLE_HELD.store(is_active, Ordering::Relaxed);
            return;
        }
        Output::Step(axis) => pins::STEP.get(usize::from(axis)),
        Output::Dir(axis) => pins::DIR.get(usize::from(axis)),
        Output::Sync => Some(&pins::SYNC),
    };
    let Some(&pin) = pin else {
        return;
    };
    // The output's own inversion is also that of its input, which a hold leaves alone.
    pac::IO_BANK0.gpio(pin.into()).ctrl().modify(|w| {
        let is_high = is_active != (w.inover() == Inover::INVERT);
        w.set_outover(if is_high { Outover::HIGH } else { Outover::LOW });
    });
}

/// Releases an output that is held.
#[inline(never)] // The loop calls it, so it must be in RAM.
fn release() {
    IS_HELD.store(false, Ordering::Relaxed);
    IS_ENABLE_HELD.store(false, Ordering::Relaxed);
    const OUTPUTS: u32 = {
        let (mut mask, mut axis) = (1 << pins::SYNC, 0);
        while axis < pins::AXES {
            mask |= 1 << pins::STEP[axis] | 1 << pins::DIR[axis];
            axis += 1;
        }
        mask
    };
    // In this form the compiler can prove that every pin exists, and that nothing can panic here.
    for pin in 0..30 {
        if OUTPUTS & 1 << pin != 0 {
            pac::IO_BANK0.gpio(pin).ctrl().modify(|w| {
                w.set_outover(Outover::from_bits(w.inover().to_bits()));
            });
        }
    }
}

/// Sets the trigger output for an oscilloscope.
pub fn sync(high: bool) {
    set(pins::SYNC, high);
}

/// Shows the state on the LED: a short flash a second in idle, quick blinking in a fault, steady light while drives are
/// on. In a fault in which the drives hold, the light has short gaps.
pub fn led(state: State, has_drives_on: bool) {
    let now_us = now_us();
    let on = match state {
        State::Idle => (now_us >> 16) & 15 == 0, // 66 ms in 1.05 s
        State::Fault if has_drives_on => (now_us >> 16) & 3 != 0, // 197 ms on, 66 ms off
        State::Fault => (now_us >> 17) & 1 == 0, // 131 ms on, 131 ms off
        _ => true,
    };
    set(pins::LED, on);
}

/// Switches the LED on or off, for firmware without settings, which has no state.
pub fn light(on: bool) {
    set(pins::LED, on);
}
