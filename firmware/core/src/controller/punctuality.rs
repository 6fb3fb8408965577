//! When missed deadlines are too many.

/// Deadlines missed at once that are no fault yet.
const MOST_AT_ONCE: u32 = 2;

/// Ticks after which a missed deadline is forgiven.
const FORGIVEN_AFTER: u32 = 8;

/// Keeps account of missed deadlines: each weighs as much as [`FORGIVEN_AFTER`] ticks take off again.
///
/// So two at once are no fault and three are; and a loop that has too much to do, and misses one deadline
/// after every few that it meets, is one as well, as soon as it misses more than one in nine for long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Punctuality {
    debt: u32,
}

impl Punctuality {
    /// Of a loop that has missed nothing.
    pub(super) const fn new() -> Self {
        Self { debt: 0 }
    }

    /// A tick is played.
    pub(super) const fn met(&mut self) {
        self.debt = self.debt.saturating_sub(1);
    }

    /// So many deadlines were missed. True if that is too many.
    pub(super) const fn missed(&mut self, deadlines: u32) -> bool {
        const MOST: u32 = MOST_AT_ONCE * FORGIVEN_AFTER;
        let debt = deadlines
            .saturating_mul(FORGIVEN_AFTER)
            .saturating_add(self.debt);
        // However long it was away: when it is back for a while, it may start again.
        const CEILING: u32 = MOST + FORGIVEN_AFTER;
        self.debt = if debt < CEILING { debt } else { CEILING };
        debt > MOST
    }
}
