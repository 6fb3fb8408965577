//! Access: which session has control, and whether it may start a motion or bring the machine up.

use crate::message::{Control, Refusal};
use crate::sample::Sample;

/// Time for which a machine stays armed, seconds.
pub const ARMED_S: u32 = 30;

/// Time for which bring-up stays unlocked, seconds.
pub const UNLOCKED_S: u32 = 600;

#[derive(Clone, Debug)]
pub(super) struct Access {
    owner: Option<usize>,
    /// Time at which the permission ends, ms.
    armed_until_ms: Option<u32>,
    /// Time at which bring-up is locked, ms.
    unlocked_until_ms: Option<u32>,
}

impl Access {
    pub(super) const fn new() -> Self {
        Self {
            owner: None,
            armed_until_ms: None,
            unlocked_until_ms: None,
        }
    }

    pub(super) fn take(&mut self, session: usize, by_force: bool) -> Result<(), Refusal> {
        if self.owner.is_some_and(|owner| owner != session) {
            if !by_force {
                return Err(Refusal::ControlTaken);
            }
            self.revoke();
        }
        self.owner = Some(session);
        Ok(())
    }

    pub(super) fn release(&mut self, session: usize) {
        if self.owner == Some(session) {
            self.owner = None;
            self.revoke();
        }
    }

    /// Ends the permissions of the session that has control.
    const fn revoke(&mut self) {
        self.disarm();
        self.unlocked_until_ms = None;
    }

    pub(super) fn has_control(&self, session: usize) -> bool {
        self.owner == Some(session)
    }

    pub(super) fn unlock(&mut self, session: usize, now_ms: u32) -> Result<(), Refusal> {
        self.check_control(session)?;
        self.unlocked_until_ms = Some(now_ms.wrapping_add(1000 * UNLOCKED_S));
        Ok(())
    }

    pub(super) const fn is_unlocked(&self) -> bool {
        self.unlocked_until_ms.is_some()
    }

    pub(super) fn check_unlocked(&self, session: usize) -> Result<(), Refusal> {
        self.check_control(session)?;
        if self.is_unlocked() {
            Ok(())
        } else {
            Err(Refusal::Locked)
        }
    }

    pub(super) const fn disarm(&mut self) {
        self.armed_until_ms = None;
    }

    pub(super) fn control(&self, session: usize) -> Control {
        match self.owner {
            None => Control::Free,
            Some(owner) if owner == session => Control::You,
            Some(_) => Control::Other,
        }
    }

    pub(super) fn check_control(&self, session: usize) -> Result<(), Refusal> {
        match self.control(session) {
            Control::You => Ok(()),
            Control::Other => Err(Refusal::ControlTaken),
            Control::Free => Err(Refusal::NoControl),
        }
    }

    pub(super) fn arm(&mut self, session: usize, now_ms: u32) -> Result<(), Refusal> {
        self.check_control(session)?;
        self.armed_until_ms = Some(now_ms.wrapping_add(1000 * ARMED_S));
        Ok(())
    }

    pub(super) const fn is_armed(&self) -> bool {
        self.armed_until_ms.is_some()
    }

    /// Checks that a session may start a motion. One arm allows one motion: [`Self::disarm`] follows a motion that starts.
    pub(super) fn check_armed(&self, session: usize) -> Result<(), Refusal> {
        self.check_control(session)?;
        if self.is_armed() {
            Ok(())
        } else {
            Err(Refusal::NotArmed)
        }
    }

    /// A permission ends with its time. The permission to move also ends when an input forbids motion.
    pub(super) fn expire(&mut self, now_ms: u32, sample: &Sample) {
        let is_over = |until: u32| has_come(until, now_ms);
        let inputs = sample.situation().inputs;
        if self.armed_until_ms.is_some_and(is_over) || !inputs.enable || inputs.stop {
            self.disarm();
        }
        if self.unlocked_until_ms.is_some_and(is_over) {
            self.unlocked_until_ms = None;
        }
    }
}

/// True if a time of the wrapping clock is not in the future.
pub(super) const fn has_come(time_ms: u32, now_ms: u32) -> bool {
    time_ms.wrapping_sub(now_ms).cast_signed() <= 0
}
