//! Encoder of one axis: the phase error of its motor in every tick.
//!
//! A crank has inertia, so its speed changes little between two ticks. A reading that jumps by more is held back for a tick. If it comes
//! back, it was a *glitch*. If it stays, either counts were lost or a blow moved the crank: the jump is *unconfirmed* until the index
//! decides. If it keeps jumping, the crank really moves like this, for example because it got stuck at speed. If a deviation grows tick by
//! tick instead, the crank swings.

use core::hash::Hash;

use super::config::AxisConfig;
use super::counts::Counts;
use crate::commanded::TickPhase;
use crate::units::{Phase, Turns};

/// Motion of a motor compared with its command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tracking {
    /// About as commanded.
    #[default]
    Ok,
    /// It stands, or turns back: [`Encoder::has_gone_back`] decides which.
    Stalled,
    /// Faster than commanded.
    Overspeed,
}

/// Result of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Read {
    /// Nothing new.
    Nothing,
    /// The reading jumped, and came back.
    Glitch {
        /// Size of the jump.
        by: Turns,
    },
    /// The reading jumped, and did not come back.
    Jump {
        /// Size of the jump.
        by: Turns,
    },
}

/// Watches one encoder.
#[derive(Clone, Debug)]
pub(super) struct Encoder {
    counts: Counts,
    /// Measured minus commanded turns since the reset, and its filtered value.
    pub(super) phase_error: Turns,
    pub(super) filtered: Turns,
    /// The filtered phase error as the crank passed its flag last.
    pub(super) at_flag: Turns,
    deviation: Deviation,
    /// Measured turns in the tick that was read last; none if they are not known.
    pub(super) last_turns: Option<Turns>,
    /// Travel back from the furthest point ahead since the motor was last about where commanded, or moved about as commanded. A rotor that is
    /// turned back may swing ahead first.
    back: Turns,
    pub(super) unconfirmed: Option<Unconfirmed>,
    /// Ticks of the window for tracking, which has some ticks and some travel.
    ticks: u8,
    /// Phase error at the beginning of the window.
    error_before: Turns,
    /// Turns that were commanded in the window.
    commanded: Turns,
    /// Result of the last window.
    pub(super) tracking: Tracking,
}

/// Jumps that the index has to confirm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unconfirmed {
    /// Their sum; about zero if the reading came back.
    by: Turns,
    /// Phase of the axis before the last of them.
    pub(super) at: Phase,
}

/// Deviation of a motor from its command in the tick before.
#[derive(Clone, Copy, Debug)]
enum Deviation {
    /// It was this, and less than a jump.
    Small(Turns),
    /// The reading jumped by this distance. The next reading shows why.
    Held(Turns),
    /// The motor moves by more than a jump per tick.
    Large,
}

impl Default for Deviation {
    fn default() -> Self {
        Self::Small(Turns::ZERO)
    }
}

const WINDOW_TICKS: u8 = 4;

/// Weight of a reading in the filtered error, as a negative power of two. A first-order low pass of weight 1/16 leaves √(1/31) of white
/// noise: 18 %.
const FILTER_SHIFT: u32 = 4;

impl Encoder {
    /// Constants, which no tick changes.
    pub(super) fn constants(&self) -> impl Hash + use<> {
        self.counts.constants()
    }

    /// Watch that has no reading yet. The phase error is zero.
    pub(super) const fn new(counts: Counts) -> Self {
        Self {
            counts,
            phase_error: Turns::ZERO,
            filtered: Turns::ZERO,
            at_flag: Turns::ZERO,
            deviation: Deviation::Small(Turns::ZERO),
            last_turns: None,
            back: Turns::ZERO,
            unconfirmed: None,
            ticks: 0,
            error_before: Turns::ZERO,
            commanded: Turns::ZERO,
            tracking: Tracking::Ok,
        }
    }

    /// Discards all readings. The phase error is zero from now on.
    pub(super) fn reset(&mut self) {
        self.counts.forget();
        *self = Self::new(self.counts);
    }

    /// True if a motor that stalled has gone back: by over a quarter of its phase error, or by more than a motor that was blocked for a
    /// time. When that is released, it may spring back, and swing once to either side.
    pub(super) fn has_gone_back(&self, config: &AxisConfig) -> bool {
        let behind = self.phase_error.wrapping_neg();
        let max = config.swing().saturating_add(config.swing());
        // The travel must be large against the noise.
        let is_sure = behind > 0 && self.back > about(config.jump());
        is_sure && (self.back > Turns::from_bits(behind.to_bits() >> 2) || self.back > max)
    }

