//! Rows as datagrams, one JSON object each, for a live plot.
//!
//! Nothing waits for the receiver. A row that the system does not take at once is lost, and counted. A row that the
//! receiver's host refuses is also counted, if the host reports it. A row that is lost on the way, or by a slow receiver,
//! is not counted.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

use super::column::{Column, Topic};
use super::json::JsonColumns;
use super::{Row, RowShape};

/// Key of the time, s since power-up, for receivers. It is PlotJuggler's default key.
const TIMESTAMP: &str = "timestamp";

/// Sends rows to one receiver.
pub struct RowsUdp {
    socket: UdpSocket,
    columns: JsonColumns,
    text: Vec<u8>,
    rows: u64,
    lost: u64,
}

/// Number of sent rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SentRows {
    /// Number of all rows.
    pub rows: u64,
    /// Number of rows that the system reported as not sent or refused.
    pub lost: u64,
}

impl RowsUdp {
    /// Opens a socket for rows to a receiver.
    ///
    /// # Errors
    /// There is no socket, or no route to the receiver.
    pub fn new(receiver: SocketAddr, shape: impl Into<RowShape>) -> io::Result<Self> {
        let any: SocketAddr = match receiver {
            SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
            SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        let socket = UdpSocket::bind(any)?;
        socket.connect(receiver)?;
        socket.set_nonblocking(true)?;
        let stamp = Column::of_topic(Topic::Loop).next();
        let stamp = stamp.map(|time| (TIMESTAMP.to_owned(), time));
        let columns = Column::of_run(shape.into()).map(|column| (column.name(), column));
        Ok(Self {
            socket,
            columns: JsonColumns::new(stamp.into_iter().chain(columns)),
            text: Vec::new(),
            rows: 0,
            lost: 0,
        })
    }

    /// Sends a row, or counts it as lost.
    ///
    /// # Panics
    /// If the row has fewer axes than were stated.
    pub fn send(&mut self, row: &Row) {
        self.rows += 1;
        let written = self.columns.write(row, &mut self.text);
        if written.is_err() {
            self.lost += 1;
            return;
        }
        let mut sent = self.socket.send(&self.text);
        // This error belongs to an earlier row. The present row has not been sent yet.
        if let Err(error) = &sent
            && error.kind() == ErrorKind::ConnectionRefused
        {
            self.lost += 1;
            sent = self.socket.send(&self.text);
        }
        self.lost += u64::from(sent.is_err());
    }

    /// Ends sending, and returns the counts.
    pub fn finish(self) -> SentRows {
        let refused = self.socket.take_error().is_ok_and(|error| error.is_some());
        SentRows {
            rows: self.rows,
            lost: self.lost + u64::from(refused),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::AxisRow;
    use std::time::Duration;

    /// PlotJuggler's UDP server cuts off a datagram at this length, bytes, and reports that it is not JSON.
    const LONGEST: usize = 2048;

    /// If this fails, a machine with many axes cannot be plotted live, while one with few axes can.
    #[test]
    fn six_axes_fit_into_a_datagram() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        let wait = Some(Duration::from_secs(60));
        receiver.set_read_timeout(wait).unwrap();
        // The longest numbers that occur: those after hundreds of hours at full speed.
        let axis = AxisRow {
            steps: i64::MIN,
            command_turns: -123_456_789.123_456_79,
            actual_turns: -123_456_789.123_456_79,
            phase_error_deg: -17_999.123_45,
            is_overdue: false,
        };
        let row = Row {
            t_s: 1_000_000.123_456_789,
            state: "homing",
            amax_requested_mps2: 12_345.678_9,
            amax_commanded_mps2: 12_345.678_9,
            omega_rad_s: -12_345.678_901,
            phase_turns: -123_456_789.123_456_79,
            axes: vec![axis; 6],
            tilt_x_mrad: -1_234.567_89,
            tilt_y_mrad: -1_234.567_89,
            warp_deg: -17_999.123_45,
            z_m: -0.123_456_789,
            accel_mps2: -12_345.678_9,
            amax_actual_mps2: 12_345.678_9,
            pitch_mrad: -1_234.567_89,
            ..Row::default()
        };
        let shape = RowShape {
            axes: 6,
            pitches: true,
        };
        let mut rows = RowsUdp::new(receiver.local_addr().unwrap(), shape).unwrap();
        rows.send(&row);
        let mut buffer = [0; 65_536];
        let length = receiver.recv(&mut buffer).unwrap();
        assert!((1000..=LONGEST).contains(&length), "{length} bytes");
        assert_eq!(rows.finish(), SentRows { rows: 1, lost: 0 });
    }
}
