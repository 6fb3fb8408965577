//! The shortest possible stop, solved in closed form, compared with the shaft's.
//!
//! *Reference.* Interpolate the acceleration linearly from each tick to the next. The shaft's motion is then one of
//! continuous time, within the same limits. Its speed at the end of a tick is v − a/2, as the sum of the trapezia is
//! that of the steps minus half of the last. So the least time T in continuous time from (v − a/2, a) to (0, 0) is a
//! lower bound of the ticks that any shaft needs. Nothing here uses the regulator's own computation.

use super::*;
use crate::shaft::limits::RampLimits;

/// Least time to standstill without acceleration, in ticks.
pub(super) fn min_ticks(ramp: &RampLimits, speed: f64, acceleration: f64) -> f64 {
    let (max, jerk) = (ramp.acceleration as f64, ramp.jerk as f64);
    // A release now ends at this speed; it is below zero only by the two roundings to whole units.
    let let_go = acceleration * acceleration / (2.0 * jerk);
    // From a down to −p at the jerk, and up to zero again, takes away p²/J − a²/2J.
    let peak = (jerk * (speed + let_go)).max(0.0).sqrt();
    let peak = peak.max(-acceleration);
    if peak <= max {
        return (acceleration + 2.0 * peak) / jerk;
    }
    let held = speed + let_go - max * max / jerk;
    (acceleration + 2.0 * max) / jerk + held / max
}

/// Least time from the present state of a shaft.
fn min_ticks_from(watch: &Watch) -> f64 {
    let (speed, acceleration) = (watch.speed as f64, watch.acceleration as f64);
    let fault = &watch.shaft.limits().fault;
    min_ticks(fault, speed - acceleration / 2.0, acceleration)
}

/// Stops for a fault and returns the ticks of motion minus the least. In ticks where `also` is true, a stop at a phase is
/// demanded as well; it must not matter.
fn over_the_min(watch: &mut Watch, also: impl Fn(u64) -> bool) -> f64 {
    let min = min_ticks_from(watch);
    let from = watch.ticks;
    let mut demand = Demand::Stop(None);
    let mut moved = 0;
    loop {
        let motion = watch.advance(demand);
        let number = watch.ticks - from;
        moved += u64::from(motion.speed > Turns::ZERO);
        if motion.at_rest {
            break;
        }
        assert!(
            (number as f64) < min + 10.0,
            "no rest, where {min} ticks are enough"
        );
        demand = Demand::Stop(also(number).then_some(Turns::from_num(0.25)));
    }
    assert_eq!((watch.speed, watch.acceleration), (0, 0));
    moved as f64 - min
}

/// Accepts at most a tick over the least, where two are allowed.
///
/// The lower bound allows two ticks less, in which the shaft is already at rest: one in which the speed is zero, and one
/// in which the acceleration is. A part in 10⁹ allows for the rounding of f64.
fn is_the_shortest(over: f64, ticks: u64) -> bool {
    let rounding = 1e-9 * ticks as f64 + 1e-6;
    (-2.0 - rounding..=1.0 + rounding).contains(&over)
}

