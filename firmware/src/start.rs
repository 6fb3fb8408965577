//! Power-up: from the reset vector to a running loop, or to a lamp that says why there is none.

use cophase_core::drift::IndexFilter;
use cophase_core::panel::Button;
use cophase_core::setup::Setup;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cortex_m_rt::{ExceptionFrame, entry, exception};
use defmt_rtt as _;
use embassy_rp::Peri;
use embassy_rp::executor::{Executor, InterruptExecutor};
use embassy_rp::gpio::{Input, Pull};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::peripherals::WATCHDOG;
use embassy_time::{Duration, Timer};
use panic_probe as _;
use static_cell::{ConstStaticCell, StaticCell};

use crate::board::index::Index;
use crate::board::steps::{Buffers, Steps};
use crate::board::watchdog::{self, Fed};
use crate::board::{CYCLES_PER_US, lines};
use crate::control::{self, Board};
use crate::report::{self, Reporter};
use crate::settings;

/// Runs the guard: above the loop, so that it cuts the drives even while the loop reckons.
static GUARD: InterruptExecutor = InterruptExecutor::new();

/// Runs the loop: above all that may wait.
static LOOP: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SWI_IRQ_0() {
    // SAFETY: called from the interrupt that it was started with, and from nowhere else.
    unsafe { LOOP.on_interrupt() }
}

#[interrupt]
fn SWI_IRQ_1() {
    // SAFETY: as above.
    unsafe { GUARD.on_interrupt() }
}

/// What a panic and a fault of the core come to: drives off, and the watchdog does the rest.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    lines::cut_drives();
    loop {
        cortex_m::asm::nop();
    }
}

#[entry]
fn main() -> ! {
    let p = embassy_rp::init(embassy_rp::config::Config::default());
    lines::set_up();
    let last_seen = watchdog::last_seen();
    match last_seen {
        Some(seen) => defmt::error!("restarted by the watchdog: {}", seen),
        None => defmt::info!("power-up"),
    }
    let setup = settings::load(p.FLASH);
    let enable = Input::new(p.PIN_26, Pull::Up);

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawner.spawn(defmt::unwrap!(report::tell()));
        let Some(setup) = setup else {
            spawner.spawn(defmt::unwrap!(refuse()));
            return;
        };
        interrupt::SWI_IRQ_1.set_priority(Priority::P1);
        let guards = GUARD.start(interrupt::SWI_IRQ_1);
        guards.spawn(defmt::unwrap!(guard(enable)));
        interrupt::SWI_IRQ_0.set_priority(Priority::P2);
        let loops = LOOP.start(interrupt::SWI_IRQ_0);
        loops.spawn(defmt::unwrap!(run_loop(
            setup,
            p.WATCHDOG,
            last_seen.is_some()
        )));
    })
}

/// Cuts the drives whenever the enable input goes.
#[embassy_executor::task]
async fn guard(mut enable: Input<'static>) -> ! {
    loop {
        enable.wait_for_high().await;
        lines::cut_drives();
        enable.wait_for_low().await;
    }
}

/// Says with the lamp that there is nothing to run on: a short flash a second. The drives are off.
#[embassy_executor::task]
async fn refuse() -> ! {
    loop {
        lines::lamp_flash(true);
        Timer::after(Duration::from_millis(50)).await;
        lines::lamp_flash(false);
        Timer::after(Duration::from_millis(950)).await;
    }
}

#[embassy_executor::task]
async fn run_loop(setup: &'static Setup, watchdog: Peri<'static, WATCHDOG>, restarted: bool) {
    match setup.axes_count() {
        2 => run::<2>(setup, watchdog, restarted).await,
        3 => run::<3>(setup, watchdog, restarted).await,
        4 => run::<4>(setup, watchdog, restarted).await,
        5 => run::<5>(setup, watchdog, restarted).await,
        6 => run::<6>(setup, watchdog, restarted).await,
        axes => defmt::error!(
            "settings refused: {=usize} axes; this board drives 2 to 6",
            axes
        ),
    }
}

async fn run<const N: usize>(setup: &Setup, watchdog: Peri<'static, WATCHDOG>, restarted: bool) {
    static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::new());

    let mut controller = match setup.controller::<N>() {
        Ok(controller) => controller,
        Err(error) => {
            defmt::error!("settings refused: {}", defmt::Display2Format(&error));
            return;
        }
    };
    if restarted {
        controller.begin_with(Fault::new(FaultKind::Restarted));
    }
    let tick_hz = controller.tick_hz();
    let tick_us = 1_000_000 / tick_hz;
    let mut reversed = [false; N];
    for (slot, axis) in reversed.iter_mut().zip(&setup.axes) {
        *slot = axis.reversed;
    }
    let levels = lines::read();
    let board = Board {
        steps: Steps::new(
            BUFFERS.take(),
            &reversed,
            Duration::from_micros(tick_us.into()),
        ),
        index: Index::new(tick_us * CYCLES_PER_US),
        filters: core::array::from_fn(|axis| {
            IndexFilter::new(setup.index.width_cycles(), levels.index(axis))
        }),
        watchdog: Fed::start(watchdog, tick_us),
        button: Button::new(tick_hz),
        tick_hz,
        ticks: 0,
        state: State::Idle,
        reporter: Reporter::new(),
        sync: true,
        ran_dry: None,
        read_to: None,
    };
    control::run(controller, board).await;
}
