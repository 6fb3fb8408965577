//! The link's server, with hosts at its sessions.
#![allow(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

mod support;

use cophase_core::supervisor::{Command, State};
use cophase_link::client::Client;
use cophase_link::frame::{MAX_FRAME_BYTES, MAX_PAYLOAD_BYTES};
use cophase_link::message::{
    Control, ControlRequest, Event, File, Message, Refusal, ReplyBody, Request, StopKind, VERSION,
};
use cophase_link::sample::{ALL_CHANNELS, Channel, Sample, unpack};
use cophase_link::server::{ARMED_S, Hub};
use proptest::prelude::*;
use support::device::{AXES, Effect, RecordingDevice, TICK_HZ};
use support::line::{Host, TestHub};

fn hub() -> TestHub {
    Hub::new(RecordingDevice::new())
}

/// A host that has control.
fn operator(hub: &mut TestHub) -> Host {
    let mut host = Host::new(0);
    take(&mut host, hub).unwrap();
    host
}

fn take(host: &mut Host, hub: &mut TestHub) -> Result<(), Refusal> {
    host.request(hub, &Request::Control(ControlRequest::Take))
}

fn effects(hub: &mut TestHub) -> Vec<Effect> {
    std::mem::take(&mut hub.device().effects)
}

#[test]
fn identity_has_the_protocol_version_and_another_version_is_refused() {
    let (mut hub, mut host) = (hub(), Host::new(0));
    let ask = |version| Request::Identify { version };
    host.ask(&mut hub, &ask(VERSION), |reply| match reply {
        Ok(ReplyBody::Identity(identity)) => assert_eq!(identity.version, VERSION),
        other => panic!("{other:?}"),
    });
    let refused = host.request(&mut hub, &ask(VERSION + 1)).unwrap_err();
    let controller = VERSION;
    assert_eq!(refused, Refusal::Version { controller });
}

/// If one of the steps could be left out, a single request could move a machine.
#[test]
fn motion_needs_control_then_an_arm_then_a_start() {
    let mut hub = hub();
    let mut host = Host::new(0);
    assert_eq!(
        host.request(&mut hub, &Request::Arm),
        Err(Refusal::NoControl)
    );
    take(&mut host, &mut hub).unwrap();
    for motion in [Request::Start, Request::Home] {
        let refused = host.request(&mut hub, &motion);
        assert_eq!(refused, Err(Refusal::NotArmed));
    }
    assert_eq!(effects(&mut hub), []);
    host.request(&mut hub, &Request::Arm).unwrap();
    host.request(&mut hub, &Request::Start).unwrap();
    assert_eq!(effects(&mut hub), [Effect::Command(Command::Start)]);
    // One arm allows one motion.
    let refused = host.request(&mut hub, &Request::Start);
    assert_eq!(refused, Err(Refusal::NotArmed));
}

#[test]
fn an_arm_ends_with_its_time_and_with_the_enable_input() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Arm).unwrap();
    hub.device().now_ms = 1000 * ARMED_S;
    hub.poll();
    let refused = host.request(&mut hub, &Request::Start);
    assert_eq!(refused, Err(Refusal::NotArmed));

    host.request(&mut hub, &Request::Arm).unwrap();
    hub.device().samples.push_back(Sample::ZERO);
    hub.poll();
    let refused = host.request(&mut hub, &Request::Start);
    assert_eq!(refused, Err(Refusal::EnableOpen));
    hub.device().enters(State::Idle);
    hub.poll();
    let refused = host.request(&mut hub, &Request::Start);
    assert_eq!(refused, Err(Refusal::NotArmed));
    assert_eq!(effects(&mut hub), []);
}

#[test]
fn one_host_has_control_and_any_host_can_stop() {
    let mut hub = hub();
    let mut first = operator(&mut hub);
    let mut second = Host::new(1);
    assert_eq!(take(&mut second, &mut hub), Err(Refusal::ControlTaken));
    hub.device().enters(State::Run);
    for request in [
        Request::Hold,
        Request::Resume,
        Request::Override { permille: 500 },
        Request::Restart,
        Request::Arm,
    ] {
        let refused = second.request(&mut hub, &request).unwrap_err();
        assert!(
            matches!(refused, Refusal::ControlTaken | Refusal::State { .. }),
            "{request:?}: {refused:?}"
        );
    }
    assert_eq!(effects(&mut hub), []);
    second
        .request(&mut hub, &Request::Stop(StopKind::Now))
        .unwrap();
    assert_eq!(effects(&mut hub), [Effect::Command(Command::StopNow)]);

    // Whoever takes over has control; the first one's arm is gone with it.
    hub.device().enters(State::Idle);
    first.request(&mut hub, &Request::Arm).unwrap();
    let take_over = Request::Control(ControlRequest::TakeOver);
    second.request(&mut hub, &take_over).unwrap();
    assert_eq!(
        first.request(&mut hub, &Request::Start),
        Err(Refusal::ControlTaken)
    );
    assert_eq!(
        second.request(&mut hub, &Request::Start),
        Err(Refusal::NotArmed)
    );
}

