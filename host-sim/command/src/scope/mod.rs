//! `cophase scope`: a local web page that shows a controller live, and operates it.
//!
//! Only the main thread of the command communicates with the controller ([`bench`]). Every browser has its own thread
//! ([`browser`]), which passes JSON requests on one by one, and takes JSON reports and binary batches of samples from a
//! queue. Files of the page are in the binary ([`page`]). [`access`] checks each socket before it gets a thread ([`http`]).
//!
//! A stop passes none of these queues. The browser's thread requests it of the connection, which looks for it before each read
//! ([`Stops`](crate::link::stops::Stops)). A new program is checked on a thread of its own ([`program_check`]).

mod access;
mod bench;
mod browser;
mod browsers;
mod columns;
mod commands;
mod http;
mod page;
mod program_check;
mod report;
mod request;
mod scene;

use std::io::{ErrorKind, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::mpsc::{channel, sync_channel};

use clap::Args;
use cophase_link::line::UART_BAUD;

use super::address::Parts;
use super::link::connection::Connection;
use super::link::transport::{self, Faults};
use super::{CommandError, Status};
use access::Access;
use bench::Bench;
use browser::Senders;
use cophase_lab::numbers::whole;

#[derive(Debug, Args)]
#[command(
    about = "Show a controller live on a local web page, and operate it",
    after_help = "The page is served until the command is interrupted. Its address has a token: whoever has the address can move the machine."
)]
pub(crate) struct ScopeArgs {
    /// The controller: a serial port, tcp:HOST:PORT, or sim[:SCENE] for a simulated one
    #[arg(long, value_name = "WHERE")]
    to: Option<String>,
    /// Baud rate of a UART; a USB port ignores it
    #[arg(long, value_name = "BAUD", default_value_t = UART_BAUD, value_parser = whole::<u32>(1..=u32::MAX.into()), allow_negative_numbers = true)]
    baud: u32,
    /// TCP port of the page; 0 takes a free one
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole::<u16>(0..=u16::MAX.into()), allow_negative_numbers = true)]
    port: u16,
    /// Address of this computer at which the page is served
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST), value_parser = address)]
    listen: IpAddr,
    /// Ticks between two samples; a UART is too slow for every tick
    #[arg(long, value_name = "TICKS", default_value_t = 1, value_parser = whole::<u16>(1..=10_000), allow_negative_numbers = true)]
    every: u16,
    /// Scene of the program editor; by default that of --to sim, or the built-in one that the controller runs
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
}

/// Parses an address of this computer.
fn address(text: &str) -> Result<IpAddr, String> {
    text.parse().map_err(|_| {
        let parts = Parts::parse(text);
        let host = parts.host.parse().ok();
        let host = host.filter(|host: &IpAddr| !host.is_unspecified());
        let port = parts.port_number();
        let port = port.map_or_else(|| "N".to_owned(), |port| port.to_string());
        match (host, parts.port()) {
            (Some(host), Some(_)) => {
                format!("it takes an address without a port; give --listen {host} --port {port}")
            }
            (Some(host), None) => format!("it takes an address alone; give --listen {host}"),
            (None, Some(_)) => format!(
                "it takes an address in numbers, without a port; give one of this computer, such as --listen 127.0.0.1 --port {port}"
            ),
            (None, None) => {
                "give an address of this computer in numbers, such as 127.0.0.1".to_owned()
            }
        }
    })
}

/// Serves the page until the process is interrupted.
pub(crate) fn scope(args: &ScopeArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    let input = |error: String| CommandError::Input(error);
    // An IPv4 address may be written as one of IPv6.
    if args.listen.to_canonical().is_unspecified() {
        return Err(input(format!(
            "--listen {}: give one address of this computer, as the page checks that requests are for it",
            args.listen
        )));
    }
    let address = SocketAddr::new(args.listen, args.port);
    let listener = TcpListener::bind(address).map_err(|e| {
        let fix = match e.kind() {
            ErrorKind::AddrNotAvailable => {
                "give an address that this computer has, such as 127.0.0.1"
            }
            ErrorKind::PermissionDenied => "give a --port of 1024 or more, or 0 for a free one",
            _ => "give a free --port, or 0 for any",
        };
        input(format!("--listen {address}: {e}; {fix}"))
    })?;
    let address = listener.local_addr()?;
    let transport =
        transport::open(args.to.as_deref(), args.baud, Faults::Injected).map_err(input)?;
    let access = Access::new(address).map_err(|e| {
        input(format!(
            "no random token: {e}; the operating system has none"
        ))
    })?;
    let mut bench = Bench::new(Connection::new(transport), args)
        .map_err(|error| CommandError::Input(error.to_string()))?;
    // The text is written in one piece, because a program that reads the address may then close the pipe.
    out.write_all(
        format!(
            "{}\nOpen this page in a browser; Ctrl-C ends it.\n",
            access.url()
        )
        .as_bytes(),
    )?;
    out.flush()?;
    let (jobs, taken) = channel();
    let (checks, waiting) = sync_channel(1);
    let senders = Senders {
        stops: bench.link.stops(),
        jobs: jobs.clone(),
        checks,
    };
    let (settings, stops) = (bench.settings.clone(), bench.link.stops());
    std::thread::spawn(move || program_check::run(&waiting, &settings, &stops, &jobs));
    std::thread::spawn(move || http::serve(&listener, &access, &senders));
    bench
        .run(&taken)
        .map_err(|error| CommandError::Input(error.to_string()))?;
    Ok(Status::Done)
}
