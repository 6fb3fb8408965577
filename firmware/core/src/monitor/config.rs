//! Configuration of the monitor: what follows from the settings, and no tick changes.

use core::hash::{Hash, Hasher};

use super::angles::{Angle, exceeds};
use super::filter::BRIDGE_WIDTHS;
use super::limits::DriftLimits;
use super::modes::Mount;
use crate::commanded::TickClock;
use crate::settings::{AxisSettings, Settings, turns};
use crate::units::{AxisSet, Turns};

/// Configuration of the monitor.
#[derive(Clone, Debug)]
pub(crate) struct Config {
    pub limits: DriftLimits,
    pub mount: Mount,
    /// Axes with an index sensor and no encoder, and axes with an encoder.
    pub by_index: AxisSet,
    pub by_encoder: AxisSet,
    pub(super) clock: TickClock,
}

impl Config {
    /// Configuration of a monitor without axes.
    pub(super) const NONE: Self = Self {
        limits: DriftLimits::NONE,
        mount: Mount::NONE,
        by_index: 0,
        by_encoder: 0,
        clock: TickClock::new(62_500),
    };

    /// Configures in place from checked settings.
    #[cold]
    pub(super) fn set(&mut self, settings: &Settings) {
        let set = |has: &dyn Fn(&AxisSettings) -> bool| {
            let axes = settings.axes.iter().enumerate();
            axes.fold(0, |set, (i, axis)| set | u8::from(has(axis)) << i)
        };
        let by_index = set(&|axis| axis.index_turns.is_some());
        self.by_encoder = set(&|axis| axis.encoder);
        self.by_index = by_index & !self.by_encoder;
        self.limits = DriftLimits::new(&settings.drift, &settings.machine, settings.tick_hz);
        self.mount = Mount::with(settings.axes.len(), by_index | self.by_encoder);
        self.clock = TickClock::new(settings.tick_cycles());
    }

    /// Hashes what is common to all axes.
    #[inline(always)]
    pub fn hash_common(&self, hasher: &mut impl Hasher) {
        let Self {
            limits: _,
            mount,
            by_index,
            by_encoder,
            clock,
        } = self;
        (by_index, by_encoder, mount.detected(), clock).hash(hasher);
    }
}

/// The sensors of one axis, and the widths by which their readings are classified.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisConfig {
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
    /// Largest error of a reading.
    pub tolerance: Turns,
    /// A pulse further than this from its place is out of place, and a crank has moved.
    pub gate: Turns,
    /// An electrical cycle; zero of an axis that has none.
    pub cycle: Turns,
    /// Phase error with which this crank alone exceeds a limit.
    pub single_axis_limit: Turns,
}

impl AxisConfig {
    #[cold]
    pub fn new(
        axis: &AxisSettings,
        settings: &Settings,
        reading: Turns,
        single_axis_limit: Turns,
    ) -> Self {
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
            single_axis_limit,
        }
    }

    /// Hashes one of three slices.
    #[inline(always)]
    pub fn hash_slice(&self, slice: usize, hasher: &mut impl Hasher) {
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
            single_axis_limit,
        } = self;
        match slice {
            0 => (has_index, has_encoder, delay, covered, index).hash(hasher),
            1 => (slow, tolerance, gate).hash(hasher),
            _ => (flag, cycle, single_axis_limit).hash(hasher),
        }
    }

    /// True if the axis has an index sensor and no encoder.
    pub const fn is_by_index(&self) -> bool {
        self.has_index && !self.has_encoder
    }

    /// Delay of a pulse beyond which the crank of an axis with an encoder has passed its flag without one.
    pub fn overdue(&self) -> Turns {
        self.single_axis_limit.max(self.gate)
    }

    /// Deviation of an encoder from its command in one tick that is larger than any crank can make.
    pub const fn jump(&self) -> Turns {
        Turns::from_bits(self.tolerance.to_bits() * 4)
    }

    /// Largest phase error of a crank that only swings. A rotor that is half an electrical cycle from its field does not come back.
    pub fn swing(&self) -> Turns {
        self.gate.max(Turns::from_bits(self.cycle.to_bits() / 2))
    }

    /// Largest change of a mean phase error that is no step of a drift.
    pub const fn drift_step(&self) -> Turns {
        Turns::from_bits(self.tolerance.to_bits() / 2)
    }

    /// True if an angle is wider than the gate.
    pub fn is_beyond_gate(&self, angle: Angle) -> bool {
        exceeds(angle, self.gate)
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
    let max = if sure < differ {
        half.max(differ)
    } else {
        sure
    };
    widest.min(Turns::from_bits(max))
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
