//! Unit of durations: the duration of a sine. In nanoseconds, the duration of a step depends on the machine; in sines, it is about the
//! same on all.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Duration of a sine on this machine.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    sine_s: f64,
}

/// Number of sines per measurement: about 0.1 ms, long enough for the clock.
const SINES: u32 = 10_000;
/// Number of measurements. The shortest counts, as other work on the machine only adds to the duration.
const TRIES: u32 = 10;

impl Yardstick {
    /// Measures the duration.
    pub fn measure() -> Self {
        let time = || {
            let began = Instant::now();
            let mut sum = 0.0;
            for i in 0..SINES {
                sum += black_box(f64::from(i) * 1e-3).sin();
            }
            black_box(sum);
            began.elapsed().as_secs_f64() / f64::from(SINES)
        };
        let best = (0..TRIES).map(|_| time()).fold(f64::INFINITY, f64::min);
        Self {
            sine_s: best.max(1e-12), // in case the clock does not advance
        }
    }

    /// Converts a duration to sines.
    pub fn sines(self, time: Duration) -> f64 {
        time.as_secs_f64() / self.sine_s
    }
}
