//! The shaft's stop at a phase, compared with the earliest possible one.

use super::earliest::{Coasting, Earliest};
use super::*;
use crate::shaft::easing::Easing;
use crate::shaft::gain::Step;

/// Result of a stop.
#[derive(Debug)]
pub(super) struct Found {
    /// Ticks over the earliest stop at the same passage.
    pub over: f64,
    /// Ticks that planning in whole units and whole jerks may cost.
    pub margin: f64,
    /// Ticks by which the reference itself may be computed late.
    pub either: f64,
    /// Turns later than the first passage at which a shaft of whole ticks could stop.
    pub turns_later: i64,
    /// Distance from the end of the fastest brake in whole ticks to that passage.
    spare: f64,
    /// Distance by which easing before the first brake, and planning in whole units, may lengthen a brake.
    longer: f64,
}

/// Distance of the fastest brake in whole ticks, that of the regulator to speed 0.
fn min_distance(watch: &Watch) -> i64 {
    let ramp = &watch.shaft.limits().usual;
    let (mut state, mut distance) = (watch.shaft.state(), 0);
    let mut near = Step::ZERO;
    while state.speed != 0 || state.acceleration > 0 {
        state = state.braked(ramp, &mut near);
        distance += state.speed;
    }
    distance
}

/// Greatest speed during a brake: the speed after releasing the acceleration.
fn max_speed(watch: &Watch) -> i64 {
    let risen = watch.shaft.limits().usual.let_go(watch.acceleration.max(0));
    watch.speed + risen
}

/// Stops; returns the distance until standstill, and the ticks for which the shaft moves.
fn stop(watch: &mut Watch, phase: Turns) -> (i64, u64) {
    let top = max_speed(watch).max(watch.shaft.limits().homing_speed);
    let (mut moved, mut ticks, mut distance) = (0, 0, 0);
    loop {
        let motion = watch.advance(Demand::Stop(Some(phase)));
        ticks += 1;
        distance += motion.speed.to_bits();
        assert!(motion.speed.to_bits() <= top, "speeds up beyond {top}");
        if motion.speed > Turns::ZERO {
            moved = ticks;
        }
        if motion.at_rest {
            break;
        }
        assert!(ticks < 10_000_000, "no rest");
    }
    assert_eq!(watch.shaft.phase().within_turn(), phase);
    (distance, moved)
}

/// Ticks for which the shaft eases before it can begin a brake: the plan is one tick ahead, and measures a tick earlier.
const AHEAD_TICKS: i64 = 3;

/// Stops, and compares the result with the earliest stop.
pub(super) fn stop_at(watch: &mut Watch, phase: Turns, earliest: &Earliest) -> Found {
    let (min, top) = (min_distance(watch), max_speed(watch));
    let easing = Easing::new(watch.shaft.state(), watch.shaft.limits());
    let eased = AHEAD_TICKS * easing.longest_distance(watch.shaft.state());
    let passage = phase.wrapping_sub(watch.shaft.phase().within_turn());
    // The first passage that is not nearer than the fastest brake's end.
    let spare = passage.to_bits().wrapping_sub(min) & (ONE_TURN - 1);
    let (acceleration, from) = (watch.acceleration as f64, watch.ticks);
    let (distance, moved) = stop(watch, phase);
    let turns_later = (distance - min - spare) >> crate::units::FRACTION_BITS;
    let limits = &watch.shaft.limits().usual;
    let (jerk, max) = (limits.jerk as f64, limits.acceleration as f64);
    // Limits that are gentler by a share lengthen release and brake by no more than that share.
    let gentler = 4.0 / jerk + 2.0 / max;
    let stretched = gentler * (earliest.easing_ticks() + earliest.min_ticks());
    let Some(stand) = earliest.stand(distance as f64) else {
        panic!(
            "stood after {} ticks, where nothing gets",
            watch.ticks - from
        );
    };
    let longer = gentler * earliest.min_ticks() * top as f64;
    let rounding = 1e-9 * moved as f64 + 1e-6;
    let spare = spare as f64;
    let (either, less) = match earliest.kind {
        // In whole ticks, from f above a multiple of the jerk, a release gains f (1 − f/J)/2 more or less than in
        // continuous time: J/8 at most. Gentler limits lose a share more.
        Coasting::LetGo => {
            let coasted = stand.coasted / earliest.coasting;
            let less = gentler * acceleration.powi(2) / (2.0 * jerk);
            (coasted * jerk / 8.0, coasted * (jerk / 8.0 + less))
        }
        // A gentler brake goes further, so that less distance is left at homing speed. That distance may be at the
        // beginning, which is slow.
        Coasting::Slow => {
            let slow_end = |distance: f64| {
                let jerked = 4.0 * (distance / (2.0 * jerk)).cbrt();
                jerked + 2.0 * (distance / max).sqrt() + distance / earliest.coasting
            };
            (0.0, slow_end(spare + longer) - slow_end(spare))
        }
        // The edge is met. Reaching it a little later, in whole ticks and by gentler limits, is even a gain.
        Coasting::BelowBand => (f64::INFINITY, 0.0),
    };
    Found {
        over: moved as f64 - stand.ticks,
        margin: stretched + less + rounding,
        either: either + rounding,
        turns_later,
        spare,
        longer: longer + eased as f64,
    }
}

