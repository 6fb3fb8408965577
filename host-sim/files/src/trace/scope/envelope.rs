//! Envelope of a run of any length in bounded memory, with all extremes.
//!
//! *Channel*: one of the values that come together at each time. *Bucket*: a number of consecutive rows, of which each
//! channel's smallest and largest value is kept. When all buckets are full, neighbours are merged in pairs, and each bucket
//! takes twice as many rows from then on. So a row costs one comparison per channel. The merging, averaged over the rows,
//! costs about the same again.

/// Buckets of a page. A page has fewer pixels across.
pub(super) const PAGE_BUCKETS: usize = 1500;

/// Smallest and largest of some values; empty, if none of them was finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Smallest.
    pub low: f64,
    /// Largest.
    pub high: f64,
}

impl Extent {
    /// Returns the extent of no values.
    pub const EMPTY: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    /// Returns true if there was no finite value.
    pub fn is_empty(self) -> bool {
        self.low > self.high
    }

    /// Adds a value, if it is finite.
    #[inline]
    pub fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    /// Returns the extent of the values of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Converts the extent to another unit; `factor` is above zero.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            low: self.low * factor,
            high: self.high * factor,
        }
    }

    /// Returns the largest magnitude; zero if empty.
    pub fn peak(self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        self.low.abs().max(self.high.abs())
    }
}

/// Envelope of a run.
#[derive(Clone, Debug)]
pub struct Envelope {
    channels: usize,
    max_buckets: usize,
    rows_per_bucket: u64,
    rows_in_last: u64,
    /// First and last time of each bucket.
    spans: Vec<(f64, f64)>,
    /// Bucket after bucket, all channels of each.
    extents: Vec<Extent>,
}

impl Envelope {
    /// An envelope without rows, of at most `max_buckets` buckets; an odd number is rounded up, as buckets merge in pairs.
    pub fn new(channels: usize, max_buckets: usize) -> Self {
        Self {
            channels,
            max_buckets: max_buckets.max(2).next_multiple_of(2),
            rows_per_bucket: 1,
            rows_in_last: 0,
            spans: Vec::new(),
            extents: Vec::new(),
        }
    }

    /// Adds a row, later than those before it, with one value per channel.
    #[inline]
    pub fn push(&mut self, t_s: f64, values: &[f64]) {
        debug_assert_eq!(values.len(), self.channels);
        if self.spans.is_empty() || self.rows_in_last == self.rows_per_bucket {
            if self.spans.len() == self.max_buckets {
                self.merge();
            }
            self.spans.push((t_s, t_s));
            self.extents
                .resize(self.spans.len() * self.channels, Extent::EMPTY);
            self.rows_in_last = 0;
        }
        self.rows_in_last += 1;
        let last = self.spans.len() - 1;
        self.spans[last].1 = t_s;
        for (extent, &value) in self.extents[last * self.channels..].iter_mut().zip(values) {
            extent.add(value);
        }
    }

    /// Merges full buckets two by two.
    #[cold]
    fn merge(&mut self) {
        let half = self.spans.len() / 2;
        for i in 0..half {
            self.spans[i] = (self.spans[2 * i].0, self.spans[2 * i + 1].1);
            for channel in 0..self.channels {
                let left = self.extents[2 * i * self.channels + channel];
                let right = self.extents[(2 * i + 1) * self.channels + channel];
                self.extents[i * self.channels + channel] = left.and(right);
            }
        }
        self.spans.truncate(half);
        self.extents.truncate(half * self.channels);
        self.rows_per_bucket *= 2;
    }

