//! Noise that is the same in every run and on every host: a normally distributed number for each draw number.
//!
//! Each sensor of each axis has its own stream, and each draw has its own position within the stream. So a sensor that is read more
//! often, or a fault that prevents a reading, shifts the noise of no other sensor. ChaCha suits this, because it gives random access to
//! any position of any stream. The formula of Box and Muller converts the uniform numbers to normal ones. It uses the `libm` crate,
//! because the standard library's logarithm depends on the host.

use std::cell::RefCell;

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// Source of noise. Its number is part of the stream's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Sensor {
    /// Position of the start of the index flag.
    FlagStart = 0,
    /// Position of the end of the index flag.
    FlagEnd = 1,
    /// Time of an index line's edge.
    EdgeTime = 2,
    /// Reading of an encoder.
    Encoder = 3,
    /// Load on a crank.
    Load = 4,
}

/// Stream numbers per sensor: more than the largest number of axes.
const AXES: u64 = 16;

/// Words of the generator per draw.
const WORDS: u128 = 4;

/// Draws per filling of the generator's buffer: four blocks of sixteen words. Sensors are read in order, so that fifteen of sixteen
/// draws find their number in the buffer. Sixteen logarithms and cosines in a row take less time than one at a time, because they do
/// not depend on each other.
const DRAWS: usize = 16;

/// Noise of one sensor on one axis.
#[derive(Clone, Debug)]
pub struct Stream {
    seed: [u8; 32],
    number: u64,
    deviation: f64,
    window: RefCell<Window>,
}

/// Buffer of [`DRAWS`] consecutive draws.
#[derive(Clone, Debug)]
struct Window {
    /// Number of the first draw, divided by [`DRAWS`].
    place: Option<u64>,
    draws: [f64; DRAWS],
}

impl Stream {
    /// Creates noise with this standard deviation; none if it is 0.
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

    /// Returns the draw with this number.
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

    /// Upper bound of the magnitude of a draw: √(−2 ln 2⁻⁵³) is 8.57.
    pub fn reach(&self) -> f64 {
        8.6 * self.deviation
    }
}

const UNIT: f64 = 1.0 / (1u64 << 53) as f64;

/// Converts two random numbers to a normally distributed one.
fn normal([radius, angle]: [u64; 2]) -> f64 {
    // The radius is from 2⁻⁵³ to 1, so that its logarithm is finite. The angle is from 0 to 1.
    let radius = ((radius >> 11) + 1) as f64 * UNIT;
    let angle = (angle >> 11) as f64 * UNIT;
    libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(std::f64::consts::TAU * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a draw depends on the draws before it, and a sensor that is read more often has other noise. The expected numbers
    /// are those of the generator at the position of the draw.
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

    /// If this fails, noise is larger or smaller than the scene sets, or not centred. The mean of 20,000 draws has the standard error
    /// σ/√n, and their deviation σ/√2n. The limits are four times these, which one seed in 10,000 exceeds.
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

    /// If this fails, one sensor has the noise of another, or noise that depends on earlier draws.
    #[test]
    fn streams_differ_and_draws_depend_only_on_number() {
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