/// Accepts at most two ticks over the earliest. The lower bound allows the two ticks in which the shaft is already at
/// rest.
pub(super) fn is_the_earliest(found: &Found) -> bool {
    let in_time = (-2.0 - found.either..=2.0 + found.margin).contains(&found.over);
    in_time && found.is_at_first_passage()
}

impl Found {
    /// True unless the shaft passed the phase where the first brake that can be planned would have ended in time.
    pub fn is_at_first_passage(&self) -> bool {
        let earlier = (self.turns_later - 1) as f64 * ONE_TURN as f64;
        self.turns_later == 0 || self.spare + earlier <= self.longer
    }
}

/// Runs a program up to a random tick; returns nothing if the shaft is at rest there.
fn run(
    limits: &ShaftLimits,
    speeds: &[(f64, u32, u32)],
    cut: prop::sample::Index,
) -> Option<Watch> {
    let targets = targets(limits, speeds);
    if targets.is_empty() {
        return None;
    }
    let mut watch = Watch::new(limits.clone());
    for &target in &targets[..=cut.index(targets.len())] {
        watch.advance(Demand::Follow(target));
    }
    (watch.speed > 0).then_some(watch)
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 1_000_000, ..ProptestConfig::default() })]

    /// From any constant speed. If this fails, a machine that is to park turns beyond the phase at which it can already
    /// stop.
    #[test]
    fn a_stop_from_a_constant_speed_is_the_earliest(
        limits in any_limits(),
        part in 0.0..1.0_f64,
        phase_bits in 0..ONE_TURN,
    ) {
        let speed = (limits.homing_speed as f64 + part * (limits.speed - limits.homing_speed) as f64) as i64;
        let mut watch = Watch::new(limits);
        watch.start_at(speed);
        let Some(earliest) = Earliest::of(&watch) else { return Err(TestCaseError::reject("at an edge")) };
        let found = stop_at(&mut watch, Turns::from_bits(phase_bits), &earliest);
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }

    /// The same from any point of a program: a speed that rises, falls or is constant, inside or outside a band.
    #[test]
    fn a_stop_from_anywhere_is_the_earliest(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
        phase_bits in 0..ONE_TURN,
    ) {
        let Some(mut watch) = run(&limits, &speeds, cut) else { return Err(TestCaseError::reject("stands")) };
        let Some(earliest) = Earliest::of(&watch) else { return Err(TestCaseError::reject("at an edge")) };
        let found = stop_at(&mut watch, Turns::from_bits(phase_bits), &earliest);
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }

    /// The same soon after another stop was cancelled, from states that no program reaches.
    #[test]
    fn a_stop_after_another_is_the_earliest(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
        phases in (0..ONE_TURN, 0..ONE_TURN),
        part in 0.0..1.0_f64,
        following in 1_u32..30,
    ) {
        let Some(mut watch) = run(&limits, &speeds, cut) else { return Err(TestCaseError::reject("stands")) };
        let other = Demand::Stop(Some(Turns::from_bits(phases.0)));
        let (mut whole, mut ticks) = (watch.shaft.clone(), 0);
        while !whole.advance(other).at_rest {
            ticks += 1;
        }
        for _ in 0..(part * f64::from(ticks)) as u32 {
            watch.advance(other);
        }
        let speed = Turns::from_bits(watch.speed / 2);
        for _ in 0..following {
            watch.advance(Demand::Follow(Target::steady(speed)));
        }
        prop_assume!(watch.speed > 0);
        let Some(earliest) = Earliest::of(&watch) else { return Err(TestCaseError::reject("at an edge")) };
        let found = stop_at(&mut watch, Turns::from_bits(phases.1), &earliest);
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }
}