    /// Processes a reading at the end of a tick. A deviation from the command by more than `jump` in a tick is held back. Returns the
    /// result, and the measured turns of the tick.
    pub(super) fn observe(
        &mut self,
        count: i32,
        commanded: &TickPhase,
        jump: Turns,
    ) -> (Read, Turns) {
        let before = self.phase_error;
        let Some(made) = self.counts.travel(count) else {
            self.last_turns = Some(commanded.turns);
            return (Read::Nothing, commanded.turns);
        };
        let off = made.wrapping_sub(commanded.turns);
        let read = self.classify(off, jump);
        if let Read::Jump { by } = read {
            // A jump is reported a tick later.
            let at = commanded
                .start
                .advanced(before.wrapping_sub(self.last_turns.unwrap_or_default()));
            let so_far = self.unconfirmed.map_or(Turns::ZERO, |jumps| jumps.by);
            let by = so_far.wrapping_add(by);
            self.unconfirmed = Some(Unconfirmed { by, at });
        }
        self.back = if self.phase_error.wrapping_abs() <= about(jump) {
            Turns::ZERO
        } else {
            self.back.saturating_sub(made).max(Turns::ZERO)
        };
        self.judge(commanded.turns, jump);
        let anew = self.phase_error.wrapping_sub(self.filtered);
        self.filtered = self
            .filtered
            .wrapping_add(Turns::from_bits(anew.to_bits() >> FILTER_SHIFT));
        let made = commanded
            .turns
            .wrapping_add(self.phase_error.wrapping_sub(before));
        self.last_turns = Some(made);
        (read, made)
    }

    fn classify(&mut self, off: Turns, jump: Turns) -> Read {
        let is_jump = |turns: Turns| turns.wrapping_abs() > jump || turns == Turns::MIN;
        if let Deviation::Held(held) = self.deviation {
            self.deviation = Deviation::default();
            let both = held.wrapping_add(off);
            if !is_jump(both) {
                self.phase_error = self.phase_error.wrapping_add(both);
                return Read::Glitch { by: held };
            }
            if !is_jump(off) {
                self.phase_error = self.phase_error.wrapping_add(off);
                return Read::Jump { by: held };
            }
            self.deviation = Deviation::Large;
            self.phase_error = self.phase_error.wrapping_add(both);
            return Read::Nothing;
        }
        self.deviation = match self.deviation {
            _ if !is_jump(off) => Deviation::Small(off),
            Deviation::Small(before) if is_jump(off.wrapping_sub(before)) => {
                self.deviation = Deviation::Held(off);
                return Read::Nothing;
            }
            _ => Deviation::Large,
        };
        self.phase_error = self.phase_error.wrapping_add(off);
        Read::Nothing
    }

    fn judge(&mut self, commanded: Turns, jump: Turns) {
        self.ticks = self.ticks.saturating_add(1);
        self.commanded = self.commanded.wrapping_add(commanded);
        // The travel must be large against the noise.
        if self.ticks < WINDOW_TICKS || self.commanded < jump {
            return;
        }
        // In units of the commanded turns: −1 is standing, less is backwards.
        let made = self.phase_error.wrapping_sub(self.error_before).to_bits() >> 8;
        let commanded = self.commanded.to_bits() >> 8;
        self.tracking = if 4 * made < -3 * commanded {
            Tracking::Stalled
        } else if 4 * made > commanded {
            Tracking::Overspeed
        } else {
            self.back = Turns::ZERO;
            Tracking::Ok
        };
        self.ticks = 0;
        self.error_before = self.phase_error;
        self.commanded = Turns::ZERO;
    }

    /// Processes a reading after ticks whose phase is not known. It assumes that the motor followed its command.
    pub(super) fn skip(&mut self, count: i32) {
        self.counts.travel(count);
        self.last_turns = None;
        if let Deviation::Held(_) = self.deviation {
            self.deviation = Deviation::default();
        }
    }

    /// Takes the sum of the jumps that the index has not confirmed, if there are any.
    pub(super) fn take_unconfirmed(&mut self) -> Option<Turns> {
        self.unconfirmed.take().map(|jumps| jumps.by)
    }

    /// Adds the unconfirmed jump to the phase error.
    pub(super) fn accept(&mut self) {
        let jump = self.take_unconfirmed().unwrap_or_default();
        self.phase_error = self.phase_error.wrapping_add(jump);
    }
}

/// Largest phase error of a motor that is about where commanded.
fn about(jump: Turns) -> Turns {
    Turns::from_bits(jump.to_bits() >> 1)
}
