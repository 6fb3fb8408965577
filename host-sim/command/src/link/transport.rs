//! Lines to a controller: a serial port, a TCP connection, or a simulated controller in this process.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::server::Hub;
use host_sim::live::SimulatedDevice;
use host_sim::scene::file::FaultAt;
use host_sim::scene::load;
use serialport::SerialPort;

use super::ports;
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
        None => ports::only_controller()?,
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

/// The way out for a name that is no serial port.
fn instead_of_port(name: &str) -> String {
    let kind = name.split(':').next().unwrap_or_default();
    match load::nearest(kind, &["sim", "tcp"]) {
        Some("sim") => return "did you mean --to sim, or --to sim:SCENE?".to_owned(),
        Some(_) => return "did you mean --to tcp:HOST:PORT?".to_owned(),
        None => {}
    }
    let address = name.rsplit_once("://").map_or(name, |(_, rest)| rest);
    let address = address.split('/').next().unwrap_or_default();
    match address.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => {
            format!("for a controller's server at that address, give --to tcp:{address}")
        }
        _ => "`cophase link list` shows the serial ports".to_owned(),
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
            .map_err(|e| format!("--to {name}: {e}; {}", instead_of_port(&name)))?;
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
    /// The first bytes that arrived.
    greeting: Vec<u8>,
}

/// Beginnings of what servers of other protocols send, and what they are.
const OTHERS: [(&[u8], &str); 2] = [(b"HTTP/", "a web server"), (b"SSH-", "an SSH server")];

impl Tcp {
    /// Refuses the server of another protocol, whose bytes would be taken for noise.
    fn check_greeting(&mut self, bytes: &[u8]) -> io::Result<()> {
        let most = OTHERS.iter().map(|(begin, _)| begin.len()).max();
        let missing = most.unwrap_or_default().saturating_sub(self.greeting.len());
        self.greeting.extend(bytes.iter().take(missing));
        let other = OTHERS
            .iter()
            .find(|(begin, _)| self.greeting.starts_with(begin));
        other.map_or(Ok(()), |(_, what)| {
            Err(io::Error::other(format!(
                "{what} is at {}, and no controller; give the port at which the controller's server listens",
                self.address
            )))
        })
    }
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
            greeting: Vec::new(),
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
            read => {
                let count = quiet(read)?;
                self.check_greeting(&buffer[..count])?;
                Ok(count)
            }
        }
    }

    fn reopen(&mut self) -> bool {
        open_stream(&self.address).is_ok_and(|stream| {
            self.stream = stream;
            self.greeting.clear();
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

    #[test]
    fn a_wrong_address_is_answered_with_the_form_of_the_right_one() {
        for (to, part) in [
            ("simu", "did you mean --to sim"),
            ("sim1:gears", "did you mean --to sim"),
            ("tcpp:localhost:5000", "did you mean --to tcp:HOST:PORT"),
            ("192.0.2.5:80", "give --to tcp:192.0.2.5:80"),
            ("[::1]:80", "give --to tcp:[::1]:80"),
            ("http://localhost:3000/page", "give --to tcp:localhost:3000"),
            ("/dev/ttyACM99", "`cophase link list`"),
            ("COM99", "`cophase link list`"),
        ] {
            let error = open(Some(to), 0, Faults::OfScene).err().unwrap();
            assert!(
                error.starts_with(&format!("--to {to}: ")) && error.contains(part),
                "{error}"
            );
        }
    }

    #[test]
    fn a_server_of_another_protocol_is_named() {
        for (greeting, part) in [
            ("HTTP/1.1 400 Bad Request\r\n\r\n", "a web server is at"),
            ("SSH-2.0-OpenSSH_9.6\r\n", "an SSH server is at"),
        ] {
            let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
            let to = format!("tcp:{}", listener.local_addr().unwrap());
            let server = std::thread::spawn(move || {
                let (mut stream, _) = listener.accept().unwrap();
                // In two pieces, as the first one may be short.
                for piece in [&greeting[..2], &greeting[2..]] {
                    stream.write_all(piece.as_bytes()).unwrap();
                }
                stream
            });
            let mut line = open(Some(&to), 0, Faults::OfScene).unwrap();
            let mut buffer = [0; 64];
            let error = loop {
                match line.receive(&mut buffer) {
                    Ok(_) => {}
                    Err(error) => break error.to_string(),
                }
            };
            assert!(error.contains(part), "{error}");
            drop(server.join());
        }
    }

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
