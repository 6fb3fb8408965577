//! Cross-coupling of servos: the other axes wait for one that is held up.
//!
//! The position setpoint of each servo is moved against the deviation of its crank from the mean of all cranks, by a
//! proportional and an integral part. The lagging servo is advanced and the others are held back. The sum of all
//! additions is zero, so that mode 0, which follows the program, does not change. All other modes are fed back with the
//! same gains.

use core::hash::Hash;

use crate::settings::Settings;
use crate::units::{MAX_AXES, PerAxis, Turns};

/// Cross-coupling of all servos.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// Proportional gain (16 fraction bits), and integral gain per tick (24 fraction bits).
    gain: i64,
    gain_a_tick: i64,
    integral: PerAxis<i64>,
    added: PerAxis<Turns>,
    change: PerAxis<Turns>,
    limit: i64,
    count: usize,
    /// Reciprocal of the number of axes, 28 fraction bits. The last axis takes the rounding of the mean, 2⁻²⁸ of it.
    share: i64,
}

impl Coupling {
    /// Creates the coupling of checked settings; none if both gains are zero.
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

    /// Constants, which no tick changes.
    pub(crate) fn constants(&self) -> impl Hash + use<> {
        let Self {
            gain,
            gain_a_tick,
            integral: _,
            added: _,
            change: _,
            limit,
            count,
            share,
        } = *self;
        (gain, gain_a_tick, limit, count, share)
    }

    /// Updates the coupling with the phase errors at the end of a tick.
    #[inline(never)] // Inlined, it would cost time on boards without servos.
    pub fn advance(&mut self, phase_error: &PerAxis<Turns>) {
        // Each error is below half a turn: 31 bits, which leaves room for gains of up to 20 and a sum of six.
        let phase_error = phase_error.map(|e| e.to_bits() >> 16);
        let mean = (phase_error.iter().sum::<i64>() * self.share) >> 28;
        let mut integral = self.integral;
        let mut added = self.added;
        let (mut rest, mut rest_integral) = (0, 0);
        for axis in 0..self.count.min(MAX_AXES) {
            let (of_integral, all) = if axis + 1 < self.count {
                let off = phase_error[axis] - mean;
                let of_integral = integral[axis] - ((off * self.gain_a_tick) >> 8);
                (of_integral, of_integral - off * self.gain)
            } else {
                (-rest_integral, -rest) // The last axis takes the remainder of rounding.
            };
            rest_integral += of_integral;
            rest += all;
            integral[axis] = of_integral;
            added[axis] = Turns::from_bits(all);
        }
        // A change that would exceed an axis's limit is not made: all axes keep their values, and the sum stays zero.
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

    /// Resets the coupling when the drives are off.
    pub fn reset(&mut self) {
        self.integral = [0; MAX_AXES];
        self.added = [Turns::ZERO; MAX_AXES];
        self.change = [Turns::ZERO; MAX_AXES];
    }

    /// Additions to the position and to the speed of an axis.
    pub fn of(&self, axis: usize) -> (Turns, Turns) {
        let at = |turns: &PerAxis<Turns>| turns.get(axis).copied().unwrap_or_default();
        (at(&self.added), at(&self.change))
    }
}
