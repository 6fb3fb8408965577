//! Reports to browsers, as JSON. Each has a `type`.

use cophase_core::mechanism::Mechanism;
use cophase_core::settings::Settings;
use cophase_core::supervisor::State;
use cophase_core::units::Turns;
use cophase_link::message::{Event, EventRecord, Identity, Status, state_name};
use cophase_link::sample::flags;
use serde::Serialize;

use super::browsers::Browser;
use super::columns::Columns;
use crate::link::show::what;

#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub(super) enum Report<'a> {
    /// The first report, with the data that do not change while the page is open.
    Hello {
        /// Name that other browsers show for this one.
        name: String,
        board: &'a str,
        serial: String,
        firmware: &'a str,
        settings: &'a str,
        can_run: bool,
        simulated: bool,
        tick_hz: u32,
        every: u16,
        axes: usize,
        /// Names of the columns of a batch, in their order. A name contains the unit.
        columns: &'a [String],
        /// Names of the states. The index is the number of the state.
        states: [&'static str; State::ALL.len()],
        limits: Box<Limits>,
        /// Text of the scene for the editor.
        text: &'a str,
    },
    Status(Box<StatusReport<'a>>),
    Event(EventReport),
    Reply {
        id: u64,
        #[serde(skip_serializing_if = "Option::is_none")]
        error: Option<String>,
    },
    /// The controller has restarted, and its time begins again.
    Restarted,
    /// The line to the controller is lost, or restored.
    Line {
        error: Option<String>,
    },
}

#[derive(Debug, Serialize)]
pub(super) struct Limits {
    speed: Level,
    /// Lower and upper edge of each forbidden band of speed.
    bands: Vec<[Level; 2]>,
    /// Limit on the tilt of the platform; none without a platform.
    tilt_mrad: Option<f64>,
}

/// Speed of the master, and the amplitude at this speed.
#[derive(Debug, Serialize)]
struct Level {
    speed_hz: f64,
    amax_mps2: f64,
}

impl Limits {
    fn new(settings: &Settings) -> Self {
        let mechanism = settings.mechanism();
        let level = |speed_hz: f64| Level {
            speed_hz,
            amax_mps2: mechanism
                .amax(Turns::saturating_from_num(
                    speed_hz / f64::from(settings.tick_hz),
                ))
                .to_num(),
        };
        let bands = settings.limits.bands.iter();
        Self {
            speed: level(settings.limits.speed_hz),
            bands: bands
                .map(|band| [band.from_hz, band.to_hz].map(level))
                .collect(),
            tilt_mrad: settings
                .machine
                .platform()
                .map(|_| settings.drift.tilt_limit_mrad),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct StatusReport<'a> {
    t_s: f64,
    state: &'static str,
    drives: bool,
    enable: bool,
    stop_input: bool,
    homed: bool,
    holding: bool,
    program_done: bool,
    override_permille: u16,
    armed: bool,
    /// `you`, `other`, or `free`.
    control: &'static str,
    /// Name of the browser that has control.
    owner: Option<&'a str>,
    program_s: f64,
    fault: Option<String>,
    /// Samples that were lost between loop and server.
    lost_samples: u64,
    /// Samples and reports for which this browser was too slow.
    dropped_samples: u64,
    dropped_reports: u64,
    browsers: usize,
}

#[derive(Debug, Serialize)]
pub(super) struct EventReport {
    number: u32,
    tick: u32,
    t_s: f64,
    kind: &'static str,
    text: String,
    /// Name of the fault.
    name: Option<&'static str>,
    axis: Option<usize>,
}

impl<'a> Report<'a> {
    pub(super) fn hello(
        name: String,
        identity: &'a Identity,
        settings: &Settings,
        columns: &'a Columns,
        every: u16,
        simulated: bool,
        text: &'a str,
    ) -> Self {
        Self::Hello {
            name,
            board: &identity.board,
            serial: format!("{:016x}", identity.serial),
            firmware: &identity.firmware,
            settings: &identity.settings,
            can_run: identity.can_run,
            simulated,
            tick_hz: identity.tick_hz,
            every,
            axes: identity.axes.into(),
            columns: columns.names(),
            states: State::ALL.map(State::name),
            limits: Box::new(Limits::new(settings)),
            text,
        }
    }

    pub(super) fn status(
        status: &Status,
        tick_hz: u32,
        owner: (Option<u32>, Option<&'a str>),
        browser: &Browser,
        lost_samples: u64,
        browsers: usize,
    ) -> Self {
        let has = |flag: u8| status.flags & flag != 0;
        let seconds = |ticks: u32| f64::from(ticks) / f64::from(tick_hz);
        let control = match owner.0 {
            Some(id) if id == browser.id => "you",
            Some(_) => "other",
            None if status.control == cophase_link::message::Control::Other => "other",
            None => "free",
        };
        Self::Status(Box::new(StatusReport {
            t_s: seconds(status.tick),
            state: state_name(status.state),
            drives: has(flags::DRIVES),
            enable: has(flags::ENABLE),
            stop_input: has(flags::STOP),
            homed: has(flags::HOMED),
            holding: has(flags::HOLDING),
            program_done: has(flags::PROGRAM_DONE),
            override_permille: status.override_permille,
            armed: status.armed,
            control,
            owner: owner.1,
            program_s: seconds(status.program_ticks),
            fault: status.fault.map(|fault| what(&Event::Fault(fault))),
            lost_samples,
            dropped_samples: browser.dropped_samples,
            dropped_reports: browser.dropped_reports,
            browsers,
        }))
    }

    pub(super) fn event(record: &EventRecord, tick_hz: u32) -> Self {
        let fault = match &record.event {
            Event::Fault(fault) | Event::Reported(fault) => fault.fault(),
            _ => None,
        };
        let kind = match record.event {
            Event::State(_) => "state",
            Event::Fault(_) => "fault",
            Event::Reported(_) => "reported",
            Event::Missed(_) | Event::Late(_) => "deadline",
            Event::Lost(_) => "lost",
            Event::Refused(_) => "refused",
        };
        Self::Event(EventReport {
            number: record.number,
            tick: record.tick,
            t_s: f64::from(record.tick) / f64::from(tick_hz),
            kind,
            text: what(&record.event),
            name: fault.as_ref().map(|fault| fault.kind.name()),
            axis: fault.as_ref().and_then(|fault| fault.axis),
        })
    }
}
