//! Bring-up: an output that is held for a check of its wiring.

use cophase_core::supervisor::State;

use super::access::has_come;
use super::{Device, Hub};
use crate::message::{Output, Refusal};

/// Time for which one request holds an output, ms. A host repeats it, so that a lost host releases the output.
pub const OUTPUT_MS: u32 = 1000;

/// Output that is held, if there is one.
#[derive(Debug)]
pub(super) struct HeldOutput {
    until_ms: Option<u32>,
}

impl HeldOutput {
    pub(super) const fn new() -> Self {
        Self { until_ms: None }
    }
}

impl<D: Device, const SESSIONS: usize> Hub<D, SESSIONS> {
    pub(super) fn hold_output(&mut self, output: Output, is_active: bool) -> Result<(), Refusal> {
        self.device
            .hold_output(Some((output, is_active)))
            .map_err(Refusal::Rejected)?;
        self.held.until_ms = Some(self.device.now_ms().wrapping_add(OUTPUT_MS));
        Ok(())
    }

    /// Releases an output when its time is over, when bring-up is locked, or when the machine leaves idle.
    pub(super) fn release_output(&mut self, now_ms: u32) {
        let Some(until_ms) = self.held.until_ms else {
            return;
        };
        let state = self.latest.situation().state;
        if has_come(until_ms, now_ms) || !self.access.is_unlocked() || state != State::Idle {
            self.release_held();
        }
    }

    /// Releases an output that is held.
    pub(super) fn release_held(&mut self) {
        if self.held.until_ms.take().is_some() {
            // An output can always be released.
            let _ = self.device.hold_output(None);
        }
    }
}
