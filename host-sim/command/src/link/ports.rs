//! Serial ports, and which of them are controllers.
//!
//! A controller is known by its USB vendor and product number, and by the beginning of its serial number. Its product name does not
//! serve: Windows gives the name of its own driver instead ("USB Serial Device (COM5)").

use std::collections::BTreeMap;

use cophase_link::line::{USB_ID, USB_SERIAL_PREFIX};
use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};

/// A serial port of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Port {
    pub(crate) name: String,
    pub(crate) device: Device,
}

/// Device at a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Device {
    /// A controller, by its serial number.
    Controller(String),
    /// A USB device with the controllers' number and another serial number.
    SameId(String),
    Other(String),
}

impl Device {
    fn new(kind: &SerialPortType) -> Self {
        match kind {
            SerialPortType::UsbPort(usb) => Self::usb(usb),
            SerialPortType::BluetoothPort => Self::Other("Bluetooth".to_owned()),
            SerialPortType::PciPort | SerialPortType::Unknown => {
                Self::Other("serial port".to_owned())
            }
        }
    }

    fn usb(usb: &UsbPortInfo) -> Self {
        let name = || usb.product.clone().unwrap_or_else(|| "USB".to_owned());
        if (usb.vid, usb.pid) != USB_ID {
            return Self::Other(name());
        }
        // Windows has capitals only.
        let serial = usb.serial_number.as_deref().unwrap_or_default();
        let serial = serial.to_ascii_uppercase();
        match serial.strip_prefix(USB_SERIAL_PREFIX) {
            Some(number) => Self::Controller(number.to_owned()),
            None => Self::SameId(name()),
        }
    }
}

/// The serial ports, controllers first.
pub(crate) fn ports() -> Result<Vec<Port>, String> {
    let found = serialport::available_ports().map_err(|e| format!("serial ports: {e}"))?;
    Ok(sorted(found))
}

fn sorted(found: Vec<SerialPortInfo>) -> Vec<Port> {
    let names: Vec<String> = found.iter().map(|port| port.port_name.clone()).collect();
    // macOS lists each device twice. The name with `tty` waits for a modem's carrier.
    let is_twin = |name: &str| {
        let twin = name.strip_prefix("/dev/tty.");
        twin.is_some_and(|device| names.contains(&format!("/dev/cu.{device}")))
    };
    let ports = found.into_iter().filter(|port| !is_twin(&port.port_name));
    let mut ports: Vec<Port> = ports
        .map(|port| Port {
            device: Device::new(&port.port_type),
            name: port.port_name,
        })
        .collect();
    ports.sort_by_key(|port| (kind_order(&port.device), port.name.clone()));
    ports
}

const fn kind_order(device: &Device) -> u8 {
    match device {
        Device::Controller(_) => 0,
        Device::SameId(_) => 1,
        Device::Other(_) => 2,
    }
}

/// The port of the one controller that is plugged in.
pub(crate) fn only_controller() -> Result<String, String> {
    the_only(&ports()?)
}

