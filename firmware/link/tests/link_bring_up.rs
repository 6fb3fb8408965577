//! Bring-up over the link, and the loss of the host.

use crate::support::device::{Effect, INPUTS};
use crate::support::line::{Host, TestHub, hub};
use cophase_core::settings::{HostLossReaction, HostLossSettings};
use cophase_core::supervisor::{Command, State};
use cophase_link::message::{ControlRequest, Event, File, Output, Refusal, ReplyBody, Request};
use cophase_link::sample::flags;
use cophase_link::server::{OUTPUT_MS, UNLOCKED_S};

const STEP: Request<'_> = Request::Output {
    output: Output::Step(2),
    is_active: true,
};
const HELD: Effect = Effect::Output(Some((Output::Step(2), true)));
const RELEASED: Effect = Effect::Output(None);

fn effects(hub: &mut TestHub) -> Vec<Effect> {
    std::mem::take(&mut hub.device().effects)
}

/// A host that has control.
fn operator(hub: &mut TestHub) -> Host {
    let mut host = Host::new(0);
    let take = Request::Control(ControlRequest::Take);
    host.request(hub, &take).unwrap();
    host
}

fn passes(hub: &mut TestHub, ms: u32) {
    hub.device().now_ms += ms;
    hub.poll();
}

#[test]
fn any_host_reads_the_inputs() {
    let mut hub = hub();
    Host::new(1).ask(&mut hub, &Request::Inputs, |reply| {
        assert_eq!(reply.unwrap(), ReplyBody::Inputs(INPUTS));
    });
}

#[test]
fn outputs_and_single_axes_need_control_and_the_unlock() {
    let mut hub = hub();
    let mut host = Host::new(0);
    for request in [STEP, Request::OnlyAxis(1), Request::Unlock] {
        let refused = host.request(&mut hub, &request);
        assert_eq!(refused, Err(Refusal::NoControl));
    }
    let mut host = operator(&mut hub);
    for request in [STEP, Request::OnlyAxis(1)] {
        assert_eq!(host.request(&mut hub, &request), Err(Refusal::Locked));
    }
    assert_eq!(effects(&mut hub), []);
    host.request(&mut hub, &Request::Unlock).unwrap();
    host.request(&mut hub, &STEP).unwrap();
    host.request(&mut hub, &Request::OnlyAxis(1)).unwrap();
    assert_eq!(effects(&mut hub), [HELD, Effect::Restart(Some(1))]);
    passes(&mut hub, 1000 * UNLOCKED_S);
    assert_eq!(host.request(&mut hub, &STEP), Err(Refusal::Locked));
}

/// If this fails, an output stays held after its host has left.
#[test]
fn a_held_output_is_released_at_its_timeout_or_disconnect() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Unlock).unwrap();
    host.request(&mut hub, &STEP).unwrap();
    passes(&mut hub, OUTPUT_MS / 2);
    host.request(&mut hub, &STEP).unwrap();
    passes(&mut hub, OUTPUT_MS - 1);
    assert_eq!(effects(&mut hub), [HELD, HELD]);
    passes(&mut hub, 1);
    passes(&mut hub, 1);
    assert_eq!(effects(&mut hub), [RELEASED], "once");

    host.request(&mut hub, &STEP).unwrap();
    hub.disconnect(0);
    hub.poll();
    assert_eq!(effects(&mut hub), [HELD, RELEASED]);
}

#[test]
fn bring_up_ends_when_the_machine_starts() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Unlock).unwrap();
    host.request(&mut hub, &STEP).unwrap();
    hub.device().enters(State::Homing);
    hub.poll();
    assert_eq!(effects(&mut hub), [HELD, RELEASED]);
    for request in [STEP, Request::OnlyAxis(0), Request::Unlock] {
        let refused = host.request(&mut hub, &request);
        let state = State::Homing as u8;
        assert_eq!(refused, Err(Refusal::State { state }));
    }
    assert_eq!(effects(&mut hub), []);
}

