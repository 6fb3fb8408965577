//! Lines to a controller: a serial port, a TCP connection, or a simulated controller in this process.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::IpAddr;
use std::time::{Duration, Instant};

use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::server::Hub;
use cophase_scene::file::FaultAt;
use cophase_scene::load;
use host_sim::live::SimulatedDevice;

use super::ports;
use super::tcp::Tcp;
use crate::address::Parts;
use crate::scenes;
use serialport::SerialPort;

/// Longest wait of one read or write.
pub(super) const SHORT_WAIT: Duration = Duration::from_millis(5);

/// Longest time in which a line takes no byte. A frame takes 90 ms at 9,600 baud, so the other end is gone or does not read.
const SEND_WAIT: Duration = Duration::from_millis(1500);

/// A line that carries bytes both ways.
pub(crate) trait Transport {
    /// Sends all bytes.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Reads the bytes that have arrived, after a short wait at most. There may be none.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Returns what to check if no reply comes.
    fn check(&self) -> String {
        "check that the port is that of a controller, and the baud rate".to_owned()
    }

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
    let parts = Parts::parse(&to);
    if let Some(protocol) = parts.protocol {
        let wrong = of_protocol(protocol, &to, &parts);
        return Err(format!("--to {to}: {wrong}"));
    }
    if let Some(address) = to.strip_prefix("tcp:") {
        return Ok(Box::new(Tcp::new(address)?));
    }
    match to.split_once(':') {
        Some(("sim", scene)) => Ok(Box::new(Simulated::new(scene, faults)?)),
        _ if to == "sim" => Ok(Box::new(Simulated::new("default", faults)?)),
        _ => Ok(Box::new(Serial::new(to, baud)?)),
    }
}

/// Returns what was meant by a name that begins almost like `sim` or `tcp`.
fn near_kind(name: &str) -> Option<&'static str> {
    let kind = name.split(':').next().unwrap_or_default();
    Some(match load::nearest(kind, &["sim", "tcp"])? {
        "sim" => "did you mean --to sim, or --to sim:SCENE?",
        _ => "did you mean --to tcp:HOST:PORT?",
    })
}

/// Returns the problem and the fix of an address with the protocol of something else than a controller.
fn of_protocol(protocol: &str, to: &str, parts: &Parts<'_>) -> String {
    let server = format!(
        "for a controller's server at that address, give --to tcp:{}",
        parts.full()
    );
    // `tcp:` may stand before the address of another protocol.
    let protocol = protocol.rsplit(':').next().unwrap_or_default();
    match protocol.to_ascii_lowercase().as_str() {
        "tcp" => format!("`tcp:` takes no slashes; give --to tcp:{}", parts.full()),
        "sim" => {
            let scene = to.split_once("://").map_or("", |(_, scene)| scene);
            format!("`sim:` takes no slashes; give --to sim:{scene}")
        }
        "http" | "https" | "ws" | "wss" => format!("is a web address; {server}"),
        _ => format!("is an address of the protocol {protocol}; {server}"),
    }
}

/// Returns true for a network address that stands where a serial port is expected.
fn is_of_network(name: &str, parts: &Parts<'_>) -> bool {
    let is_path = name.contains(['/', '\\']);
    !is_path && (parts.problem().is_none() || parts.host.parse::<IpAddr>().is_ok())
}

struct Serial {
    name: String,
    baud: u32,
    port: Option<Box<dyn SerialPort>>,
}

