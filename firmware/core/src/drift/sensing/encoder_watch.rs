//! One axis's encoder: how far its motor is from where commanded, all the time.
//!
//! A crank has inertia: between two ticks its speed changes by little. A reading that jumps by more than that is held back for a
//! tick. If it returns, it was a *glitch*. If it stays, counts were lost, or the crank was moved by a blow: then the jump is
//! *unconfirmed*, and the index shows. If it goes on, the crank is really moving so, as one does that gets stuck at speed.

use super::tick_phase::TickPhase;
use crate::units::Turns;

/// Motion of a motor compared with its command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::drift) enum Tracking {
    /// About as commanded.
    #[default]
    Ok,
    /// Hardly, or the other way: [`EncoderWatch::has_gone_back`] decides which.
    Stalled,
    /// Faster.
    Overspeed,
}

/// What a reading brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::drift) enum Read {
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
pub(in crate::drift) struct EncoderWatch {
    /// Turns of a count in the axis's own sense.
    per_count: i64,
    /// What a count is more than that, 16 fraction bits; and what of it is left over.
    rest_a_count: i64,
    rest: i64,
    /// More than this in a tick, against the command, is no crank's doing.
    jump: Turns,
    last: Option<i32>,
    /// Measured minus commanded turns since the reset; and the same without most of its noise, some ticks later.
    phase_error: Turns,
    filtered: Turns,
    /// Sum of phase error times share of a turn: the mean error, once the shares add up to a turn.
    mean: Turns,
    held: Option<Turns>,
    /// It really moves by more than a jump a tick.
    moving: bool,
    /// Turns made, as read, since the motor was last about where commanded, or moved about as commanded.
    made_since: Turns,
    /// Sum of the jumps that the index has to confirm; about zero if the reading came back.
    pub(in crate::drift) unconfirmed_jump: Option<Turns>,
    window: Window,
}

/// Window over which the tracking is judged: some ticks, and some travel.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    ticks: u8,
    phase_error: Turns,
    commanded: Turns,
    tracking: Tracking,
}

const WINDOW_TICKS: u8 = 4;

/// Weight of each tick's reading in the filtered error, as a power of two: 16 ticks take away three quarters of the noise.
const FILTER_SHIFT: u32 = 4;

impl EncoderWatch {
    /// Of `counts` to a turn, `reversed` or not; `jump`: see there.
    pub(in crate::drift) fn new(counts: u32, reversed: bool, jump: Turns) -> Self {
        let counts = i64::from(counts.max(1));
        let sense = if reversed { -1 } else { 1 };
        Self {
            per_count: sense * (crate::units::ONE_TURN / counts),
            rest_a_count: sense * (((crate::units::ONE_TURN % counts) << 16) / counts),
            rest: 0,
            jump,
            last: None,
            phase_error: Turns::ZERO,
            filtered: Turns::ZERO,
            mean: Turns::ZERO,
            held: None,
            moving: false,
            made_since: Turns::ZERO,
            unconfirmed_jump: None,
            window: Window::default(),
        }
    }

    /// Forgets what was read: from now on the motor is where commanded.
    pub(in crate::drift) fn reset(&mut self) {
        *self = Self {
            last: None,
            phase_error: Turns::ZERO,
            filtered: Turns::ZERO,
            mean: Turns::ZERO,
            held: None,
            moving: false,
            made_since: Turns::ZERO,
            unconfirmed_jump: None,
            window: Window::default(),
            ..*self
        };
    }

    pub(in crate::drift) const fn phase_error(&self) -> Turns {
        self.phase_error
    }

    /// Adds the present phase error over a share of a turn, up to ½, to the mean. Its error is below a millionth of the errors.
    pub(in crate::drift) const fn average(&mut self, share: Turns) {
        let (error, share) = (self.phase_error.to_bits() >> 16, share.to_bits() >> 16);
        let part = Turns::from_bits(error.wrapping_mul(share) >> 16);
        self.mean = self.mean.wrapping_add(part);
    }

    /// Begins a new mean.
    pub(in crate::drift) const fn restart_average(&mut self) {
        self.mean = Turns::ZERO;
    }

