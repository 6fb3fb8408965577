//! Stops that other threads request of a connection.
//!
//! A stop passes no queue. The thread of the connection looks for one before each read, also while it waits for the reply to another
//! request. Any number of requests together are one stop: the number of the last one, and the stronger kind.

use std::sync::{Mutex, MutexGuard, PoisonError};

use cophase_link::message::StopKind;

#[derive(Debug, Default)]
pub(crate) struct Stops(Mutex<Inner>);

#[derive(Debug, Default)]
struct Inner {
    /// Number of stops that were requested so far.
    requested: u64,
    /// Kind of those that were not sent yet.
    due: Option<StopKind>,
    /// Number of the last one that has its outcome, and the outcome.
    ended: u64,
    error: Option<String>,
}

impl Stops {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        // Each change is a single assignment, so that a thread that panicked left a valid state.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests a stop. Returns its number.
    pub(crate) fn request(&self, kind: StopKind) -> u64 {
        let mut inner = self.lock();
        inner.requested += 1;
        inner.due = stronger(inner.due, Some(kind));
        inner.requested
    }

    /// Returns the number of stops that were requested so far.
    pub(crate) fn requested(&self) -> u64 {
        self.lock().requested
    }

    /// Returns the outcome of a stop, once there is one.
    pub(crate) fn outcome(&self, number: u64) -> Option<Result<(), String>> {
        let inner = self.lock();
        (inner.ended >= number).then(|| inner.error.clone().map_or(Ok(()), Err))
    }

    /// Takes the stops that are due, if they are stronger than the one under way.
    pub(super) fn take(&self, sent: Option<StopKind>) -> Option<(u64, StopKind)> {
        let mut inner = self.lock();
        let is_stronger = inner.due.is_some() && stronger(sent, inner.due) != sent;
        let kind = inner.due.take_if(|_| is_stronger)?;
        Some((inner.requested, kind))
    }

    /// Makes a stop due again, because its line was opened again.
    pub(super) fn put_back(&self, kind: StopKind) {
        let mut inner = self.lock();
        inner.due = stronger(inner.due, Some(kind));
    }

    /// Ends all stops up to a number.
    pub(super) fn end(&self, number: u64, outcome: Result<(), String>) {
        let mut inner = self.lock();
        inner.ended = number;
        inner.error = outcome.err();
    }

    /// Ends all stops so far with an error, because nothing can be sent.
    pub(crate) fn fail(&self, error: &str) {
        let mut inner = self.lock();
        if inner.ended < inner.requested {
            inner.due = None;
            inner.ended = inner.requested;
            inner.error = Some(error.to_owned());
        }
    }
}

fn stronger(a: Option<StopKind>, b: Option<StopKind>) -> Option<StopKind> {
    match (a, b) {
        (Some(StopKind::Now), _) | (_, Some(StopKind::Now)) => Some(StopKind::Now),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_of_several_threads_are_sent_as_one_of_the_stronger_kind() {
        let stops = Stops::default();
        let first = stops.request(StopKind::AtPhase);
        let second = stops.request(StopKind::Now);
        assert_eq!(stops.take(None), Some((second, StopKind::Now)));
        assert_eq!(stops.outcome(first), None);
        stops.end(second, Ok(()));
        assert_eq!(stops.outcome(first), Some(Ok(())));
        assert_eq!(stops.take(None), None);
    }

    #[test]
    fn only_a_stronger_stop_overtakes_the_one_that_was_sent() {
        let stops = Stops::default();
        stops.request(StopKind::AtPhase);
        assert_eq!(stops.take(Some(StopKind::AtPhase)), None);
        let now = stops.request(StopKind::Now);
        assert_eq!(
            stops.take(Some(StopKind::AtPhase)),
            Some((now, StopKind::Now))
        );
    }

    #[test]
    fn a_lost_line_ends_a_stop_with_its_reason_and_sends_it_no_more() {
        let stops = Stops::default();
        let stop = stops.request(StopKind::Now);
        stops.fail("lost");
        assert_eq!(stops.outcome(stop), Some(Err("lost".to_owned())));
        assert_eq!(stops.take(None), None);
    }
}
