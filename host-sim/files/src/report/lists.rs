//! Lists of a report: faults, corrections and events.

use cophase_core::settings::AxisSettings;
use cophase_core::supervisor::Fault;
use cophase_scene::file::FaultName;
use cophase_scene::units::degrees;
use host_sim::sim::events::{Event, EventKind};
use host_sim::sim::record::rounded;
use serde::Serialize;

use super::causes::{Cause, causes};
use super::describe;

#[derive(Clone, Debug, Serialize)]
pub(super) struct FaultReport {
    t_s: f64,
    kind: &'static str,
    axis: Option<usize>,
    size_deg: f64,
    phase_deg: f64,
    tick: u64,
    /// Causes that the sensors cannot distinguish, the name among them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    causes: Vec<Cause>,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct InjectedReport {
    at_s: f64,
    kind: FaultName,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<usize>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct CorrectionReport {
    t_s: f64,
    in_s: f64,
    /// Angle by which each axis was moved.
    by_deg: Vec<f64>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct EventReport {
    t_s: f64,
    what: String,
}

/// Returns the reports of the events for which `pick` gives a fault.
pub(super) fn faults_in(
    events: &[Event],
    axes: &[AxisSettings],
    pick: fn(&EventKind) -> Option<&Fault>,
) -> Vec<FaultReport> {
    events
        .iter()
        .filter_map(|event| Some(fault_report(event.t_s, pick(&event.what)?, axes)))
        .collect()
}

fn fault_report(t_s: f64, fault: &Fault, axes: &[AxisSettings]) -> FaultReport {
    FaultReport {
        t_s: rounded(t_s, 9),
        kind: fault.kind.name(),
        axis: fault.axis,
        size_deg: degrees(fault.size),
        phase_deg: degrees(fault.phase.within_turn()),
        tick: fault.tick,
        causes: causes(fault, axes),
    }
}

pub(super) fn injected_report(event: &Event) -> Option<InjectedReport> {
    let EventKind::Injected(fault) = &event.what else {
        return None;
    };
    Some(InjectedReport {
        at_s: rounded(event.t_s, 9),
        kind: fault.kind,
        axis: fault.axis,
    })
}

pub(super) fn correction_report(event: &Event, axes: usize) -> Option<CorrectionReport> {
    let EventKind::Corrected { by_deg, in_s } = &event.what else {
        return None;
    };
    Some(CorrectionReport {
        t_s: rounded(event.t_s, 9),
        in_s: rounded(*in_s, 9),
        by_deg: by_deg.iter().take(axes).copied().collect(),
    })
}

pub(super) fn event_report(event: &Event) -> EventReport {
    EventReport {
        t_s: rounded(event.t_s, 9),
        what: describe(&event.what),
    }
}
