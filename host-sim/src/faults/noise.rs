//! Noise that is the same on every run and host: a number of a normal distribution for each number that is given.
//!
//! Each sensor of each axis has a stream of its own, and within it each draw its own place. So one sensor that is read more
//! often, or a fault that keeps it from being read, shifts the noise of no other. ChaCha is made for that: any place of any
//! stream is had at once. The uniform numbers become normal ones by Box and Muller's formula with the `libm` crate, as the
//! standard library's logarithm is the host's.

use std::cell::RefCell;

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// What noise is on; its number is part of the stream's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Sensor {
    /// Place of the index flag's beginning.
    FlagStart = 0,
    /// Place of its end.
    FlagEnd = 1,
    /// Time of an index line's edge.
    EdgeTime = 2,
    /// Reading of an encoder.
    Encoder = 3,
    /// Load on a crank.
    Load = 4,
}

/// More axes than a machine has: streams of one sensor lie side by side.
const AXES: u64 = 16;

/// Words of the generator that a draw takes.
const WORDS: u128 = 4;

/// Draws that one filling of the generator's buffer gives: four blocks of sixteen words. Sensors are read in order, so that all but one
/// in sixteen draws find their number there. Sixteen logarithms and cosines in a row take less time than one at a time, as no one waits
/// for another.
const DRAWS: usize = 16;

/// The noise of one sensor on one axis.
#[derive(Clone, Debug)]
pub struct Stream {
    seed: [u8; 32],
    number: u64,
    deviation: f64,
    window: RefCell<Window>,
}

/// [`DRAWS`] draws in a row.
#[derive(Clone, Debug)]
struct Window {
    /// Number of the first draw, over [`DRAWS`].
    place: Option<u64>,
    draws: [f64; DRAWS],
}

impl Stream {
    /// Noise of that standard deviation; none if it is 0.
    pub fn new(seed: u64, sensor: Sensor, axis: usize, deviation: f64) -> Option<Self> {
        if deviation == 0.0 {
            return None;
        }
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        Some(Self {
            seed: bytes,
            number: sensor as u64 * AXES + axis as u64,
            deviation,
            window: RefCell::new(Window {
                place: None,
                draws: [0.0; DRAWS],
            }),
        })
    }

    /// The draw of that number.
    pub fn draw(&self, number: i64) -> f64 {
        let number = number as u64;
        let place = number / DRAWS as u64;
        let mut window = self.window.borrow_mut();
        if window.place != Some(place) {
            window.place = Some(place);
            self.fill(place, &mut window.draws);
        }
        window.draws[(number % DRAWS as u64) as usize]
    }

    #[inline(never)]
    fn fill(&self, place: u64, draws: &mut [f64; DRAWS]) {
        let mut rng = ChaCha8Rng::from_seed(self.seed);
        rng.set_stream(self.number);
        rng.set_word_pos(WORDS * DRAWS as u128 * u128::from(place));
        let words: [[u64; 2]; DRAWS] =
            std::array::from_fn(|_| std::array::from_fn(|_| rng.next_u64()));
        *draws = words.map(|words| self.deviation * normal(words));
    }

    /// What no draw goes beyond, either way: √(−2 ln 2⁻⁵³) is 8.57.
    pub fn reach(&self) -> f64 {
        8.6 * self.deviation
    }
}

const UNIT: f64 = 1.0 / (1u64 << 53) as f64;

/// A number of a normal distribution, of two random numbers.
fn normal([radius, angle]: [u64; 2]) -> f64 {
    // From 2⁻⁵³ to 1, so that its logarithm is finite; and from 0 to 1.
    let radius = ((radius >> 11) + 1) as f64 * UNIT;
    let angle = (angle >> 11) as f64 * UNIT;
    libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(std::f64::consts::TAU * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If a draw depended on the draws before it, a sensor that is read more often would have other noise. The numbers are those of the
    /// generator at the place of the draw.
    #[test]
    fn a_draw_is_the_same_in_any_order() {
        let alone = |number: i64| {
            let stream = Stream::new(7, Sensor::FlagEnd, 3, 1.0).unwrap();
            stream.draw(number)
        };
        let stream = Stream::new(7, Sensor::FlagEnd, 3, 1.0).unwrap();
        for number in [0, 1, 15, 16, 17, 3, -1, -16, -17, i64::MIN, i64::MAX, 40] {
            assert_eq!(stream.draw(number), alone(number), "{number}");
            let mut rng = ChaCha8Rng::from_seed(stream.seed);
            rng.set_stream(stream.number);
            rng.set_word_pos(WORDS * u128::from(number as u64));
            let words = [rng.next_u64(), rng.next_u64()];
            assert_eq!(stream.draw(number), normal(words), "{number}");
        }
    }

    /// Were it wrong, noise would be of another size than the scene says, or off centre. Of 20,000 draws the mean is within
    /// σ/√n, the deviation within σ/√2n: four of those each, which one seed in 10,000 does not keep.
    #[test]
    fn draws_have_the_requested_deviation() {
        const DRAWS: i64 = 20_000;
        for (seed, axis) in [(1, 0), (1, 5), (99, 0)] {
            let stream = Stream::new(seed, Sensor::Encoder, axis, 2.5).unwrap();
            let draws: Vec<f64> = (0..DRAWS).map(|number| stream.draw(number)).collect();
            let mean = draws.iter().sum::<f64>() / DRAWS as f64;
            let square = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / DRAWS as f64;
            let n = DRAWS as f64;
            assert!(mean.abs() < 4.0 * 2.5 / n.sqrt(), "{mean}");
            assert!(
                (square.sqrt() / 2.5 - 1.0).abs() < 4.0 / (2.0 * n).sqrt(),
                "{}",
                square.sqrt()
            );
            assert!(draws.iter().all(|x| x.abs() <= stream.reach()));
        }
    }

    /// Were it wrong, one sensor's noise would be another's, or depend on what was drawn before.
    #[test]
    fn streams_are_apart_and_draws_are_by_number() {
        let stream = |sensor, axis| Stream::new(7, sensor, axis, 1.0).unwrap();
        let first = stream(Sensor::FlagStart, 0);
        let later = first.draw(40);
        assert_eq!((first.draw(-1), first.draw(40)), (first.draw(-1), later));
        for (sensor, axis) in [
            (Sensor::FlagStart, 1),
            (Sensor::FlagEnd, 0),
            (Sensor::Load, 0),
        ] {
            assert_ne!(stream(sensor, axis).draw(40), later);
        }
        assert!(Stream::new(7, Sensor::Load, 0, 0.0).is_none());
    }
}
