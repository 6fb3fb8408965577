//! Rules that detect a change of the phase error from one reading a turn. All lengths are in tolerances.
//!
//! The gate and the windows are those of the monitor, written anew. The gate takes the first reading as the place of the crank. CUSUM and
//! GLR are given the place exactly, which favours them.
//!
//! - CUSUM: E. S. Page, *Continuous inspection schemes*, Biometrika 41 (1954). G. Lorden, *Procedures for reacting to a change in
//!   distribution*, Ann. Math. Statist. 42 (1971): with k half of the step, it is asymptotically the fastest for that step.
//! - GLR: A. S. Willsky and H. L. Jones, *A generalized likelihood ratio approach to the detection and estimation of jumps in linear
//!   systems*, IEEE Trans. Automat. Control 21 (1976); the same for a slope.

use super::noise::SIGMA;

/// Turns of a window.
pub const WINDOW: usize = 64;
/// Steps in a row that are a drift.
const STEPS: i32 = 4;

/// Rule, without its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// A reading that is further from the first than the threshold.
    Gate,
    /// Four steps in a row in one direction; a mean of a window that is further than the threshold from that at the last step is a step.
    Windows,
    /// A difference of two readings that exceeds the threshold.
    Range,
    /// CUSUM in both directions: S ← max(0, S ± x − k), with S above the threshold.
    Cusum {
        /// Allowance a turn, k.
        k: f64,
    },
    /// Generalised likelihood ratio of a step of any size, over lengths up to [`LONGEST`] turns. The threshold is in standard deviations.
    GlrStep,
    /// The same of a slope.
    GlrSlope,
}

/// Longest time since a change that a GLR considers, turns.
pub const LONGEST: usize = 1024;

impl Rule {
    /// All rules of the chart.
    pub const ALL: [Self; 8] = [
        Self::Gate,
        Self::Windows,
        Self::Range,
        Self::Cusum { k: 0.25 },
        Self::Cusum { k: 1.0 },
        Self::Cusum { k: 2.0 },
        Self::GlrStep,
        Self::GlrSlope,
    ];

    /// Name in the data and the picture.
    pub fn name(self) -> String {
        match self {
            Self::Gate => "gate".to_owned(),
            Self::Windows => "windows".to_owned(),
            Self::Range => "range".to_owned(),
            Self::Cusum { k } => format!("CUSUM k = {k} r"),
            Self::GlrStep => "GLR step".to_owned(),
            Self::GlrSlope => "GLR slope".to_owned(),
        }
    }

    /// Threshold of the monitor, if it has the rule.
    pub const fn present(self) -> Option<f64> {
        match self {
            Self::Gate => Some(4.0),
            Self::Windows => Some(0.5),
            _ => None,
        }
    }

    /// Least threshold without a false alarm while no reading errs by more than a tolerance.
    pub fn without_false_alarms(self) -> Option<f64> {
        match self {
            Self::Gate | Self::Range => Some(2.0),
            Self::Windows => Some(0.5),
            Self::Cusum { k } if k >= 1.0 => Some(0.0),
            _ => None,
        }
    }

    /// Numbers that the rule stores for each axis, without constants.
    pub const fn numbers(self) -> usize {
        match self {
            Self::Gate => 1,
            // Turns, sum, mean at the last step, mean before the first step, steps.
            Self::Windows => 5,
            Self::Range => 2,
            // Both sums, and the place.
            Self::Cusum { .. } => 3,
            Self::GlrStep | Self::GlrSlope => LONGEST + 1,
        }
    }