/// If this fails, a restart, an erase of the flash or a single axis releases the cranks. An operator releases them with
/// a reset.
#[test]
fn requests_that_need_drives_off_are_refused_while_holding() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Unlock).unwrap();
    hub.device().enters_with(State::Fault, flags::DRIVES);
    hub.poll();
    let begin = Request::BeginWrite {
        file: File::Settings,
        length: 0,
        crc: 0,
    };
    host.request(&mut hub, &begin).unwrap();
    let refused = Err(Refusal::State {
        state: State::Fault as u8,
    });
    for request in [
        Request::Unlock,
        STEP,
        Request::OnlyAxis(0),
        Request::Restart,
        Request::FinishWrite,
    ] {
        assert_eq!(host.request(&mut hub, &request), refused, "{request:?}");
    }
    host.request(&mut hub, &Request::Reset).unwrap();
    assert_eq!(effects(&mut hub), [Effect::Command(Command::Reset)]);
    hub.device().enters(State::Idle);
    hub.poll();
    host.request(&mut hub, &Request::Restart).unwrap();
    assert_eq!(effects(&mut hub), [Effect::Restart(None)]);
}

/// If this fails, a held STEP suppresses the first steps.
#[test]
fn a_held_output_is_released_before_a_motion_is_commanded() {
    let mut hub = hub();
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Unlock).unwrap();
    host.request(&mut hub, &STEP).unwrap();
    host.request(&mut hub, &Request::Arm).unwrap();
    host.request(&mut hub, &Request::Home).unwrap();
    let home = Effect::Command(Command::Home);
    assert_eq!(effects(&mut hub), [HELD, RELEASED, home]);
}

/// A host that started the machine, and a hub that stops it half a second after the host is lost.
fn started(reaction: HostLossReaction) -> (TestHub, Host) {
    let mut hub = hub();
    hub.device().host_loss = HostLossSettings {
        timeout_s: 0.5,
        reaction,
    };
    let mut host = operator(&mut hub);
    host.request(&mut hub, &Request::Arm).unwrap();
    host.request(&mut hub, &Request::Start).unwrap();
    hub.device().enters(State::Run);
    assert_eq!(effects(&mut hub), [Effect::Command(Command::Start)]);
    (hub, host)
}

#[test]
fn a_machine_whose_host_is_lost_stops_as_its_settings_define() {
    for (reaction, command) in [
        (HostLossReaction::Stop, Command::Stop),
        (HostLossReaction::StopNow, Command::StopNow),
    ] {
        let (mut hub, mut host) = started(reaction);
        passes(&mut hub, 499);
        // Any frame shows that the host is there.
        host.ask(&mut hub, &Request::Counters, |reply| assert!(reply.is_ok()));
        passes(&mut hub, 499);
        assert_eq!(effects(&mut hub), []);
        passes(&mut hub, 1);
        passes(&mut hub, 10_000);
        assert_eq!(effects(&mut hub), [Effect::Command(command)], "once");
    }
}

/// Frames of a host that only watches do not keep a machine running after its operator is lost.
#[test]
fn frames_of_another_host_do_not_reset_the_timeout() {
    let (mut hub, _host) = started(HostLossReaction::Stop);
    let mut other = Host::new(1);
    passes(&mut hub, 499);
    other.ask(&mut hub, &Request::Counters, |reply| assert!(reply.is_ok()));
    passes(&mut hub, 1);
    assert_eq!(effects(&mut hub), [Effect::Command(Command::Stop)]);
}

#[test]
fn a_stop_is_retried_while_the_queue_is_full() {
    let (mut hub, _host) = started(HostLossReaction::Stop);
    hub.device().is_busy = true;
    passes(&mut hub, 500);
    assert_eq!(effects(&mut hub), []);
    hub.device().is_busy = false;
    passes(&mut hub, 2);
    assert_eq!(effects(&mut hub), [Effect::Command(Command::Stop)]);
}

#[test]
fn no_stop_is_commanded_without_a_timeout_or_host() {
    let (mut hub, _host) = started(HostLossReaction::Stop);
    hub.device().host_loss = HostLossSettings::NONE;
    passes(&mut hub, 3_600_000);
    assert_eq!(effects(&mut hub), []);

    // Parked, and started again by the button.
    let (mut hub, _host) = started(HostLossReaction::Stop);
    hub.device()
        .events
        .push_back((1, Event::State(State::Parked as u8)));
    hub.poll();
    passes(&mut hub, 3_600_000);
    assert_eq!(effects(&mut hub), []);
}
