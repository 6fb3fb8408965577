//! Pin assignment of this board: it belongs to this crate alone, and neither the core nor `cophase_link::board` reads it.
//! `docs/wiring.md` shows this table as a diagram, and a test compares the two.
//!
//! Five axes fit the 26 pins that a Raspberry Pi Pico brings out. STEP, DIR and alarm of the sixth axis are on three
//! pins that it does not bring out. Boards of the same class with all 30 pins have them.

use cophase_link::board::{Board as _, Rp2040};

/// Greatest number of axes.
pub const AXES: usize = Rp2040::MAX_AXES;

/// STEP of each axis.
pub const STEP: [u8; AXES] = [0, 2, 4, 6, 8, 23];

/// DIR of each axis.
pub const DIR: [u8; AXES] = [1, 3, 5, 7, 9, 24];

/// Index sensor of axis 0; those of the other axes follow. One machine samples them together, so they must be
/// neighbours.
pub const INDEX: u8 = 10;

/// Alarm input of each axis's drive. Low: no alarm. High, or a broken wire: alarm.
pub const ALARM: [u8; AXES] = [16, 17, 18, 19, 20, 29];

/// Switches all drives on. Low, or a controller without power: off.
pub const DRIVE_ENABLE: u8 = 21;

/// Sync output, high in the first half of each turn of the master: a trigger for an oscilloscope.
pub const SYNC: u8 = 22;

/// LED on the board.
pub const LED: u8 = 25;

/// Enable input. Low: drives may be on. High, or a broken wire: they may not.
pub const ENABLE: u8 = 26;

/// Stop input. Low: run. High, or a broken wire: stop.
pub const STOP: u8 = 27;

/// Push button, to ground: start, and reset after a fault.
pub const START: u8 = 28;