    /// Mean of the phase error over the turn that was averaged.
    pub(in crate::drift) const fn mean_error(&self) -> Turns {
        self.mean
    }

    /// The drift as a mean over the last ticks, some 16.
    pub(in crate::drift) const fn filtered_error(&self) -> Turns {
        self.filtered
    }

    pub(in crate::drift) const fn tracking(&self) -> Tracking {
        self.window.tracking
    }

    /// True if a motor that stalled has gone back: by over a quarter of its phase error, or by over `most`. A motor that stood for a
    /// time and is let go may spring back by less.
    pub(in crate::drift) fn has_gone_back(&self, most: Turns) -> bool {
        let back = self.made_since.wrapping_neg();
        let behind = self.phase_error.wrapping_neg();
        // Far enough for noise to be little of it.
        let is_sure = behind > 0 && back > self.about();
        is_sure && (back > Turns::from_bits(behind.to_bits() >> 2) || back > most)
    }

    /// Phase error of a motor that is about where commanded.
    fn about(&self) -> Turns {
        Turns::from_bits(self.jump.to_bits() >> 1)
    }

    /// Takes in a reading at the end of a tick in which `commanded` was commanded; and the turns that were made.
    pub(in crate::drift) fn observe(&mut self, count: i32, commanded: &TickPhase) -> (Read, Turns) {
        let before = self.phase_error;
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
        let read = self.classify(off);
        self.made_since = if self.phase_error.wrapping_abs() <= self.about() {
            Turns::ZERO
        } else {
            self.made_since.saturating_add(made)
        };
        self.judge(commanded.turns);
        let anew = self.phase_error.wrapping_sub(self.filtered);
        self.filtered = self
            .filtered
            .wrapping_add(Turns::from_bits(anew.to_bits() >> FILTER_SHIFT));
        let made = commanded
            .turns
            .wrapping_add(self.phase_error.wrapping_sub(before));
        (read, made)
    }

    fn classify(&mut self, off: Turns) -> Read {
        let is_jump = |turns: Turns| turns.wrapping_abs() > self.jump || turns == Turns::MIN;
        if let Some(held) = self.held.take() {
            let both = held.wrapping_add(off);
            if !is_jump(both) {
                self.phase_error = self.phase_error.wrapping_add(both);
                return Read::Glitch { by: held };
            }
            if !is_jump(off) {
                self.phase_error = self.phase_error.wrapping_add(off);
                let before = self.unconfirmed_jump.unwrap_or_default();
                self.unconfirmed_jump = Some(before.wrapping_add(held));
                return Read::Jump { by: held };
            }
            self.moving = true;
            self.phase_error = self.phase_error.wrapping_add(both);
            return Read::Nothing;
        }
        if !is_jump(off) {
            self.moving = false;
        } else if !self.moving {
            self.held = Some(off);
            return Read::Nothing;
        }
        self.phase_error = self.phase_error.wrapping_add(off);
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
        // Of what was commanded, −1 is standing, and less is backwards.
        let made = self.phase_error.wrapping_sub(window.phase_error).to_bits() >> 8;
        let commanded_turns = window.commanded.to_bits() >> 8;
        let tracking = if 4 * made < -3 * commanded_turns {
            Tracking::Stalled
        } else if 4 * made > commanded_turns {
            Tracking::Overspeed
        } else {
            self.made_since = Turns::ZERO;
            Tracking::Ok
        };
        *window = Window {
            ticks: 0,
            phase_error: self.phase_error,
            commanded: Turns::ZERO,
            tracking,
        };
    }

    /// Takes in a reading after ticks of which nothing is known: the motor followed.
    pub(in crate::drift) const fn skip(&mut self, count: i32) {
        self.last = Some(count);
        self.held = None;
    }

    /// The jump that was unconfirmed was real.
    pub(in crate::drift) fn believe(&mut self) {
        let jump = self.unconfirmed_jump.take().unwrap_or_default();
        self.phase_error = self.phase_error.wrapping_add(jump);
    }
}
