//! A simulated controller behind a TCP port, for tests of hosts: `--to tcp:127.0.0.1:PORT` reaches it as a board.
//!
//! `controller SCENE.toml [PORT]` serves one host at a time on loopback, in real time. It prints `port PORT`, and serves
//! until it is interrupted.

use std::error::Error;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::thread::sleep;
use std::time::Duration;

use cophase_link::server::Hub;
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::live::SimulatedDevice;

/// Longest wait for bytes of the host, before the controller has its turn.
const TURN: Duration = Duration::from_millis(1);

type Controller = Hub<SimulatedDevice, 1>;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("give the path of a scene")?;
    let port = args.next().map_or(Ok(0), |port| port.parse())?;
    let scene = load::parse(&std::fs::read_to_string(path)?)?;
    let device = SimulatedDevice::new(Checked::new(scene)?, 1.0)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
    listener.set_nonblocking(true)?;
    println!("port {}", listener.local_addr()?.port());
    let mut controller = Controller::new(device);
    loop {
        // The machine goes on without a host.
        controller.poll();
        match listener.accept() {
            Ok((stream, _)) => {
                controller.connect(0);
                // The host has left, or its line is lost: the next one may come.
                let _ = exchange(&mut controller, stream);
                controller.disconnect(0);
            }
            Err(_) => sleep(TURN),
        }
    }
}

/// Passes bytes in both directions until the host leaves.
fn exchange(controller: &mut Controller, mut stream: TcpStream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(TURN))?;
    let mut bytes = [0; 1024];
    loop {
        // The hub has room for a few frames only.
        while controller.poll_one() {
            send(controller, &mut stream)?;
        }
        send(controller, &mut stream)?;
        match stream.read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(count) => controller.receive(0, &bytes[..count]),
            Err(e)
                if matches!(
                    e.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) => {}
            Err(e) => return Err(e),
        }
    }
}

fn send(controller: &mut Controller, stream: &mut TcpStream) -> io::Result<()> {
    let mut bytes = [0; 1024];
    loop {
        match controller.transmit(0, &mut bytes) {
            0 => return Ok(()),
            count => stream.write_all(&bytes[..count])?,
        }
    }
}
