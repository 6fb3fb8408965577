//! Access: which session has control, and whether it may start a motion.

use crate::message::{Control, Refusal};
use crate::sample::{Sample, flags};

/// Time for which a machine stays armed, seconds.
pub const ARMED_S: u32 = 30;

#[derive(Clone, Debug)]
pub(super) struct Access {
    owner: Option<usize>,
    /// Time at which the permission ends, ms.
    armed_until_ms: Option<u32>,
}

impl Access {
    pub(super) const fn new() -> Self {
        Self {
            owner: None,
            armed_until_ms: None,
        }
    }

    pub(super) fn take(&mut self, session: usize, by_force: bool) -> Result<(), Refusal> {
        if self.owner.is_some_and(|owner| owner != session) {
            if !by_force {
                return Err(Refusal::ControlTaken);
            }
            self.disarm();
        }
        self.owner = Some(session);
        Ok(())
    }

    pub(super) fn release(&mut self, session: usize) {
        if self.owner == Some(session) {
            self.owner = None;
            self.disarm();
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

    pub(super) fn arm(
        &mut self,
        session: usize,
        now_ms: u32,
        sample: &Sample,
    ) -> Result<(), Refusal> {
        self.check_control(session)?;
        check_inputs(sample)?;
        self.armed_until_ms = Some(now_ms.wrapping_add(1000 * ARMED_S));
        Ok(())
    }

    pub(super) const fn is_armed(&self) -> bool {
        self.armed_until_ms.is_some()
    }

    /// Checks that a session may start a motion. One arm allows one motion: [`Self::disarm`] follows a motion that starts.
    pub(super) fn check_armed(&self, session: usize, sample: &Sample) -> Result<(), Refusal> {
        self.check_control(session)?;
        check_inputs(sample)?;
        if self.is_armed() {
            Ok(())
        } else {
            Err(Refusal::NotArmed)
        }
    }

    /// The permission ends with its time, and when an input forbids motion.
    pub(super) fn expire(&mut self, now_ms: u32, sample: &Sample) {
        let is_over = |until: u32| until.wrapping_sub(now_ms).cast_signed() <= 0;
        if self.armed_until_ms.is_some_and(is_over) || check_inputs(sample).is_err() {
            self.disarm();
        }
    }
}

fn check_inputs(sample: &Sample) -> Result<(), Refusal> {
    if sample.flags & flags::ENABLE == 0 {
        Err(Refusal::EnableOpen)
    } else if sample.flags & flags::STOP != 0 {
        Err(Refusal::StopActive)
    } else {
        Ok(())
    }
}
