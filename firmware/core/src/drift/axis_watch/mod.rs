//! One axis of the monitor: its index sensor, its encoder, and the events of its crank.

mod sorting;
mod steady_drift;
mod tracking;
mod traits;

pub(super) use sorting::Report;
use steady_drift::SteadyDrift;
pub(super) use traits::Traits;
pub use traits::place_gate;

use core::hash::{Hash, Hasher};

use super::detection::angles::{angle, of_angle};
use super::diagnosis::events::Diagnosis;
use super::sensing::encoder_watch::{CountScale, EncoderWatch, Read};
use super::sensing::index_watch::{Detection, IndexWatch};
use super::sensing::tick_phase::{IndexPulse, TickClock, TickPhase};
use crate::servo::{ServoPart, servo_part};
use crate::settings::AxisSettings;
use crate::supervisor::FaultKind;
use crate::units::{Phase, Turns, nearest};

/// Time at which a phase error is measured, on an axis whose encoder shows it all the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// In this tick, with the noise of a reading.
    Now,
    /// Filtered over the last ticks: with less noise, and delayed by some ticks.
    Lately,
    /// At the last passage of the flag, where loads are alike in each turn, to be compared with that of a turn ago. Without an index
    /// sensor, the same as `Lately`.
    AtFlag,
    /// Mean over a turn. A load acts on a crank differently at each angle, so a mean over less would depend on where it began.
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
    pub(super) traits: Traits,
    /// Watch of the index sensor. Without a sensor, pulses are ignored, and the offset stays zero.
    pub(super) index: IndexWatch,
    pub(super) encoder: Option<ServoPart<EncoderWatch>>,
    /// Offset in the last round, and the offset from which drift is counted: angles.
    last: i32,
    home: i32,
    pub(super) diagnosis: Diagnosis,
    pub(super) steady_drift: SteadyDrift,
}

impl AxisWatch {
    #[cold]
    pub(super) fn new(axis: &AxisSettings, traits: Traits) -> Self {
        let encoder = axis
            .encoder
            .then(|| CountScale::new(axis.steps_per_crank_turn(), axis.reversed))
            .map(EncoderWatch::new);
        Self {
            traits,
            index: IndexWatch::new(&traits, Phase::ZERO),
            encoder: servo_part(encoder),
            last: 0,
            home: 0,
            diagnosis: Diagnosis::new(),
            steady_drift: SteadyDrift::default(),
        }
    }

    /// Hashes one of four slices of what no tick changes.
    #[inline(always)]
    pub(super) fn hash_slice(&self, slice: usize, home_offset: Turns, hasher: &mut impl Hasher) {
        let Self {
            traits,
            index: _,
            encoder,
            last: _,
            home: _,
            diagnosis: _,
            steady_drift: _,
        } = self;
        if slice == 3 {
            // An option of the constants would be none as well if a flipped bit makes an encoder of memory without one.
            encoder.is_some().hash(hasher);
            if let Some(encoder) = encoder {
                encoder.constants().hash(hasher);
            }
        }
        traits.hash_slice(slice, home_offset, hasher);
    }

    /// Processes a tick of an axis with an encoder.
    #[inline(never)]
    pub(super) fn observe(
        &mut self,
        pulse: Option<IndexPulse>,
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
        let before = encoder.made;
        let (read, turns) = encoder.observe(count, commanded, self.traits.jump());
        let Self { traits, index, .. } = self;
        if !traits.has_index {
            return (Detection::Nothing, read);
        }
        let measured = TickPhase { start, turns };
        // Noise may turn a motor back for a tick. The commanded sense decides which end of the flag it meets.
        let commanded_turns = commanded.turns;
        let detection = match pulse {
            Some(pulse) => index.detect(traits, pulse, &measured, commanded_turns, before, clock),
            None => index.check_timeout(traits, &measured, commanded_turns, is_homing),
        };
        if let Read::Jump { .. } = read {
            // A jump is reported a tick later.
            let before = before.unwrap_or_default();
            index.decide_within_a_turn_of(traits, start.advanced(before.wrapping_neg()));
        }
        (detection, read)
    }

    pub(super) fn disregard(&mut self, pulse: bool, count: i32, mut start: Phase) {
        if let Some(encoder) = &mut self.encoder {
            encoder.skip(count);
            start = start.advanced(encoder.phase_error);
        }
        if pulse && self.traits.has_index {
            self.index.disregard(start);
        }
    }

    /// Compares an axis without an encoder with the `common` motion, and begins a new round.
    pub(super) fn compare(&mut self, common: Motion) {
        let own = self.motion();
        let own_jump = own.jump.wrapping_sub(common.jump);
        let own_walk = own.walk.wrapping_sub(common.walk);
        self.last = angle(self.index.offset);
        if self.traits.is_beyond_gate(own_jump) {
            self.home = self.home.wrapping_add(own_jump);
            self.jump(of_angle(own_jump));
        } else {
            self.walk(own_walk);
        }
    }

    /// Records how far the crank is from where steady motion is counted, an angle, once a turn.
    fn walk(&mut self, walk: i32) {
        self.steady_drift.add(walk, self.traits.drift_step());
        if self.traits.is_beyond_gate(walk) {
            self.home = self.home.wrapping_add(walk);
            self.steady_drift.shift(walk);
            self.diagnosis.drift(of_angle(walk));
        }
    }

    /// Records that the crank jumped; returns the name.
    pub(super) fn jump(&mut self, by: Turns) -> FaultKind {
        let is_ahead = self.phase_error() > 0;
        self.diagnosis.jump(&self.traits, by, is_ahead)
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
        let is_beyond_gate =
            |own: i32, common| self.traits.is_beyond_gate(own.wrapping_sub(common));
        is_beyond_gate(own.jump, common.jump) || is_beyond_gate(own.walk, common.walk)
    }

    /// Measured minus commanded, turns, −½ to ½.
    #[inline(never)]
    pub(super) fn error(&self, measured: Measured) -> Turns {
        let Some(encoder) = &self.encoder else {
            return self.index.offset;
        };
        let own = match measured {
            Measured::Now => encoder.phase_error,
            Measured::AtFlag if self.traits.has_index => encoder.at_flag,
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
        self.traits.has_index && self.encoder.is_none()
    }

    /// True if an axis without an encoder made no pulse in its place up to the end of a tick, or has no index sensor.
    pub(super) fn is_late(&self, commanded: &TickPhase) -> bool {
        let is_late = || {
            self.index.is_late()
                || self
                    .index
                    .has_timed_out(&self.traits, commanded, commanded.turns)
        };
        self.encoder.is_none() && (!self.traits.has_index || is_late())
    }

    #[inline(never)] // long, and runs only once per start
    pub(super) fn reset(&mut self, phase: Phase) {
        self.index = IndexWatch::new(&self.traits, phase);
        if let Some(encoder) = &mut self.encoder {
            encoder.reset();
        }
        self.diagnosis = Diagnosis::new();
    }

    pub(super) fn settle(&mut self) {
        self.last = angle(self.index.offset);
        self.home = self.last;
        self.diagnosis = Diagnosis::new();
        self.steady_drift = SteadyDrift::default();
    }

    pub(super) fn shift(&mut self, by: Turns) {
        if self.traits.has_index {
            self.traits.index = self.traits.index.wrapping_add(by);
            self.index.shift(by);
        }
        self.last = self.last.wrapping_add(angle(by));
        self.home = self.home.wrapping_add(angle(by));
    }
}