fn the_only(ports: &[Port]) -> Result<String, String> {
    // By serial number, as a board may have several ports.
    let mut boards: BTreeMap<&str, &str> = BTreeMap::new();
    for port in ports {
        if let Device::Controller(serial) = &port.device {
            boards.entry(serial).or_insert(&port.name);
        }
    }
    let names: Vec<&str> = boards.into_values().collect();
    match names.as_slice() {
        [name] => Ok((*name).to_owned()),
        [] => {
            let same_id = ports
                .iter()
                .find(|port| matches!(port.device, Device::SameId(_)));
            let hint = same_id.map_or(String::new(), |port| {
                format!(
                    "; {} has a controller's USB number, but no serial number of one: if its firmware is of an earlier version, give --to {}",
                    port.name, port.name
                )
            });
            Err(format!(
                "no controller is plugged in; connect one by USB, or give --to PORT, --to tcp:HOST:PORT or --to sim{hint}"
            ))
        }
        several => Err(format!(
            "{} controllers are plugged in; give --to with one of {}",
            several.len(),
            several.join(", ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn usb(
        name: &str,
        id: (u16, u16),
        serial: Option<&str>,
        product: Option<&str>,
    ) -> SerialPortInfo {
        SerialPortInfo {
            port_name: name.to_owned(),
            port_type: SerialPortType::UsbPort(UsbPortInfo {
                vid: id.0,
                pid: id.1,
                serial_number: serial.map(str::to_owned),
                manufacturer: None,
                product: product.map(str::to_owned),
            }),
        }
    }

    fn plain(name: &str, port_type: SerialPortType) -> SerialPortInfo {
        SerialPortInfo {
            port_name: name.to_owned(),
            port_type,
        }
    }

    const SERIAL: &str = "COPHASE-E6614104032B592A";
    const OTHER_SERIAL: &str = "COPHASE-E6614104032B0001";
    const PRODUCT: Option<&str> = Some("Cophase controller");

    /// Port lists as `serialport` makes them on each system, from the descriptors of the firmware, and of devices that its sources and
    /// tests name. With the port that is used, or a part of the refusal.
    #[test]
    fn the_one_controller_is_found_in_the_port_lists_of_all_systems() {
        let pico = (0x2e8a, 0x000a);
        let ftdi = (0x0403, 0x6001);
        let windows = |n: u8| format!("USB Serial Device (COM{n})");
        let cases: Vec<(&str, Vec<SerialPortInfo>, Result<&str, &str>)> = vec![
            (
                "Linux, one board",
                vec![usb("/dev/ttyACM0", USB_ID, Some(SERIAL), PRODUCT)],
                Ok("/dev/ttyACM0"),
            ),
            (
                "Linux without udev, which has no product name",
                vec![usb("/dev/ttyACM0", USB_ID, Some(SERIAL), None)],
                Ok("/dev/ttyACM0"),
            ),
            (
                "Linux, beside a mainboard's ports",
                vec![
                    plain("/dev/ttyS0", SerialPortType::PciPort),
                    plain("/dev/ttyS4", SerialPortType::Unknown),
                    usb("/dev/ttyACM1", USB_ID, Some(SERIAL), PRODUCT),
                ],
                Ok("/dev/ttyACM1"),
            ),
            (
                "Linux, beside an adapter and a debug probe",
                vec![
                    usb(
                        "/dev/ttyUSB0",
                        ftdi,
                        Some("A702TB52"),
                        Some("FT232R USB UART"),
                    ),
                    usb(
                        "/dev/ttyACM0",
                        (0x2e8a, 0x000c),
                        Some("E6614C311B7A8B21"),
                        Some("Debug Probe (CMSIS-DAP)"),
                    ),
                    usb("/dev/ttyACM1", USB_ID, Some(SERIAL), PRODUCT),
                ],
                Ok("/dev/ttyACM1"),
            ),
            (
                "Linux, two boards",
                vec![
                    usb("/dev/ttyACM0", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/ttyACM1", USB_ID, Some(OTHER_SERIAL), PRODUCT),
                ],
                Err(
                    "2 controllers are plugged in; give --to with one of /dev/ttyACM1, /dev/ttyACM0",
                ),
            ),
            (
                "Linux, another device with the test number",
                vec![usb(
                    "/dev/ttyACM0",
                    USB_ID,
                    Some("0123456789ABCDEF"),
                    Some("Blinky"),
                )],
                Err("/dev/ttyACM0 has a controller's USB number"),
            ),
            ("Linux, nothing", vec![], Err("no controller is plugged in")),
            (
                "Windows, one board, whose product name is that of the driver",
                vec![usb("COM5", USB_ID, Some(SERIAL), Some(&windows(5)))],
                Ok("COM5"),
            ),
            (
                "Windows, a serial number in small letters",
                vec![usb(
                    "COM5",
                    USB_ID,
                    Some("cophase-e6614104032b592a"),
                    Some(&windows(5)),
                )],
                Ok("COM5"),
            ),
            (
                "Windows, beside a Pico with MicroPython and a mainboard's port",
                vec![
                    plain("COM1", SerialPortType::Unknown),
                    usb("COM4", pico, Some("E660583883724A32"), Some(&windows(4))),
                    usb("COM12", USB_ID, Some(SERIAL), Some(&windows(12))),
                ],
                Ok("COM12"),
            ),
            (
                "Windows, beside an FTDI adapter",
                vec![
                    usb(
                        "COM3",
                        ftdi,
                        Some("A702TB52A"),
                        Some("USB Serial Port (COM3)"),
                    ),
                    usb("COM4", USB_ID, Some(SERIAL), Some(&windows(4))),
                ],
                Ok("COM4"),
            ),
            (
                "Windows, a device without a serial number: its place on the hub",
                vec![usb("COM6", USB_ID, Some("6"), Some(&windows(6)))],
                Err("COM6 has a controller's USB number"),
            ),
            (
                "Windows, two boards",
                vec![
                    usb("COM5", USB_ID, Some(SERIAL), Some(&windows(5))),
                    usb("COM6", USB_ID, Some(OTHER_SERIAL), Some(&windows(6))),
                ],
                Err("2 controllers are plugged in"),
            ),
            (
                "macOS, one board, which is listed twice",
                vec![
                    usb("/dev/tty.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/cu.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                ],
                Ok("/dev/cu.usbmodem1101"),
            ),
            (
                "macOS, beside Bluetooth",
                vec![
                    plain(
                        "/dev/cu.Bluetooth-Incoming-Port",
                        SerialPortType::BluetoothPort,
                    ),
                    plain(
                        "/dev/tty.Bluetooth-Incoming-Port",
                        SerialPortType::BluetoothPort,
                    ),
                    usb("/dev/cu.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/tty.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                ],
                Ok("/dev/cu.usbmodem1101"),
            ),
            (
                "macOS, two boards",
                vec![
                    usb("/dev/cu.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/tty.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/cu.usbmodem1201", USB_ID, Some(OTHER_SERIAL), PRODUCT),
                    usb("/dev/tty.usbmodem1201", USB_ID, Some(OTHER_SERIAL), PRODUCT),
                ],
                Err("2 controllers are plugged in"),
            ),
            (
                "macOS, a board and another device on the same hub",
                vec![
                    usb(
                        "/dev/cu.usbserial-A702TB52",
                        ftdi,
                        Some("A702TB52"),
                        Some("FT232R USB UART"),
                    ),
                    usb(
                        "/dev/tty.usbserial-A702TB52",
                        ftdi,
                        Some("A702TB52"),
                        Some("FT232R USB UART"),
                    ),
                    usb("/dev/cu.usbmodem21301", USB_ID, Some(SERIAL), PRODUCT),
                    usb("/dev/tty.usbmodem21301", USB_ID, Some(SERIAL), PRODUCT),
                ],
                Ok("/dev/cu.usbmodem21301"),
            ),
        ];
        for (system, found, expected) in cases {
            let chosen = the_only(&sorted(found));
            match (&chosen, expected) {
                (Ok(port), Ok(expected)) => assert_eq!(port, expected, "{system}"),
                (Err(error), Err(part)) => assert!(error.contains(part), "{system}: {error}"),
                _ => panic!("{system}: {chosen:?}, not {expected:?}"),
            }
        }
    }

    #[test]
    fn the_list_has_each_device_once_and_controllers_first() {
        let ports = sorted(vec![
            plain(
                "/dev/cu.Bluetooth-Incoming-Port",
                SerialPortType::BluetoothPort,
            ),
            plain(
                "/dev/tty.Bluetooth-Incoming-Port",
                SerialPortType::BluetoothPort,
            ),
            plain("/dev/tty.only", SerialPortType::Unknown),
            usb("/dev/tty.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
            usb("/dev/cu.usbmodem1101", USB_ID, Some(SERIAL), PRODUCT),
        ]);
        let names: Vec<&str> = ports.iter().map(|port| port.name.as_str()).collect();
        let expected = [
            "/dev/cu.usbmodem1101",
            "/dev/cu.Bluetooth-Incoming-Port",
            "/dev/tty.only",
        ];
        assert_eq!(names, expected);
        assert_eq!(
            ports[0].device,
            Device::Controller("E6614104032B592A".to_owned())
        );
    }
}
