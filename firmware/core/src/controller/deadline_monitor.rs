//! Limit on missed deadlines.

/// Largest number of deadlines missed at once that is no fault.
const MAX_AT_ONCE: u32 = 2;

/// Number of ticks after which a missed deadline no longer counts.
const FORGIVEN_AFTER: u32 = 8;

/// Counts missed deadlines. Each adds [`FORGIVEN_AFTER`], and each tick subtracts one.
///
/// Two at once are no fault, and three are one. An overloaded loop that misses one deadline after every few ticks is a fault, too, once it
/// misses more than one in nine for long.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeadlineMonitor {
    debt: u32,
}

impl DeadlineMonitor {
    /// Creates the count of a loop that has missed no deadline.
    pub(super) const fn new() -> Self {
        Self { debt: 0 }
    }

    /// Counts a tick that was played.
    pub(super) const fn on_time(&mut self) {
        self.debt = self.debt.saturating_sub(1);
    }

    /// Counts missed deadlines. Returns true if there are too many.
    pub(super) const fn missed(&mut self, deadlines: u32) -> bool {
        const MAX: u32 = MAX_AT_ONCE * FORGIVEN_AFTER;
        let debt = deadlines
            .saturating_mul(FORGIVEN_AFTER)
            .saturating_add(self.debt);
        // The ceiling lets the machine start again soon after the loop is back, however long it was away.
        const CEILING: u32 = MAX + FORGIVEN_AFTER;
        self.debt = if debt < CEILING { debt } else { CEILING };
        debt > MAX
    }
}
