//! One entry for each axis of a machine, in the order of their numbers.

use cophase_core::units::MAX_AXES;

/// One entry for each axis that a machine has. It needs no heap.
pub type Axes<T> = heapless::Vec<T, MAX_AXES>;

/// Creates one entry for each of `count` axes, from the axis's number.
///
/// # Panics
/// If `count` is above [`MAX_AXES`].
#[inline]
pub fn per_axis<T>(count: usize, mut make: impl FnMut(usize) -> T) -> Axes<T> {
    assert!(count <= MAX_AXES, "{count} axes, and at most {MAX_AXES}");
    // A loop, because no compiler inlines the call of `collect`.
    let mut axes = Axes::new();
    for i in 0..count {
        let _ = axes.push(make(i));
    }
    axes
}
