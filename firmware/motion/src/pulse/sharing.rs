//! Groups of axes that share a plan.
//!
//! The edges of an axis in a tick depend only on its turns and on its [`Place`](super::Place). Most axes of a machine have
//! both in common. Their edges are planned once and sent to all of them.

use crate::units::MAX_AXES;

/// For each axis, the first axis that plays the same plan.
///
/// It is one word, so that a change is detected by one comparison. The lowest bits hold the first axis of each axis. Above them, a bit for
/// each axis is set if the axis is the first of its own plan.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Sharing(u32);

const BITS: u32 = 4;
const PLANNED: u32 = MAX_AXES as u32 * BITS;
const _: () = assert!(MAX_AXES <= 1 << BITS && PLANNED + MAX_AXES as u32 <= u32::BITS);

impl Sharing {
    /// Every axis plays a plan of its own.
    pub const NONE: Self = {
        let (mut none, mut axis) = (Self(0), 0);
        while axis < MAX_AXES {
            none = none.with(axis, axis);
            axis += 1;
        }
        none
    };

    /// First axis that plays the same plan as `axis`, which must be below [`MAX_AXES`].
    #[inline(always)]
    pub const fn first(self, axis: usize) -> usize {
        (self.0 >> (BITS * axis as u32) & ((1 << BITS) - 1)) as usize
    }

    /// Lets `axis` share the plan of `first`; both must be below [`MAX_AXES`].
    #[must_use]
    pub const fn with(self, axis: usize, first: usize) -> Self {
        let shift = BITS * axis as u32;
        let planned = 1 << (PLANNED + axis as u32);
        let others = self.0 & !(((1 << BITS) - 1) << shift | planned);
        let own = if first == axis { planned } else { 0 };
        Self(others | own | (first as u32) << shift)
    }

    /// Axes that play the plan of `first`, a bit each.
    pub fn group(self, first: usize) -> u32 {
        (0..MAX_AXES).fold(0, |group, axis| {
            group | u32::from(self.first(axis) == first) << axis
        })
    }

    /// Axes that are the first of a plan, a bit each. An axis that does not exist counts as the first of its own.
    #[inline(always)]
    pub const fn planned(self) -> u32 {
        self.0 >> PLANNED
    }
}

impl core::fmt::Debug for Sharing {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list()
            .entries((0..MAX_AXES).map(|axis| self.first(axis)))
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_axis_returns_its_assigned_first_axis() {
        let mut sharing = Sharing::NONE;
        for axis in 0..MAX_AXES {
            assert_eq!(sharing.first(axis), axis);
        }
        sharing = sharing.with(5, 1).with(2, 1).with(5, 0);
        let firsts: std::vec::Vec<_> = (0..MAX_AXES).map(|axis| sharing.first(axis)).collect();
        assert_eq!(firsts, [0, 1, 1, 3, 4, 0]);
        assert_eq!(sharing.planned(), 0b01_1011);
        assert_eq!(
            [0, 1, 2].map(|first| sharing.group(first)),
            [0b10_0001, 0b00_0110, 0]
        );
        assert_eq!(sharing.with(5, 5).planned(), 0b11_1011);
    }
}
