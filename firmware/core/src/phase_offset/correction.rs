//! Correction: phase offsets of all axes against the differences between their cranks.
//!
//! The sum of the corrections is zero. The common error of all cranks is not corrected, or the machine would move away from
//! its program.

use super::PhaseOffsets;
use crate::units::{PerAxis, Turns};

/// Reciprocals 1, ½, ⅓ … with 16 fraction bits, so that a tick needs no division.
static SHARES: PerAxis<u32> = [65_536, 32_768, 21_845, 16_384, 13_107, 10_922];

impl PhaseOffsets {
    /// Computes the controller's parts, turns, that remove the differences between the `error`s of the cranks. Their sum does not change.
    ///
    /// With `all` they remove the whole difference, otherwise the fraction that is corrected at once. Axes that are not
    /// `watched` keep theirs.
    pub fn against(&self, error: &PerAxis<Turns>, watched: u8, all: bool) -> PerAxis<Turns> {
        let mut target = *self.now();
        if watched.count_ones() > 1 {
            let mean = self.mean(error, watched);
            take_away(
                &mut target,
                error,
                watched,
                mean,
                (!all).then_some(self.gain),
            );
        }
        target
    }

    /// Mean error of the `watched` axes, to a part in 10,000; zero without axes.
    pub fn mean(&self, error: &PerAxis<Turns>, watched: u8) -> Turns {
        let axes = (watched.count_ones() as usize).wrapping_sub(1);
        let share = SHARES.get(axes).copied();
        Turns::from_bits(sum(error, watched) * i64::from(share.unwrap_or(0)))
    }
}

/// Sum of the errors of the `watched` axes, with 16 fraction bits fewer.
#[inline(never)]
fn sum(error: &[Turns], watched: u8) -> i64 {
    let axes = error.iter().enumerate();
    axes.filter(|(axis, _)| watched & 1 << axis != 0)
        .map(|(_, error)| error.to_bits() >> 16)
        .sum()
}

/// Subtracts from offsets the deviations of the `watched` axes from the mean, or a fraction of them. The last of these axes
/// takes the remainder, so that the sum does not change.
#[inline(never)]
fn take_away(offsets: &mut [Turns], error: &[Turns], watched: u8, mean: Turns, gain: Option<i64>) {
    let mut rest = Turns::ZERO;
    let mut left = watched;
    for (axis, (offset, &error)) in offsets.iter_mut().zip(error).enumerate() {
        let own = 1 << axis;
        if left & own == 0 {
            continue;
        }
        left &= !own;
        let off = mean.wrapping_sub(error);
        let by = match gain {
            _ if left == 0 => rest,
            None => off,
            Some(gain) => Turns::from_bits((off.to_bits() >> 16) * gain),
        };
        *offset = offset.wrapping_add(by);
        rest = rest.wrapping_sub(by);
    }
}
