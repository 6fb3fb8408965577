//! Parts of the report that only a recording has, and its summary.

use std::fmt::Write;

use cophase_link::message::Identity;
use serde::Serialize;

use crate::record::Recorded;

#[derive(Clone, Debug, Serialize)]
pub(super) struct ControllerReport<'a> {
    board: &'a str,
    serial: u64,
    firmware: &'a str,
    settings_crc: u32,
    program_crc: u32,
    tick_hz: u32,
}

impl<'a> ControllerReport<'a> {
    pub fn new(identity: &'a Identity) -> Self {
        Self {
            board: &identity.board,
            serial: identity.serial,
            firmware: &identity.firmware,
            settings_crc: identity.settings_crc,
            program_crc: identity.program_crc,
            tick_hz: identity.tick_hz,
        }
    }
}

/// Frames of the line to the host.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Frames {
    /// Frames with a wrong CRC.
    pub damaged: u32,
    /// Missing frame numbers.
    pub missing: u32,
}

/// Returns the warnings of a recording, a sentence each without its full stop.
pub(super) fn recording_warnings(recorded: &Recorded, lost_line: Option<&str>) -> Vec<String> {
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
    let tick_s = 1.0 / f64::from(identity.tick_hz);
    let (first, last) = recorded.gaps.ticks.unwrap_or_default();
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
    for event in &recorded.record.events {
        let _ = writeln!(
            text,
            "{:10.3} s  {}",
            event.t_s,
            super::describe(&event.what)
        );
    }
    for warning in recording_warnings(recorded, lost_line) {
        let _ = writeln!(text, "Warning: {warning}.");
    }
    text
}
