//! Bytes as a sequence of numbers.

/// Reads numbers from bytes. At their end it starts again from the beginning, each time with other values, so that a
/// few bytes also make a long sequence without repetition.
#[derive(Clone, Debug)]
pub struct Script<'a> {
    bytes: &'a [u8],
    at: usize,
    round: u32,
}

impl<'a> Script<'a> {
    /// Creates a script from any bytes, also from none.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            round: 0,
        }
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let byte = self.bytes.get(self.at).copied().unwrap_or_default();
        self.at += 1;
        // Knuth's multiplicative hash of the round and the place in it; not used in the first round.
        let hash = (self.round << 16 ^ self.at as u32).wrapping_mul(2_654_435_761) >> 24;
        let reported = if self.round == 0 {
            byte
        } else {
            byte ^ hash as u8
        };
        if self.at >= self.bytes.len() {
            self.at = 0;
            self.round = self.round.wrapping_add(1);
        }
        reported
    }

    /// Any number.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// Any number; small ones, of either sign, as often as large ones.
    pub fn number(&mut self) -> i32 {
        let shift = self.byte() % 32;
        self.word().cast_signed() >> shift
    }

    /// Below `max`, which is above 0.
    pub fn below(&mut self, max: usize) -> usize {
        usize::from(self.byte()) % max
    }

    /// True one time in `times`.
    pub fn one_in(&mut self, times: u8) -> bool {
        self.byte().is_multiple_of(times)
    }

    /// Between two numbers, both above 0, evenly in their logarithm.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let part = f64::from(self.byte()) / 255.0;
        (low * (high / low).powf(part)).clamp(low, high)
    }
}
