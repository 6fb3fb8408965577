//! Input and output of the loop on this board.
//!
//! The loop is `cophase_core::control_loop::run`, the same function that the host runs. Only short interrupts come
//! between a deadline and the work that it starts.

use core::future::Future;

use cophase_core::control_loop::{Io, SubmissionResult};
use cophase_core::monitor::IndexFilter;
use cophase_core::monitor::IndexPulses;
use cophase_core::panel::{self, Panel, Source};
use cophase_core::program::Program;
use cophase_core::signals::{Feedback, Output};
use cophase_core::supervisor::State;
use cophase_core::units::MAX_AXES;
use cophase_link::sample::flags;
use embassy_time::Instant;

use crate::board::alarm::Until;
use crate::board::failure::{Failure, fail};
use crate::board::index::Index;
use crate::board::lines::AlarmInputs;
use crate::board::sampler::Label;
use crate::board::steps::{Steps, Submission};
use crate::board::watchdog::Fed;
use crate::board::{handover, has_passed, lines, sampler, witness};
use crate::link::LoopEnd;
use crate::report::Reporter;

/// Input and output of the loop.
#[repr(C)] // The fields that every tick needs come first: instructions reach 32 bytes, or 128 by words.
pub struct Board {
    /// State of the machine in the last output.
    pub state: State,
    /// The trigger's level while the output that was submitted last is played.
    pub sync: bool,
    /// Control ticks since power-up.
    pub ticks: u32,
    /// An axis that underran, until it has been reported to the loop.
    pub fifo_underrun: Option<usize>,
    /// The deadline that ends the tick whose index pulses are read next. None before the machines were started.
    pub read_to: Option<Instant>,
    /// Watchdog, which restarts a loop that hangs.
    pub watchdog: Fed,
    /// Start and reset, and whose turn it is to give a command.
    pub panel: Panel,
    /// Timing of the index pulses.
    pub index: Index,
    /// Commands and samples of the host link.
    pub link: LoopEnd,
    /// Levels of the inputs that were read last, as a sample has them.
    pub inputs: u8,
    /// Index pulses of all axes so far, wrapping.
    pub index_count: u8,
    /// Alarm inputs of the machine's axes.
    pub alarms: AlarmInputs,
    /// Log of states and faults.
    pub reporter: Reporter,
    /// Generation of the step edges.
    pub steps: Steps,
    /// Filter that makes pulses of the index lines' changes.
    pub filter: IndexFilter<MAX_AXES>,
}

impl Board {
    /// Takes the index pulses of the ticks that are over: of one, unless deadlines were missed.
    #[inline(always)]
    fn read_index(&mut self, pulses: &mut IndexPulses) {
        let Some(mut deadline) = self.read_to else {
            return;
        };
        while has_passed(deadline) {
            self.index.read(&mut self.filter);
            self.index.end_tick(&mut self.filter, pulses);
            let next = deadline
                .as_ticks()
                .wrapping_add(self.steps.tick().as_ticks());
            deadline = Instant::from_ticks(next);
        }
        self.read_to = Some(deadline);
        if pulses.axes() != 0 {
            self.index_count = self
                .index_count
                .wrapping_add(pulses.axes().count_ones() as u8);
        }
    }
}

impl Io for Board {
    #[inline(never)] // as `Controller::tick`
    #[expect(
        unsafe_code,
        reason = "only the loop knows when it may change its output"
    )]
    fn read(&mut self, feedback: &mut Feedback) {
        // SAFETY: only the loop's interrupt polls the loop.
        unsafe { sampler::end() };
        // The output that was submitted last is played from now on.
        lines::sync(self.sync);
        feedback.index.clear();
        self.read_index(&mut feedback.index);
        let levels = lines::read_latched();
        let inputs = lines::safety_inputs(levels);
        witness::check(levels, inputs);
        self.inputs = if inputs.enable { flags::ENABLE } else { 0 };
        self.inputs |= if inputs.stop { flags::STOP } else { 0 };
        feedback.inputs = inputs;
        feedback.alarms = levels.alarms(&self.alarms);
        feedback.fifo_underrun = self.fifo_underrun.take();
        feedback.command = match self.panel.turn(levels.start(), self.link.waiting()) {
            Some(Source::Button) => Some(panel::command(self.state)),
            Some(Source::Host) => self.link.take(),
            None => None,
        };
        // The counts of encoders stay zero: this board has no pins left for encoders.
    }

    fn new_program(&mut self) -> Option<&Program> {
        handover::submitted()
    }

    fn program_loaded(&mut self, is_loaded: bool) {
        handover::answer(is_loaded);
    }

    fn settings_changed(&mut self) {
        fail(Failure::Settings);
    }

    fn until(&mut self, deadline: Instant) -> impl Future<Output = ()> {
        Until(deadline)
    }

    #[inline(never)] // as `Controller::tick`
    #[expect(
        unsafe_code,
        reason = "only the loop knows for how long its output stays unchanged"
    )]
    fn write(&mut self, output: &Output, start: Instant) -> SubmissionResult {
        lines::drives(output.drives_enabled, output.telemetry.state);
        // SAFETY: the controller is in a static, and plans into its other buffer until the next submission is taken.
        match unsafe { self.steps.submit(output, start) } {
            Submission::TooLate => return SubmissionResult::TooLate,
            Submission::Underrun(axis) => {
                self.fifo_underrun = Some(axis);
                return SubmissionResult::TooLate;
            }
            Submission::Begun(cycles) if self.read_to.is_none() => {
                self.index.begin(cycles);
                self.read_to = Some(start);
            }
            Submission::Begun(_) | Submission::Taken => {}
        }
        self.sync = output.sync;
        self.state = output.telemetry.state;
        self.watchdog.feed(self.state, self.ticks);
        lines::led(self.state, output.drives_enabled);
        self.reporter.observe(self.ticks, output);
        if self.link.is_sample_due(self.ticks) {
            let drives = if output.drives_enabled {
                flags::DRIVES
            } else {
                0
            };
            let label = Label {
                tick: self.ticks,
                flags: self.inputs | drives,
                index_count: self.index_count,
            };
            // SAFETY: as in `read`. The telemetry is part of the controller, which is in a static. The loop changes it after the next reading only.
            unsafe { sampler::request(&output.telemetry, label) };
        }
        self.ticks = self.ticks.wrapping_add(1);
        SubmissionResult::InTime
    }
}
