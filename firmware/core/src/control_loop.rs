//! Control loop: wait for a deadline, read, compute, write.
//!
//! Board and host run this same function: as a task on the controller, and as a future in virtual time on the host.
//! [`Io`] is its only interface to the world outside.
//!
//! Deadlines are absolute, a whole number of ticks apart. A loop that wakes after the next deadline does not catch up with a burst. It
//! continues at the next future deadline, and reports how many it missed. Output that is submitted too late is not discarded. It is played
//! a tick later, and counts as a missed deadline.

use core::future::Future;

use embassy_time::{Duration, Instant, Timer};

use crate::controller::Controller;
use crate::program::Program;
use crate::signals::{Feedback, Output};

/// Interface to the world outside the loop: sensors and safety lines in; pulses, setpoints and safety lines out.
pub trait Io {
    /// Replaces `feedback`, which still holds that of the last call, by the feedback since then. From here on the last output is no longer
    /// valid.
    fn read(&mut self, feedback: &mut Feedback);

    /// Returns a new program for a machine that is idle or parked, once.
    fn new_program(&mut self) -> Option<&Program> {
        None
    }

    /// Takes the result of the last [`Self::new_program`]: false if the machine was in another state.
    fn program_loaded(&mut self, _is_loaded: bool) {}

    /// Submits the output to be played from `start` on, for one tick.
    ///
    /// The safety lines are set at once.
    fn write(&mut self, output: &Output, start: Instant) -> SubmissionResult;

    /// Reacts to a change of the settings in use, which nothing may change: a flipped bit.
    fn settings_changed(&mut self) {}

    /// Waits for a deadline. A board may replace this with a timer of the loop's own.
    fn until(&mut self, deadline: Instant) -> impl Future<Output = ()> {
        Timer::at(deadline)
    }
}

/// Result of submitting an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubmissionResult {
    /// The output will be played in its tick.
    InTime,
    /// The output came too late: the step FIFO has underrun or was about to. All axes stand still from `start` on. The
    /// same output must be submitted again a tick later.
    TooLate,
    /// The run is over; a board never returns this.
    Over,
}

/// Runs the loop from the present time on, until [`Io::write`] ends it.
pub async fn run(controller: &mut Controller, io: &mut impl Io) {
    run_from(Instant::now(), controller, io).await;
}

/// Runs the loop from a first deadline on, until [`Io::write`] ends it. A loop that [`Io::write`] ended goes on from the start of the
/// output that was submitted last.
pub async fn run_from(first: Instant, controller: &mut Controller, io: &mut impl Io) {
    let tick = Duration::from_micros(1_000_000 / u64::from(controller.tick_hz()));
    let mut deadline = first;
    let mut feedback = Feedback::with_command(None);
    let mut held_over = 0;
    loop {
        io.until(deadline).await;
        let late = Instant::now().saturating_duration_since(deadline);
        // The last output may be in use up to here, so the controller stays unchanged until then.
        io.read(&mut feedback);
        if !controller.check_settings() {
            io.settings_changed();
        }
        if held_over > 0 {
            controller.held_over(held_over);
        }
        if late.as_ticks() * 2 > tick.as_ticks() {
            deadline += report_late(controller, late, tick);
        }
        if let Some(program) = io.new_program() {
            let is_loaded = controller.load_program(program);
            io.program_loaded(is_loaded);
        }
        deadline += tick;
        let output = controller.tick(&feedback);
        held_over = 0;
        loop {
            match io.write(output, deadline) {
                SubmissionResult::InTime => break,
                SubmissionResult::Over => return,
                SubmissionResult::TooLate => {
                    io.until(deadline).await;
                    deadline += tick;
                    held_over += 1;
                }
            }
        }
    }
}

/// Reports a deadline that was met late by over half a tick; returns the time of the deadlines that were missed before it.
#[inline(never)] // It divides, which takes 150 cycles on the board and is rarely needed.
fn report_late(controller: &mut Controller, late: Duration, tick: Duration) -> Duration {
    let missed = late.as_ticks() / tick.as_ticks();
    let missed_time = missed * tick.as_ticks();
    let over_half = (late.as_ticks() - missed_time) * 2 > tick.as_ticks();
    controller.late(u32::try_from(missed).unwrap_or(u32::MAX), over_half);
    Duration::from_ticks(missed_time)
}
