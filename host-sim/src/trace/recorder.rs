//! Looks on while a scene runs, and writes down what is to be written.

use std::io::Write;

use cophase_core::mechanism::{AnyMechanism, Mechanism};

use super::rows::{Every, Rows};
use super::window::{StepWindow, Window};
use super::{AxisRow, Row, ScopeData, TraceCsv, TraceError, VcdError};
use crate::scene::Checked;
use crate::sim::{Moment, Observer};
use crate::units::{degrees, speed_hz};

/// What went wrong while a trace was written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// In `trace.csv`.
    #[error("trace.csv: {0}")]
    Csv(#[from] TraceError),
    /// In `steps.vcd`.
    #[error("steps.vcd: {0}")]
    Vcd(#[from] VcdError),
}

/// Writes `trace.csv` and `steps.vcd`, and gathers what `scope.svg` is drawn from.
pub struct Recorder<C: Write, V: Write> {
    rows: Rows<C>,
    steps: StepWindow<V>,
    scope: ScopeData,
    row: Row,
    reversed: Vec<bool>,
    failed: Option<RecordError>,
    tick_hz: u32,
    mechanism: AnyMechanism,
}

impl<C: Write, V: Write> Recorder<C, V> {
    /// Writes to `csv` and `vcd` what a scene's run shows, and gathers `scope`.
    ///
    /// # Errors
    /// The trace's header cannot be written.
    pub fn new(
        checked: &Checked,
        csv: C,
        vcd: V,
        every: Every,
        window: Window,
        scope: ScopeData,
    ) -> Result<Self, RecordError> {
        let axes = checked.scene.axes.count;
        let reversed = (0..axes)
            .map(|i| checked.overrides(i).is_some_and(|own| own.reversed))
            .collect();
        Ok(Self {
            rows: Rows::new(TraceCsv::new(csv, axes)?, every),
            steps: StepWindow::new(vcd, window),
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

    /// Closes both files; returns how the trace was written, and what the scope shows.
    ///
    /// # Errors
    /// The first thing that went wrong with either file.
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

impl<C: Write, V: Write> Observer for Recorder<C, V> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if self.failed.is_some() {
            return;
        }
        self.fill(moment);
        self.scope.push(&self.row);
        let done = self
            .rows
            .push(&self.row)
            .map_err(RecordError::from)
            .and_then(|()| {
                self.steps
                    .tick(moment, &self.reversed)
                    .map_err(RecordError::from)
            });
        self.failed = done.err();
    }
}
