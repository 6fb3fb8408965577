//! Sets the machine up: the loop's state and its world, each in a place of its own.

use cophase_blob::board::{self, Unfit};
use cophase_core::controller::Controller;
use cophase_core::drift::IndexFilter;
use cophase_core::panel::Button;
use cophase_core::settings::{Settings, SettingsError};
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_core::units::MAX_AXES;
use embassy_rp::Peri;
use embassy_rp::peripherals::WATCHDOG;
use embassy_time::Duration;
use static_cell::{ConstStaticCell, StaticCell};

use crate::board::index::Index;
use crate::board::steps::{Buffers, Steps};
use crate::board::watchdog::Fed;
use crate::board::{CYCLES_PER_US, lines};
use crate::control::Board;
use crate::report::Reporter;

/// Why there is no machine.
#[derive(Debug, defmt::Format)]
pub enum Refusal {
    /// A setting is wrong.
    Settings(SettingsError),
    /// The board cannot run them.
    Unfit(Unfit),
}

impl Refusal {
    /// The kind of fault that it is: settings whose key is under `program` are the program's.
    #[cold]
    pub fn kind(&self) -> FaultKind {
        match self {
            Self::Settings(error) if error.key.starts_with("program") => FaultKind::ProgramRejected,
            _ => FaultKind::SettingsRejected,
        }
    }
}

/// Sets up the controller, its world and the watchdog. After a restart the controller begins in the fault state. To be called once.
///
/// # Errors
/// The settings are for a machine that cannot be, or not with this board. The watchdog was not started, and nothing moves.
#[cold]
#[inline(never)] // in a frame of its own
pub fn make(
    settings: &Settings,
    watchdog: Peri<'static, WATCHDOG>,
    restarted: bool,
    reporter: Reporter,
) -> Result<(&'static mut Controller, &'static mut Board), Refusal> {
    static CONTROLLER: ConstStaticCell<Controller> = ConstStaticCell::new(Controller::new());
    static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::new());
    static BOARD: StaticCell<Board> = StaticCell::new();

    board::check(settings).map_err(Refusal::Unfit)?;
    let controller = CONTROLLER.take();
    controller.configure(settings).map_err(Refusal::Settings)?;
    if restarted {
        controller.begin_with(Fault::new(FaultKind::Restarted));
    }

    let tick_us = 1_000_000 / settings.tick_hz;
    let mut reversed = [false; MAX_AXES];
    for (slot, axis) in reversed.iter_mut().zip(&settings.axes) {
        *slot = axis.reversed;
    }
    let axes = settings.axes.len();
    let tick = Duration::from_micros(tick_us.into());
    let levels = lines::read();
    let width = settings.index.width_cycles();
    let board = BOARD.init(Board {
        steps: Steps::new(BUFFERS.take(), &reversed[..axes], tick),
        index: Index::new(tick_us * CYCLES_PER_US),
        filters: (0..axes)
            .map(|axis| IndexFilter::new(width, levels.index(axis)))
            .collect(),
        watchdog: Fed::start(watchdog, tick_us),
        button: Button::new(settings.tick_hz),
        ticks: 0,
        state: State::Idle,
        reporter,
        sync: true,
        ran_dry: None,
        read_to: None,
    });
    Ok((controller, board))
}
