//! Cross-coupling of servos: an axis that is held up is waited for by the others.
//!
//! Each servo's position setpoint is moved against what its crank is off from the mean of all, in proportion and integrated. The
//! one that lags is told to go on, the others are told to hold back, by as much in all: the sum of what is added is zero, so
//! that mode 0, which the program decides, is not touched. All other modes are fed back with the same gains.

use crate::settings::Settings;
use crate::units::Turns;

/// The coupling of `N` servos.
#[derive(Clone, Debug)]
pub struct Coupling<const N: usize> {
    /// Gains: in proportion, and of the integral a tick; 16 and 24 fraction bits.
    gain: i64,
    gain_a_tick: i64,
    integral: [i64; N],
    added: [Turns; N],
    change: [Turns; N],
    limit: i64,
}

impl<const N: usize> Coupling<N> {
    /// Of settings that have been checked; none if they ask for none.
    pub fn new(settings: &Settings<N>) -> Option<Self> {
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
            integral: [0; N],
            added: [Turns::ZERO; N],
            change: [Turns::ZERO; N],
            limit,
        })
    }

    /// Takes in the drifts at a tick's end.
    #[inline(never)] // of boards without servos it is not to be in the way
    pub fn advance(&mut self, drift: &[Turns; N]) {
        // Below half a turn each: 31 bits, and room for gains of up to 20 and a sum of six.
        let drift = drift.map(|e| e.to_bits() >> 16);
        // 1/N with 28 bits: what the mean is off, 2⁻²⁸ of it, is the last axis's.
        let share = const { (1 << 28) / N as i64 };
        let mean = (drift.iter().sum::<i64>() * share) >> 28;
        let mut integral = self.integral;
        let mut added = self.added;
        let (mut rest, mut rest_integral) = (0, 0);
        for axis in 0..N {
            let (of_integral, all) = if axis + 1 < N {
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
            self.change = [Turns::ZERO; N];
        }
    }

    /// Lets go: the drives are off.
    pub fn reset(&mut self) {
        self.integral = [0; N];
        self.added = [Turns::ZERO; N];
        self.change = [Turns::ZERO; N];
    }

    /// What is added to an axis's position and to its speed.
    pub fn of(&self, axis: usize) -> (Turns, Turns) {
        let at = |turns: &[Turns; N]| turns.get(axis).copied().unwrap_or_default();
        (at(&self.added), at(&self.change))
    }
}
