//! Traits of an axis: the place of its index sensor, and the widths by which readings are classified. They follow from the settings. Only
//! the place of the sensor moves, as homing moves the common zero.

use core::hash::{Hash, Hasher};

use crate::drift::detection::angles::angle as to_angle;
use crate::drift::sensing::index_filter::BRIDGE_WIDTHS;
use crate::settings::{AxisSettings, Settings, turns};
use crate::units::{Phase, Turns};

/// Traits of an axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::drift) struct Traits {
    pub has_index: bool,
    pub has_encoder: bool,
    /// Phase at which the flag of its index sensor begins, going forward.
    pub index: Turns,
    /// The flag's length.
    pub flag: Turns,
    /// Ticks by which the sensor's line is late, 16 fraction bits.
    pub delay: u32,
    /// Part of a tick whose pulses have been reported by its end, 16 fraction bits. It is less than one because of the delay of the line
    /// and its filter, and negative if they take longer than a tick.
    pub covered: i32,
    /// Commanded turns per tick up to which a swinging rotor may go back.
    pub slow: Turns,
    /// Largest error of a reading, and difference of two readings of a crank that has not moved.
    pub tolerance: Turns,
    /// A pulse further than this from its place is out of place, and a crank has moved.
    pub gate: Turns,
    /// An electrical cycle; zero of an axis that has none.
    pub cycle: Turns,
    /// Phase error with which this crank alone exceeds a limit.
    pub alone: Turns,
}

impl Traits {
    #[cold]
    pub fn new(axis: &AxisSettings, settings: &Settings, reading: Turns, alone: Turns) -> Self {
        let tolerance = tolerance(axis, reading);
        let cycle = cycle(axis);
        let tick_hz = settings.tick_hz;
        let ticks = |time_s: f64| time_s * f64::from(tick_hz) * 65_536.0;
        // Time from a pulse's edge until the filter reports it: the bridged widths, and one width.
        let filter_s = settings.index.width_us * 1e-6 * f64::from(BRIDGE_WIDTHS + 1);
        Self {
            has_index: axis.index_turns.is_some(),
            has_encoder: axis.encoder,
            index: turns(axis.index_turns.unwrap_or_default()),
            flag: turns(axis.index_width_turns),
            delay: libm::round(ticks(axis.index_delay_s)) as u32,
            covered: libm::floor(65_536.0 - ticks(axis.index_delay_s + filter_s)) as i32,
            slow: slow(tolerance, tick_hz),
            tolerance,
            gate: gate(tolerance, cycle),
            cycle,
            alone,
        }
    }

    /// Hashes one of four slices of the traits. Homing moves the place of the sensor and the home offset by as much in opposite senses, so
    /// their sum within a turn never changes.
    #[inline(always)]
    pub fn hash_slice(&self, slice: usize, home_offset: Turns, hasher: &mut impl Hasher) {
        let Self {
            has_index,
            has_encoder,
            index,
            flag,
            delay,
            covered,
            slow,
            tolerance,
            gate,
            cycle,
            alone,
        } = self;
        match slice {
            0 => (has_index, has_encoder, delay, covered).hash(hasher),
            1 => (slow, tolerance, gate).hash(hasher),
            2 => {
                let place = index.wrapping_add(home_offset);
                if *has_index {
                    Phase::from_turns(place).within_turn().hash(hasher);
                }
                alone.hash(hasher);
            }
            _ => (flag, cycle).hash(hasher),
        }
    }

    /// Delay of a pulse beyond which the crank may exceed its limit.
    pub fn overdue(&self, is_homing: bool) -> Turns {
        // A pulse that is late by a gate may show a lost cycle. If that exceeds a limit, it may have done so for a turn.
        let is_cycle_too_far =
            self.cycle > 0 && self.alone < self.cycle.saturating_sub(self.tolerance);
        if is_cycle_too_far && !is_homing {
            self.gate
        } else {
            self.alone.max(self.gate)
        }
    }

    /// Deviation of an encoder from its command in one tick that is larger than any crank can make.
    pub fn jump(&self) -> Turns {
        Turns::from_bits(self.tolerance.to_bits() * 4)
    }

    /// Largest phase error of a crank that only swings. A rotor that is half an electrical cycle from its field does not come back.
    pub fn swing(&self) -> Turns {
        self.gate.max(Turns::from_bits(self.cycle.to_bits() / 2))
    }

    /// Largest change of a mean phase error that is no step of a drift, an angle.
    pub fn drift_step(&self) -> u32 {
        to_angle(self.tolerance).unsigned_abs() / 2
    }

    /// True if an angle is wider than the gate.
    pub fn is_beyond_gate(&self, angle: i32) -> bool {
        angle.unsigned_abs() > to_angle(self.gate).unsigned_abs()
    }
}

/// Largest error of a reading of an axis: that of the settings, and two steps.
fn tolerance(axis: &AxisSettings, reading: Turns) -> Turns {
    let step = turns(axis.steps_per_crank_turn().turns_of(1.0));
    reading.saturating_add(step).saturating_add(step)
}

/// An electrical cycle, turns; zero of an axis that has none.
fn cycle(axis: &AxisSettings) -> Turns {
    turns(axis.cycle_turns())
}

/// Gate: half an electrical cycle less the error of a reading, but at least the largest difference of two readings.
fn gate(tolerance: Turns, cycle: Turns) -> Turns {
    let widest = Turns::from_bits(tolerance.to_bits() * 4);
    if cycle <= 0 {
        return widest;
    }
    let (half, tolerance) = (cycle.to_bits() / 2, tolerance.to_bits());
    // If steps are so coarse that this is below the largest difference of two readings, the gate is half a cycle. Behind a gear, a cycle
    // may be too short to be distinguished from that difference at all.
    let (sure, differ) = (half - tolerance, 2 * tolerance);
    let most = if sure < differ {
        half.max(differ)
    } else {
        sure
    };
    widest.min(Turns::from_bits(most))
}

/// Greatest speed, in tolerances per second, of a rotor that swings by one tolerance at 16 Hz: 2π · 16. Motors with their loads swing at
/// this rate or above.
const SWING_PER_S: f64 = 100.0;

/// Commanded turns of a tick up to which a swinging rotor may go back.
fn slow(tolerance: Turns, tick_hz: u32) -> Turns {
    turns(tolerance.to_num::<f64>() * SWING_PER_S / f64::from(tick_hz))
}

/// Largest distance, turns, of an axis's index pulse from the place that the pulse before gives, at which it is still in place.
/// `reading_error_deg` is that of the settings.
#[cold]
pub fn place_gate(axis: &AxisSettings, reading_error_deg: f64) -> Turns {
    gate(
        tolerance(axis, turns(reading_error_deg / 360.0)),
        cycle(axis),
    )
}
