//! Every way to stop, through scenes.
//!
//! [`cophase_tests::watch`] asserts at every tick of every one of these runs that all axes are in phase,
//! to the bit. [`scripted`] asserts that the shaft keeps its limits.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Parked, Run, Stop};
use cophase_core::units::Phase;
use cophase_tests::scripted::{
    HZ, ONE_TURN, command, input, program, scripted, stands_at_park_phase,
};
use cophase_tests::{Tick, Watched};

/// Returns the time at which the shaft was in the middle of its first passage through the band, s.
fn amid_band(watched: &Watched) -> f64 {
    let inside = |tick: &&Tick| tick.crossing;
    let first = watched
        .ticks
        .iter()
        .find(inside)
        .expect("the band is crossed");
    let ticks = watched
        .ticks
        .iter()
        .skip_while(|tick| !tick.crossing)
        .take_while(inside)
        .count();
    first.start_ns as f64 * 1e-9 + ticks as f64 / 2.0 / HZ
}

/// If this fails, a machine does not come to rest by itself, or comes to rest elsewhere than commanded.
#[test]
fn a_program_ends_parked_at_the_parking_phase() {
    let watched = scripted("");
    assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
    stands_at_park_phase(watched.last());
    assert_eq!(watched.outcome.fault, None);
    assert_eq!(program(&watched).len(), 3300 * 2);
}

/// If this fails, a stop that comes while the shaft accelerates jerks it, or misses the phase.
#[test]
fn a_stop_amid_a_ramp_parks() {
    for at_s in [0.7, 0.9, 1.1, 2.6, 3.0] {
        let watched = scripted(&command(at_s, "stop"));
        let before = watched.at(at_s);
        assert_eq!(before.state, Run, "{at_s} s");
        assert_ne!(
            watched.at(at_s - 0.01).speed,
            before.speed,
            "{at_s} s is amid a ramp"
        );
        assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
        stands_at_park_phase(watched.last());
    }
}

/// If this fails, a stop leaves the shaft dwelling at a resonance, or takes it up through the resonance
/// first.
#[test]
fn a_stop_amid_a_band_leaves_it_downwards_at_once() {
    let plain = scripted("");
    let at_s = amid_band(&plain);
    let watched = scripted(&command(at_s, "stop"));
    stands_at_park_phase(watched.last());
    let stopping = || watched.ticks.iter().filter(|tick| tick.state == Stop);
    let crossing = stopping().take_while(|tick| tick.crossing).count();
    assert!(crossing > 0, "the stop came inside the band");
    assert!(
        stopping().skip(crossing).all(|tick| !tick.crossing),
        "the band is entered again"
    );
    // Until the acceleration has ended, the speed gains at most a²/2J = 1 rev/s. The band is 2 rev/s wide
    // and the stop came half way up, so the speed turns round in it. From there it falls at 40 rev/s² and
    // 800 rev/s³. That takes a/J to end the acceleration, a/J to brake, and 2 rev/s / a: 150 ms.
    assert!(crossing as f64 / HZ < 0.15, "{crossing} ticks in the band");
    let top = stopping().map(|tick| tick.speed).max().expect("ticks");
    assert!(
        top as f64 / ONE_TURN * HZ < 11.0,
        "the shaft went up through the band"
    );
}

/// If this fails, a stop that comes near a band may wait there for the phase to park at.
#[test]
fn no_stop_dwells_in_a_band() {
    let amid_s = amid_band(&scripted(""));
    for offset in -12..=12 {
        let at_s = amid_s + f64::from(offset) * 0.005;
        let watched = scripted(&command(at_s, "stop"));
        stands_at_park_phase(watched.last());
        let even = |pair: &&[Tick]| {
            pair[1].state == Stop && pair[1].crossing && pair[0].speed == pair[1].speed
        };
        // Where the speed turns round, the acceleration may be zero for a tick.
        let waited = watched.ticks.windows(2).filter(even).count();
        assert!(
            waited <= 1,
            "stopped at {at_s} s: {waited} ticks at one speed in the band"
        );
    }
}

/// If this fails, a stop that comes before the first index pulse is lost.
#[test]
fn a_stop_while_homing_parks() {
    for at_s in [0.01, 0.1, 0.2] {
        let watched = scripted(&command(at_s, "stop"));
        assert_eq!(watched.states()[..2], [Homing, Stop], "{at_s} s");
        assert!(!watched.states().contains(&Run), "{at_s} s");
        assert_eq!(watched.last().state, Parked);
        if at_s > 0.02 {
            stands_at_park_phase(watched.last());
        } else {
            assert_eq!(
                watched.last().phase,
                Phase::ZERO,
                "nothing had moved: nothing moves"
            );
        }
    }
}

