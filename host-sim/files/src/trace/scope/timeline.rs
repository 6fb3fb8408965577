//! States of the supervisor, and marks: named times.
//!
//! Both are bounded. When there are too many states, the shortest stretch is merged into the one before it,
//! because the page could not show it. Marks beyond the bound are counted, those of faults separately from the
//! others. The page states how many are missing.

/// State stretches at most.
const STATES: usize = 400;
/// Marks at most, of each of the two kinds.
const MARKS: usize = 60;

/// A stretch of one state.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// From, seconds.
    pub from_s: f64,
    /// To, seconds: the time of the first row of the next stretch, or of the last row.
    pub to_s: f64,
    /// The state's name.
    pub state: &'static str,
}

/// A named event.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Time, seconds.
    pub t_s: f64,
    /// Its name.
    pub label: String,
    /// True for the mark of a fault.
    pub is_fault: bool,
}

/// States and marks of a run.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    stretches: Vec<Stretch>,
    marks: Vec<Mark>,
    missing: usize,
}

impl Timeline {
    /// Sets the state at `t_s`.
    #[inline]
    pub fn state(&mut self, t_s: f64, state: &'static str) {
        if let Some(last) = self.stretches.last_mut() {
            last.to_s = t_s;
            if last.state == state {
                return;
            }
        }
        self.change(t_s, state);
    }

    #[cold]
    fn change(&mut self, t_s: f64, state: &'static str) {
        if self.stretches.len() == STATES {
            self.drop_shortest();
        }
        self.stretches.push(Stretch {
            from_s: t_s,
            to_s: t_s,
            state,
        });
    }

    fn drop_shortest(&mut self) {
        let length = |i: usize| self.stretches[i].to_s - self.stretches[i].from_s;
        // The first stretch has no predecessor into which it could be merged.
        let Some(shortest) =
            (1..self.stretches.len()).min_by(|&a, &b| length(a).total_cmp(&length(b)))
        else {
            return;
        };
        let gone = self.stretches.remove(shortest);
        self.stretches[shortest - 1].to_s = gone.to_s;
        // Its two neighbours may now have the same state.
        if self
            .stretches
            .get(shortest)
            .is_some_and(|next| next.state == self.stretches[shortest - 1].state)
        {
            let next = self.stretches.remove(shortest);
            self.stretches[shortest - 1].to_s = next.to_s;
        }
    }

    /// Marks an event. An event without a finite time is counted as missing.
    pub fn mark(&mut self, t_s: f64, label: &str) {
        let is_fault = label.starts_with("fault");
        let alike = self
            .marks
            .iter()
            .filter(|mark| mark.is_fault == is_fault)
            .count();
        if alike == MARKS || !t_s.is_finite() {
            self.missing += 1;
            return;
        }
        self.marks.push(Mark {
            t_s,
            label: label.to_owned(),
            is_fault,
        });
    }

    /// States in the order of time.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Marks in the order of time; of the same time, in the order given.
    pub fn marks(&self) -> Vec<&Mark> {
        let mut marks: Vec<&Mark> = self.marks.iter().collect();
        marks.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        marks
    }

    /// Returns the number of marks that were not kept.
    pub fn missing(&self) -> usize {
        self.missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_become_stretches_without_gaps() {
        let mut timeline = Timeline::default();
        for (t_s, state) in [(0.0, "idle"), (1.0, "idle"), (2.0, "run"), (3.0, "run")] {
            timeline.state(t_s, state);
        }
        let idle = Stretch {
            from_s: 0.0,
            to_s: 2.0,
            state: "idle",
        };
        let run = Stretch {
            from_s: 2.0,
            to_s: 3.0,
            state: "run",
        };
        assert_eq!(timeline.stretches(), [idle, run]);
    }

    #[test]
    fn a_chattering_supervisor_stays_bounded_and_the_last_state_is_right() {
        let mut timeline = Timeline::default();
        for tick in 0..5000 {
            timeline.state(f64::from(tick), if tick % 2 == 0 { "run" } else { "stop" });
        }
        timeline.state(5000.0, "fault");
        let stretches = timeline.stretches();
        assert!(stretches.len() <= STATES);
        assert_eq!(stretches.last().unwrap().state, "fault");
        assert_eq!(stretches[0].from_s, 0.0);
        for pair in stretches.windows(2) {
            assert_eq!(pair[0].to_s, pair[1].from_s);
            assert_ne!(pair[0].state, pair[1].state);
        }
    }

    #[test]
    fn crossings_do_not_hide_the_fault() {
        let mut timeline = Timeline::default();
        for i in 0..1000 {
            timeline.mark(f64::from(i), "band crossed");
        }
        timeline.mark(0.5, "fault: tilt");
        assert_eq!(timeline.marks().len(), MARKS + 1);
        assert_eq!(timeline.marks()[1].label, "fault: tilt");
        assert_eq!(timeline.missing(), 1000 - MARKS);
    }
}