/// A new host on a line must not have what the last one had.
#[test]
fn control_ends_with_the_connection() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Arm).unwrap();
    hub.disconnect(0);
    hub.connect(0);
    let mut next = Host::new(0);
    assert_eq!(
        next.request(&mut hub, &Request::Start),
        Err(Refusal::NoControl)
    );
}

#[test]
fn files_are_read_and_written_part_by_part() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    let file = hub.device().settings.clone();
    let mut read = Vec::new();
    loop {
        let request = Request::Read {
            file: File::Settings,
            offset: read.len() as u32,
        };
        let part = host.ask(&mut hub, &request, |reply| match reply {
            Ok(ReplyBody::Chunk { length, bytes }) => {
                assert_eq!(length as usize, file.len());
                bytes.to_vec()
            }
            other => panic!("{other:?}"),
        });
        if part.is_empty() {
            break;
        }
        read.extend(part);
    }
    assert_eq!(read, file);

    let begin = Request::BeginWrite {
        file: File::Settings,
        length: file.len() as u32,
        crc: cophase_link::checksum(&file),
    };
    host.request(&mut hub, &begin).unwrap();
    for (i, bytes) in file.chunks(300).enumerate() {
        let offset = 300 * i as u32;
        let write = Request::Write { offset, bytes };
        host.request(&mut hub, &write).unwrap();
        // A host whose reply was lost sends the part again.
        host.request(&mut hub, &write).unwrap();
    }
    host.request(&mut hub, &Request::FinishWrite).unwrap();
    assert_eq!(effects(&mut hub), [Effect::Settings(file)]);
}

#[test]
fn incomplete_and_damaged_files_are_refused() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    let write = |offset, bytes| Request::Write { offset, bytes };
    let begin = Request::BeginWrite {
        file: File::Program,
        length: 6,
        crc: 0,
    };
    assert_eq!(
        host.request(&mut hub, &write(0, b"abc")),
        Err(Refusal::NotWriting)
    );
    host.request(&mut hub, &begin).unwrap();
    host.request(&mut hub, &write(0, b"abc")).unwrap();
    let expected = 3;
    assert_eq!(
        host.request(&mut hub, &write(4, b"f")),
        Err(Refusal::Offset { expected })
    );
    assert_eq!(
        host.request(&mut hub, &Request::FinishWrite),
        Err(Refusal::Offset { expected })
    );
    host.request(&mut hub, &write(3, b"def")).unwrap();
    let refused = host.request(&mut hub, &Request::FinishWrite).unwrap_err();
    assert!(matches!(refused, Refusal::FileCrc { .. }), "{refused:?}");
    assert_eq!(effects(&mut hub), []);
    // Settings are stored only while the drives are off: a flash erase stops the loop.
    hub.device().enters(State::Parked);
    let begin = Request::BeginWrite {
        file: File::Settings,
        length: 0,
        crc: 0,
    };
    host.request(&mut hub, &begin).unwrap();
    let refused = host.request(&mut hub, &Request::FinishWrite).unwrap_err();
    assert!(matches!(refused, Refusal::State { .. }), "{refused:?}");
    assert_eq!(effects(&mut hub), []);
}

/// Samples with every value different.
fn samples(count: u32, seed: u64) -> Vec<Sample> {
    let mut state = seed | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> (state % 64)).cast_signed()
    };
    (0..count)
        .map(|tick| Sample {
            tick,
            state: next() as u8,
            flags: next() as u8,
            override_permille: next() as u16,
            program_ticks: next() as u32,
            amax: next(),
            speed: next(),
            acceleration: next(),
            phase: next(),
            lead: std::array::from_fn(|_| next()),
            steps: std::array::from_fn(|_| next()),
            phase_error: std::array::from_fn(|_| next()),
            modes: std::array::from_fn(|_| next()),
            correction: std::array::from_fn(|_| next()),
        })
        .collect()
}

/// Reads the samples that have been sent.
fn received(host: &mut Host, hub: &mut TestHub) -> Vec<Sample> {
    let mut all = Vec::new();
    host.read(hub, |message| {
        if let Message::Samples {
            tick,
            every,
            channels,
            count,
            packet,
        } = message
        {
            let before = all.len();
            all.extend(unpack(tick, every, channels, AXES, packet));
            assert_eq!(all.len() - before, usize::from(count));
        }
    });
    all
}

/// If a bit were lost, a recorded run would differ from what the controller did.
#[test]
fn a_stream_has_every_sample_bit_for_bit() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.poll();
    let stream = Request::Stream {
        channels: ALL_CHANNELS,
        every: 1,
    };
    host.request(&mut hub, &stream).unwrap();
    assert_eq!(hub.device().every, 1);
    let sent = samples(500, 7);
    let mut all = Vec::new();
    for sample in &sent {
        hub.device().samples.push_back(*sample);
        hub.poll();
        all.extend(received(&mut host, &mut hub));
    }
    // The last packet waits for more.
    let missing = sent.len() - all.len();
    assert!(missing <= TICK_HZ as usize / 50, "{missing} samples wait");
    assert_eq!(all, sent[..all.len()]);
}

