//! Forbidden bands in the log: the time of each visit, and the edges that the shaft crossed.

use cophase_files::report;
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::sim::events::EventKind;
use host_sim::sim::simulate;

const FROM_HZ: f64 = 9.0;
const TO_HZ: f64 = 31.0;
const ACCELERATION_HZ_PER_S: f64 = 100.0;
const JERK_HZ_PER_S2: f64 = 1600.0;
const TICK_S: f64 = 0.0005;

/// Returns the events of a program that crosses the band upwards and downwards. A request stops it at the given time.
fn events(stop_s: f64) -> Vec<EventKind> {
    let text = format!(
        "name = \"bands\"\n[machine]\ncrank_radius_mm = 4\nlambda = 0.25\nload_kg = 5\n\
         [limits]\nspeed_hz = 47\nacceleration_hz_per_s = {ACCELERATION_HZ_PER_S}\njerk_hz_per_s2 = {JERK_HZ_PER_S2}\n\
         homing_speed_hz = 4\nband = [{{ from_hz = {FROM_HZ}, to_hz = {TO_HZ} }}]\n\
         [axes]\ncount = 2\ndrive = \"stepper\"\nsteps_per_turn = 800\n\
         [[program]]\namax_g = 24\nhold_s = 0.5\n[[program]]\namax_g = 1\nhold_s = 0.5\n\
         [[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = {stop_s}\ndo = \"stop\"\n"
    );
    let checked = Checked::new(load::parse(&text).unwrap()).unwrap();
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
