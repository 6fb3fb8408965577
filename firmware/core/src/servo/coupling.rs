//! Cross-coupling of servos: an axis that is held up is waited for by the others.
//!
//! Each servo's position setpoint is moved against what its crank is off from the mean of all, in proportion and integrated. The
//! one that lags is told to go on, the others are told to hold back, by as much in all: the sum of what is added is zero, so
//! that mode 0, which the program decides, is not touched. All other modes are fed back with the same gains.

use crate::settings::Settings;
use crate::units::{MAX_AXES, PerAxis, Turns};

/// The coupling of all servos.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// Gains: in proportion, and of the integral a tick; 16 and 24 fraction bits.
    gain: i64,
    gain_a_tick: i64,
    integral: PerAxis<i64>,
    added: PerAxis<Turns>,
    change: PerAxis<Turns>,
    limit: i64,
    count: usize,
    /// One over the number of axes, 28 fraction bits: what the mean is off, 2⁻²⁸ of it, is the last axis's.
    share: i64,
}

impl Coupling {
    /// Of settings that have been checked; none if they ask for none.
    #[cold]
    pub fn new(settings: &Settings) -> Option<Self> {
        let correction = &settings.correction;
        if correction.coupling == 0.0 && correction.coupling_per_s == 0.0 {
            return None;
        }
        let limits = settings.axes.iter().map(|axis| axis.trim_limit_turns);
        let limit = crate::settings::turns_at_most(limits.fold(0.5, f64::min));
        let a_tick = correction.coupling_per_s / f64::from(settings.tick_hz);
        Some(Self {
            gain: libm::round(correction.coupling * 65_536.0) as i64,
            gain_a_tick: libm::round(a_tick * f64::from(1 << 24)) as i64,
            integral: [0; MAX_AXES],
            added: [Turns::ZERO; MAX_AXES],
            change: [Turns::ZERO; MAX_AXES],
            limit,
            count: settings.axes.len(),
            share: (1 << 28) / settings.axes.len() as i64,
        })
    }

    /// Takes in the drifts at a tick's end.
    #[inline(never)] // of boards without servos it is not to be in the way
    pub fn advance(&mut self, drift: &PerAxis<Turns>) {
        // Below half a turn each: 31 bits, and room for gains of up to 20 and a sum of six.
        let drift = drift.map(|e| e.to_bits() >> 16);
        let mean = (drift.iter().sum::<i64>() * self.share) >> 28;
        let mut integral = self.integral;
        let mut added = self.added;
        let (mut rest, mut rest_integral) = (0, 0);
        for axis in 0..self.count.min(MAX_AXES) {
            let (of_integral, all) = if axis + 1 < self.count {
                let off = drift[axis] - mean;
                let of_integral = integral[axis] - ((off * self.gain_a_tick) >> 8);
                (of_integral, of_integral - off * self.gain)
            } else {
                (-rest_integral, -rest) // whatever rounding has left over
            };
            rest_integral += of_integral;
            rest += all;
            integral[axis] = of_integral;
            added[axis] = Turns::from_bits(all);
        }
        // What would take an axis past its limit is not begun: all stay where they are, and their sum zero.
        if integral.iter().all(|integral| integral.abs() <= self.limit) {
            self.integral = integral;
        }
        if added
            .iter()
            .all(|added| added.to_bits().abs() <= self.limit)
        {
            for ((change, &to), &from) in self.change.iter_mut().zip(&added).zip(&self.added) {
                *change = to.wrapping_sub(from);
            }
            self.added = added;
        } else {
            self.change = [Turns::ZERO; MAX_AXES];
        }
    }

    /// Lets go: the drives are off.
    pub fn reset(&mut self) {
        self.integral = [0; MAX_AXES];
        self.added = [Turns::ZERO; MAX_AXES];
        self.change = [Turns::ZERO; MAX_AXES];
    }

    /// What is added to an axis's position and to its speed.
    pub fn of(&self, axis: usize) -> (Turns, Turns) {
        let at = |turns: &PerAxis<Turns>| turns.get(axis).copied().unwrap_or_default();
        (at(&self.added), at(&self.change))
    }
}
