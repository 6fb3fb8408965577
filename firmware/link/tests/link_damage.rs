//! Damage on the line: it has no effect, and is counted.

use crate::support::device::Effect;
use crate::support::line::{Host, hub};
use cophase_link::client::Client;
use cophase_link::frame::{MAX_FRAME_BYTES, MAX_PAYLOAD_BYTES};
use cophase_link::message::{ControlRequest, File, Request, VERSION};

/// Frames of a session that loads a program, arms and starts, as bytes.
fn session() -> (Client, Vec<u8>) {
    let mut client = Client::new();
    let program: Vec<u8> = (0..=255).collect();
    let crc = cophase_link::checksum(&program);
    let requests = [
        Request::Identify { version: VERSION },
        Request::Control(ControlRequest::Take),
        Request::BeginWrite {
            file: File::Program,
            length: 256,
            crc,
        },
        Request::Write {
            offset: 0,
            bytes: &program,
        },
        Request::FinishWrite,
        Request::Arm,
        Request::Start,
    ];
    let mut all = Vec::new();
    for request in &requests {
        let mut frame = [0; MAX_FRAME_BYTES];
        let (_, length) = client.request(request, &mut frame).unwrap();
        all.extend(&frame[..length]);
    }
    (client, all)
}

/// Plays bytes to a controller; returns its effects, and the damaged and missing frames that it counted.
fn play(client: &Client, bytes: &[u8]) -> (Vec<Effect>, u32) {
    let mut hub = hub();
    hub.receive(0, bytes);
    let mut host = Host::new(0);
    host.read(&mut hub, |_| {});
    host.client = client.clone();
    // A frame whose end was damaged includes the next one. A zero ends it.
    hub.receive(0, &[0]);
    let mut damaged = 0;
    host.ask_counters(&mut hub, |bad, missing| damaged = bad + missing);
    (std::mem::take(&mut hub.device().effects), damaged)
}

/// If this fails, a bit that flips on the line becomes another request, or is not counted.
#[test]
fn every_flipped_bit_of_a_session_is_detected_and_counted() {
    let (client, bytes) = session();
    let (whole, none) = play(&client, &bytes);
    assert_eq!((whole.len(), none), (2, 0));
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let (effects, counted) = play(&client, &flipped);
        assert!(counted > 0, "bit {bit} is not counted");
        let is_part = effects.iter().all(|effect| whole.contains(effect));
        assert!(is_part, "bit {bit}: {effects:?}");
    }
    println!("{} bits", 8 * bytes.len());
}

/// A frame of any length with the right CRC, as any sender can make it.
fn frame_of(payload: &[u8]) -> Vec<u8> {
    let mut plain = vec![0, 0];
    plain.extend(payload);
    let crc = cophase_link::checksum(&plain);
    plain.extend(crc.to_le_bytes());
    // No block of it has a zero, so that its code is as short as codes get.
    let mut coded = Vec::new();
    for block in plain.split(|&byte| byte == 0) {
        let mut rest = block;
        while rest.len() >= 254 {
            coded.push(255);
            coded.extend(&rest[..254]);
            rest = &rest[254..];
        }
        coded.push(rest.len() as u8 + 1);
        coded.extend(rest);
    }
    coded.push(0);
    coded
}

/// If this fails, a long frame makes the server panic, and any host can reset a running controller.
#[test]
fn frames_of_any_length_are_answered_or_counted() {
    for length in 0..1000 {
        let mut hub = hub();
        hub.receive(0, &frame_of(&vec![0xFF; length]));
        let mut bytes = [0; 1024];
        let is_answered = hub.transmit(0, &mut bytes) > 0;
        assert_eq!(is_answered, length <= MAX_PAYLOAD_BYTES, "{length} bytes");
    }
}
