//! All browsers, and the one that has control.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::SyncSender;

use serde::Serialize;
use tungstenite::Message;

/// Data of the bench about a browser.
#[derive(Debug)]
pub(super) struct Browser {
    pub(super) id: u32,
    address: SocketAddr,
    queue: SyncSender<Message>,
    /// The place among the pages, free again once the bench has forgotten the browser.
    _slot: Arc<()>,
    /// Numbers of samples and of reports that found no room in the queue.
    pub(super) dropped_samples: u64,
    pub(super) dropped_reports: u64,
}

impl Browser {
    pub(super) fn new(address: SocketAddr, queue: SyncSender<Message>, slot: Arc<()>) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(1);
        Self {
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            address,
            queue,
            _slot: slot,
            dropped_samples: 0,
            dropped_reports: 0,
        }
    }

    /// Returns the name that other browsers show for it.
    pub(super) fn name(&self) -> String {
        format!("browser {} ({})", self.id, self.address)
    }

    pub(super) fn report(&mut self, report: &impl Serialize) {
        if self.queue.try_send(message(report)).is_err() {
            self.dropped_reports += 1;
        }
    }
}

/// Returns a report as a message.
pub(super) fn message(report: &impl Serialize) -> Message {
    // All keys of a report are valid in JSON.
    Message::text(serde_json::to_string(report).unwrap_or_default())
}

#[derive(Debug, Default)]
pub(super) struct Browsers {
    all: Vec<Browser>,
    /// The browser that has control.
    owner: Option<u32>,
}

impl Browsers {
    pub(super) fn join(&mut self, browser: Browser) {
        self.all.push(browser);
    }

    /// Removes a browser, and ends its control. Returns true if it had control.
    pub(super) fn leave(&mut self, id: u32) -> bool {
        self.all.retain(|browser| browser.id != id);
        self.owner.take_if(|owner| *owner == id).is_some()
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Browser> {
        self.all.iter_mut()
    }

    pub(super) fn count(&self) -> usize {
        self.all.len()
    }

    /// Sends a report to all.
    pub(super) fn report(&mut self, report: &impl Serialize) {
        let message = message(report);
        for browser in &mut self.all {
            if browser.queue.try_send(message.clone()).is_err() {
                browser.dropped_reports += 1;
            }
        }
    }

    /// Sends a batch of samples to all browsers, and counts the samples that find no room.
    pub(super) fn samples(&mut self, batch: Vec<u8>, count: u64) {
        let message = Message::binary(batch);
        for browser in &mut self.all {
            if browser.queue.try_send(message.clone()).is_err() {
                browser.dropped_samples += count;
            }
        }
    }

    pub(super) const fn owner(&self) -> Option<u32> {
        self.owner
    }

    pub(super) const fn set_owner(&mut self, owner: Option<u32>) {
        self.owner = owner;
    }

    /// Returns the name of the browser that has control.
    pub(super) fn owner_name(&self) -> Option<String> {
        let owner = self.owner?;
        self.all
            .iter()
            .find(|browser| browser.id == owner)
            .map(Browser::name)
    }

    /// Checks that a browser has control.
    pub(super) fn check_control(&self, id: u32) -> Result<(), String> {
        match self.owner_name() {
            _ if self.owner == Some(id) => Ok(()),
            Some(name) => Err(format!(
                "{name} has control; this page can watch, and stop the machine"
            )),
            None => Err("this page does not have control; take control first".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::sync_channel;

    use super::*;

    /// Messages without room are counted, for the slow browser only.
    #[test]
    fn dropped_samples_and_reports_are_counted_per_browser() {
        let address = SocketAddr::from(([127, 0, 0, 1], 1));
        let (slow, _waits) = sync_channel(1);
        let (fast, waiting) = sync_channel(8);
        let mut browsers = Browsers::default();
        for queue in [slow, fast] {
            browsers.join(Browser::new(address, queue, Arc::default()));
        }
        for count in [10, 20, 30] {
            browsers.samples(vec![0], count);
        }
        browsers.report(&"status");
        let dropped: Vec<_> = browsers
            .iter_mut()
            .map(|browser| (browser.dropped_samples, browser.dropped_reports))
            .collect();
        assert_eq!(dropped, [(50, 1), (0, 0)]);
        assert_eq!(waiting.try_iter().count(), 4);
    }
}
