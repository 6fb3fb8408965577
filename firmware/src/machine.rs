//! Sets up the machine: the state of the loop and the board around it, each in a static of its own.

use cophase_core::controller::Controller;
use cophase_core::monitor::IndexFilter;
use cophase_core::panel::Panel;
use cophase_core::problem::SettingsError;
use cophase_core::settings::Settings;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_core::units::MAX_AXES;
use cophase_link::board::{self, Rp2040, Unfit};
use embassy_rp::Peri;
use embassy_rp::peripherals::WATCHDOG;
use embassy_time::Duration;
use static_cell::{ConstStaticCell, StaticCell};

use crate::board::index::Index;
use crate::board::lines::AlarmInputs;
use crate::board::steps::Steps;
use crate::board::watchdog::Fed;
use crate::board::{CYCLES_PER_US, lines, witness};
use crate::control::Board;
use crate::link::LoopEnd;
use crate::report::Reporter;

/// Reason why the machine cannot run.
#[derive(Debug, defmt::Format)]
pub enum Refusal {
    /// A setting is wrong.
    Settings(SettingsError),
    /// The board cannot run the settings.
    Unfit(Unfit),
}

impl Refusal {
    /// Kind of fault: a key under `program` is a fault of the program, any other one of the settings.
    #[cold]
    pub fn kind(&self) -> FaultKind {
        match self {
            Self::Settings(error) if error.key.starts_with("program") => FaultKind::ProgramRejected,
            _ => FaultKind::SettingsRejected,
        }
    }
}

/// Sets up the controller, the board and the watchdog. The lines of axis 0 are those of the board's axis `first_axis`. After a watchdog reset the controller begins in the fault state.
/// To be called once.
///
/// # Errors
/// The settings are wrong, or this board cannot run them. The watchdog was not started, and nothing moves.
#[cold]
#[inline(never)] // It has a stack frame of its own.
pub fn make(
    settings: &Settings,
    first_axis: usize,
    watchdog: Peri<'static, WATCHDOG>,
    after_watchdog_reset: bool,
    reporter: Reporter,
    link: LoopEnd,
) -> Result<(&'static mut Controller, &'static mut Board), Refusal> {
    static CONTROLLER: ConstStaticCell<Controller> = ConstStaticCell::new(Controller::new());
    static BOARD: StaticCell<Board> = StaticCell::new();

    board::check::<Rp2040>(settings).map_err(Refusal::Unfit)?;
    let controller = CONTROLLER.take();
    controller.configure(settings).map_err(Refusal::Settings)?;
    if after_watchdog_reset {
        controller.begin_with(Fault::new(FaultKind::WatchdogReset));
    }

    let tick_us = 1_000_000 / settings.tick_hz;
    let mut reversed = [false; MAX_AXES];
    for (slot, axis) in reversed.iter_mut().zip(&settings.axes) {
        *slot = axis.reversed;
    }
    let axes = settings.axes.len();
    let tick = Duration::from_micros(tick_us.into());
    witness::set_up();
    // Edges that were noted while the lines were set up are none of the machine's.
    let lines = lines::read_latched();
    let levels = (0..axes).fold(0, |levels, axis| {
        levels | u32::from(lines.index(first_axis + axis)) << axis
    });
    let width = settings.index_width_cycles();
    let board = BOARD.init(Board {
        steps: Steps::new(&reversed[..axes], first_axis, settings.wiring.step, tick),
        index: Index::new(tick_us * CYCLES_PER_US, first_axis),
        filter: IndexFilter::new(width, axes, levels),
        watchdog: Fed::start(watchdog, tick_us),
        panel: Panel::new(settings.tick_hz),
        ticks: 0,
        state: State::Idle,
        reporter,
        link,
        inputs: 0,
        index_count: 0,
        alarms: AlarmInputs::new(first_axis, axes),
        sync: true,
        fifo_underrun: None,
        read_to: None,
    });
    Ok((controller, board))
}
