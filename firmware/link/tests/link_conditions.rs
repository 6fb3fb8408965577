//! Every request in every state of the machine.
#![allow(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

mod support;

use std::collections::BTreeSet;

use cophase_core::supervisor::State;
use cophase_link::message::{
    ControlRequest, File, Output, Refusal, ReplyBody, Request, StopKind, VERSION,
};
use support::line::{Host, hub};

/// States, the last one twice: with the drives off, and while they hold.
const STATES: [(State, bool); 7] = [
    (State::Idle, false),
    (State::Homing, true),
    (State::Run, true),
    (State::Stop, true),
    (State::Parked, true),
    (State::Fault, false),
    (State::Fault, true),
];

const fn begin(file: File) -> Request<'static> {
    let (length, crc) = (0, 0);
    Request::BeginWrite { file, length, crc }
}

/// Requests, the file that is being written, and the states in which each is possible: a letter for each of [`STATES`].
const TABLE: &[(Request<'_>, File, &str)] = &[
    (Request::Arm, File::Program, "i...p.."),
    (Request::Start, File::Program, "i...p.."),
    (Request::Home, File::Program, "i......"),
    // A jog is repeated while it runs.
    (Request::Jog, File::Program, "..r.p.."),
    (Request::Hold, File::Program, "..r...."),
    (Request::Resume, File::Program, "..r...."),
    (Request::Reset, File::Program, ".....fh"),
    (Request::FinishWrite, File::Program, "i...p.."),
    (Request::FinishWrite, File::Settings, "i....f."),
    (Request::Restart, File::Program, "i....f."),
    (Request::Unlock, File::Program, "i....f."),
    (Request::OnlyAxis(1), File::Program, "i....f."),
    (
        Request::Output {
            output: Output::Sync,
            is_active: true,
        },
        File::Program,
        "i......",
    ),
    (Request::Stop(StopKind::AtPhase), File::Program, "ihrspfh"),
    (Request::Stop(StopKind::Now), File::Program, "ihrspfh"),
    (
        Request::Override { permille: 500 },
        File::Program,
        "ihrspfh",
    ),
    (Request::ResetPeak, File::Program, "ihrspfh"),
    (
        Request::Control(ControlRequest::Take),
        File::Program,
        "ihrspfh",
    ),
    (Request::Disarm, File::Program, "ihrspfh"),
    (begin(File::Program), File::Program, "ihrspfh"),
    (begin(File::Settings), File::Program, "ihrspfh"),
    (
        Request::Write {
            offset: 0,
            bytes: &[],
        },
        File::Program,
        "ihrspfh",
    ),
    (
        Request::Read {
            file: File::Settings,
            offset: 0,
        },
        File::Program,
        "ihrspfh",
    ),
    (
        Request::Identify { version: VERSION },
        File::Program,
        "ihrspfh",
    ),
    (Request::Counters, File::Program, "ihrspfh"),
    (Request::Events { from: 0 }, File::Program, "ihrspfh"),
    (
        Request::Stream {
            channels: 1,
            every: 1,
        },
        File::Program,
        "ihrspfh",
    ),
    (
        Request::StreamStatus { period_ms: 100 },
        File::Program,
        "ihrspfh",
    ),
    (Request::Inputs, File::Program, "ihrspfh"),
];

/// If this fails, a request takes effect in a state in which it must not, or is refused in one in which users need it.
#[test]
fn each_request_is_possible_in_the_states_of_the_table() {
    for (request, file, possible) in TABLE {
        for ((state, drives), letter) in STATES.into_iter().zip(possible.chars()) {
            let mut hub = hub();
            let mut host = Host::new(0);
            for before in [
                Request::Control(ControlRequest::Take),
                Request::Arm,
                Request::Unlock,
                begin(*file),
            ] {
                host.request(&mut hub, &before).unwrap();
            }
            hub.device().enters_with(state, drives);
            let refused = host.ask(&mut hub, request, |reply| reply.map(drop_body).err());
            let state = state as u8;
            let expected = (letter == '.').then_some(Refusal::State { state });
            assert_eq!(
                refused, expected,
                "{request:?} {file:?} in {state}, {drives}"
            );
            let is_changed = !hub.device().effects.is_empty();
            assert!(!(is_changed && letter == '.'), "{request:?} in {state}");
        }
    }
}

fn drop_body(_: ReplyBody<'_>) {}

/// If this fails, a request is missing in the table.
#[test]
fn the_table_has_every_request() {
    let number = |request: &Request<'_>| postcard::to_slice(request, &mut [0; 64]).unwrap()[0];
    let listed: BTreeSet<u8> = TABLE.iter().map(|(request, ..)| number(request)).collect();
    // Zeros are a valid content of every request, so that only the number decides whether there is one.
    let exists = |&number: &u8| {
        let mut bytes = [0; 64];
        bytes[0] = number;
        postcard::take_from_bytes::<Request<'_>>(&bytes).is_ok()
    };
    assert_eq!(listed, (0..128).filter(exists).collect());
}
