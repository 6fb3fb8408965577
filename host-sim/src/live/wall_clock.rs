//! Simulated time in step with the wall clock.

use std::time::{Duration, Instant};

use crate::sim::{Moment, Observer};

/// Largest lag of the simulation behind the wall clock. Beyond it, both clocks are aligned again. This
/// happens if the computer slept or is too slow.
const MAX_BEHIND: Duration = Duration::from_millis(200);

/// Delays a simulation, so that it is not ahead of the wall clock. As an observer, it delays a run.
#[derive(Debug)]
pub struct WallClock {
    /// Simulated seconds per second of the wall clock.
    speed: f64,
    /// Time of both clocks at the same moment.
    began: (Instant, Duration),
}

impl WallClock {
    /// Creates a clock whose simulated time is 0 now, and advances `speed` times as fast as the wall clock.
    pub fn new(speed: f64) -> Self {
        Self {
            speed,
            began: (Instant::now(), Duration::ZERO),
        }
    }

    /// Sleeps until the wall clock reaches a simulated time.
    pub fn wait(&mut self, now: Duration) {
        let (wall, simulated) = self.began;
        let due = wall + now.saturating_sub(simulated).div_f64(self.speed);
        let wall_now = Instant::now();
        match due.checked_duration_since(wall_now) {
            Some(early) => std::thread::sleep(early),
            None if wall_now - due > MAX_BEHIND => self.began = (wall_now, now),
            None => {}
        }
    }
}

impl Observer for WallClock {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.wait(Duration::from_nanos(moment.end_ns));
    }
}
