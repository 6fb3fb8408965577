//! Cranks that slip on their shafts, which their encoders do not see, and sensors that only seem to say so.

use super::*;

/// Plays ticks in which encoders read what was commanded; crank i is off by `slipped(i, turns)`, and `sensor` makes of its pulses what
/// it likes.
fn play(
    cranks: &mut Cranks<3>,
    ticks: u32,
    slipped: impl Fn(usize, f64) -> f64,
    sensor: impl Fn(usize, f64, Option<IndexPulse>) -> Option<IndexPulse>,
) -> Vec<(FaultKind, Option<usize>, bool)> {
    let mut found = Vec::new();
    for _ in 0..ticks {
        let at = |tick: u32| f64::from(tick) * cranks.speed;
        let (start, end) = (at(cranks.tick), at(cranks.tick + 1));
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(cranks.speed),
        };
        let pulses = core::array::from_fn(|i| {
            let (from, to) = (start + slipped(i, start), end + slipped(i, end));
            let pulse = (to.floor() > from.floor()).then(|| IndexPulse {
                cycle: ((to.floor() - from) / (to - from) * f64::from(TICK_CYCLES)) as i32,
            });
            sensor(i, end, pulse)
        });
        let counts = [(end * 3200.0).floor() as i32; 3];
        let heard = hear(&mut cranks.monitor, &pulses, &counts, &[phase; 3]);
        found.extend(heard.map(|told| (told.fault.kind, told.fault.axis, told.in_safety)));
        cranks.tick += 1;
    }
    found
}

/// Were it wrong, a crank that falls back fast on its shaft would first be a missing index, which only is reported, and stop the machine a
/// turn later.
#[test]
fn a_fast_slip_stops_the_machine_as_its_flag_comes() {
    let mut cranks = encoders(3.0);
    let slip = |i: usize, t: f64| {
        if i == 0 {
            -0.03 * (t - 2.3).max(0.0)
        } else {
            0.0
        }
    };
    let ticks = (3.1 / cranks.speed) as u32 - cranks.tick;
    let found = play(&mut cranks, ticks, slip, |_, _, pulse| pulse);
    assert!(
        found.contains(&(FaultKind::Slip, Some(0), false)),
        "{found:?}"
    );
}

/// Were it wrong, a crank that slipped once, by little, would never be vouched for by its encoder again: a pulse that is lost long after
/// would stop a sound machine; and whatever takes it past a limit years later would be called a slip.
#[test]
fn a_slip_of_long_ago_is_not_why_a_pulse_is_missing() {
    let mut cranks = encoders(30.0);
    let slip = |i: usize, t: f64| {
        let slipped = -0.0007 * (t - 2.0).clamp(0.0, 10.0);
        if i == 0 { slipped } else { 0.0 }
    };
    let ticks = (20.5 / cranks.speed) as u32;
    let found = play(&mut cranks, ticks, slip, |_, _, pulse| pulse);
    assert!(!found.is_empty());
    assert_eq!(cranks.monitor.axes[0].name(), None);
    let once = |i: usize, t: f64, pulse: Option<IndexPulse>| {
        pulse.filter(|_| i != 0 || !(22.5..23.5).contains(&t))
    };
    let ticks = (3.0 / cranks.speed) as u32;
    let found = play(&mut cranks, ticks, slip, once);
    assert_eq!(found, [(FaultKind::IndexMissing, Some(0), true)]);
}

/// Were it wrong, noise somewhere in the turn after a pulse was lost would be a crank that moved there, whatever its encoder says.
#[test]
fn a_pulse_lost_and_noise_after_it_are_no_slip() {
    let mut cranks = encoders(3.0);
    let sensor = |i: usize, t: f64, pulse: Option<IndexPulse>| {
        if i != 1 {
            return pulse;
        }
        let noise = (t - 3.3).abs() < 0.0051;
        let pulse = pulse.filter(|_| !(2.5..3.5).contains(&t));
        pulse.or(noise.then_some(IndexPulse { cycle: 100 }))
    };
    let found = play(&mut cranks, 700, |_, _| 0.0, sensor);
    assert!(!found.is_empty());
    assert!(found.iter().all(|told| told.2), "{found:?}");
}