/// A host that reads too slowly must learn how many samples it missed.
#[test]
fn every_sample_is_received_or_counted_as_lost() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.poll();
    let stream = Request::Stream {
        channels: ALL_CHANNELS,
        every: 2,
    };
    host.request(&mut hub, &stream).unwrap();
    let mut all = Vec::new();
    for (i, sample) in samples(4000, 3).iter().enumerate() {
        // The loop itself drops some, too.
        if i % 97 != 0 {
            hub.device().samples.push_back(*sample);
        }
        hub.poll();
        if i % 250 == 249 {
            all.extend(received(&mut host, &mut hub));
        }
    }
    all.extend(received(&mut host, &mut hub));
    let lost = host.ask(&mut hub, &Request::Counters, |reply| match reply {
        Ok(ReplyBody::Counters(counters)) => counters.samples_lost as usize,
        other => panic!("{other:?}"),
    });
    println!("{} received, {lost} lost", all.len());
    assert!(lost > 100, "the line was not too slow");
    let waiting = 2000 - all.len() - lost;
    assert!(
        waiting <= 20,
        "{waiting} samples are neither received nor lost"
    );
    // Frame numbers show the same to a host that does not ask.
    assert!(host.client.counts().missing > 0);
}

#[test]
fn events_are_sent_and_kept_in_the_log() {
    let mut hub = hub();
    let mut host = Host::new(0);
    host.ask(&mut hub, &Request::Identify { version: VERSION }, |reply| {
        assert!(reply.is_ok());
    });
    for state in 1..=5 {
        hub.device()
            .events
            .push_back((10 * u32::from(state), Event::State(state)));
    }
    hub.poll();
    let mut sent = Vec::new();
    host.read(&mut hub, |message| {
        if let Message::Event(record) = message {
            sent.push(record);
        }
    });
    assert_eq!(sent.len(), 5);
    host.ask(
        &mut hub,
        &Request::Events { from: 2 },
        |reply| match reply {
            Ok(ReplyBody::Events(events)) => assert_eq!(*events, sent[2..]),
            other => panic!("{other:?}"),
        },
    );
}

#[test]
fn a_status_says_who_has_control() {
    let mut hub = hub();
    let mut first = operator(&mut hub);
    let mut second = Host::new(1);
    let status = Request::StreamStatus { period_ms: 100 };
    first.request(&mut hub, &status).unwrap();
    second.request(&mut hub, &status).unwrap();
    hub.poll();
    for (host, expected) in [(&mut first, Control::You), (&mut second, Control::Other)] {
        let mut control = None;
        host.read(&mut hub, |message| {
            if let Message::Status(status) = message {
                control = Some(status.control);
            }
        });
        assert_eq!(control, Some(expected));
    }
}

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
    // A frame whose end was damaged takes the next one with it; a zero ends it.
    hub.receive(0, &[0]);
    let mut damaged = 0;
    host.ask_counters(&mut hub, |bad, missing| damaged = bad + missing);
    (effects(&mut hub), damaged)
}

/// A bit that flips on the line must not become another request, and it must show.
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

/// A frame as any sender could make it, of any length, with the right CRC.
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

/// If a long frame made the server panic, any host could reset a running controller.
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

/// If they had samples without end, a damaged controller would stop its host.
#[test]
fn packets_without_channels_have_no_samples() {
    assert_eq!(unpack(0, 1, 0, AXES, &[1, 2, 3]).count(), 0);
    assert_eq!(unpack(0, 1, Channel::Lead as u16, 0, &[1, 2, 3]).count(), 0);
}

proptest! {
    /// Packing and unpacking is exact for any values and any selection of channels.
    #[test]
    fn samples_survive_packing(seed in any::<u64>(), axes in 1..=AXES) {
        let mut packet = heapless::Vec::<u8, 4096>::new();
        let all = samples(10, seed);
        let mut before = Sample::ZERO;
        for sample in &all {
            prop_assert!(cophase_link::sample::pack(sample, &before, ALL_CHANNELS, axes, &mut packet));
            before = *sample;
        }
        let unpacked: Vec<_> = unpack(0, 1, ALL_CHANNELS, axes, &packet).collect();
        prop_assert_eq!(unpacked.len(), all.len());
        for (sample, mut expected) in unpacked.into_iter().zip(all) {
            for axis in axes..AXES {
                for values in [&mut expected.lead, &mut expected.steps, &mut expected.phase_error, &mut expected.correction] {
                    values[axis] = 0;
                }
            }
            prop_assert_eq!(sample, expected);
        }
    }
}
