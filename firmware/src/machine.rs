//! The machine, set up: the loop's state and its world.
//!
//! It is made in functions of its own, once, and not in the loop's task: that would have what it takes on its stack, and on its
//! way, in every tick.

use cophase_blob::board::{self, Unfit};
use cophase_core::controller::Controller;
use cophase_core::drift::IndexFilter;
use cophase_core::panel::Button;
use cophase_core::settings::{Ready, Settings, SettingsError};
use cophase_core::supervisor::{Fault, FaultKind, State};
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

/// A loop and its world.
pub struct Machine {
    /// The loop's state.
    pub controller: Controller,
    /// Its world.
    pub board: Board,
}

/// Why there is no machine.
#[derive(Debug, defmt::Format)]
pub enum Refusal {
    /// A setting is wrong.
    Settings(#[defmt(Display2Format)] SettingsError),
    /// The board cannot run them.
    Unfit(Unfit),
}

impl Refusal {
    /// The kind of fault that it is: settings whose key is under `program` are the program's.
    pub fn kind(&self) -> FaultKind {
        match self {
            Self::Settings(error) if error.key.starts_with("program") => FaultKind::ProgramRejected,
            _ => FaultKind::SettingsRejected,
        }
    }
}

impl Machine {
    /// Sets the machine up, and the watchdog. After a restart it begins in the fault state. To be called once.
    ///
    /// # Errors
    /// The settings are for a machine that cannot be, or not with this board. Nothing was set up.
    #[inline(never)] // in a frame of its own
    pub fn new(
        settings: &Settings,
        watchdog: Peri<'static, WATCHDOG>,
        restarted: bool,
        reporter: Reporter,
    ) -> Result<&'static mut Self, Refusal> {
        board::check(settings).map_err(Refusal::Unfit)?;
        // Looked at where it is: moved out of the result, it would be on the stack twice.
        match &settings.ready() {
            Ok(ready) => Ok(place(settings, ready, watchdog, restarted, reporter)),
            Err(error) => Err(Refusal::Settings(*error)),
        }
    }
}

#[inline(never)] // what checks settings, and what makes a machine of them, are not on the stack together
fn place(
    settings: &Settings,
    ready: &Ready<'_>,
    watchdog: Peri<'static, WATCHDOG>,
    restarted: bool,
    reporter: Reporter,
) -> &'static mut Machine {
    static MACHINE: StaticCell<Machine> = StaticCell::new();
    static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::new());

    let tick_us = 1_000_000 / settings.tick_hz;
    let mut reversed = [false; cophase_core::units::MAX_AXES];
    for (slot, axis) in reversed.iter_mut().zip(&settings.axes) {
        *slot = axis.reversed;
    }
    let axes = settings.axes.len();
    let tick = Duration::from_micros(tick_us.into());
    let levels = lines::read();
    let width = settings.index.width_cycles();
    let board = Board {
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
    };
    let machine = MACHINE.init_with(|| Machine {
        controller: ready.controller(),
        board,
    });
    if restarted {
        machine
            .controller
            .begin_with(Fault::new(FaultKind::Restarted));
    }
    machine
}
