//! Buffer for the runs of a tick.

use core::fmt;
use core::ops::Deref;

use super::planner::CHUNK;
use super::{MAX_EDGES, Run};

/// Greatest number of runs in a tick.
///
/// Every [`super::planner::CHUNK`] edges take one run, and nine more are needed:
///
/// - three for a change of direction, one for the first edge and one for the pause at the end;
/// - one more each for the two chunks after the first edge and for the last one, which the guards make differ from the
///   others;
/// - one for the last chunk, as it is short.
pub const MAX_RUNS: usize = (MAX_EDGES / CHUNK) as usize + 9;

/// The runs of one axis over one tick, in order. The step hardware can read them where they are.
#[derive(Clone)]
#[repr(C)] // Behind the buffer its length would be out of reach of a load instruction.
pub struct Runs {
    used: usize,
    room: [Run; MAX_RUNS],
}

/// Runs that are being appended to; their number stays in a register meanwhile.
pub(super) struct Appending<'a> {
    room: &'a mut [Run; MAX_RUNS],
    used: usize,
    length: &'a mut usize,
}

impl Appending<'_> {
    #[inline(always)]
    pub(super) fn push(&mut self, run: Run) {
        // Checked settings keep to MAX_EDGES, for which MAX_RUNS are enough.
        debug_assert!(self.used < MAX_RUNS, "more runs than a tick holds");
        if let Some(place) = self.room.get_mut(self.used) {
            *place = run;
            self.used += 1;
        }
    }

    #[inline(always)]
    pub(super) fn finish(self) {
        *self.length = self.used;
    }
}

impl Runs {
    /// Creates an empty buffer.
    pub const fn new() -> Self {
        Self {
            used: 0,
            room: [Run::pause(Run::MIN_CYCLES, false); MAX_RUNS], // all zeros
        }
    }

    /// Removes all runs.
    pub const fn clear(&mut self) {
        self.used = 0;
    }

    /// Appends a run; returns false if there was no room.
    #[inline(always)]
    pub fn push(&mut self, run: Run) -> bool {
        let Some(place) = self.room.get_mut(self.used) else {
            return false;
        };
        *place = run;
        self.used += 1;
        true
    }

    #[inline(always)]
    pub(super) fn append(&mut self) -> Appending<'_> {
        Appending {
            room: &mut self.room,
            used: self.used,
            length: &mut self.used,
        }
    }

    /// Replaces all runs; those without room are left out.
    pub fn copy_from(&mut self, runs: &[Run]) {
        let runs = runs.get(..MAX_RUNS).unwrap_or(runs);
        self.used = runs.len();
        for (place, run) in self.room.iter_mut().zip(runs) {
            *place = *run;
        }
    }
}

impl Default for Runs {
    fn default() -> Self {
        Self::new()
    }
}

impl Deref for Runs {
    type Target = [Run];

    fn deref(&self) -> &[Run] {
        self.room.get(..self.used).unwrap_or_default()
    }
}

impl Extend<Run> for Runs {
    /// Appends runs; those without room are left out.
    fn extend<T: IntoIterator<Item = Run>>(&mut self, runs: T) {
        for run in runs {
            let pushed = self.push(run);
            debug_assert!(pushed, "more runs than a tick holds");
        }
    }
}

impl<'a> IntoIterator for &'a Runs {
    type Item = &'a Run;
    type IntoIter = core::slice::Iter<'a, Run>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Debug for Runs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the hardware misses runs, or plays those of an earlier tick.
    #[test]
    fn a_buffer_holds_the_runs_that_were_added_last() {
        let mut runs = Runs::new();
        for n in 1..=MAX_RUNS {
            assert!(runs.push(Run::new(n as u32, Run::MIN_CYCLES, true)));
            assert_eq!(runs.len(), n);
        }
        assert!(!runs.push(Run::pause(Run::MIN_CYCLES, true)));
        let mut other = Runs::new();
        other.push(Run::pause(Run::MIN_CYCLES, true));
        let mut copy = Runs::new();
        for runs in [&runs, &other, &runs] {
            copy.copy_from(runs);
            assert_eq!(copy[..], runs[..]);
        }
        let too_many: std::vec::Vec<_> = runs.iter().chain(&other).copied().collect();
        copy.copy_from(&too_many);
        assert_eq!(copy[..], runs[..]);
        runs.clear();
        assert!(runs.is_empty());
    }
}
