//! What time is measured in: sines. A nanosecond is another on every machine; a step of so many sines is about the same.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// How long a sine takes here and now.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    sine_s: f64,
}

/// Long enough for the clock, short enough not to be waited for: some 0.1 ms.
const SINES: u32 = 10_000;
/// The shortest counts: whatever else a machine does only adds.
const TRIES: u32 = 10;

impl Yardstick {
    /// Measured now.
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
            sine_s: best.max(1e-12), // a clock that stands still
        }
    }

    /// A time in sines.
    pub fn sines(self, time: Duration) -> f64 {
        time.as_secs_f64() / self.sine_s
    }
}
