//! Boards: the properties of the hardware that the core does not contain.
//!
//! A [`Board`] states its step clock, its capabilities, and a bound on its longest tick. Its pins and registers are in the crate
//! of its firmware. [`check()`] compares settings with a board.
//!
//! A simulated machine may need hardware that no board has. This is reported when the settings file is made. A tick rate that no board
//! keeps is refused ([`check_rate`]). The firmware refuses both, before a deadline is missed.
//!
//! To add a board, write its file here and add one line to [`BOARDS`]. `docs/recipes/add-a-board.md` has all steps. The tests in
//! `tests/board.rs` then cover it, too.

mod rp2040;

pub use rp2040::Rp2040;

use cophase_core::settings::{AxisSettings, Settings};
use cophase_core::units::MAX_AXES;

/// Interface of a board for the code that makes, checks or runs settings.
pub trait Board {
    /// Name of the board, for messages.
    const NAME: &'static str;

    /// Cycles of the step clock per second, Hz: a multiple of 1 MHz, so that a tick of whole microseconds has whole cycles.
    const CLOCK_HZ: u32;

    /// Greatest number of axes, 1 to [`MAX_AXES`].
    const MAX_AXES: usize;

    /// Time by which the loop must submit its output before it is due, µs.
    const MIN_LEAD_US: u32;

    /// Checks that the board has the hardware for an axis. `number` is the axis's place in the settings, counted from 0.
    ///
    /// # Errors
    /// Capability that the board lacks, with that number.
    fn check_axis(number: usize, axis: &AxisSettings) -> Result<(), Unfit>;

    /// Bound on the longest tick of settings at a tick rate in Hz: cycles of the step clock from a deadline to the end of the loop's
    /// work for it. No tick of these settings may take longer, whatever coincides in it.
    fn tick_cycles(settings: &Settings, tick_hz: u32) -> f64;
}

/// Least share of a tick that is free beside the longest one. Link and log run in what the loop leaves, so they also go on if every tick
/// is the longest.
const MIN_FREE: f64 = 0.05;

/// Reason why a board cannot run settings that are valid in themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unfit {
    /// The board has no fieldbus for setpoints.
    #[error(
        "axis {0} is a servo that takes setpoints over a fieldbus, which the board does not have; give drive = \"pulse-servo\" for a drive \
         that takes STEP and DIR"
    )]
    Servo(usize),
    /// The board has no inputs for encoders.
    #[error(
        "axis {0} has an encoder, and the board has no pins left to count with; remove `encoder`, or run it on the host"
    )]
    Encoder(usize),
    /// The board has outputs for fewer axes.
    #[error(
        "axes.count: the board has outputs for {max} axes, and the settings have {axes}; remove axes"
    )]
    TooManyAxes {
        /// Number of axes of the settings.
        axes: usize,
        /// Greatest number of axes of the board.
        max: usize,
    },
    /// The loop cannot finish its work within a tick.
    #[error(
        "control.tick_hz: at {tick_hz} Hz a tick is too short for the longest one of these {axes} axes; \
         give at most {max_hz} Hz"
    )]
    TickTooShort {
        /// Tick rate of the settings, Hz.
        tick_hz: u32,
        /// Number of axes.
        axes: usize,
        /// Highest tick rate that the board can run, Hz.
        max_hz: u32,
    },
}

/// Checks that a board can run settings. Their numbers must be valid otherwise. Their clock is not read.
///
/// # Errors
/// The first reason why the board cannot run them.
pub fn check<B: Board>(settings: &Settings) -> Result<(), Unfit> {
    const {
        assert!(B::CLOCK_HZ > 0 && B::CLOCK_HZ.is_multiple_of(1_000_000));
        assert!(B::MAX_AXES > 0 && B::MAX_AXES <= MAX_AXES);
    }
    let axes = settings.axes.len();
    if axes > B::MAX_AXES {
        let max = B::MAX_AXES;
        return Err(Unfit::TooManyAxes { axes, max });
    }
    for (number, axis) in settings.axes.iter().enumerate() {
        B::check_axis(number, axis)?;
    }
    if has_time::<B>(settings, settings.tick_hz) {
        return Ok(());
    }
    // A tick is a whole number of microseconds (`control.tick_hz`).
    let rates = (1..settings.tick_hz).rev();
    let max_hz = rates
        .filter(|hz| 1_000_000 % hz == 0)
        .find(|&hz| has_time::<B>(settings, hz));
    Err(Unfit::TickTooShort {
        tick_hz: settings.tick_hz,
        axes,
        max_hz: max_hz.unwrap_or(1),
    })
}

fn has_time<B: Board>(settings: &Settings, tick_hz: u32) -> bool {
    let period = f64::from(B::CLOCK_HZ / tick_hz);
    let lead_cycles = f64::from(B::MIN_LEAD_US * (B::CLOCK_HZ / 1_000_000));
    B::tick_cycles(settings, tick_hz) + lead_cycles.max(MIN_FREE * period) <= period
}

/// Checks that some board keeps the tick rate of settings. Settings for which no board has the hardware pass: their machine is run on the
/// host only.
///
/// # Errors
/// [`Unfit::TickTooShort`] of a board that has the hardware.
pub fn check_rate(settings: &Settings) -> Result<(), Unfit> {
    let mut too_short = Ok(());
    for board in BOARDS {
        match (board.check)(settings) {
            Ok(()) => return Ok(()),
            Err(unfit @ Unfit::TickTooShort { .. }) => too_short = Err(unfit),
            Err(_) => {}
        }
    }
    too_short
}

/// A board as a value, for lists of boards.
#[derive(Clone, Copy, Debug)]
pub struct AnyBoard {
    /// [`Board::NAME`].
    pub name: &'static str,
    /// [`Board::CLOCK_HZ`].
    pub clock_hz: u32,
    /// [`Board::MAX_AXES`].
    pub max_axes: usize,
    /// [`check()`] for this board.
    pub check: fn(&Settings) -> Result<(), Unfit>,
    /// [`Board::tick_cycles`].
    pub tick_cycles: fn(&Settings, u32) -> f64,
}

impl AnyBoard {
    /// Value of a board.
    pub const fn of<B: Board>() -> Self {
        Self {
            name: B::NAME,
            clock_hz: B::CLOCK_HZ,
            max_axes: B::MAX_AXES,
            check: check::<B>,
            tick_cycles: B::tick_cycles,
        }
    }
}

/// All boards.
pub const BOARDS: &[AnyBoard] = &[AnyBoard::of::<Rp2040>()];
