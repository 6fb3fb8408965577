//! A host and a controller with a line between them.

use cophase_link::client::Client;
use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::message::{Message, Refusal, ReplyBody, Request};
use cophase_link::server::Hub;

use super::device::RecordingDevice;

/// Sessions of the controller.
pub const SESSIONS: usize = 2;

pub type TestHub = Hub<RecordingDevice, SESSIONS>;

/// A controller without a host.
pub fn hub() -> TestHub {
    Hub::new(RecordingDevice::new())
}

/// One host at one session of a controller.
pub struct Host {
    pub session: usize,
    pub client: Client,
}

impl Host {
    pub fn new(session: usize) -> Self {
        Self {
            session,
            client: Client::new(),
        }
    }

    /// Makes a request, and passes its reply to `check`.
    pub fn ask<T>(
        &mut self,
        hub: &mut TestHub,
        request: &Request<'_>,
        check: impl FnOnce(Result<ReplyBody<'_>, Refusal>) -> T,
    ) -> T {
        let mut frame = [0; MAX_FRAME_BYTES];
        let (number, length) = self.client.request(request, &mut frame).unwrap();
        hub.receive(self.session, &frame[..length]);
        let mut check = Some(check);
        let mut answer = None;
        self.read(hub, |message| match message {
            Message::Reply { to, body } => {
                assert_eq!(to, number, "a reply to another request");
                let check = check.take().expect("one reply to a request");
                answer = Some(check(body));
            }
            other => assert!(!matches!(other, Message::Reply { .. })),
        });
        answer.expect("every request is answered")
    }

    /// Makes a request that is answered without content.
    pub fn request(&mut self, hub: &mut TestHub, request: &Request<'_>) -> Result<(), Refusal> {
        self.ask(hub, request, |body| {
            body.map(|body| assert_eq!(body, ReplyBody::Done))
        })
    }

    /// Reads all that the controller has sent.
    pub fn read(&mut self, hub: &mut TestHub, mut visit: impl FnMut(Message<'_>)) {
        let mut bytes = [0; 64];
        loop {
            let count = hub.transmit(self.session, &mut bytes);
            if count == 0 {
                return;
            }
            for &byte in &bytes[..count] {
                if let Some(message) = self.client.push(byte) {
                    visit(message);
                }
            }
        }
    }

    /// Reads the counters of damaged and missing frames, with a request that continues the numbers of a session.
    pub fn ask_counters(&mut self, hub: &mut TestHub, mut visit: impl FnMut(u32, u32)) {
        let mut frame = [0; MAX_FRAME_BYTES];
        let (_, length) = self.client.request(&Request::Counters, &mut frame).unwrap();
        hub.receive(self.session, &frame[..length]);
        self.read(hub, |message| {
            if let Message::Reply {
                body: Ok(ReplyBody::Counters(counters)),
                ..
            } = message
            {
                visit(counters.received.bad, counters.received.missing);
            }
        });
    }
}
