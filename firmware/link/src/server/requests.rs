//! Requests: the conditions, the effect and the reply of each.

use cophase_core::supervisor::Command;
use cophase_core::units::Turns;

use super::device::{Device, SettingsRefusal};
use super::{EVENTS, Hub};
use crate::message::{
    ControlRequest, Counters, EVENTS_IN_REPLY, EventRecord, File, MAX_CHUNK_BYTES,
    MAX_OVERRIDE_PERMILLE, Message, Refusal, ReplyBody, Request, Status, StopKind, VERSION,
};
use crate::sample::ALL_CHANNELS;

/// Greatest number of ticks between two samples of a stream.
const MAX_EVERY: u16 = 10_000;

/// Period of a stream of statuses, ms.
const STATUS_MS: core::ops::RangeInclusive<u16> = 10..=1000;

/// Samples and events that are moved before a request is answered, at most. They are few, because a stop may wait behind the request.
const MOVED_BEFORE_ANSWER: usize = 8;

impl<D: Device, const SESSIONS: usize> Hub<D, SESSIONS> {
    /// Answers the request of a frame.
    pub(super) fn answer(&mut self, session: usize, number: u16, payload: &[u8]) {
        // A request is checked against the latest state of the machine.
        for _ in 0..MOVED_BEFORE_ANSWER {
            if !self.poll_one() {
                break;
            }
        }
        let body = match postcard::take_from_bytes::<Request<'_>>(payload) {
            Ok((request, [])) => self.act(session, &request),
            _ => Err(Refusal::Unreadable),
        };
        let line = &mut self.sessions[session];
        line.refused = line.refused.wrapping_add(body.is_err().into());
        // The bytes of a file are in the device, and the reply borrows them. So they are sent from there.
        let body = body.map(|answer| match answer {
            Answer::Body(body) => body,
            Answer::Chunk { file, offset } => {
                let bytes = self.device.file(file);
                let length = bytes.len() as u32;
                let rest = bytes.get(offset as usize..).unwrap_or_default();
                let bytes = &rest[..rest.len().min(MAX_CHUNK_BYTES)];
                ReplyBody::Chunk { length, bytes }
            }
        });
        line.send(&Message::Reply { to: number, body });
    }

    fn act(&mut self, session: usize, request: &Request<'_>) -> Result<Answer, Refusal> {
        let situation = self.latest.situation();
        request
            .condition()
            .check(&situation, self.drives_are_on())?;
        match *request {
            Request::Identify { version } => {
                if version != VERSION {
                    return Err(Refusal::Version {
                        controller: VERSION,
                    });
                }
                // On a line without a signal for a new host, only this request shows that there is one.
                self.connect(session);
                self.sessions[session].is_known = true;
                return body(ReplyBody::Identity(self.device.identity()));
            }
            Request::Read { file, offset } => return Ok(Answer::Chunk { file, offset }),
            Request::Inputs => return body(ReplyBody::Inputs(self.device.inputs())),
            Request::Unlock => self.access.unlock(session, self.device.now_ms())?,
            Request::Output { output, is_active } => {
                self.access.check_unlocked(session)?;
                self.hold_output(output, is_active)?;
            }
            Request::OnlyAxis(axis) => {
                self.access.check_unlocked(session)?;
                self.device.restart(Some(axis)).map_err(Refusal::Rejected)?;
            }
            Request::Counters => return body(ReplyBody::Counters(self.counters(session))),
            Request::Events { from } => return body(ReplyBody::Events(self.events_from(from))),
            Request::BeginWrite { file, length, crc } => {
                self.access.check_control(session)?;
                self.upload.begin(session, file, length, crc)?;
            }
            Request::Write { offset, bytes } => self.upload.write(session, offset, bytes)?,
            Request::FinishWrite => self.finish_write(session)?,
            Request::Restart => {
                self.access.check_control(session)?;
                self.device.restart(None).map_err(Refusal::Rejected)?;
            }
            Request::Control(ControlRequest::Take) => self.access.take(session, false)?,
            Request::Control(ControlRequest::TakeOver) => self.access.take(session, true)?,
            Request::Control(ControlRequest::Release) => self.access.release(session),
            Request::Arm => {
                let now_ms = self.device.now_ms();
                self.access.arm(session, now_ms)?;
            }
            Request::Disarm => self.access.disarm(),
            Request::Start => self.start(session, Command::Start)?,
            Request::Home => self.start(session, Command::Home)?,
            // While the machine jogs, the request is repeated and needs no further arm.
            Request::Jog if situation.jogs => self.controlled(session, Command::Jog)?,
            Request::Jog => self.start(session, Command::Jog)?,
            Request::Stop(StopKind::AtPhase) => self.command(Command::Stop)?,
            Request::Stop(StopKind::Now) => self.command(Command::StopNow)?,
            Request::Hold => self.controlled(session, Command::Hold)?,
            Request::Resume => self.controlled(session, Command::Resume)?,
            Request::Reset => self.controlled(session, Command::Reset)?,
            Request::ResetPeak => self.controlled(session, Command::ResetPeak)?,
            Request::Override { permille } => {
                within(permille, 0..=MAX_OVERRIDE_PERMILLE)?;
                self.controlled(session, Command::Override(permille))?;
            }
            Request::Stream { channels, every } => {
                within(channels, 0..=ALL_CHANNELS)?;
                within(every, 1..=MAX_EVERY)?;
                self.sessions[session].select(channels, every);
                self.choose_sampling();
            }
            Request::StreamStatus { period_ms } => {
                if period_ms != 0 {
                    within(period_ms, STATUS_MS)?;
                }
                let now_ms = self.device.now_ms();
                self.sessions[session].stream_status(period_ms, now_ms);
            }
        }
        body(ReplyBody::Done)
    }

    fn finish_write(&mut self, session: usize) -> Result<(), Refusal> {
        self.access.check_control(session)?;
        let (situation, drives_are_on) = (self.latest.situation(), self.drives_are_on());
        let (file, bytes) = self.upload.finish(session)?;
        file.condition().check(&situation, drives_are_on)?;
        match file {
            File::Program => self.device.load_program(bytes).map_err(Refusal::Rejected),
            File::Settings => self
                .device
                .store_settings(bytes)
                .map_err(|refusal| match refusal {
                    SettingsRefusal::Rejected(why) => Refusal::Rejected(why),
                    SettingsRefusal::NotStored(why) => Refusal::NotStored(why),
                }),
        }
    }

    /// Starts a motion.
    fn start(&mut self, session: usize, command: Command) -> Result<(), Refusal> {
        self.access.check_armed(session)?;
        self.release_held();
        self.command(command)?;
        self.access.disarm();
        self.host.begins(self.device.now_ms());
        Ok(())
    }

    fn controlled(&mut self, session: usize, command: Command) -> Result<(), Refusal> {
        self.access.check_control(session)?;
        self.command(command)
    }

    fn command(&mut self, command: Command) -> Result<(), Refusal> {
        if self.device.command(command) {
            Ok(())
        } else {
            Err(Refusal::Busy)
        }
    }

    pub(super) fn status(&self, session: usize) -> Status {
        let sample = &self.latest;
        let hz = self.device.tick_hz() as f32;
        let turns = |bits: i64| Turns::from_bits(bits).to_num::<f32>();
        let errors = sample.phase_error.iter().take(self.device.axes());
        Status {
            tick: sample.tick,
            state: sample.state,
            flags: sample.flags,
            override_permille: sample.override_permille,
            control: self.access.control(session),
            armed: self.access.is_armed(),
            amax_mps2: sample.amax().to_num(),
            speed_hz: turns(sample.speed) * hz,
            program_ticks: sample.program_ticks,
            phase_error_deg: errors.map(|&bits| turns(bits) * 360.0).collect(),
            tilt_deg: [sample.modes[1], sample.modes[2]].map(|bits| turns(bits) * 360.0),
            fault: self.fault,
            events: self.event_count,
            samples_lost: self.sessions[session].samples_lost,
        }
    }

    fn counters(&self, session: usize) -> Counters {
        let line = &self.sessions[session];
        Counters {
            received: line.receiver.counts(),
            refused: line.refused,
            not_sent: line.not_sent,
            samples_lost: line.samples_lost,
            missed_deadlines: self.missed_deadlines,
            late_deadlines: self.late_deadlines,
        }
    }

    fn events_from(&self, from: u32) -> heapless::Vec<EventRecord, EVENTS_IN_REPLY> {
        let oldest = self.event_count.saturating_sub(EVENTS as u32);
        let skipped = from.saturating_sub(oldest) as usize;
        let events = self.events.oldest_ordered().skip(skipped);
        events.take(EVENTS_IN_REPLY).copied().collect()
    }
}

#[allow(
    clippy::large_enum_variant,
    reason = "there is no heap, and one answer at a time"
)]
/// Answer to a request, before the bytes of a file are fetched.
enum Answer {
    Body(ReplyBody<'static>),
    Chunk { file: File, offset: u32 },
}

fn body(body: ReplyBody<'static>) -> Result<Answer, Refusal> {
    Ok(Answer::Body(body))
}

fn within(value: u16, range: core::ops::RangeInclusive<u16>) -> Result<(), Refusal> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(Refusal::OutOfRange {
            min: (*range.start()).into(),
            max: (*range.end()).into(),
        })
    }
}
