//! Forbidden bands: they are crossed, and no stop dwells in one. The log has the time of each visit, and the edges that the shaft crossed.
//!
//! Unit tests: `firmware/motion/src/shaft/tests/mod.rs`, `firmware/core/src/controller/tests/mod.rs`.

use cophase_core::supervisor::State::Stop;
use cophase_files::report;
use cophase_tests::scripted::{HZ, ONE_TURN, command, scripted, stands_at_park_phase};
use cophase_tests::{Tick, Watched, bench_scene};
use host_sim::sim::events::EventKind;
use host_sim::sim::simulate;

const FROM_HZ: f64 = 9.0;
const TO_HZ: f64 = 31.0;
const ACCELERATION_HZ_PER_S: f64 = 100.0;
const JERK_HZ_PER_S2: f64 = 1600.0;
const TICK_S: f64 = 0.0005;

/// Returns the events of a program that crosses the band upwards and downwards. A request stops it at the given time.
fn events(stop_s: f64) -> Vec<EventKind> {
    let checked = bench_scene()
        .set("machine.crank_radius_mm", 4)
        .set("limits.speed_hz", 47)
        .set("limits.acceleration_hz_per_s", ACCELERATION_HZ_PER_S)
        .set("limits.jerk_hz_per_s2", JERK_HZ_PER_S2)
        .set("limits.homing_speed_hz", 4)
        .with(&format!(
            "limits.band = [{{ from_hz = {FROM_HZ}, to_hz = {TO_HZ} }}]"
        ))
        .with("axes = { count = 2, steps_per_turn = 800 }")
        .with("program = [{ amax_g = 24, hold_s = 0.5 }, { amax_g = 1, hold_s = 0.5 }]")
        .with(&(command(0.0, "start") + &command(stop_s, "stop")))
        .checked();
    let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
    assert!(outcome.fault.is_none(), "{stop_s}");
    let events = outcome.record.events.into_iter();
    events.map(|event| event.what).collect()
}

/// If this fails, a stop in a band is logged as a crossing that did not happen, or stays in the band longer than
/// docs/loop.md claims.
#[test]
fn stops_in_a_band_turn_back_and_are_logged() {
    // Time from rest at one edge to rest at the other.
    let across_s =
        (TO_HZ - FROM_HZ) / ACCELERATION_HZ_PER_S + ACCELERATION_HZ_PER_S / JERK_HZ_PER_S2;
    let (mut turned_back, mut downwards) = (0, 0);
    for step in 0..60 {
        let stop_s = 0.3 + 0.025 * f64::from(step);
        for what in events(stop_s) {
            match what {
                EventKind::BandCrossed { in_s, upwards } => {
                    assert!(in_s <= across_s + 2.0 * TICK_S, "{stop_s}: {in_s}");
                    downwards += usize::from(!upwards);
                }
                EventKind::TurnedBackInBand {
                    in_s,
                    entered_upwards,
                } => {
                    assert!(entered_upwards, "a stop leaves a band downwards");
                    assert!(in_s <= 2.0 * across_s + 2.0 * TICK_S, "{stop_s}: {in_s}");
                    let words = report::describe(&what);
                    let start = "band entered upwards, turned back, and left after ";
                    assert!(words.starts_with(start), "{words}");
                    turned_back += 1;
                }
                _ => {}
            }
        }
    }
    assert!(turned_back >= 3, "{turned_back}");
    assert!(downwards >= 20, "{downwards}");
}

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

/// If this fails, a stop leaves the shaft dwelling at a resonance, or takes it up through the resonance
/// first.
#[test]
fn stop_amid_a_band_leaves_it_downwards_at_once() {
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
fn stops_do_not_dwell_in_a_band() {
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
