//! Input and output of the loop while a host operates it: the simulated machine, in step with the
//! wall clock.

use std::sync::mpsc::{Receiver, SyncSender, TryRecvError};
use std::time::Duration;

use cophase_core::control_loop::{Io, SubmissionResult};
use cophase_core::program::Program;
use cophase_core::signals::{Feedback, Output};
use cophase_core::supervisor::{Command, SafetyInputs};
use cophase_link::message::Event;
use cophase_link::sample::{Sample, flags};
use cophase_link::watch::Watch;
use cophase_scene::file::FaultAt;
use embassy_time::Instant;

use super::WallClock;
use crate::sim::SimulatedIo;
use crate::virtual_time::{self, TICKS_PER_S};

/// Message to the loop.
pub(super) enum ToLoop {
    /// A command for the next tick.
    Command(Command),
    /// A new program, and the channel for the report of whether it was accepted.
    Program(Box<Program>, SyncSender<bool>),
    /// Ticks between two samples.
    Sampling(u16),
    /// A fault that begins now.
    Fault(Box<FaultAt>),
}

/// Message from the loop.
#[expect(clippy::large_enum_variant, reason = "nearly all of them are samples")]
pub(super) enum FromLoop {
    Sample(Sample),
    Event(u32, Event),
}

/// The simulated machine, in step with the wall clock.
pub(super) struct Paced {
    inner: SimulatedIo,
    from_host: Receiver<ToLoop>,
    to_host: SyncSender<FromLoop>,
    clock: WallClock,
    tick: u32,
    every: u32,
    inputs: SafetyInputs,
    /// Index pulses so far, wrapping.
    index_count: u8,
    watch: Watch,
    program: Option<(Box<Program>, SyncSender<bool>)>,
    lost_events: u32,
    is_over: bool,
}

impl Paced {
    pub(super) fn new(
        inner: SimulatedIo,
        speed: f64,
        from_host: Receiver<ToLoop>,
        to_host: SyncSender<FromLoop>,
    ) -> Self {
        Self {
            inner,
            from_host,
            to_host,
            clock: WallClock::new(speed),
            tick: 0,
            every: 1,
            inputs: SafetyInputs {
                enable: true,
                stop: false,
            },
            index_count: 0,
            watch: Watch::new(),
            program: None,
            lost_events: 0,
            is_over: false,
        }
    }

    /// Reads the host's messages up to the next command. The loop takes one command per tick.
    fn next_command(&mut self) -> Option<Command> {
        loop {
            match self.from_host.try_recv() {
                Ok(ToLoop::Command(command)) => return Some(command),
                Ok(ToLoop::Program(program, loaded)) => self.program = Some((program, loaded)),
                Ok(ToLoop::Sampling(every)) => self.every = every.into(),
                Ok(ToLoop::Fault(mut fault)) => {
                    fault.at_s = Instant::now().as_micros() as f64 / TICKS_PER_S as f64;
                    self.inner.inject(&fault);
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    self.is_over = true;
                    return None;
                }
            }
        }
    }

    /// Passes an event on. An event for which there is no room is counted.
    fn publish(&mut self, event: Event) {
        let tick = self.tick;
        if self.lost_events > 0 {
            let lost = FromLoop::Event(tick, Event::Lost(self.lost_events));
            if self.to_host.try_send(lost).is_ok() {
                self.lost_events = 0;
            }
        }
        if self.to_host.try_send(FromLoop::Event(tick, event)).is_err() {
            self.lost_events += 1;
        }
    }
}

impl Io for Paced {
    fn read(&mut self, feedback: &mut Feedback) {
        self.clock
            .wait(Duration::from_micros(Instant::now().as_micros()));
        *feedback = self.inner.read(&mut ());
        feedback.command = self.next_command();
        self.inputs = feedback.inputs;
        let pulses = feedback.index.axes().count_ones();
        self.index_count = self.index_count.wrapping_add(pulses as u8);
    }

    fn new_program(&mut self) -> Option<&Program> {
        self.program.as_ref().map(|(program, _)| &**program)
    }

    fn program_loaded(&mut self, is_loaded: bool) {
        if let Some((_, loaded)) = self.program.take() {
            // The receiver may have stopped waiting.
            let _ = loaded.send(is_loaded);
        }
    }

    fn until(&mut self, deadline: Instant) -> impl Future<Output = ()> {
        virtual_time::until(deadline.as_micros())
    }

    fn write(&mut self, output: &Output, start: Instant) -> SubmissionResult {
        let telemetry = &output.telemetry;
        let mut changes = Vec::new();
        self.watch
            .observe(telemetry, |change| changes.push(Event::from(&change)));
        for event in changes {
            self.publish(event);
        }
        if self.tick.is_multiple_of(self.every) {
            let mut inputs = 0;
            inputs |= if self.inputs.enable { flags::ENABLE } else { 0 };
            inputs |= if self.inputs.stop { flags::STOP } else { 0 };
            inputs |= if output.drives_enabled {
                flags::DRIVES
            } else {
                0
            };
            let sample = Sample::new(self.tick, telemetry, inputs, self.index_count);
            // The tick of the next sample shows that one was lost.
            let _ = self.to_host.try_send(FromLoop::Sample(sample));
        }
        self.tick = self.tick.wrapping_add(1);
        // A scene ends when nothing more is to happen. Here, the host may still give commands.
        let _ = self.inner.write(output, start);
        if self.is_over {
            SubmissionResult::Over
        } else {
            SubmissionResult::InTime
        }
    }
}
