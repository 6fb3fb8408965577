//! A recording in progress: the messages that arrive, its end, and its progress.

use std::io::{Seek, Write};
use std::time::{Duration, Instant};

use cophase_core::supervisor::State;
use cophase_files::record::{Recorded, Recording, TAIL_S};
use cophase_link::message::{Counters, EventRecord, Identity, Request};
use cophase_link::sample::Sample;
use indicatif::ProgressBar;

use super::Problem;
use super::connection::{Connection, Incoming};
use super::error::LinkError;
use crate::signals;

/// Time between two requests that show the controller that the host is connected, and between two updates of the progress.
const ALIVE_EVERY: Duration = Duration::from_millis(250);

/// Longest wait for the first sample, also at the slowest rate.
const FIRST_WITHIN: Duration = Duration::from_secs(30);

/// Recording in progress.
pub(super) struct Session<W: Write + Seek> {
    recording: Recording<W>,
    events: Vec<EventRecord>,
    watched: Watched,
    tail_ticks: u32,
    bar: ProgressBar,
}

/// Progress of the machine.
#[derive(Default)]
struct Watched {
    /// True if a program ran, or a motion ended in a fault.
    has_run: bool,
    /// Tick since which nothing moves, after the program or the fault.
    rests_since: Option<u32>,
}

impl Watched {
    fn take(&mut self, sample: &Sample) {
        let state = State::ALL.get(usize::from(sample.state));
        self.has_run |= matches!(state, Some(State::Run | State::Fault));
        let rests = matches!(state, Some(State::Idle | State::Parked | State::Fault));
        self.rests_since = if self.has_run && rests {
            self.rests_since.or(Some(sample.tick))
        } else {
            None
        };
    }

    fn is_over(&self, tick: u32, tail_ticks: u32) -> bool {
        self.rests_since
            .is_some_and(|since| tick.wrapping_sub(since) > tail_ticks)
    }
}

impl<W: Write + Seek + 'static> Session<W> {
    pub(super) fn new(recording: Recording<W>, identity: &Identity, is_quiet: bool) -> Self {
        Self {
            recording,
            events: Vec::new(),
            watched: Watched::default(),
            tail_ticks: (TAIL_S * f64::from(identity.tick_hz)) as u32,
            bar: if is_quiet {
                ProgressBar::hidden()
            } else {
                ProgressBar::new_spinner()
            },
        }
    }

    /// Waits until the first sample has arrived.
    pub(super) fn wait_for_sample(&mut self, link: &mut Connection) -> Result<(), Problem> {
        let end = Instant::now() + FIRST_WITHIN;
        while self.recording.last().is_none() {
            if Instant::now() >= end {
                let stream = Request::Stream {
                    channels: 0,
                    every: 1,
                };
                return Err(link.no_reply("record", &stream).into());
            }
            if let Some(incoming) = link.next(Duration::from_millis(20))? {
                self.take(incoming)?;
            }
        }
        Ok(())
    }

    /// Records until the program or the time is over, or until Ctrl-C.
    pub(super) fn record(
        &mut self,
        link: &mut Connection,
        for_s: Option<f64>,
    ) -> Result<(), Problem> {
        let is_interrupted = signals::catch_interrupt();
        let began = Instant::now();
        let end = for_s.map(|s| began + Duration::from_secs_f64(s));
        let mut alive_at = began;
        while !is_interrupted() && end.is_none_or(|end| Instant::now() < end) {
            if Instant::now() >= alive_at {
                alive_at = Instant::now() + ALIVE_EVERY;
                link.counters()?;
                self.show();
            }
            if let Some(incoming) = link.next(Duration::from_millis(20))?
                && self.take(incoming)?
            {
                break;
            }
        }
        self.bar.finish_and_clear();
        Ok(())
    }

    /// Takes a message. Returns true if the program is over.
    fn take(&mut self, incoming: Incoming) -> Result<bool, Problem> {
        match incoming {
            Incoming::Event(event) => self.events.push(event),
            Incoming::Status(_) => {}
            Incoming::Samples(samples) => {
                for sample in samples {
                    self.recording
                        .push(&sample)
                        .map_err(|e| LinkError::Input(e.to_string()))?;
                    self.watched.take(&sample);
                    if self.watched.is_over(sample.tick, self.tail_ticks) {
                        return Ok(true);
                    }
                }
            }
        }
        Ok(false)
    }

    fn show(&self) {
        let gaps = self.recording.gaps();
        let state = self
            .recording
            .last()
            .map_or("", |last| cophase_link::message::state_name(last.state));
        self.bar.set_message(format!(
            "{state}: {} samples, {} lost; Ctrl-C ends the recording",
            gaps.recorded, gaps.lost
        ));
        self.bar.tick();
    }

    /// Ends the stream, and fetches the events that were lost on the line.
    pub(super) fn end(&mut self, link: &mut Connection, next: u32) -> Result<Counters, Problem> {
        let none = Request::Stream {
            channels: 0,
            every: 1,
        };
        link.repeatable("record", &none)?;
        // The controller keeps the last events only. Earlier ones arrived as they happened.
        let kept = link.events(next)?;
        let first = kept.first().map_or(u32::MAX, |event| event.number);
        self.events.retain(|event| event.number < first);
        self.events.extend(kept);
        Ok(link.counters()?)
    }

    /// Ends the recording with the events up to its last sample, and the counters of the controller.
    pub(super) fn finish(self, counters: &Counters) -> Result<Recorded, String> {
        // Events after the last sample are not part of the recording.
        let last = self.recording.last().map(|sample| sample.tick);
        let events: Vec<_> = self
            .events
            .into_iter()
            .filter(|event| last.is_some_and(|last| event.tick <= last))
            .collect();
        self.recording
            .finish(&events, counters)
            .map_err(|e| e.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_session_ends_some_ticks_after_the_machine_parks() {
        let mut watched = Watched::default();
        let mut over = Vec::new();
        let states = [
            State::Idle,
            State::Homing,
            State::Parked,
            State::Run,
            State::Stop,
        ];
        let states = states.into_iter().chain([State::Parked; 5]);
        for (tick, state) in (0..).zip(states) {
            watched.take(&Sample {
                tick,
                state: state as u8,
                ..Sample::ZERO
            });
            over.push(watched.is_over(tick, 2));
        }
        // The machine is parked from tick 5 on. Tick 8 is more than two ticks later.
        assert_eq!(over.iter().position(|&over| over), Some(8));
    }
}