impl Serial {
    fn new(name: String, baud: u32) -> Result<Self, String> {
        let port = open_port(&name, baud).map_err(|e| {
            let parts = Parts::parse(&name);
            match near_kind(&name) {
                Some(meant) => format!("--to {name}: {e}; {meant}"),
                None if is_of_network(&name, &parts) => format!(
                    "--to {name}: is a network address, and no serial port; for a controller's server at that address, give --to tcp:{}",
                    parts.full()
                ),
                None => format!("--to {name}: {e}; `cophase link list` shows the serial ports"),
            }
        })?;
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
    let mut port = serialport::new(name, baud).timeout(SHORT_WAIT).open()?;
    // The controller regards a port with this signal as open. A pseudo-terminal has no such signal.
    let _ = port.write_data_terminal_ready(true);
    Ok(port)
}

impl Transport for Serial {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        send_all(self.port()?, bytes)
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

/// Sends all bytes over a line whose writes end after a short wait. Fails if it takes none for [`SEND_WAIT`].
pub(super) fn send_all(line: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    send_within(SEND_WAIT, line, bytes)
}

fn send_within(longest: Duration, line: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let mut rest = bytes;
    let mut since = Instant::now();
    while !rest.is_empty() {
        let count = quiet(line.write(rest))?;
        if count > 0 {
            rest = &rest[count..];
            since = Instant::now();
        } else if since.elapsed() >= longest {
            return Err(io::Error::new(
                io::ErrorKind::TimedOut,
                format!("the line took no byte for {} ms", longest.as_millis()),
            ));
        }
    }
    Ok(())
}

/// Converts a timeout of a read or write to 0 bytes, as it is no error.
pub(super) fn quiet(read: io::Result<usize>) -> io::Result<usize> {
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

/// Controller of a scene, simulated in real time in this process.
struct Simulated {
    hub: Hub<SimulatedDevice, 1>,
    /// Bytes from the controller that were not fetched yet.
    arrived: VecDeque<u8>,
}

impl Simulated {
    fn new(scene: &str, faults: Faults) -> Result<Self, String> {
        let checked = scenes::read(scene)?;
        let refused = |e: cophase_scene::SceneError| e.in_file(scene).to_string();
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

    /// Line that takes some bytes, and then none.
    struct Stalled(usize);

    impl Write for Stalled {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = bytes.len().min(self.0).min(3);
            self.0 -= count;
            match count {
                0 => Err(io::ErrorKind::TimedOut.into()),
                count => Ok(count),
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// If this fails, a command waits forever at a line whose other end does not read.
    #[test]
    fn a_line_that_takes_no_byte_is_given_up() {
        let wait = Duration::from_millis(20);
        assert!(send_within(wait, &mut Stalled(10), &[0; 10]).is_ok());
        let error = send_within(wait, &mut Stalled(10), &[0; 11]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(
            error.to_string().contains("took no byte for 20 ms"),
            "{error}"
        );
    }

    #[test]
    fn a_wrong_address_is_answered_with_the_form_of_the_right_one() {
        for (to, part) in [
            ("simu", "did you mean --to sim"),
            ("sim1:gears", "did you mean --to sim"),
            ("tcpp:localhost:5000", "did you mean --to tcp:HOST:PORT"),
            (
                "192.0.2.5:80",
                "is a network address, and no serial port; for a controller's server at that address, give --to tcp:192.0.2.5:80",
            ),
            ("192.0.2.5", "give --to tcp:192.0.2.5:PORT"),
            ("[::1]:80", "give --to tcp:[::1]:80"),
            (
                "http://localhost:3000/page",
                "is a web address; for a controller's server at that address, give --to tcp:localhost:3000",
            ),
            ("tcp:http://board:80", "is a web address; for"),
            ("https://board", "is a web address; for"),
            ("ws://localhost:3000", "is a web address; for"),
            (
                "ssh://me@board:22",
                "is an address of the protocol ssh; for a controller's server at that address, give --to tcp:board:22",
            ),
            (
                "tcp://127.0.0.1:18080",
                "`tcp:` takes no slashes; give --to tcp:127.0.0.1:18080",
            ),
            (
                "sim://default",
                "`sim:` takes no slashes; give --to sim:default",
            ),
            (
                "tcp:127.0.0.1",
                "the port is missing; give tcp:127.0.0.1:PORT, where",
            ),
            (
                "tcp:board",
                "the port is missing; give tcp:board:PORT, where",
            ),
            (
                "tcp:board:99999",
                "port 99999 is no number from 1 to 65535; give tcp:board:PORT, where",
            ),
            ("tcp:board:http", "port http is no number"),
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
    fn what_is_no_controller_is_named() {
        for (greeting, problem) in [
            (
                "HTTP/1.1 400 Bad Request\r\n\r\n",
                "a web server is at this address, and no controller",
            ),
            (
                "<!doctype html>\n",
                "a web server is at this address, and no controller",
            ),
            (
                "SSH-2.0-OpenSSH_9.6\r\n",
                "an SSH server is at this address, and no controller",
            ),
            (
                "220 ready\r\n",
                "what listens there is no controller, as it closed the connection without a frame",
            ),
        ] {
            let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
            let to = format!("tcp:{}", listener.local_addr().unwrap());
            let server = std::thread::spawn(move || {
                let (mut stream, _) = listener.accept().unwrap();
                // In two pieces, as the first one may be short. Then the connection ends.
                for piece in [&greeting[..2], &greeting[2..]] {
                    stream.write_all(piece.as_bytes()).unwrap();
                }
            });
            let mut link = Connection::new(open(Some(&to), 0, Faults::OfScene).unwrap());
            let error = link.identify().unwrap_err().to_string();
            assert_eq!(
                error,
                format!(
                    "--to {to}: {problem}; give the port at which the controller's server listens"
                )
            );
            server.join().unwrap();
        }
    }

    /// If this fails, a user searches the baud rate of a network.
    #[test]
    fn a_server_that_does_not_answer_is_named_by_its_address() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let line = open(Some(&format!("tcp:{address}")), 0, Faults::OfScene).unwrap();
        let error = Connection::new(line).identify().unwrap_err().to_string();
        let expected = format!(
            "identify: no reply; nothing has changed; check that a controller's server listens at {address}"
        );
        assert_eq!(error, expected);
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
        for round in 1..=3 {
            std::thread::sleep(Duration::from_millis(300));
            while ticks.len() < 400 * round {
                let incoming = link.next(Duration::from_secs(60)).unwrap();
                if let Incoming::Samples(samples) = incoming.expect("samples come") {
                    ticks.extend(samples.iter().map(|sample| sample.tick));
                }
            }
        }
        assert!(
            ticks.is_sorted_by(|a, b| a + 1 == *b),
            "samples are missing"
        );
        assert_eq!(link.counters().unwrap().samples_lost, 0);
    }
}
