//! Simulated time in step with the wall clock.

use std::time::{Duration, Instant};

use crate::sim::{Moment, Observer};

/// Longest time that the wall clock may be ahead before the step begins anew: a computer that slept, or is too slow.
const MOST_BEHIND: Duration = Duration::from_millis(200);

/// Holds a simulation back, so that it is not ahead of the wall clock. As an observer it holds a run back.
#[derive(Debug)]
pub struct WallClock {
    /// Simulated seconds per second of the wall clock.
    speed: f64,
    /// The same time on both clocks.
    began: (Instant, Duration),
}

impl WallClock {
    /// A clock whose simulated time is 0 now, and passes `speed` times as fast as the wall clock's.
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
            None if wall_now - due > MOST_BEHIND => self.began = (wall_now, now),
            None => {}
        }
    }
}

impl Observer for WallClock {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.wait(Duration::from_nanos(moment.end_ns));
    }
}
