//! A machine of so many axes, set up: the loop's state and its world.
//!
//! The number of axes is in the loop's type, and in the settings only when they are read. So all are compiled
//! in, and one is made. It is made in functions of its own, once, and not in the loop's task: that would have
//! what it takes on its stack, and on its way, in every tick.

use cophase_blob::board::{self, Unfit};
use cophase_core::controller::Controller;
use cophase_core::drift::IndexFilter;
use cophase_core::panel::Button;
use cophase_core::settings::SettingsError;
use cophase_core::setup::{Ready, Setup};
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

/// A loop and its world, of as many axes as the settings have.
#[allow(missing_docs, reason = "they are what they are called")]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one, in a place of its own"
)]
pub enum Machine {
    Two(Controller<2>, Board<2>),
    Three(Controller<3>, Board<3>),
    Four(Controller<4>, Board<4>),
    Five(Controller<5>, Board<5>),
    Six(Controller<6>, Board<6>),
}

/// Why there is no machine.
#[derive(Debug, defmt::Format)]
pub enum Refusal {
    /// A setting is wrong.
    Settings(#[defmt(Display2Format)] SettingsError),
    /// The board drives 2 to 6 axes, and not this many.
    Axes(usize),
    /// The board cannot run them.
    Unfit(Unfit),
}

impl Refusal {
    /// What that is among faults: settings whose key is under `program` are the program's.
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
    pub fn new(
        setup: &Setup,
        watchdog: Peri<'static, WATCHDOG>,
        restarted: bool,
        reporter: Reporter,
    ) -> Result<&'static mut Self, Refusal> {
        board::check(setup).map_err(Refusal::Unfit)?;
        match setup.axes_count() {
            2 => make(setup, watchdog, restarted, reporter, Self::Two),
            3 => make(setup, watchdog, restarted, reporter, Self::Three),
            4 => make(setup, watchdog, restarted, reporter, Self::Four),
            5 => make(setup, watchdog, restarted, reporter, Self::Five),
            6 => make(setup, watchdog, restarted, reporter, Self::Six),
            axes => Err(Refusal::Axes(axes)),
        }
    }

    const fn begin_with(&mut self, fault: Fault) {
        match self {
            Self::Two(controller, _) => controller.begin_with(fault),
            Self::Three(controller, _) => controller.begin_with(fault),
            Self::Four(controller, _) => controller.begin_with(fault),
            Self::Five(controller, _) => controller.begin_with(fault),
            Self::Six(controller, _) => controller.begin_with(fault),
        }
    }
}

#[inline(never)] // each number of axes in a frame of its own
fn make<const N: usize>(
    setup: &Setup,
    watchdog: Peri<'static, WATCHDOG>,
    restarted: bool,
    reporter: Reporter,
    machine: impl FnOnce(Controller<N>, Board<N>) -> Machine,
) -> Result<&'static mut Machine, Refusal> {
    // Looked at where it is: moved out of the result, it would be on the stack twice.
    match &setup.ready::<N>() {
        Ok(ready) => Ok(place(ready, watchdog, restarted, reporter, machine)),
        Err(error) => Err(Refusal::Settings(*error)),
    }
}

#[inline(never)] // what checks settings, and what makes a machine of them, are not on the stack together
fn place<const N: usize>(
    ready: &Ready<N>,
    watchdog: Peri<'static, WATCHDOG>,
    restarted: bool,
    reporter: Reporter,
    machine: impl FnOnce(Controller<N>, Board<N>) -> Machine,
) -> &'static mut Machine {
    static MACHINE: StaticCell<Machine> = StaticCell::new();
    static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::new());

    let tick_hz = ready.tick_hz();
    let tick_us = 1_000_000 / tick_hz;
    let reversed: [bool; N] = core::array::from_fn(|axis| ready.is_reversed(axis));
    let tick = Duration::from_micros(tick_us.into());
    let levels = lines::read();
    let width = ready.index_width_cycles();
    let board = Board {
        steps: Steps::new(BUFFERS.take(), &reversed, tick),
        index: Index::new(tick_us * CYCLES_PER_US),
        filters: core::array::from_fn(|axis| IndexFilter::new(width, levels.index(axis))),
        watchdog: Fed::start(watchdog, tick_us),
        button: Button::new(tick_hz),
        ticks: 0,
        state: State::Idle,
        reporter,
        sync: true,
        ran_dry: None,
        read_to: None,
    };
    let machine = MACHINE.init_with(|| machine(ready.controller(), board));
    if restarted {
        machine.begin_with(Fault::new(FaultKind::Restarted));
    }
    machine
}
