//! UART line.

use cophase_link::line::UART_BAUD;
use embassy_executor::Spawner;
use embassy_futures::join::join;
use embassy_rp::peripherals::{PIN_8, PIN_9, UART1};
use embassy_rp::uart::{
    BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config,
};
use embassy_rp::{Peri, bind_interrupts, pac};
use embassy_time::Timer;
use embedded_io_async::{Read, Write};
use static_cell::ConstStaticCell;

use super::{ROUND, SharedHub, UART_SESSION};

bind_interrupts!(struct Interrupts {
    UART1_IRQ => BufferedInterruptHandler<UART1>;
});

const RX_PIN: usize = 9;

const SEND_BYTES: usize = 256;
const RECEIVE_BYTES: usize = 512;

/// Starts the task of the line.
#[cold]
pub fn spawn(
    spawner: Spawner,
    hub: SharedHub,
    uart: Peri<'static, UART1>,
    tx: Peri<'static, PIN_8>,
    rx: Peri<'static, PIN_9>,
) {
    static SEND: ConstStaticCell<[u8; SEND_BYTES]> = ConstStaticCell::new([0; SEND_BYTES]);
    static RECEIVE: ConstStaticCell<[u8; RECEIVE_BYTES]> = ConstStaticCell::new([0; RECEIVE_BYTES]);
    let mut config = Config::default();
    config.baudrate = UART_BAUD;
    let uart = BufferedUart::new(
        uart,
        tx,
        rx,
        Interrupts,
        SEND.take(),
        RECEIVE.take(),
        config,
    );
    // A line that nothing drives is idle, and not a break.
    pac::PADS_BANK0.gpio(RX_PIN).modify(|w| {
        w.set_pue(true);
        w.set_pde(false);
    });
    let (sender, receiver) = uart.split();
    spawner.spawn(defmt::unwrap!(exchange(hub, sender, receiver)));
}

/// Task that passes bytes between the host and the server.
#[embassy_executor::task]
async fn exchange(hub: SharedHub, sender: BufferedUartTx, receiver: BufferedUartRx) -> ! {
    join(receive(hub, receiver), send(hub, sender)).await.0
}

async fn receive(hub: SharedHub, mut line: BufferedUartRx) -> ! {
    let mut bytes = [0; 64];
    loop {
        // Noise on the line damages a frame, which the server counts.
        if let Ok(length) = line.read(&mut bytes).await {
            let received = bytes.get(..length).unwrap_or_default();
            hub.borrow_mut().receive(UART_SESSION, received);
        }
    }
}

async fn send(hub: SharedHub, mut line: BufferedUartTx) -> ! {
    let mut bytes = [0; 64];
    loop {
        let length = hub.borrow_mut().transmit(UART_SESSION, &mut bytes);
        if length == 0 {
            Timer::after(ROUND).await;
            continue;
        }
        let to_send = bytes.get(..length).unwrap_or_default();
        // Writing to a UART cannot fail.
        let _ = line.write_all(to_send).await;
    }
}
