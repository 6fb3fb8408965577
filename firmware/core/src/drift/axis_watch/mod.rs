//! One axis of the monitor: its index sensor, its encoder, and the events of its crank.

mod gate;
mod sorting;
mod tracking;

pub use gate::place_gate;
use gate::{cycle, gate, slow, tolerance};
pub(super) use sorting::Report;

use super::detection::angles::{angle, of_angle};
use super::diagnosis::events::Diagnosis;
use super::sensing::encoder_watch::{EncoderWatch, Read};
use super::sensing::index_filter::BRIDGE_WIDTHS;
use super::sensing::index_watch::{Detection, IndexWatch, Place};
use super::sensing::tick_phase::{IndexPulse, TickClock, TickPhase};
use crate::settings::{AxisSettings, Settings, turns};
use crate::supervisor::FaultKind;
use crate::units::{Phase, Turns, nearest};

/// Time at which a phase error is measured, on an axis whose encoder shows it all the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measured {
    /// In this tick, with the noise of a reading.
    Now,
    /// Mean over the last ticks.
    Lately,
    /// At the last passage of the flag, where loads are alike in each turn. Without an index sensor, the same as `Lately`.
    AtFlag,
    /// Mean over a turn.
    OverTurn,
}

/// Motion of a crank on its shaft or away from its command, angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Since the last round.
    pub jump: i32,
    /// Since the offset from which drift is counted.
    pub walk: i32,
}

/// Monitor of one axis.
#[derive(Clone, Debug)]
pub(super) struct AxisWatch {
    /// True if it has an index sensor.
    pub(super) has_index: bool,
    /// Watch of that sensor. Without a sensor, pulses are ignored, and the offset stays zero.
    pub(super) index: IndexWatch,
    pub(super) encoder: Option<EncoderWatch>,
    /// Turns that an encoder measured in the tick before the one that is over; none if they are not known.
    before: Option<Turns>,
    /// Phase error of the motor at the last detection of the index.
    at_flag: Turns,
    /// A crank that is further than this angle from its last place has moved.
    gate: u32,
    /// Offset in the last round, and the offset from which drift is counted: angles.
    last: i32,
    home: i32,
    pub(super) diagnosis: Diagnosis,
}

impl AxisWatch {
    #[cold]
    pub(super) fn new(
        axis: &AxisSettings,
        settings: &Settings,
        reading: Turns,
        alone: Turns,
    ) -> Self {
        let tolerance = tolerance(axis, reading);
        let cycle = cycle(axis);
        let gate = gate(tolerance, cycle);
        let tick_hz = settings.tick_hz;
        let ticks = |time_s: f64| time_s * f64::from(tick_hz) * 65_536.0;
        // Time from a pulse's edge until the filter reports it: the bridged widths, and one width.
        let filter_s = settings.index.width_us * 1e-6 * f64::from(BRIDGE_WIDTHS + 1);
        let place = Place {
            index: turns(axis.index_turns.unwrap_or_default()),
            flag: turns(axis.index_width_turns),
            delay: libm::round(ticks(axis.index_delay_s)) as u32,
            covered: libm::floor(65_536.0 - ticks(axis.index_delay_s + filter_s)) as i32,
            slow: slow(tolerance, tick_hz),
            gate,
            tolerance,
            alone,
            is_cycle_too_far: cycle > 0 && alone < cycle.saturating_sub(tolerance),
            has_encoder: axis.encoder,
        };
        let jump = Turns::from_bits(tolerance.to_bits() * 4);
        let encoder = axis
            .encoder
            .then(|| EncoderWatch::new(axis.steps_per_turn, axis.reversed, jump));
        Self {
            has_index: axis.index_turns.is_some(),
            index: IndexWatch::new(place, Phase::ZERO),
            encoder,
            before: None,
            at_flag: Turns::ZERO,
            gate: angle(gate).unsigned_abs(),
            last: 0,
            home: 0,
            diagnosis: Diagnosis::new(cycle, tolerance),
        }
    }

    /// Processes a tick without a pulse of an axis by index.
    #[inline(never)] // It is rare, and a loop over all axes needs the registers.
    pub(super) fn check_timeout(&mut self, commanded: &TickPhase, is_homing: bool) -> Detection {
        let turns = commanded.turns;
        self.index.check_timeout(commanded, turns, is_homing)
    }

