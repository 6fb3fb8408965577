//! The link's server: access, files, events and statuses.

use crate::support::device::Effect;
use crate::support::line::{Host, TestHub, hub};
use cophase_core::supervisor::{Command, State};
use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::message::{
    Control, ControlRequest, Event, File, Message, Refusal, ReplyBody, Request, StopKind, VERSION,
};
use cophase_link::sample::Sample;
use cophase_link::server::ARMED_S;

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

/// If this fails, a step can be left out, and a single request can move a machine.
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
fn an_arm_ends_at_its_timeout_or_when_enable_opens() {
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

    // The host that takes over has control. The first host's arm is gone with it.
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

/// If this fails, a new host on a line has the control of the last one.
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

/// If this fails, the first reply after a port was closed within a frame is lost: the receiver takes it for the rest of that frame.
#[test]
fn a_frame_that_the_end_of_a_connection_cuts_takes_no_reply_with_it() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    let mut frame = [0; MAX_FRAME_BYTES];
    let read = Request::Read {
        file: File::Settings,
        offset: 0,
    };
    let (_, length) = host.client.request(&read, &mut frame).unwrap();
    hub.receive(0, &frame[..length]);
    let mut part = [0; 64];
    assert_eq!(
        hub.transmit(0, &mut part),
        part.len(),
        "a part of the reply"
    );
    for byte in part {
        assert!(host.client.push(byte).is_none());
    }
    hub.disconnect(0);
    hub.connect(0);
    assert_eq!(
        host.request(&mut hub, &Request::Start),
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
