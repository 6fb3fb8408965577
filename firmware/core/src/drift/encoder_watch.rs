//! One axis's encoder: how far its motor is from where it was told to be, all the time.
//!
//! A crank has inertia: between two ticks its speed changes by little. A reading that jumps by more than that is held back for a
//! tick. If it returns, it was a *glitch*. If it stays, counts were lost, or the crank was moved by a blow: then the jump is
//! *doubted*, and the index tells. If it goes on, the crank is really moving so, as one does that gets stuck at speed.

use super::tick_phase::TickPhase;
use crate::units::Turns;

/// How a motor moves, against what it is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Manner {
    /// About as told.
    #[default]
    Follows,
    /// Not at all.
    Stands,
    /// The other way.
    Backwards,
    /// Faster.
    Ahead,
}

/// What a reading brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Read {
    /// Nothing new.
    Nothing,
    /// The reading jumped, and is back.
    Glitch {
        /// By how much it was off.
        by: Turns,
    },
    /// The reading jumped, and stays.
    Jump {
        /// By how much.
        by: Turns,
    },
}

/// Watches one encoder.
#[derive(Clone, Debug)]
pub(super) struct EncoderWatch {
    /// Turns of a count in the axis's own sense.
    per_count: i64,
    /// What a count is more than that, 16 fraction bits; and what of it is left over.
    rest_a_count: i64,
    rest: i64,
    /// More than this in a tick, against what was told, is no crank's doing.
    jump: Turns,
    last: Option<i32>,
    /// Measured minus commanded turns since the reset; and the same without most of its noise, some ticks later.
    drift: Turns,
    calm: Turns,
    held: Option<Turns>,
    /// It really moves by more than a jump a tick.
    moving: bool,
    /// A jump that the index has to tell of.
    pub(super) doubt: Turns,
    window: Window,
}

/// Over which the manner is judged: some ticks, and some way.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    ticks: u8,
    drift: Turns,
    commanded: Turns,
    manner: Manner,
}

const WINDOW_TICKS: u8 = 4;

/// Each tick's reading counts for this part of the calm drift, as a power of two: 16 ticks take away three quarters of the noise.
const CALM: u32 = 4;

impl EncoderWatch {
    /// Of `counts` to a turn, `reversed` or not; `jump`: see there.
    pub(super) fn new(counts: u32, reversed: bool, jump: Turns) -> Self {
        let counts = i64::from(counts.max(1));
        let sense = if reversed { -1 } else { 1 };
        Self {
            per_count: sense * (crate::units::ONE_TURN / counts),
            rest_a_count: sense * (((crate::units::ONE_TURN % counts) << 16) / counts),
            rest: 0,
            jump,
            last: None,
            drift: Turns::ZERO,
            calm: Turns::ZERO,
            held: None,
            moving: false,
            doubt: Turns::ZERO,
            window: Window::default(),
        }
    }

    /// Forgets what was read: from now on the motor is where it is told to be.
    pub(super) fn reset(&mut self) {
        *self = Self {
            last: None,
            drift: Turns::ZERO,
            calm: Turns::ZERO,
            held: None,
            moving: false,
            doubt: Turns::ZERO,
            window: Window::default(),
            ..*self
        };
    }

    pub(super) const fn drift(&self) -> Turns {
        self.drift
    }

    /// The drift as a mean over the last ticks, some 16.
    pub(super) const fn calm_drift(&self) -> Turns {
        self.calm
    }

    pub(super) const fn manner(&self) -> Manner {
        self.window.manner
    }

    /// Takes in a reading at the end of a tick in which `commanded` was commanded; and the turns that were made.
    pub(super) fn observe(&mut self, count: i32, commanded: &TickPhase) -> (Read, Turns) {
        let before = self.drift;
        let Some(last) = self.last.replace(count) else {
            return (Read::Nothing, commanded.turns);
        };
        // A tick has at most half a turn, and that at most 2^15 counts; what is more is nonsense, and wraps.
        let counts = i64::from(count.wrapping_sub(last));
        let mut made = counts.wrapping_mul(self.per_count);
        // So that a million turns are a million turns, to a millionth of a degree.
        self.rest = self
            .rest
            .wrapping_add(counts.wrapping_mul(self.rest_a_count));
        made = made.wrapping_add(self.rest >> 16);
        self.rest &= 0xFFFF;
        let made = Turns::from_bits(made);
        let off = made.wrapping_sub(commanded.turns);
        let read = self.weigh(off);
        self.judge(commanded.turns);
        let anew = self.drift.wrapping_sub(self.calm);
        self.calm = self
            .calm
            .wrapping_add(Turns::from_bits(anew.to_bits() >> CALM));
        let made = commanded
            .turns
            .wrapping_add(self.drift.wrapping_sub(before));
        (read, made)
    }

    fn weigh(&mut self, off: Turns) -> Read {
        let is_jump = |turns: Turns| turns.wrapping_abs() > self.jump || turns == Turns::MIN;
        if let Some(held) = self.held.take() {
            let both = held.wrapping_add(off);
            if !is_jump(both) {
                self.drift = self.drift.wrapping_add(both);
                return Read::Glitch { by: held };
            }
            if !is_jump(off) {
                self.drift = self.drift.wrapping_add(off);
                self.doubt = self.doubt.wrapping_add(held);
                return Read::Jump { by: held };
            }
            self.moving = true;
            self.drift = self.drift.wrapping_add(both);
            return Read::Nothing;
        }
        if !is_jump(off) {
            self.moving = false;
        } else if !self.moving {
            self.held = Some(off);
            return Read::Nothing;
        }
        self.drift = self.drift.wrapping_add(off);
        Read::Nothing
    }

    fn judge(&mut self, commanded: Turns) {
        let window = &mut self.window;
        window.ticks = window.ticks.saturating_add(1);
        window.commanded = window.commanded.wrapping_add(commanded);
        // Far enough for noise to be little of it.
        if window.ticks < WINDOW_TICKS || window.commanded < self.jump {
            return;
        }
        // Of what was commanded, −2 is backwards and −1 is standing; half way between them is the border.
        let made = self.drift.wrapping_sub(window.drift).to_bits() >> 8;
        let told = window.commanded.to_bits() >> 8;
        let manner = if 2 * made < -3 * told {
            Manner::Backwards
        } else if 4 * made < -3 * told {
            Manner::Stands
        } else if 4 * made > told {
            Manner::Ahead
        } else {
            Manner::Follows
        };
        *window = Window {
            ticks: 0,
            drift: self.drift,
            commanded: Turns::ZERO,
            manner,
        };
    }

    /// Takes in a reading after ticks of which nothing is known: the motor followed.
    pub(super) const fn skip(&mut self, count: i32) {
        self.last = Some(count);
        self.held = None;
    }

    /// The jump that was doubted was real.
    pub(super) fn believe(&mut self) {
        self.drift = self.drift.wrapping_add(self.doubt);
        self.doubt = Turns::ZERO;
    }
}