    /// Processes a tick of an axis with an encoder.
    #[inline(never)]
    pub(super) fn observe(
        &mut self,
        pulse: Option<&IndexPulse>,
        count: i32,
        commanded: &TickPhase,
        is_homing: bool,
        clock: TickClock,
    ) -> (Detection, Read) {
        let Some(encoder) = &mut self.encoder else {
            return (Detection::Nothing, Read::Nothing);
        };
        // The phase of the motor, not of its command.
        let start = commanded.start.advanced(encoder.phase_error);
        let (read, turns) = encoder.observe(count, commanded);
        let before = self.before.replace(turns);
        if !self.has_index {
            return (Detection::Nothing, read);
        }
        let index = &mut self.index;
        let measured = TickPhase { start, turns };
        // Noise may turn a motor back for a tick. The commanded sense decides which end of the flag it meets.
        let commanded_turns = commanded.turns;
        let detection = match pulse {
            Some(&pulse) => index.detect(pulse, &measured, commanded_turns, before, clock),
            None => index.check_timeout(&measured, commanded_turns, is_homing),
        };
        if let Read::Jump { .. } = read {
            // A jump is reported a tick later.
            let before = before.unwrap_or_default();
            index.decide_within_a_turn_of(start.advanced(before.wrapping_neg()));
        }
        (detection, read)
    }

    pub(super) fn disregard(&mut self, pulse: bool, count: i32, mut start: Phase) {
        if let Some(encoder) = &mut self.encoder {
            encoder.skip(count);
            start = start.advanced(encoder.phase_error);
            self.before = None;
        }
        if pulse && self.has_index {
            self.index.disregard(start);
        }
    }

    /// Compares an axis without an encoder with the `common` motion, and begins a new round.
    pub(super) fn compare(&mut self, common: Motion) {
        let own = self.motion();
        let own_jump = own.jump.wrapping_sub(common.jump);
        let own_walk = own.walk.wrapping_sub(common.walk);
        self.last = angle(self.index.offset);
        if own_jump.unsigned_abs() > self.gate {
            self.home = self.home.wrapping_add(own_jump);
            self.jump(of_angle(own_jump));
        } else if own_walk.unsigned_abs() > self.gate {
            self.home = self.last.wrapping_sub(common.walk);
            self.diagnosis.drift(of_angle(own_walk));
        }
    }

    /// Records that the crank jumped; returns the name.
    pub(super) fn jump(&mut self, by: Turns) -> FaultKind {
        let is_ahead = self.phase_error() > 0;
        self.diagnosis.jump(by, is_ahead)
    }

    /// Motion of the crank.
    pub(super) fn motion(&self) -> Motion {
        let now = angle(self.index.offset);
        Motion {
            jump: now.wrapping_sub(self.last),
            walk: now.wrapping_sub(self.home),
        }
    }

    /// True if the crank moved by more than a gate from the `common` motion.
    pub(super) fn moves_from(&self, common: Motion) -> bool {
        let own = self.motion();
        own.jump.wrapping_sub(common.jump).unsigned_abs() > self.gate
            || own.walk.wrapping_sub(common.walk).unsigned_abs() > self.gate
    }

    /// Measured minus commanded, turns, −½ to ½.
    #[inline(never)]
    pub(super) fn error(&self, measured: Measured) -> Turns {
        let Some(encoder) = &self.encoder else {
            return self.index.offset;
        };
        let own = match measured {
            Measured::Now => encoder.phase_error,
            Measured::AtFlag if self.has_index => self.at_flag,
            Measured::Lately | Measured::AtFlag => encoder.filtered,
            Measured::OverTurn => encoder.mean,
        };
        nearest(self.index.offset.wrapping_add(own))
    }

    /// The same, from the latest reading.
    pub(super) fn phase_error(&self) -> Turns {
        self.error(Measured::Now)
    }

    /// True if the axis has an index sensor and no encoder.
    pub(super) const fn is_by_index(&self) -> bool {
        self.has_index && self.encoder.is_none()
    }

    /// Largest phase error of a crank that only swings. A rotor that is half an electrical cycle from its field does not come back.
    pub(super) fn swing(&self) -> Turns {
        let half_cycle = Turns::from_bits(self.diagnosis.cycle.to_bits() / 2);
        of_angle(self.gate as i32).max(half_cycle)
    }

    /// True if an axis without an encoder made no pulse in its place up to the end of a tick, or has no index sensor.
    pub(super) fn is_late(&self, commanded: &TickPhase) -> bool {
        let is_late =
            || self.index.is_late() || self.index.has_timed_out(commanded, commanded.turns);
        self.encoder.is_none() && (!self.has_index || is_late())
    }

    #[inline(never)] // long, and runs only once per start
    pub(super) fn reset(&mut self, phase: Phase) {
        self.index.reset(phase);
        if let Some(encoder) = &mut self.encoder {
            encoder.reset();
        }
        self.diagnosis.clear();
    }

    pub(super) fn settle(&mut self) {
        self.last = angle(self.index.offset);
        self.home = self.last;
        self.diagnosis.clear();
    }

    pub(super) fn shift(&mut self, by: Turns) {
        if self.has_index {
            self.index.shift(by);
        }
        self.last = self.last.wrapping_add(angle(by));
        self.home = self.home.wrapping_add(angle(by));
    }
}
