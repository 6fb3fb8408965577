//! Live rows of a run, which are sent during the run, in step with the wall clock.

use std::net::SocketAddr;

use cophase_files::trace::{RowShape, RowsUdp, SentRows};
use host_sim::checked::Checked;
use host_sim::live::WallClock;

use super::RunArgs;

/// Receiver of the rows, and speed of the run.
pub(super) struct Live {
    rows: Option<(SocketAddr, RowsUdp)>,
    speed: Option<f64>,
}

impl Live {
    /// Opens the socket that was requested.
    ///
    /// # Errors
    /// The receiver cannot be reached. The error is a message for the user.
    pub(super) fn new(args: &RunArgs, checked: &Checked) -> Result<Self, String> {
        let open = |receiver| match RowsUdp::new(receiver, RowShape::for_scene(checked)) {
            Ok(rows) => Ok((receiver, rows)),
            Err(error) => Err(format!(
                "--udp: no way to {receiver}: {error}; give a receiver that can be reached"
            )),
        };
        Ok(Self {
            rows: args.udp.map(open).transpose()?,
            speed: args.real_time,
        })
    }

    /// Returns the observers of a run that begins now.
    pub(super) fn begin(&mut self) -> (Option<&mut RowsUdp>, Option<WallClock>) {
        let rows = self.rows.as_mut().map(|(_, rows)| rows);
        (rows, self.speed.map(WallClock::new))
    }

    /// Ends the transmission. Returns the receiver, and the number of sent rows.
    pub(super) fn finish(self) -> Option<(SocketAddr, SentRows)> {
        self.rows.map(|(receiver, rows)| (receiver, rows.finish()))
    }
}
