//! Every request in every state of the machine.

use std::collections::BTreeSet;

use crate::support::line::{Host, hub};
use cophase_core::supervisor::{
    Command, Fault, FaultKind, Reaction, SafetyInputs, State, Supervisor, SupervisorInput,
};
use cophase_link::message::{
    ControlRequest, File, Output, Refusal, ReplyBody, Request, StopKind, VERSION,
};
use cophase_link::sample::flags;

/// Situations: state, flags, and a letter. The machine is homed where it can be. A run is that of a program (`r`) or a jog (`j`); a machine
/// is parked after homing (`p`) or after an interrupted one (`n`); a fault has the drives off (`f`), or they hold (`h`).
const SITUATIONS: [(State, u8, char); 9] = [
    (State::Idle, 0, 'i'),
    (State::Homing, flags::DRIVES, 'o'),
    (State::Run, flags::DRIVES | flags::HOMED, 'r'),
    (State::Run, flags::DRIVES | flags::HOMED | flags::JOGS, 'j'),
    (State::Stop, flags::DRIVES | flags::HOMED, 's'),
    (State::Parked, flags::DRIVES | flags::HOMED, 'p'),
    (State::Parked, flags::DRIVES, 'n'),
    (State::Fault, 0, 'f'),
    (State::Fault, flags::DRIVES | flags::HOMED, 'h'),
];

const ALWAYS: &str = "iorjspnfh";

const fn begin(file: File) -> Request<'static> {
    let (length, crc) = (0, 0);
    Request::BeginWrite { file, length, crc }
}

