//! Loss of the host that started the machine.

use cophase_core::settings::HostLossReaction;
use cophase_core::supervisor::{Command, State};

use super::access::has_come;
use super::{Device, Hub};

/// Time of the last frame from the host that has control, during a motion that a host started.
#[derive(Debug)]
pub(super) struct HostWatch {
    last_ms: Option<u32>,
}

impl HostWatch {
    pub(super) const fn new() -> Self {
        Self { last_ms: None }
    }

    /// A host starts a motion.
    pub(super) const fn begins(&mut self, now_ms: u32) {
        self.last_ms = Some(now_ms);
    }

    /// A frame of the host that has control arrived.
    pub(super) const fn is_there(&mut self, now_ms: u32) {
        if self.last_ms.is_some() {
            self.last_ms = Some(now_ms);
        }
    }

    /// The machine entered a state; once it rests, the motion is over.
    pub(super) fn entered(&mut self, state: State) {
        if [State::Idle, State::Parked, State::Fault].contains(&state) {
            self.last_ms = None;
        }
    }
}

impl<D: Device, const SESSIONS: usize> Hub<D, SESSIONS> {
    /// Stops the machine if the settings require it and the host is lost.
    pub(super) fn react_to_host_loss(&mut self, now_ms: u32) {
        let settings = self.device.host_loss();
        let Some(last_ms) = self.host.last_ms.filter(|_| settings.timeout_s > 0.0) else {
            return;
        };
        let timeout_ms = (settings.timeout_s * 1000.0) as u32;
        if !has_come(last_ms.wrapping_add(timeout_ms), now_ms) {
            return;
        }
        let command = match settings.reaction {
            HostLossReaction::Stop => Command::Stop,
            HostLossReaction::StopNow => Command::StopNow,
        };
        // If the queue is full, the next round tries again.
        if self.device.command(command) {
            self.host.last_ms = None;
        }
    }
}