/// If this fails, the stop button acts differently from the command, or lets a start through.
#[test]
fn the_stop_input_stops_like_the_command_and_keeps_the_machine_stopped() {
    let commanded = scripted(&command(1.0, "stop"));
    let pressed = input(1.0, "stop", true);
    let held = scripted(&(pressed.clone() + &command(0.0, "start") + &command(3.0, "start")));
    assert_eq!(held.states(), [Homing, Run, Stop, Parked]);
    let moving = |watched: &Watched| -> Vec<Tick> {
        watched
            .ticks
            .iter()
            .take_while(|tick| tick.state != Parked)
            .copied()
            .collect()
    };
    assert_eq!(moving(&held), moving(&commanded));
    assert!(
        held.last().start_ns > 3_000_000_000,
        "the start was received, and not obeyed"
    );
    stands_at_park_phase(held.last());

    let freed = pressed + &input(2.5, "stop", false);
    let freed = scripted(&(freed + &command(0.0, "start") + &command(3.0, "start")));
    assert_eq!(
        freed.states(),
        [Homing, Run, Stop, Parked, Run, Stop, Parked]
    );
    stands_at_park_phase(freed.last());
}

/// If this fails, the drives push on after their enable is removed, or come back by themselves.
#[test]
fn enable_lost_at_speed_cuts_the_drives_the_same_tick() {
    let lost_s = 2.0;
    let happens = command(0.0, "start")
        + &input(lost_s, "enable", false)
        + &input(2.2, "enable", true)
        + &command(2.4, "start");
    let watched = scripted(&happens);
    assert!(
        watched.at(lost_s - 0.01).speed as f64 / ONE_TURN * HZ > 15.0,
        "at speed"
    );
    assert_eq!(watched.states(), [Homing, Run, Fault]);
    for tick in &watched.ticks {
        assert_eq!(
            tick.drives_enabled,
            (1..2_000_000_000).contains(&tick.start_ns),
            "{tick:?}"
        );
        if tick.start_ns > 2_000_000_000 {
            assert_eq!((tick.state, tick.speed), (Fault, 0), "a start is no reset");
        }
    }
    let fault = watched
        .outcome
        .fault
        .expect("a fault, and so exit status 1");
    assert_eq!(fault.kind, FaultKind::EnableLost);
    assert_eq!(fault.tick as f64, lost_s * HZ, "it is dated");
    assert_eq!(watched.last().fault, Some(fault), "it is latched");
}

/// If this fails, an idle machine's trim is stepped into drives that are off, and is lost there.
#[test]
fn drives_that_are_off_get_no_pulses() {
    let trimmed = "[[axis]]\nnumber = 0\ntrim_deg = 2\n";
    let scene = cophase_tests::scene(
        &(cophase_tests::scripted::SCENE.to_owned() + trimmed + &command(4.0, "start")),
    );
    let run = cophase_tests::record(
        &scene,
        cophase_files::trace::Every::Ticks(1),
        cophase_files::trace::Window::All,
    );
    let edges = run.edges();
    let rises = |from_ns, to_ns| edges.wire("step_0").cut(from_ns, to_ns).rises().count();
    assert_eq!(rises(0, 4_000_000_000), 0);
    assert!(
        rises(4_000_000_000, 5_000_000_000) > 17,
        "the trim is made once the machine moves"
    );
}

/// If this fails, an operator whose start does nothing learns neither why nor what to do.
#[test]
fn a_start_that_comes_in_a_stop_is_reported_with_what_to_do() {
    let stop_s = 1.5;
    let start_s = 1.55;
    let watched =
        scripted(&(command(0.0, "start") + &command(stop_s, "stop") + &command(start_s, "start")));
    assert_eq!(watched.at(start_s).state, Stop);
    assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
    let events = cophase_files::report::notable(&watched.outcome.record.events);
    let mut said = events
        .iter()
        .map(|event| (event.t_s, cophase_files::report::describe(&event.what)))
        .filter(|(_, what)| what.starts_with("refused: "));
    let (t_s, what) = said.next().expect("an event");
    // The loop reads the command at a deadline, and its answer is played from the next one on.
    assert!((start_s..=start_s + 2.0 / HZ).contains(&t_s), "{t_s} s");
    assert!(
        what.contains("`start`") && what.contains("in state stop"),
        "{what}"
    );
    assert!(
        what.contains("possible in state idle") && what.contains("or parked"),
        "{what}"
    );
    assert_eq!(said.next(), None);
}