proptest! {
    // About every fourth case has no band, or ends at standstill.
    #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..ProptestConfig::default() })]

    /// From any speed and acceleration, inside or outside a band, the stop takes at most the shortest time plus two
    /// ticks. Otherwise cranks that drift apart would turn longer than the motors' torque requires.
    #[test]
    fn a_fault_stop_is_the_shortest(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
    ) {
        let targets = targets(&limits, &speeds);
        prop_assume!(!targets.is_empty());
        let mut watch = Watch::new(limits);
        for &target in &targets[..=cut.index(targets.len())] {
            watch.advance(Demand::Follow(target));
        }
        prop_assume!(watch.speed > 0);
        let over = over_the_min(&mut watch, |_| false);
        prop_assert!(is_the_shortest(over, watch.ticks), "{over} ticks over the least");
    }

    /// If this fails, a fault during a stop at a phase waits for that stop, or starts from a wrong acceleration. A
    /// caller that demands both at once then gets neither.
    #[test]
    fn a_fault_stop_during_another_stop_is_the_shortest(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
        phase in 0.0..1.0_f64,
        part in 0.0..1.0_f64,
        pattern in any::<u64>(),
    ) {
        let targets = targets(&limits, &speeds);
        prop_assume!(!targets.is_empty());
        let mut watch = Watch::new(limits);
        for &target in &targets[..=cut.index(targets.len())] {
            watch.advance(Demand::Follow(target));
        }
        let stop = Demand::Stop(Some(Turns::from_num(phase)));
        let (mut whole, mut ticks) = (watch.shaft.clone(), 0_u64);
        while !whole.advance(stop).at_rest {
            ticks += 1;
        }
        for _ in 0..(ticks as f64 * part) as u64 {
            watch.advance(stop);
        }
        prop_assume!(watch.speed > 0);
        let over = over_the_min(&mut watch, |tick| pattern >> (tick % 64) & 1 == 1);
        prop_assert!(is_the_shortest(over, watch.ticks), "{over} ticks over the least");
    }

    /// If this fails, a fault stop inside a band, on the way up or down, crosses the band first.
    #[test]
    fn a_fault_stop_while_crossing_a_band_is_the_shortest(
        limits in any_limits(),
        up in any::<bool>(),
        part in 0.0..1.0_f64,
    ) {
        prop_assume!(!limits.bands.is_empty());
        let band = limits.bands[0];
        let (from, to) = if up { (band.from, band.to) } else { (band.to, band.from) };
        let follow = |speed| Demand::Follow(Target::steady(Turns::from_bits(speed)));
        let mut watch = Watch::new(limits);
        let mut tries = 0;
        while (watch.speed, watch.acceleration) != (from, 0) {
            watch.advance(follow(from));
            tries += 1;
            prop_assert!(tries < 1_000_000);
        }
        let mut whole = watch.shaft.clone();
        let inside = (0..1_000_000).take_while(|_| whole.advance(follow(to)).speed.to_bits() != to).count();
        for _ in 0..1 + (inside as f64 * part) as usize {
            watch.advance(follow(to));
        }
        let over = over_the_min(&mut watch, |_| false);
        prop_assert!(is_the_shortest(over, watch.ticks), "{over} ticks over the least");
    }
}

/// Fault stops during homing, while starting and at constant speed: speeds of 0.1 to 10 rev/s, at each tick.
#[test]
fn a_fault_stop_during_homing_is_the_shortest() {
    for (speed_hz, stop) in [(60.0, 1.0), (60.0, 8.0), (2.0, 3.0)] {
        let settings = LimitSettings {
            speed_hz,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 500.0,
            stop_acceleration_hz_per_s: 20.0 * stop,
            stop_jerk_hz_per_s2: 500.0 * stop,
            homing_speed_hz: speed_hz / 20.0,
            bands: heapless::Vec::new(),
        };
        let limits = ShaftLimits::from_settings(&settings, 2000);
        let homing_speed = Demand::Follow(Target::steady(limits.homing_speed()));
        for ticks in 1..600 {
            let mut watch = Watch::new(limits.clone());
            for _ in 0..ticks {
                watch.advance(homing_speed);
            }
            let over = over_the_min(&mut watch, |_| false);
            assert!(
                is_the_shortest(over, watch.ticks),
                "{over} ticks after {ticks}"
            );
        }
    }
}

/// A fault stop continues to its end, whatever is demanded then. With equal limits it is the same as any other stop.
#[test]
fn a_fault_stop_completes_before_following_resumes() {
    let mut limits = limits(2000, 60.0, 50.0, 500.0, &[]);
    limits.fault = self::limits(2000, 60.0, 500.0, 50_000.0, &[]).usual;
    let full = Demand::Follow(Target::steady(Turns::from_num(0.02)));
    let mut watch = Watch::new(limits);
    for _ in 0..4000 {
        watch.advance(full);
    }
    watch.advance(Demand::Stop(None));
    let from = watch.ticks;
    while !watch.advance(full).at_rest {}
    // 40 rev/s at 500 rev/s², and 0.01 s for the jerk: 0.09 s.
    assert!(
        (178..=182).contains(&(watch.ticks - from)),
        "{}",
        watch.ticks - from
    );
    watch.advance(full);
    assert!(watch.speed > 0, "and then it is followed again");
}