    /// First and last time, seconds.
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((self.spans.first()?.0, self.spans.last()?.1))
    }

    /// Returns true if a bucket holds more than one row, so that an extent is a range and not a value.
    pub fn is_folded(&self) -> bool {
        self.rows_per_bucket > 1
    }

    /// Number of buckets.
    pub fn buckets(&self) -> usize {
        self.spans.len()
    }

    /// All buckets: first time, last time, and the extent of each channel.
    pub fn rows(&self) -> impl Iterator<Item = (f64, f64, &[Extent])> {
        self.spans
            .iter()
            .zip(self.extents.chunks_exact(self.channels.max(1)))
            .map(|(&(first, last), extents)| (first, last, extents))
    }

    /// One channel's buckets: first time, last time, extent.
    pub fn channel(&self, channel: usize) -> impl Iterator<Item = (f64, f64, Extent)> + '_ {
        let extents = self
            .extents
            .iter()
            .skip(channel)
            .step_by(self.channels.max(1));
        self.spans
            .iter()
            .zip(extents)
            .map(|(&(first, last), &extent)| (first, last, extent))
    }

    /// Returns true if two channels differ by at most `near` in every bucket.
    pub fn are_alike(&self, one: usize, other: usize, near: f64) -> bool {
        let is_near = |a: f64, b: f64| a == b || (a - b).abs() <= near;
        self.rows().all(|(_, _, extents)| {
            let (one, other) = (extents[one], extents[other]);
            is_near(one.low, other.low) && is_near(one.high, other.high)
        })
    }

    /// Returns the extent of a channel over the whole run.
    pub fn total(&self, channel: usize) -> Extent {
        self.channel(channel)
            .fold(Extent::EMPTY, |all, (_, _, extent)| all.and(extent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn folded(rows: &[[f64; 2]]) -> Envelope {
        let mut envelope = Envelope::new(2, PAGE_BUCKETS);
        for (tick, row) in rows.iter().enumerate() {
            envelope.push(tick as f64, row);
        }
        envelope
    }

    #[test]
    fn a_single_spike_survives_any_number_of_merges() {
        let rows = 1_000_000_u32;
        let mut envelope = Envelope::new(1, PAGE_BUCKETS);
        for tick in 0..rows {
            let value = if tick == 123_457 { -7.0 } else { 0.0 };
            envelope.push(f64::from(tick), &[value]);
        }
        assert!(envelope.spans.len() <= PAGE_BUCKETS);
        assert_eq!(
            envelope.total(0),
            Extent {
                low: -7.0,
                high: 0.0
            }
        );
        let (first, last, _) = envelope
            .channel(0)
            .find(|(_, _, extent)| extent.low < 0.0)
            .unwrap();
        assert!(
            first <= 123_457.0 && 123_457.0 <= last,
            "at {first}..{last}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Compares with the plain definition: each bucket is the extent of exactly the rows within its times, the buckets
        /// hold every row once, in order, and there are never more than allowed.
        #[test]
        fn buckets_hold_exactly_their_rows(
            seeds in prop::collection::vec((any::<f64>(), -1e3_f64..1e3), 1..97),
            repeats in 1_usize..100,
        ) {
            let rows: Vec<[f64; 2]> = (0..repeats)
                .flat_map(|r| seeds.iter().map(move |&(wild, tame)| [wild, tame * (r + 1) as f64]))
                .collect();
            let envelope = folded(&rows);
            prop_assert!(envelope.spans.len() <= PAGE_BUCKETS);
            prop_assert_eq!(envelope.span(), Some((0.0, (rows.len() - 1) as f64)));
            for channel in 0..2 {
                let mut next = 0;
                for (first, last, extent) in envelope.channel(channel) {
                    prop_assert_eq!(first, next as f64);
                    next = last as usize + 1;
                    let mut expected = Extent::EMPTY;
                    for row in &rows[first as usize..next] {
                        expected.add(row[channel]);
                    }
                    prop_assert_eq!(extent, expected);
                }
                prop_assert_eq!(next, rows.len());
                let finite = || rows.iter().map(|row| row[channel]).filter(|v| v.is_finite());
                let total = envelope.total(channel);
                prop_assert_eq!(total.low, finite().fold(f64::INFINITY, f64::min));
                prop_assert_eq!(total.high, finite().fold(f64::NEG_INFINITY, f64::max));
            }
        }
    }
}
