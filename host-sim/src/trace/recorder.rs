//! Observer of a scene's run that writes its traces.

use std::io::{Seek, Write};

use cophase_link::sample::Sample;

use super::mcap::McapTraceError;
use super::overdue::PhaseSensor;
use super::rows::Every;
use super::traces::{TraceSetup, Traces};
use super::window::Window;
use super::{
    ControllerRows, EdgeError, Format, Row, RowShape, RowsUdp, ScopeData, TickEdges, TraceError,
};
use crate::scene::Checked;
use crate::sim::{Moment, Observer};

/// Error while a trace was written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// In `trace.csv`.
    #[error("{file}: {0}", file = Format::Csv.file_name())]
    Csv(#[from] TraceError),
    /// In `trace.mcap`.
    #[error("{file}: {0}", file = Format::Mcap.file_name())]
    Mcap(#[from] McapTraceError),
    /// In a file of edges.
    #[error("edges: {0}")]
    Edges(#[from] EdgeError),
}

/// Writes the files of a trace, and collects the data for `scope.svg`.
pub struct Recorder<'a, W: Write + Seek> {
    traces: Traces<'a, W>,
    rows: ControllerRows,
    row: Row,
    sensors: Vec<PhaseSensor>,
    reversed: Vec<bool>,
    failed: Option<RecordError>,
}

impl<'a, W: Write + Seek + 'a> Recorder<'a, W> {
    /// Writes a scene's run to `files`, of which each format has at most one. Sends its rows to `udp`, and fills `scope`.
    ///
    /// # Errors
    /// A header cannot be written.
    pub fn new(
        checked: &Checked,
        files: impl IntoIterator<Item = (Format, W)>,
        udp: Option<&'a mut RowsUdp>,
        every: Every,
        window: Window,
        scope: ScopeData,
    ) -> Result<Self, RecordError> {
        let axes = checked.scene.axes.count;
        let reversed = (0..axes)
            .map(|i| checked.overrides(i).is_some_and(|own| own.reversed))
            .collect();
        let setup = TraceSetup {
            shape: RowShape::of(checked),
            every,
            window,
            unknown: &[],
        };
        Ok(Self {
            traces: Traces::new(&setup, files, udp, scope)?,
            rows: ControllerRows::new(&checked.settings),
            row: Row::of_axes(axes),
            sensors: (0..axes).map(|i| PhaseSensor::new(checked, i)).collect(),
            reversed,
            failed: None,
        })
    }

    /// Closes the files. Returns the form of the written trace, and the content of the scope.
    ///
    /// # Errors
    /// The first error of a file.
    pub fn finish(self) -> Result<(crate::report::Written, ScopeData), RecordError> {
        match self.failed {
            Some(error) => Err(error),
            None => self.traces.finish(),
        }
    }

    fn fill(&mut self, moment: &Moment<'_>) {
        // The row has the time of the tick that is played, and not the number of the tick in which it was planned.
        let sample = Sample::new(0, moment.telemetry, 0, 0);
        let row = &mut self.row;
        let (master_turns, command_turns) = (moment.master_turns, moment.command_turns);
        self.rows
            .fill(row, moment.end_ns, &sample, master_turns, command_turns);
        for (i, (axis, sensor)) in row.axes.iter_mut().zip(&mut self.sensors).enumerate() {
            axis.actual_turns = moment.actual_turns[i];
            axis.is_overdue = sensor.is_overdue(command_turns[i], moment.index[i].is_some());
        }
        let pose = moment.pose();
        row.tilt_x_mrad = pose.tilt_x_mrad;
        row.tilt_y_mrad = pose.tilt_y_mrad;
        row.warp_deg = pose.warp_deg;
        row.z_m = pose.z_m;
        row.accel_mps2 = pose.accel_mps2;
        row.pitch_mrad = pose.pitch_mrad;
    }
}

impl<'a, W: Write + Seek + 'a> Observer for Recorder<'a, W> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if self.failed.is_some() {
            return;
        }
        self.fill(moment);
        let edges = TickEdges::of(moment, &self.reversed);
        let done = self
            .traces
            .push_row(&self.row)
            .and_then(|()| self.traces.push_edges(&edges, Some(&self.row)));
        self.failed = done.err();
    }
}