    /// Creates the rule's detector: it takes one reading a turn, and returns true from the alarm on.
    pub fn detector(self, threshold: f64) -> Box<dyn FnMut(f64) -> bool> {
        match self {
            Self::Gate => {
                let mut home = None;
                Box::new(move |x| (x - *home.get_or_insert(x)).abs() > threshold)
            }
            Self::Windows => windows(threshold),
            Self::Range => {
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                Box::new(move |x| {
                    low = x.min(low);
                    high = x.max(high);
                    high - low > threshold
                })
            }
            Self::Cusum { k } => {
                let (mut ahead, mut behind) = (0.0_f64, 0.0_f64);
                Box::new(move |x| {
                    ahead = (ahead + x - k).max(0.0);
                    behind = (behind - x - k).max(0.0);
                    ahead.max(behind) > threshold
                })
            }
            Self::GlrStep => glr(Shape::Step, threshold),
            Self::GlrSlope => glr(Shape::Slope, threshold),
        }
    }
}

fn windows(step: f64) -> Box<dyn FnMut(f64) -> bool> {
    let (mut turns, mut sum, mut last, mut row) = (0, 0.0, None, 0_i32);
    Box::new(move |x| {
        sum += x;
        turns += 1;
        if turns < WINDOW {
            return false;
        }
        let mean = sum / WINDOW as f64;
        (turns, sum) = (0, 0.0);
        let by: f64 = mean - *last.get_or_insert(mean);
        if by.abs() > step {
            let sense = if by < 0.0 { -1 } else { 1 };
            row = if row.signum() == sense {
                row + sense
            } else {
                sense
            };
            last = Some(mean);
        }
        row.abs() >= STEPS
    })
}

/// Shape of a change that a GLR looks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Constant from the change on.
    Step,
    /// Grows by the same from turn to turn.
    Slope,
}

impl Shape {
    /// Weight of the reading in turn `i` of a change, from 1 on.
    pub fn weight(self, i: usize) -> f64 {
        match self {
            Self::Step => 1.0,
            Self::Slope => i as f64,
        }
    }

    /// Root of the sum of the squares of the weights over `length` turns.
    pub fn norm(self, length: usize) -> f64 {
        let n = length as f64;
        match self {
            Self::Step => n.sqrt(),
            Self::Slope => (n * (n + 1.0) * (2.0 * n + 1.0) / 6.0).sqrt(),
        }
    }
}

/// Lengths since a change, turns: all up to 8, and from there on each about 1.2 times the one before.
pub fn lengths(longest: usize) -> Vec<usize> {
    std::iter::successors(Some(1), |length| Some(length + (length / 6).max(1)))
        .take_while(|length| *length <= longest)
        .collect()
}

/// Running sums of readings, and the weighted sums that follow from them.
pub struct Sums {
    shape: Shape,
    plain: Vec<f64>,
    by_turn: Vec<f64>,
}

impl Sums {
    /// Creates the sums before the first reading.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            plain: vec![0.0],
            by_turn: vec![0.0],
        }
    }

    /// Number of readings.
    pub fn turns(&self) -> usize {
        self.plain.len() - 1
    }

    /// Adds a reading.
    pub fn add(&mut self, x: f64) {
        let turn = self.plain.len() as f64;
        self.plain.push(self.plain[self.plain.len() - 1] + x);
        self.by_turn
            .push(self.by_turn[self.by_turn.len() - 1] + turn * x);
    }

    /// Returns the weighted sum of the `length` readings up to `turn`.
    pub fn sum(&self, turn: usize, length: usize) -> f64 {
        let before = turn - length;
        let plain = self.plain[turn] - self.plain[before];
        match self.shape {
            Shape::Step => plain,
            Shape::Slope => self.by_turn[turn] - self.by_turn[before] - before as f64 * plain,
        }
    }
}

fn glr(shape: Shape, threshold: f64) -> Box<dyn FnMut(f64) -> bool> {
    let limits: Vec<_> = lengths(LONGEST)
        .into_iter()
        .map(|length| (length, threshold * SIGMA * shape.norm(length)))
        .collect();
    let mut sums = Sums::new(shape);
    Box::new(move |x| {
        sums.add(x);
        limits
            .iter()
            .take_while(|(length, _)| *length <= sums.turns())
            .any(|&(length, limit)| sums.sum(sums.turns(), length).abs() > limit)
    })
}
