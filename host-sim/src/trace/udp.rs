//! Rows as datagrams, one JSON object each, for a live plot.
//!
//! Nothing waits for the receiver: what the system does not take at once is lost, and counted. So is what the receiver's system
//! refuses, where it reports that. What is lost on the way, or by a receiver that is too slow, nobody reports.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

use super::Row;
use super::column::{Column, Topic};
use super::json::JsonColumns;

/// The key by which receivers find the time, s since power-up; that of PlotJuggler, unless it is given another.
const TIMESTAMP: &str = "timestamp";

/// Sends rows to one receiver.
pub struct RowsUdp {
    socket: UdpSocket,
    columns: JsonColumns,
    text: Vec<u8>,
    rows: u64,
    lost: u64,
}

/// How many rows were sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SentRows {
    /// Rows there were.
    pub rows: u64,
    /// Those of them that the system reported as not sent or refused.
    pub lost: u64,
}

impl RowsUdp {
    /// Opens a socket for rows of `axes` axes to a receiver.
    ///
    /// # Errors
    /// No socket, or no way to the receiver.
    pub fn new(receiver: SocketAddr, axes: usize) -> io::Result<Self> {
        let any: SocketAddr = match receiver {
            SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
            SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        let socket = UdpSocket::bind(any)?;
        socket.connect(receiver)?;
        socket.set_nonblocking(true)?;
        let stamp = Column::of_topic(Topic::Loop).next();
        let stamp = stamp.map(|time| (TIMESTAMP.to_owned(), time));
        let columns = Column::of_run(axes).map(|column| (column.name(), column));
        Ok(Self {
            socket,
            columns: JsonColumns::new(stamp.into_iter().chain(columns)),
            text: Vec::new(),
            rows: 0,
            lost: 0,
        })
    }

    /// Sends a row, which must have the socket's axes, or counts it as lost.
    pub fn send(&mut self, row: &Row) {
        self.rows += 1;
        let written = self.columns.write(row, &mut self.text);
        if written.is_err() {
            self.lost += 1;
            return;
        }
        let mut sent = self.socket.send(&self.text);
        // This is of an earlier row, and this row has not been sent yet.
        if let Err(error) = &sent
            && error.kind() == ErrorKind::ConnectionRefused
        {
            self.lost += 1;
            sent = self.socket.send(&self.text);
        }
        self.lost += u64::from(sent.is_err());
    }

    /// Ends sending, and gives the counts.
    pub fn finish(self) -> SentRows {
        let refused = self.socket.take_error().is_ok_and(|error| error.is_some());
        SentRows {
            rows: self.rows,
            lost: self.lost + u64::from(refused),
        }
    }
}
