//! What cranks did when they were moved, next to what they were told: which of them strays, and whether it does what another was told.

use crate::units::{Turns, nearest};

/// What a crank was found to have done when it was moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Away from what it was told.
    pub off: Turns,
    /// What it was told.
    pub moved: Turns,
    /// What both may be off by.
    pub allowed: Turns,
}

/// The crank that strays most, by how much, and whether it does what another was told.
#[inline(never)] // one for every number of axes
pub(super) fn stray(looks: &[Look], watched: u8, on_the_way: bool) -> Option<(usize, Turns, bool)> {
    let strays = |look: &Look| look.off.abs() > look.allowed;
    let (axis, look) = looks
        .iter()
        .enumerate()
        .filter(|&(axis, look)| watched & 1 << axis != 0 && strays(look))
        .max_by_key(|(_, look)| look.off.abs())?;
    // As far off as some other crank was moved further?
    let follows = |other: usize, by: Turns| {
        let between = by.wrapping_sub(look.moved);
        let apart = between.abs() > look.allowed;
        let rest = nearest(between.wrapping_sub(look.off));
        // On the way there it may be anywhere between.
        let partly = on_the_way && (look.off < 0) == (between < 0) && (rest < 0) == (between < 0);
        other != axis && apart && (partly || rest.abs() <= look.allowed)
    };
    let mut others = looks.iter().enumerate();
    let is_swapped = others.any(|(other, at)| follows(other, at.moved));
    Some((axis, look.off, is_swapped))
}
