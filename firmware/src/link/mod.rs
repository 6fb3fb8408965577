//! Host link: the controller's side of `cophase link`, over USB and UART.
//!
//! `cophase_link::server::Hub` decides and is tested on a host. This module connects it to the loop and to the lines. The
//! loop and the link exchange only queue entries: commands one way, samples and notes the other. All tasks here run in
//! the time that the loop leaves, and the interrupts of USB and UART have a lower priority than the loop's alarm.

mod device;
mod uart;
mod usb;

use core::cell::RefCell;

use cophase_link::server::Hub;
use embassy_executor::Spawner;
use embassy_futures::yield_now;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::peripherals::{PIN_8, PIN_9, UART1, USB};
use embassy_rp::{Peri, interrupt};
use embassy_time::{Duration, Timer};
use static_cell::StaticCell;

pub use device::{FirmwareDevice, LoopEnd, Running, queues, running};

/// Sessions: USB and UART.
const SESSIONS: usize = 2;
const USB_SESSION: usize = 0;
const UART_SESSION: usize = 1;

/// Greatest number of axes that leaves the pins of the UART free.
const UART_AXES: usize = 4;

/// Time between two rounds of the server, and the longest delay of a sample.
const ROUND: Duration = Duration::from_millis(2);

type SharedHub = &'static RefCell<Hub<FirmwareDevice, SESSIONS>>;

/// Peripherals of the lines.
pub struct Lines {
    /// USB device controller; it needs no pin of its own.
    pub usb: Peri<'static, USB>,
    /// UART on the STEP and DIR pins of the fifth axis.
    pub uart: Peri<'static, UART1>,
    /// TX: GPIO 8.
    pub tx: Peri<'static, PIN_8>,
    /// RX: GPIO 9.
    pub rx: Peri<'static, PIN_9>,
}

/// Starts the server and its lines: USB always, the UART if no axis uses its pins.
#[cold]
#[inline(never)]
pub fn spawn(spawner: Spawner, device: FirmwareDevice, lines: Lines) {
    static HUB: StaticCell<RefCell<Hub<FirmwareDevice, SESSIONS>>> = StaticCell::new();
    let has_uart = device.axes_with_lines() <= UART_AXES;
    let serial = device.serial();
    let hub: SharedHub = HUB.init_with(|| RefCell::new(Hub::new(device)));
    for interrupt in [interrupt::USBCTRL_IRQ, interrupt::UART1_IRQ] {
        interrupt.set_priority(Priority::P3);
    }
    spawner.spawn(defmt::unwrap!(keep_times(hub)));
    spawner.spawn(defmt::unwrap!(move_all(hub)));
    usb::spawn(spawner, hub, lines.usb, serial);
    if has_uart {
        uart::spawn(spawner, hub, lines.uart, lines.tx, lines.rx);
    }
}

/// Task that does what is due, whatever waits.
#[embassy_executor::task]
async fn keep_times(hub: SharedHub) -> ! {
    loop {
        Timer::after(ROUND).await;
        let mut hub = hub.borrow_mut();
        hub.check_times();
        hub.device().restart_if_due();
    }
}

/// Task that moves samples and events to the sessions. After each one the other tasks run, so that a stop waits for one sample and not for
/// a stream.
#[embassy_executor::task]
async fn move_all(hub: SharedHub) -> ! {
    loop {
        let has_moved = hub.borrow_mut().move_one();
        if has_moved {
            yield_now().await;
        } else {
            Timer::after(ROUND).await;
        }
    }
}
