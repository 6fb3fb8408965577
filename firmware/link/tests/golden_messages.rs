//! The bytes of every message, against a file. A change of these bytes breaks hosts and boards of other versions: it needs a
//! new `message::VERSION`. `COPHASE_BLESS=1 cargo test -p cophase-link --test integration golden_messages` writes the file.

use cophase_core::supervisor::{Fault, FaultKind};
use cophase_core::units::{Phase, Turns};
use cophase_link::frame::{self, FrameCounts, MAX_FRAME_BYTES};
use cophase_link::message::{
    Control, ControlRequest, Counters, Event, EventRecord, FaultRecord, File, Identity, Inputs,
    Message, Name, Output, Refusal, RefusedRecord, ReplyBody, Request, Status, StopKind, Text,
    VERSION,
};
use cophase_link::sample::ALL_CHANNELS;

fn requests() -> Vec<Request<'static>> {
    vec![
        Request::Identify { version: VERSION },
        Request::Read {
            file: File::Settings,
            offset: 384,
        },
        Request::BeginWrite {
            file: File::Program,
            length: 1000,
            crc: 0x1234_5678,
        },
        Request::Write {
            offset: 384,
            bytes: &[0, 1, 255],
        },
        Request::FinishWrite,
        Request::Restart,
        Request::Control(ControlRequest::Take),
        Request::Control(ControlRequest::TakeOver),
        Request::Control(ControlRequest::Release),
        Request::Arm,
        Request::Disarm,
        Request::Start,
        Request::Stop(StopKind::AtPhase),
        Request::Stop(StopKind::Now),
        Request::Hold,
        Request::Resume,
        Request::Reset,
        Request::Override { permille: 1200 },
        Request::Home,
        Request::Jog,
        Request::Counters,
        Request::Events { from: 300 },
        Request::Stream {
            channels: ALL_CHANNELS,
            every: 2,
        },
        Request::StreamStatus { period_ms: 100 },
        Request::ResetPeak,
        Request::Inputs,
        Request::Unlock,
        Request::Output {
            output: Output::Step(3),
            is_active: true,
        },
        Request::Output {
            output: Output::DriveEnable,
            is_active: false,
        },
        Request::OnlyAxis(2),
    ]
}

fn refusals() -> Vec<Refusal> {
    let text = Text::try_from("a reason").unwrap();
    vec![
        Refusal::Unreadable,
        Refusal::Version { controller: 2 },
        Refusal::ControlTaken,
        Refusal::NoControl,
        Refusal::NotArmed,
        Refusal::EnableOpen,
        Refusal::StopActive,
        Refusal::State { state: 2 },
        Refusal::OutOfRange {
            min: 1,
            max: 10_000,
        },
        Refusal::Offset { expected: 384 },
        Refusal::NotWriting,
        Refusal::TooLong {
            length: 100_000,
            max: 9000,
        },
        Refusal::FileCrc { found: 0x1234_5678 },
        Refusal::Rejected(text.clone()),
        Refusal::NotStored(text),
        Refusal::Busy,
        Refusal::Locked,
        Refusal::NotHomed,
        Refusal::ProgramRuns,
        Refusal::Jogs,
    ]
}

fn messages() -> Vec<Message<'static>> {
    let name = |text| Name::try_from(text).unwrap();
    let fault = Fault::new(FaultKind::LostSteps)
        .on_axis(2)
        .with_size(Turns::from_num(-0.02))
        .at(1_000_000, Phase::from_turns(Turns::from_num(0.25)));
    let fault = FaultRecord::from(&fault);
    let record = |number, event| EventRecord {
        number,
        tick: 2000,
        event,
    };
    let events = [
        Event::State(2),
        Event::Fault(fault),
        Event::Reported(fault),
        Event::Missed(3),
        Event::Late(4),
        Event::Lost(5),
        Event::Refused(RefusedRecord([0, 3, 0])),
    ];
    let events = (0..)
        .zip(events)
        .map(|(number, event)| record(number, event));
    let replies = [
        ReplyBody::Done,
        ReplyBody::Identity(Identity {
            version: VERSION,
            board: name("RP2040"),
            serial: 0x0123_4567_89AB_CDEF,
            firmware: name("0.1.0"),
            settings: name("default"),
            settings_crc: 1,
            program_crc: 2,
            axes: 4,
            tick_hz: 2000,
            can_run: true,
            only_axis: Some(3),
            restarts: 300,
        }),
        ReplyBody::Chunk {
            length: 3,
            bytes: &[1, 2, 3],
        },
        ReplyBody::Counters(Counters {
            received: FrameCounts {
                good: 1000,
                bad: 2,
                missing: 3,
            },
            refused: 4,
            not_sent: 5,
            samples_lost: 6,
            missed_deadlines: 7,
            late_deadlines: 8,
        }),
        ReplyBody::Events(events.clone().collect()),
        ReplyBody::Inputs(Inputs {
            index: 0b10_0001,
            alarm: 0b00_0010,
            enable: true,
            stop: false,
            start: true,
        }),
    ];
    let mut all: Vec<_> = replies
        .into_iter()
        .map(|body| Message::Reply {
            to: 300,
            body: Ok(body),
        })
        .collect();
    all.extend(refusals().into_iter().map(|refusal| Message::Reply {
        to: 300,
        body: Err(refusal),
    }));
    all.push(Message::Status(Status {
        tick: 123_456,
        state: 2,
        flags: 41,
        override_permille: 1000,
        control: Control::You,
        armed: true,
        amax_mps2: 98.0665,
        speed_hz: 9.1,
        program_ticks: 100_000,
        phase_error_deg: [0.5, -0.25, 0.0, 1.0].into_iter().collect(),
        tilt_deg: [0.125, -0.5],
        fault: Some(fault),
        events: 12,
        samples_lost: 0,
    }));
    all.push(Message::Samples {
        tick: 1000,
        every: 2,
        channels: ALL_CHANNELS,
        count: 1,
        packet: &[0, 0x80, 1],
    });
    all.extend(events.map(Message::Event));
    all
}

/// One line a message: its frame in hexadecimal digits, and the message as Rust prints it.
fn lines() -> String {
    let mut text = String::new();
    let mut line = |payload: Vec<u8>, what: String| {
        let mut buffer = [0; MAX_FRAME_BYTES];
        let length = frame::encode(7, &mut buffer, |room| {
            room[..payload.len()].copy_from_slice(&payload);
            Some(payload.len())
        });
        let bytes = &buffer[..length.unwrap()];
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        text += &format!("{digits} {what}\n");
    };
    for request in requests() {
        let mut bytes = [0; 480];
        let payload = postcard::to_slice(&request, &mut bytes).unwrap().to_vec();
        assert_eq!(postcard::from_bytes::<Request<'_>>(&payload), Ok(request));
        line(payload, format!("{request:?}"));
    }
    for message in messages() {
        let mut bytes = [0; 480];
        let payload = postcard::to_slice(&message, &mut bytes).unwrap().to_vec();
        assert_eq!(
            postcard::from_bytes::<Message<'_>>(&payload).as_ref(),
            Ok(&message)
        );
        line(payload, format!("{message:?}"));
    }
    text
}

#[test]
fn bytes_of_messages_have_not_changed() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/messages.txt");
    let lines = lines();
    if std::env::var_os("COPHASE_BLESS").is_some() {
        std::fs::write(path, &lines).unwrap();
    }
    let golden = std::fs::read_to_string(path).unwrap();
    for (actual, expected) in lines.lines().zip(golden.lines()) {
        assert_eq!(actual, expected);
    }
    assert_eq!(lines.lines().count(), golden.lines().count());
}
