//! `report.json` of a recording, and its summary.

use std::fmt::Write;

use cophase_core::settings::AxisSettings;
use cophase_core::supervisor::State;
use cophase_link::message::{Counters, Identity};
use host_sim::sim::events::EventKind;
use serde::Serialize;

use super::lists::{EventReport, FaultReport, event_report, faults_in};
use super::{TimeInState, round};
use crate::record::{Gaps, Recorded};
use crate::trace::Written;
use crate::trace::written::WrittenBy;

/// Content of `report.json` of a recording. Keys that a simulated run also has mean the same.
#[derive(Clone, Debug, Serialize)]
pub struct RecordedReport<'a> {
    name: &'a str,
    #[serde(flatten)]
    written_by: WrittenBy,
    controller: ControllerReport<'a>,
    ended: Ended,
    warnings: Vec<String>,
    /// Time from the first sample to the end of the last one, gaps included.
    recorded_s: f64,
    control_ticks: u64,
    time_in_state_s: TimeInState,
    axes: Vec<AxisReport>,
    speed_top_hz: f64,
    amax_top_mps2: f64,
    late_deadlines: u32,
    missed_deadlines: u32,
    reported_faults: Vec<FaultReport>,
    faults: Vec<FaultReport>,
    events: Vec<EventReport>,
    samples: &'a Gaps,
    frames: Frames,
    written: WrittenReport,
}

#[derive(Clone, Debug, Serialize)]
struct ControllerReport<'a> {
    board: &'a str,
    serial: u64,
    firmware: &'a str,
    settings_crc: u32,
    program_crc: u32,
    tick_hz: u32,
}

#[derive(Clone, Debug, Serialize)]
struct Ended {
    state: Option<&'static str>,
    fault: bool,
}

#[derive(Clone, Debug, Serialize)]
struct AxisReport {
    steps: i64,
    command_turns: f64,
    phase_error_peak_deg: f64,
    correction_deg: f64,
}

/// Frames of the line to the host.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Frames {
    /// Frames with a wrong CRC.
    pub damaged: u32,
    /// Missing frame numbers.
    pub missing: u32,
}

/// Format of the written files.
#[derive(Clone, Copy, Debug, Serialize)]
struct WrittenReport {
    every: u64,
    rows: usize,
    /// Window of `steps.vcd`; `None` if there is no such file.
    window_from_s: Option<f64>,
    window_to_s: Option<f64>,
}

impl<'a> RecordedReport<'a> {
    /// Creates the report of a recording of a controller with these axes, with the counters of its loop, the frames of the line, and the
    /// reason if the line was lost.
    pub fn new(
        identity: &'a Identity,
        axes: &[AxisSettings],
        recorded: &'a Recorded,
        counters: &Counters,
        frames: Frames,
        lost_line: Option<&str>,
    ) -> Self {
        let totals = &recorded.totals;
        let [idle, homing, run, stop, parked, fault] = totals.time_in_state_s.map(|s| round(s, 6));
        let control_ticks = totals.ticks.map_or(0, |(first, last)| {
            u64::from(last - first) + recorded.written.every
        });
        let Written {
            every,
            rows,
            window_from_s,
            window_to_s,
        } = recorded.written;
        let has_edges = recorded.no_edges.is_none();
        Self {
            name: &identity.settings,
            written_by: WrittenBy::this(),
            controller: ControllerReport {
                board: &identity.board,
                serial: identity.serial,
                firmware: &identity.firmware,
                settings_crc: identity.settings_crc,
                program_crc: identity.program_crc,
                tick_hz: identity.tick_hz,
            },
            ended: Ended {
                state: totals.state.map(State::name),
                fault: totals.has_fault,
            },
            warnings: warnings(recorded, lost_line),
            recorded_s: round(control_ticks as f64 / f64::from(identity.tick_hz), 9),
            control_ticks,
            time_in_state_s: TimeInState {
                idle,
                homing,
                run,
                stop,
                parked,
                fault,
            },
            axes: totals
                .axes
                .iter()
                .map(|axis| AxisReport {
                    steps: axis.steps,
                    command_turns: axis.command_turns,
                    phase_error_peak_deg: axis.phase_error_peak_deg,
                    correction_deg: axis.correction_deg,
                })
                .collect(),
            speed_top_hz: totals.top_speed_hz,
            amax_top_mps2: totals.top_amax_mps2,
            late_deadlines: counters.late_deadlines,
            missed_deadlines: counters.missed_deadlines,
            reported_faults: faults_in(&recorded.events, axes, |what| match what {
                EventKind::Reported(fault) => Some(fault),
                _ => None,
            }),
            faults: faults_in(&recorded.events, axes, |what| match what {
                EventKind::Fault { fault, .. } => Some(fault),
                _ => None,
            }),
            events: recorded.events.iter().map(event_report).collect(),
            samples: &recorded.gaps,
            frames,
            written: WrittenReport {
                every,
                rows,
                window_from_s: has_edges.then_some(window_from_s),
                window_to_s: has_edges.then_some(window_to_s),
            },
        }
    }
}

fn warnings(recorded: &Recorded, lost_line: Option<&str>) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(reason) = lost_line {
        warnings.push(format!(
            "{reason}; the recording ends there, without the counters of the controller"
        ));
    }
    let gaps = &recorded.gaps;
    if gaps.lost > 0 {
        warnings.push(format!(
            "{} of {} samples were lost, in {} gaps; the traces have no values there",
            gaps.lost,
            gaps.lost + gaps.recorded,
            gaps.gaps
        ));
    }
    if let Some(reason) = recorded.no_edges {
        warnings.push(format!("there is no steps.vcd: {reason}"));
    }
    warnings
}

/// Returns the summary of a recording, several lines.
pub fn recorded_summary(
    identity: &Identity,
    recorded: &Recorded,
    lost_line: Option<&str>,
) -> String {
    let mut text = String::new();
    let totals = &recorded.totals;
    let tick_s = 1.0 / f64::from(identity.tick_hz);
    let (first, last) = totals.ticks.unwrap_or_default();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "Recorded {} ({}): {} samples from {:.4} to {:.4} s, {} lost in {} gaps.",
        identity.settings,
        identity.board,
        recorded.gaps.recorded,
        f64::from(first) * tick_s,
        f64::from(last) * tick_s,
        recorded.gaps.lost,
        recorded.gaps.gaps
    );
    for event in &recorded.events {
        let _ = writeln!(
            text,
            "{:10.3} s  {}",
            event.t_s,
            super::describe(&event.what)
        );
    }
    for warning in warnings(recorded, lost_line) {
        let _ = writeln!(text, "Warning: {warning}.");
    }
    text
}
