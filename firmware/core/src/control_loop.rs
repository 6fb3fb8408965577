//! The control loop: wait for a deadline, read, think, write.
//!
//! This is the one function that both worlds run: a task on the controller, and a future in virtual
//! time on the host. Between it and the world stands [`Io`], and nothing else.
//!
//! Deadlines are absolute, a whole number of ticks apart. A loop that wakes after the next deadline
//! has already passed does not catch up with a burst: it goes on at the next deadline to come, and
//! says how many it missed. What was reckoned too late to be handed over in time is not thrown away
//! either: it is played a tick later, and counted as a deadline missed.

use core::future::Future;

use embassy_time::{Duration, Instant, Timer};

use crate::controller::Controller;
use crate::signals::{Feedback, Output};

/// The world outside the loop: sensors and safety lines in, pulses, setpoints and safety lines out.
pub trait Io {
    /// What came in since the last call.
    fn read(&mut self) -> Feedback;

    /// Hands over what is to be played from `start` on, for one tick.
    ///
    /// The safety lines are set at once.
    fn write(&mut self, output: &Output, start: Instant) -> Written;

    /// Waits for a deadline. A board whose loop has a timer of its own waits for that.
    fn until(&mut self, deadline: Instant) -> impl Future<Output = ()> {
        Timer::at(deadline)
    }
}

/// What became of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// It will be played in its tick.
    InTime,
    /// It came too late for that: the step hardware was about to run dry, or has, and all axes stand from
    /// `start` on. The same output is to be offered again a tick later.
    TooLate,
    /// There is nothing more to control; a board never says that.
    Over,
}

/// Runs the loop from the present time on, until [`Io::write`] ends it.
pub async fn run(controller: &mut Controller, io: &mut impl Io) {
    let tick = Duration::from_micros(1_000_000 / u64::from(controller.tick_hz()));
    let mut deadline = Instant::now();
    loop {
        io.until(deadline).await;
        let late = Instant::now().saturating_duration_since(deadline);
        // Hardly ever is there anything to divide, which takes the board 150 cycles.
        let (missed, rest) = if late < tick {
            (0, late.as_ticks())
        } else {
            (
                late.as_ticks() / tick.as_ticks(),
                late.as_ticks() % tick.as_ticks(),
            )
        };
        if missed > 0 {
            deadline += Duration::from_ticks(missed * tick.as_ticks());
        }
        let over_half = rest * 2 > tick.as_ticks();
        if missed > 0 || over_half {
            controller.late(u32::try_from(missed).unwrap_or(u32::MAX), over_half);
        }
        let feedback = io.read();
        deadline += tick;
        let output = controller.tick(&feedback);
        let mut held_over = 0;
        loop {
            match io.write(output, deadline) {
                Written::InTime => break,
                Written::Over => return,
                Written::TooLate => {
                    io.until(deadline).await;
                    deadline += tick;
                    held_over += 1;
                }
            }
        }
        if held_over > 0 {
            controller.held_over(held_over);
        }
    }
}
