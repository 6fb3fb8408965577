//! Looks on while a scene runs, and writes down what is to be written.

use std::io::{Seek, Write};

use cophase_core::mechanism::{AnyMechanism, Mechanism};

use super::edges::EdgeOutputs;
use super::mcap::{McapTraceError, TraceMcap};
use super::rows::{Every, RowWriter, Rows};
use super::window::{StepWindow, Window};
use super::{AxisRow, EdgeError, Format, Row, RowsUdp, ScopeData, TraceCsv, TraceError};
use crate::scene::Checked;
use crate::sim::{Moment, Observer};
use crate::units::{degrees, speed_hz};

/// What went wrong while a trace was written.
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

/// Writes the files of a trace, and gathers what `scope.svg` is drawn from.
pub struct Recorder<'a, W: Write + Seek> {
    rows: Rows<'a>,
    steps: StepWindow<W>,
    scope: ScopeData,
    row: Row,
    reversed: Vec<bool>,
    failed: Option<RecordError>,
    tick_hz: u32,
    mechanism: AnyMechanism,
}

impl<'a, W: Write + Seek + 'a> Recorder<'a, W> {
    /// Writes to `files`, one of each format at most, what a scene's run shows; sends its rows to `udp`; and gathers `scope`.
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
        let mut rows: Vec<Box<dyn RowWriter + 'a>> = Vec::new();
        let mut edges = EdgeOutputs::default();
        for (format, w) in files {
            match format {
                Format::Csv => rows.push(Box::new(TraceCsv::new(w, axes)?)),
                Format::Mcap => rows.push(Box::new(TraceMcap::new(w, axes)?)),
                Format::Vcd => edges.vcd = Some(w),
                Format::Fst => edges.fst = Some(w),
            }
        }
        if let Some(udp) = udp {
            rows.push(Box::new(udp));
        }
        Ok(Self {
            rows: Rows::new(rows, every),
            steps: StepWindow::new(edges, window),
            scope,
            row: Row {
                axes: vec![AxisRow::default(); axes],
                ..Row::default()
            },
            reversed,
            failed: None,
            tick_hz: checked.scene.control.tick_hz,
            mechanism: checked.settings.mechanism(),
        })
    }

    /// Closes the files; returns how the trace was written, and what the scope shows.
    ///
    /// # Errors
    /// The first thing that went wrong with a file.
    pub fn finish(self) -> Result<(crate::report::Written, ScopeData), RecordError> {
        if let Some(error) = self.failed {
            return Err(error);
        }
        let (every, rows) = self.rows.finish()?;
        let (from_ns, to_ns) = self.steps.finish(self.row.axes.len())?;
        let written = crate::report::Written {
            every,
            rows,
            window_from_s: from_ns as f64 * 1e-9,
            window_to_s: to_ns as f64 * 1e-9,
        };
        Ok((written, self.scope))
    }

    fn fill(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let hz = speed_hz(telemetry.motion.speed, self.tick_hz);
        let omega = hz * std::f64::consts::TAU;
        let pose = moment.pose();
        let row = &mut self.row;
        row.t_s = moment.end_ns as f64 * 1e-9;
        row.state = telemetry.state.name();
        row.state_code = telemetry.state as u8;
        row.amax_requested_mps2 = telemetry.amax_requested.to_num();
        row.amax_commanded_mps2 = self.mechanism.amax(telemetry.motion.speed).to_num();
        row.omega_rad_s = omega;
        row.phase_turns = moment.master_turns;
        for (i, axis) in row.axes.iter_mut().enumerate() {
            axis.steps = telemetry.steps(i);
            axis.command_turns = moment.command_turns[i];
            axis.actual_turns = moment.actual_turns[i];
            axis.phase_error_deg = degrees(telemetry.phase_error[i]);
        }
        row.tilt_x_mrad = pose.tilt_x_mrad;
        row.tilt_y_mrad = pose.tilt_y_mrad;
        row.warp_deg = pose.warp_deg;
        row.z_m = pose.z_m;
        row.accel_mps2 = pose.accel_mps2;
    }
}

impl<'a, W: Write + Seek + 'a> Observer for Recorder<'a, W> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if self.failed.is_some() {
            return;
        }
        self.fill(moment);
        self.scope.push(&self.row);
        let edges = &mut self.steps;
        let done = self.rows.push(&self.row).and_then(|()| {
            edges
                .tick(moment, &self.reversed, &self.row)
                .map_err(RecordError::from)
        });
        self.failed = done.err();
    }
}

impl<W: Write> RowWriter for TraceCsv<W> {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        Ok(self.write(row)?)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        (*self).finish()?;
        Ok(())
    }
}

impl<W: Write + Seek> RowWriter for TraceMcap<W> {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        Ok(self.write(row)?)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        (*self).finish()?;
        Ok(())
    }
}

/// What cannot be sent is counted, and is no reason to end a run.
impl RowWriter for &mut RowsUdp {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        self.send(row);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        Ok(())
    }
}