/// Requests, the file that is being written, and the situations in which each is possible: the letters of [`SITUATIONS`].
const TABLE: &[(Request<'_>, File, &str)] = &[
    (Request::Arm, File::Program, "ipn"),
    (Request::Start, File::Program, "ipn"),
    (Request::Home, File::Program, "i"),
    // A jog is repeated while it runs.
    (Request::Jog, File::Program, "jp"),
    (Request::Hold, File::Program, "r"),
    (Request::Resume, File::Program, "r"),
    (Request::Reset, File::Program, "fh"),
    (Request::FinishWrite, File::Program, "ipn"),
    (Request::FinishWrite, File::Settings, "if"),
    (Request::Restart, File::Program, "if"),
    (Request::Unlock, File::Program, "if"),
    (Request::OnlyAxis(1), File::Program, "if"),
    (
        Request::Output {
            output: Output::Sync,
            is_active: true,
        },
        File::Program,
        "i",
    ),
    (Request::Stop(StopKind::AtPhase), File::Program, ALWAYS),
    (Request::Stop(StopKind::Now), File::Program, ALWAYS),
    (Request::Override { permille: 500 }, File::Program, ALWAYS),
    (Request::ResetPeak, File::Program, ALWAYS),
    (
        Request::Control(ControlRequest::Take),
        File::Program,
        ALWAYS,
    ),
    (Request::Disarm, File::Program, ALWAYS),
    (begin(File::Program), File::Program, ALWAYS),
    (begin(File::Settings), File::Program, ALWAYS),
    (
        Request::Write {
            offset: 0,
            bytes: &[],
        },
        File::Program,
        ALWAYS,
    ),
    (
        Request::Read {
            file: File::Settings,
            offset: 0,
        },
        File::Program,
        ALWAYS,
    ),
    (
        Request::Identify { version: VERSION },
        File::Program,
        ALWAYS,
    ),
    (Request::Counters, File::Program, ALWAYS),
    (Request::Events { from: 0 }, File::Program, ALWAYS),
    (
        Request::Stream {
            channels: 1,
            every: 1,
        },
        File::Program,
        ALWAYS,
    ),
    (
        Request::StreamStatus { period_ms: 100 },
        File::Program,
        ALWAYS,
    ),
    (Request::Inputs, File::Program, ALWAYS),
];

/// If this fails, a request takes effect in a state in which it must not, or is refused in one in which users need it.
#[test]
fn each_request_is_possible_in_the_situations_of_the_table() {
    for (request, file, possible) in TABLE {
        for (state, flags, letter) in SITUATIONS {
            let is_possible = possible.contains(letter);
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
            hub.device().enters_with(state, flags);
            let refused = host.ask(&mut hub, request, |reply| reply.map(drop_body).err());
            let expected = match (request, letter) {
                _ if is_possible => None,
                (Request::Jog, 'n') => Some(Refusal::NotHomed),
                (Request::Jog, 'r') => Some(Refusal::ProgramRuns),
                (Request::Hold | Request::Resume, 'j') => Some(Refusal::Jogs),
                _ => Some(Refusal::State { state: state as u8 }),
            };
            assert_eq!(refused, expected, "{request:?} {file:?} in {letter}");
            let is_changed = !hub.device().effects.is_empty();
            assert!(is_possible || !is_changed, "{request:?} in {letter}");
        }
    }
}

fn drop_body(_: ReplyBody<'_>) {}

const SAFE: SafetyInputs = SafetyInputs {
    enable: true,
    stop: false,
};

/// Plays ticks on a supervisor until it is in a situation of the table.
fn supervisor_in(letter: char) -> Supervisor {
    let mut supervisor = Supervisor::new(0, 10, false);
    let homed = SupervisorInput {
        homed: letter != 'n',
        ..SupervisorInput::default()
    };
    let rests = SupervisorInput {
        at_rest: true,
        ..homed
    };
    let alarm = SupervisorInput {
        fault: Some(Fault::new(FaultKind::DriveAlarm)),
        ..homed
    };
    let start = (Some(Command::Start), homed);
    let go = (None, homed);
    let stop = (Some(Command::Stop), homed);
    let rest = (None, rests);
    let cut = SupervisorInput {
        reaction: Reaction::StopAndCut,
        ..alarm
    };
    let path = match letter {
        'i' => vec![],
        'o' => vec![start],
        'r' => vec![start, go],
        'j' => vec![start, go, stop, rest, (Some(Command::Jog), rests)],
        's' => vec![start, go, stop],
        // An interrupted homing, or a run.
        'p' | 'n' => vec![start, go, stop, rest],
        'f' => vec![start, go, (None, cut), rest],
        _ => vec![start, go, (None, alarm), rest],
    };
    for (command, input) in path {
        supervisor.step(SAFE, command, &input);
        assert_eq!(supervisor.refused(), None);
    }
    supervisor
}

/// If this fails, the link answers "done" to a command that the loop drops, or refuses one that the loop would obey. Both are asked about
/// every request that moves the machine, in every situation, with every level of the inputs.
#[test]
fn the_link_lets_pass_exactly_what_the_supervisor_obeys() {
    let requests = TABLE.iter().map(|(request, ..)| request);
    let mut passed = 0;
    for (request, command) in requests.filter_map(|request| Some((request, request.command()?))) {
        for (state, flags, letter) in SITUATIONS {
            for (enable, stop) in [(true, false), (false, false), (true, true), (false, true)] {
                let mut hub = hub();
                let mut host = Host::new(0);
                let take = Request::Control(ControlRequest::Take);
                host.request(&mut hub, &take).unwrap();
                host.request(&mut hub, &Request::Arm).unwrap();
                hub.device().enters_with_inputs(state, flags, enable, stop);
                // The arm ends with an input that forbids motion, and the loop does not know it.
                let refused = host.ask(&mut hub, request, |reply| reply.map(drop_body).err());

                let mut supervisor = supervisor_in(letter);
                assert_eq!(
                    (supervisor.state(), supervisor.jogs()),
                    (state, letter == 'j')
                );
                let input = SupervisorInput {
                    homed: flags & flags::HOMED != 0,
                    at_rest: matches!(state, State::Parked),
                    ..SupervisorInput::default()
                };
                let inputs = SafetyInputs { enable, stop };
                supervisor.step(inputs, Some(command), &input);
                let say = format!("{request:?} in {letter}, enable {enable}, stop {stop}");
                assert_eq!(
                    refused.is_some(),
                    supervisor.refused().is_some(),
                    "{say}: {refused:?}"
                );
                passed += u32::from(refused.is_none());
            }
        }
    }
    assert!(passed > 150, "only {passed} requests were obeyed");
}

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
