//! Lines to a controller: a serial port, a TCP connection, or a simulated controller in this process.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use cophase_link::line::{USB_ID, USB_PRODUCT};
use cophase_link::server::Hub;
use host_sim::live::SimulatedDevice;
use serialport::{SerialPort, SerialPortInfo, SerialPortType};

use crate::scenes;

/// Time for which a read waits for bytes.
const READ_WAIT: Duration = Duration::from_millis(5);

/// A line that carries bytes both ways.
pub(super) trait Transport {
    /// Sends all bytes.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Reads what has arrived, after a short wait at most; nothing may have.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Opens the line again, after the controller has restarted; false if it is not there yet.
    fn reopen(&mut self) -> bool {
        true
    }

    /// True if the controller ends with this process.
    fn is_simulated(&self) -> bool {
        false
    }
}

/// Opens the line that `--to` names, or the one controller that is plugged in.
pub(super) fn open(to: Option<&str>, baud: u32) -> Result<Box<dyn Transport>, String> {
    let to = match to {
        Some(to) => to.to_owned(),
        None => only_port()?,
    };
    if let Some(address) = to.strip_prefix("tcp:") {
        return Ok(Box::new(Tcp::new(address)?));
    }
    match to.split_once(':') {
        Some(("sim", scene)) => Ok(Box::new(Simulated::new(scene)?)),
        _ if to == "sim" => Ok(Box::new(Simulated::new("default")?)),
        _ => Ok(Box::new(Serial::new(to, baud)?)),
    }
}

/// Serial ports, and whether a controller is at each.
pub(super) fn ports() -> Result<Vec<(SerialPortInfo, bool)>, String> {
    let ports = serialport::available_ports().map_err(|e| format!("serial ports: {e}"))?;
    let is_controller = |port: &SerialPortInfo| match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            let named = usb
                .product
                .as_deref()
                .is_none_or(|p| p.contains(USB_PRODUCT));
            (usb.vid, usb.pid) == USB_ID && named
        }
        _ => false,
    };
    let mut ports: Vec<_> = ports
        .into_iter()
        .map(|port| (is_controller(&port), port))
        .collect();
    ports.sort_by_key(|(is_ours, port)| (!is_ours, port.port_name.clone()));
    Ok(ports
        .into_iter()
        .map(|(is_ours, port)| (port, is_ours))
        .collect())
}

fn only_port() -> Result<String, String> {
    let ours: Vec<String> = ports()?
        .into_iter()
        .filter_map(|(port, is_ours)| is_ours.then_some(port.port_name))
        .collect();
    match ours.as_slice() {
        [port] => Ok(port.clone()),
        [] => Err("no controller is plugged in; connect one by USB, or give --to PORT, --to tcp:HOST:PORT or --to sim".to_owned()),
        several => Err(format!("{} controllers are plugged in; give --to with one of {}", several.len(), several.join(", "))),
    }
}

struct Serial {
    name: String,
    baud: u32,
    port: Option<Box<dyn SerialPort>>,
}

impl Serial {
    fn new(name: String, baud: u32) -> Result<Self, String> {
        let port = open_port(&name, baud)
            .map_err(|e| format!("--to {name}: {e}; `cophase link list` shows the serial ports"))?;
        Ok(Self {
            name,
            baud,
            port: Some(port),
        })
    }

    fn port(&mut self) -> io::Result<&mut Box<dyn SerialPort>> {
        self.port
            .as_mut()
            .ok_or_else(|| io::ErrorKind::NotConnected.into())
    }
}

fn open_port(name: &str, baud: u32) -> serialport::Result<Box<dyn SerialPort>> {
    let mut port = serialport::new(name, baud).timeout(READ_WAIT).open()?;
    // The controller takes the signal for an open port. A pseudo-terminal has none.
    let _ = port.write_data_terminal_ready(true);
    Ok(port)
}

impl Transport for Serial {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.port()?.write(rest) {
                Ok(count) => rest = &rest[count..],
                Err(e) if e.kind() == io::ErrorKind::TimedOut => {}
                Err(e) => return Err(e),
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        quiet(self.port()?.read(buffer))
    }

    fn reopen(&mut self) -> bool {
        self.port = None;
        self.port = open_port(&self.name, self.baud).ok();
        self.port.is_some()
    }
}

/// Nothing arrived in time: no error.
fn quiet(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock
            ) =>
        {
            Ok(0)
        }
        other => other,
    }
}

struct Tcp {
    address: String,
    stream: TcpStream,
}

impl Tcp {
    fn new(address: &str) -> Result<Self, String> {
        let stream = open_stream(address).map_err(|e| {
            format!("--to tcp:{address}: {e}; check that the controller's server listens there")
        })?;
        Ok(Self {
            address: address.to_owned(),
            stream,
        })
    }
}

fn open_stream(address: &str) -> io::Result<TcpStream> {
    let stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_WAIT))?;
    Ok(stream)
}

impl Transport for Tcp {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.write_all(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.stream.read(buffer) {
            Ok(0) if !buffer.is_empty() => Err(io::ErrorKind::ConnectionAborted.into()),
            read => quiet(read),
        }
    }

    fn reopen(&mut self) -> bool {
        open_stream(&self.address).is_ok_and(|stream| {
            self.stream = stream;
            true
        })
    }
}

/// Controller of a scene, simulated in real time in this process.
struct Simulated(Hub<SimulatedDevice, 1>);

impl Simulated {
    fn new(scene: &str) -> Result<Self, String> {
        let checked = scenes::read(scene)?;
        let refused = |e: host_sim::scene::SceneError| e.in_file(scene).to_string();
        let checked = host_sim::fidelity::check(checked).map_err(refused)?;
        let device = SimulatedDevice::new(checked, 1.0).map_err(refused)?;
        Ok(Self(Hub::new(device)))
    }
}

impl Transport for Simulated {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.receive(0, bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.poll();
        let count = self.0.transmit(0, buffer);
        if count == 0 {
            // At 10 kHz, five samples; a poll takes more.
            std::thread::sleep(Duration::from_micros(500));
        }
        Ok(count)
    }

    fn is_simulated(&self) -> bool {
        true
    }
}
