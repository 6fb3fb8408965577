//! USB line: a CDC-ACM serial port.

use core::fmt::Write;

use cophase_link::line::{USB_ID, USB_PRODUCT, USB_SERIAL_PREFIX};
use embassy_executor::Spawner;
use embassy_futures::join::join;
use embassy_futures::select::{Either, select};
use embassy_futures::yield_now;
use embassy_rp::peripherals::USB;
use embassy_rp::usb::{Driver, InterruptHandler};
use embassy_rp::{Peri, bind_interrupts, pac};
use embassy_time::Timer;
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::{Builder, Config, UsbDevice};
use static_cell::{ConstStaticCell, StaticCell};

use super::{ROUND, SharedHub, USB_SESSION};

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => InterruptHandler<USB>;
});

/// Bytes of a packet at full speed.
const PACKET_BYTES: usize = 64;

type Usb = Driver<'static, USB>;

/// Starts the tasks of the line.
#[cold]
pub fn spawn(spawner: Spawner, hub: SharedHub, usb: Peri<'static, USB>, serial: u64) {
    static SERIAL: StaticCell<heapless::String<32>> = StaticCell::new();
    static CONFIGURATION: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);
    static BOS: ConstStaticCell<[u8; 16]> = ConstStaticCell::new([0; 16]);
    static CONTROL: ConstStaticCell<[u8; 64]> = ConstStaticCell::new([0; 64]);
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    let mut config = Config::new(USB_ID.0, USB_ID.1);
    config.manufacturer = Some("Cophase");
    config.product = Some(USB_PRODUCT);
    let text = SERIAL.init(heapless::String::new());
    // There is room for 16 digits.
    let _ = write!(text, "{USB_SERIAL_PREFIX}{serial:016X}");
    config.serial_number = Some(text);
    config.max_power = 100;
    let mut builder = Builder::new(
        Driver::new(usb, Interrupts),
        config,
        CONFIGURATION.take(),
        BOS.take(),
        &mut [],
        CONTROL.take(),
    );
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET_BYTES as u16);
    let (sender, receiver, control) = class.split_with_control();
    spawner.spawn(defmt::unwrap!(run(builder.build())));
    spawner.spawn(defmt::unwrap!(exchange(hub, sender, receiver, control)));
}

#[embassy_executor::task]
async fn run(mut device: UsbDevice<'static, Usb>) -> ! {
    loop {
        select(device.run(), reset_is_pending()).await;
    }
}

/// Completes when a bus reset has waited for 3 to 6 ms.
///
/// A reset or an unplug within the data stage of a control request makes embassy-usb 0.6 wait for that request forever
/// (embassy issue 3868). A restart ends this wait.
async fn reset_is_pending() {
    let mut was_pending = false;
    loop {
        Timer::after_millis(3).await;
        let is_pending = pac::USB.sie_status().read().bus_reset();
        if was_pending && is_pending {
            return;
        }
        was_pending = is_pending;
    }
}

/// Task that passes bytes between the host and the server.
#[embassy_executor::task]
async fn exchange(
    hub: SharedHub,
    sender: Sender<'static, Usb>,
    receiver: Receiver<'static, Usb>,
    control: ControlChanged<'static>,
) -> ! {
    join(receive(hub, receiver, control), send(hub, sender))
        .await
        .0
}

async fn receive(
    hub: SharedHub,
    mut line: Receiver<'static, Usb>,
    control: ControlChanged<'static>,
) -> ! {
    let mut packet = [0; PACKET_BYTES];
    loop {
        line.wait_connection().await;
        hub.borrow_mut().connect(USB_SESSION);
        loop {
            let length =
                match select(line.read_packet(&mut packet), control.control_changed()).await {
                    Either::First(Ok(length)) => length,
                    Either::First(Err(_)) => break,
                    // Without DTR no program has the port open.
                    Either::Second(()) if !control.dtr() => {
                        hub.borrow_mut().disconnect(USB_SESSION);
                        continue;
                    }
                    Either::Second(()) => continue,
                };
            let bytes = packet.get(..length).unwrap_or_default();
            hub.borrow_mut().receive(USB_SESSION, bytes);
            // A host that sends without a break must not keep the other tasks from running.
            yield_now().await;
            while !hub.borrow().can_answer(USB_SESSION) {
                Timer::after(ROUND).await;
            }
        }
        hub.borrow_mut().disconnect(USB_SESSION);
    }
}

async fn send(hub: SharedHub, mut line: Sender<'static, Usb>) -> ! {
    let mut packet = [0; PACKET_BYTES];
    // A full packet is followed by another one, even if only an empty one. Otherwise the host would wait for more.
    let mut last_was_full = false;
    loop {
        line.wait_connection().await;
        let length = hub.borrow_mut().transmit(USB_SESSION, &mut packet);
        if length == 0 && !last_was_full {
            Timer::after(ROUND).await;
            continue;
        }
        let bytes = packet.get(..length).unwrap_or_default();
        last_was_full = line.write_packet(bytes).await.is_ok() && length == PACKET_BYTES;
    }
}
