//! Arbitrary bytes and arbitrary messages at both ends of the host link. `COPHASE_FUZZ_FRAMES` says how many frames each
//! decoder gets; without it there are few:
//!
//!     COPHASE_FUZZ_FRAMES=10000000 cargo test -p cophase-fuzz --test link -- --nocapture

#[path = "../../../firmware/link/tests/support/device.rs"]
mod device;

use std::sync::Mutex;

use cophase_link::client::Client;
use cophase_link::frame::{self, MAX_FRAME_BYTES, MAX_PAYLOAD_BYTES, Receiver};
use cophase_link::message::Message;
use cophase_link::sample::unpack;
use cophase_link::server::Hub;
use device::RecordingDevice;

fn frames() -> usize {
    let requested = std::env::var("COPHASE_FUZZ_FRAMES").ok();
    requested.map_or(200_000, |requested| {
        requested.parse().expect("a number of frames")
    })
}

/// A server that all cases share. Each case begins in the state after the previous case.
fn hub() -> Mutex<Hub<RecordingDevice, 1>> {
    Mutex::new(Hub::new(RecordingDevice::new()))
}

/// Makes a frame of arbitrary bytes, with the right CRC.
fn framed(payload: &[u8]) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME_BYTES];
    let length = frame::encode(0, &mut buffer, |room| {
        room.get_mut(..payload.len())?.copy_from_slice(payload);
        Some(payload.len())
    });
    buffer[..length.expect("the payload is short")].to_vec()
}

/// If this fails, bytes of noise have an effect, and a bad cable could start a machine.
#[test]
fn noise_has_no_effect_on_a_controller() {
    let hub = hub();
    bolero::check!()
        .with_iterations(frames())
        .with_max_len(64)
        .for_each(|bytes: &[u8]| {
            let mut hub = hub.lock().expect("no case left it locked");
            hub.receive(0, bytes);
            hub.receive(0, &[0]);
            assert!(hub.device().effects.is_empty());
            assert_eq!(hub.transmit(0, &mut [0; 64]), 0, "noise was answered");
        });
}

/// An intact frame may have any payload. The server must answer it, and must not panic.
#[test]
fn any_payload_is_answered() {
    let hub = hub();
    bolero::check!()
        .with_iterations(frames())
        .with_max_len(MAX_PAYLOAD_BYTES)
        .for_each(|payload: &[u8]| {
            let mut hub = hub.lock().expect("no case left it locked");
            hub.receive(0, &framed(payload));
            let mut bytes = [0; 2048];
            assert!(hub.transmit(0, &mut bytes) > 0, "no answer");
            while hub.transmit(0, &mut bytes) > 0 {}
            hub.device().effects.clear();
        });
}

/// The host's decoders: of frames, messages and packets of samples.
#[test]
fn any_bytes_are_decoded_or_refused_by_the_host() {
    bolero::check!()
        .with_iterations(frames())
        .with_max_len(64)
        .for_each(|bytes: &[u8]| {
            let mut client = Client::new();
            for &byte in framed(bytes).iter().chain(bytes) {
                if let Some(Message::Samples {
                    tick,
                    every,
                    channels,
                    packet,
                    ..
                }) = client.push(byte)
                {
                    unpack(tick, every, channels, device::AXES, packet).for_each(drop);
                }
            }
        });
}

/// If this fails, a damaged frame is taken for an intact one. The CRC finds one to three changed bytes, because they lie
/// within 32 bits or are few.
#[test]
fn damaged_frames_are_detected() {
    bolero::check!()
        .with_iterations(frames())
        .with_max_len(64)
        .for_each(|bytes: &[u8]| {
            let Some((&[place, change], payload)) = bytes.split_first_chunk::<2>() else {
                return;
            };
            let mut frame = framed(payload);
            let place = usize::from(place) % (frame.len() - 1);
            let changed = frame[place] ^ change.max(1);
            if changed == 0 {
                return; // A zero ends a frame: this is a cut frame, which another test covers.
            }
            frame[place] = changed;
            let mut receiver = Receiver::new();
            let is_intact = frame.iter().any(|&byte| receiver.push(byte).is_some());
            assert!(!is_intact, "byte {place} was changed");
        });
}
