//! Power-up: from the reset vector to a running loop, or to an LED that shows that there are no settings to run.

use core::panic::PanicInfo;
use core::pin::pin;
use core::sync::atomic::{AtomicBool, Ordering};

use cophase_core::control_loop;
use cophase_core::controller::Controller;
use cophase_core::settings::Settings;
use cortex_m_rt::entry;
use embassy_rp::executor::Executor;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::peripherals::{FLASH, WATCHDOG};
use embassy_rp::{Peri, interrupt};
use embassy_time::{Duration, Timer};
use heapless::spsc::Producer;
use static_cell::StaticCell;

use crate::board::failure::{Failure, fail};
use crate::board::{alarm, flash, from_ram, lines, log, watchdog, witness};
use crate::control::Board;
use crate::link::{self, FirmwareDevice, Lines, LoopEnd, Running};
use crate::machine;
use crate::report::{self, Note, Reporter};
use crate::settings;

/// Handles a panic: switches the drives off first, and logs the message.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    static IS_SECOND: AtomicBool = AtomicBool::new(false);
    cortex_m::interrupt::disable();
    lines::cut_drives();
    // A second panic, from within the message, is not logged.
    if !IS_SECOND.load(Ordering::Relaxed) {
        IS_SECOND.store(true, Ordering::Relaxed);
        log::discard();
        defmt::error!("{}", defmt::Display2Format(info));
    }
    fail(Failure::Panic)
}

// Cold, so that it is in the flash: it runs before the code that belongs in RAM is there.
#[cold]
#[entry]
fn main() -> ! {
    from_ram::place();
    witness::set_canary();
    let p = embassy_rp::init(embassy_rp::config::Config::default());
    lines::set_up_led();
    let last_state = watchdog::last_state();
    match last_state {
        Some(state) => defmt::error!("reset by the watchdog: {}", state),
        None => defmt::info!("power-up"),
    }
    interrupt::TIMER_IRQ_0.set_priority(Priority::P3);
    let (notes, noted) = report::queue();
    let (loop_end, link_end) = link::queues();
    let running = link::running();
    let mut flash_chip = p.FLASH;
    running.serial = flash::serial(flash_chip.reborrow());
    let made = machine(
        flash_chip.reborrow(),
        p.WATCHDOG,
        last_state.is_some(),
        notes,
        loop_end,
        running,
    );
    let device = FirmwareDevice::new(link_end, noted, running, flash_chip);
    let lines = Lines {
        usb: p.USB,
        uart: p.UART1,
        tx: p.PIN_8,
        rx: p.PIN_9,
    };

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    let executor = EXECUTOR.init(Executor::new());
    let Some((controller, board)) = made else {
        executor.run(|spawner| {
            link::spawn(spawner, device, lines);
            spawner.spawn(defmt::unwrap!(refuse()));
        })
    };
    let task = pin!(control_loop::run(controller, board));
    alarm::run(task, || {
        executor.run(|spawner| {
            link::spawn(spawner, device, lines);
            spawner.spawn(defmt::unwrap!(witness::code()));
        })
    })
}

/// Makes the machine from the chosen settings; returns none if there are no valid settings, which is logged.
#[cold]
#[inline(never)] // Settings take kilobytes, which the stack holds no longer than needed.
fn machine(
    flash: Peri<'_, FLASH>,
    watchdog: Peri<'static, WATCHDOG>,
    after_watchdog_reset: bool,
    notes: Producer<'static, Note>,
    loop_end: LoopEnd,
    running: &mut Running,
) -> Option<(&'static mut Controller, &'static mut Board)> {
    let mut settings = Settings::new();
    let file = settings::load(flash, &mut settings)?;
    lines::set_up(&settings.wiring);
    let only_axis = watchdog::only_axis()
        .map(usize::from)
        .filter(|&axis| axis < settings.axes.len());
    if let Some(only) = only_axis {
        // All drives are enabled together.
        let others = (0..settings.axes.len()).filter(|&axis| axis != only);
        others.for_each(|axis| lines::rest(axis, &settings.wiring));
    }
    running.take_over(&mut settings, only_axis, file);
    let reporter = Reporter::new(notes, settings.axes.len());
    let made = machine::make(
        &settings,
        only_axis.unwrap_or(0),
        watchdog,
        after_watchdog_reset,
        reporter,
        loop_end,
    );
    let (controller, board) = made
        .inspect_err(|refusal| report::refused(refusal.kind(), refusal))
        .ok()?;
    running.runs(*controller.mechanism());
    Some((controller, board))
}

/// Task that shows that there are no settings to run: two short flashes of the LED a second. The drives are off.
#[embassy_executor::task]
async fn refuse() -> ! {
    loop {
        for dark_ms in [150, 750] {
            lines::light(true);
            Timer::after(Duration::from_millis(50)).await;
            lines::light(false);
            Timer::after(Duration::from_millis(dark_ms)).await;
        }
    }
}
