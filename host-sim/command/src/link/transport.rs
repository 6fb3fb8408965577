//! Lines to a controller: a serial port, a TCP connection, or a simulated controller in this process.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::line::{USB_ID, USB_PRODUCT};
use cophase_link::server::Hub;
use host_sim::live::SimulatedDevice;
use host_sim::scene::file::FaultAt;
use serialport::{SerialPort, SerialPortInfo, SerialPortType};

use crate::scenes;

/// Longest wait of a read for bytes.
const READ_WAIT: Duration = Duration::from_millis(5);

/// A line that carries bytes both ways.
pub(crate) trait Transport {
    /// Sends all bytes.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Reads the bytes that have arrived, after a short wait at most. There may be none.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Opens the line again after the controller has restarted. Returns false if the controller is not there yet.
    fn reopen(&mut self) -> bool {
        true
    }

    /// Returns true if the controller ends with this process.
    fn is_simulated(&self) -> bool {
        false
    }

    /// Injects a fault into a simulated machine, now.
    fn inject(&mut self, _fault: &FaultAt) -> Result<(), String> {
        Err("this machine is not simulated; faults are injected with --to sim".to_owned())
    }
}

/// Faults of a simulated machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Faults {
    /// Those of its scene.
    OfScene,
    /// Also those of [`Transport::inject`].
    Injected,
}

/// Opens the line that `--to` names, or the one controller that is plugged in.
pub(crate) fn open(
    to: Option<&str>,
    baud: u32,
    faults: Faults,
) -> Result<Box<dyn Transport>, String> {
    let to = match to {
        Some(to) => to.to_owned(),
        None => only_port()?,
    };
    if let Some(address) = to.strip_prefix("tcp:") {
        return Ok(Box::new(Tcp::new(address)?));
    }
    match to.split_once(':') {
        Some(("sim", scene)) => Ok(Box::new(Simulated::new(scene, faults)?)),
        _ if to == "sim" => Ok(Box::new(Simulated::new("default", faults)?)),
        _ => Ok(Box::new(Serial::new(to, baud)?)),
    }
}

/// Returns the serial ports, each with true if a controller is connected to it.
pub(crate) fn ports() -> Result<Vec<(SerialPortInfo, bool)>, String> {
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
    // The controller regards a port with this signal as open. A pseudo-terminal has no such signal.
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

/// Converts a timeout of a read to 0 bytes, as it is no error.
fn quiet(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
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
            format!(
                "--to tcp:{address}: {e}; give tcp:HOST:PORT, where the controller's server listens"
            )
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
struct Simulated {
    hub: Hub<SimulatedDevice, 1>,
    /// Bytes from the controller that were not fetched yet.
    arrived: VecDeque<u8>,
}

impl Simulated {
    fn new(scene: &str, faults: Faults) -> Result<Self, String> {
        let checked = scenes::read(scene)?;
        let refused = |e: host_sim::scene::SceneError| e.in_file(scene).to_string();
        let checked = host_sim::fidelity::check(checked).map_err(refused)?;
        let device = match faults {
            Faults::OfScene => SimulatedDevice::new(checked, 1.0),
            Faults::Injected => SimulatedDevice::open_to_faults(checked, 1.0),
        };
        let device = device.map_err(refused)?;
        Ok(Self {
            hub: Hub::new(device),
            arrived: VecDeque::new(),
        })
    }

    /// Fetches the bytes that wait in the loop. The hub has room for a few frames only. It is emptied after every sample, so
    /// that no frame is lost after a long time without a call.
    fn fetch(&mut self) {
        let mut bytes = [0; MAX_FRAME_BYTES];
        loop {
            let may_be_more = self.hub.poll_one();
            loop {
                let count = self.hub.transmit(0, &mut bytes);
                if count == 0 {
                    break;
                }
                self.arrived.extend(&bytes[..count]);
            }
            if !may_be_more {
                return;
            }
        }
    }
}

impl Transport for Simulated {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.fetch();
        self.hub.receive(0, bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.fetch();
        if self.arrived.is_empty() {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.arrived.read(buffer)
    }

    fn reopen(&mut self) -> bool {
        self.hub.disconnect(0);
        self.arrived.clear();
        true
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn inject(&mut self, fault: &FaultAt) -> Result<(), String> {
        let injected = self.hub.device().inject(fault);
        injected.map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use cophase_link::message::Request;
    use cophase_link::sample::ALL_CHANNELS;

    use super::*;
    use crate::link::connection::{Connection, Incoming};

    /// If this fails, a host that reads late loses samples. The hub has room for a few frames, so samples must be fetched
    /// one by one.
    #[test]
    fn a_host_that_comes_late_loses_no_sample_of_the_simulated_controller() {
        let mut link = Connection::new(open(Some("sim"), 0, Faults::OfScene).unwrap());
        link.identify().unwrap();
        let (channels, every) = (ALL_CHANNELS, 1);
        link.repeatable("samples", &Request::Stream { channels, every })
            .unwrap();
        let mut ticks = Vec::new();
        for _ in 0..3 {
            std::thread::sleep(Duration::from_millis(300));
            while let Some(incoming) = link.next(Duration::from_millis(1)).unwrap() {
                if let Incoming::Samples(samples) = incoming {
                    ticks.extend(samples.iter().map(|sample| sample.tick));
                }
            }
        }
        assert!(ticks.len() > 1000, "only {} samples came", ticks.len());
        assert!(
            ticks.is_sorted_by(|a, b| a + 1 == *b),
            "samples are missing"
        );
        assert_eq!(link.counters().unwrap().samples_lost, 0);
    }
}
