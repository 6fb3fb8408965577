//! The shaft's stop at a phase, next to the earliest there is.

use super::earliest::{Coasting, Earliest};
use super::*;

/// How a stop went.
#[derive(Debug)]
pub(super) struct Found {
    /// Ticks over the earliest stop at the same passage.
    pub over: f64,
    /// Ticks that planning within whole units and whole jerks may cost.
    pub margin: f64,
    /// Ticks for which the earliest, too, may be reckoned late.
    pub either: f64,
    /// Turns later than the first passage that a shaft of whole ticks could stand at.
    pub turns_later: i64,
    /// By how much that passage is beyond the fastest brake in whole ticks.
    spare: f64,
    /// By how much planning within whole units may lengthen a brake.
    longer: f64,
}

/// The way of the fastest brake in whole ticks: the regulator's own, to speed 0.
fn least_way(watch: &Watch) -> i64 {
    let ramp = &watch.shaft.limits().usual;
    let (mut state, mut way) = (watch.shaft.state(), 0);
    while state.speed != 0 || state.acceleration > 0 {
        state = state.braked(ramp);
        way += state.speed;
    }
    way
}

/// The greatest speed of a brake: what letting the acceleration go makes of it.
fn greatest_speed(watch: &Watch) -> i64 {
    let risen = watch.shaft.limits().usual.let_go(watch.acceleration.max(0));
    watch.speed + risen
}

/// Stops: the way until the shaft stands, and the ticks for which it moves.
fn stop(watch: &mut Watch, phase: Turns) -> (i64, u64) {
    let top = greatest_speed(watch).max(watch.shaft.limits().creep);
    let (mut moved, mut ticks, mut way) = (0, 0, 0);
    loop {
        let motion = watch.advance(Demand::Stop(Some(phase)));
        ticks += 1;
        way += motion.speed.to_bits();
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
    (way, moved)
}

/// Stops, and says how late that was.
pub(super) fn stop_at(watch: &mut Watch, phase: Turns, earliest: &Earliest) -> Found {
    let (least, top) = (least_way(watch), greatest_speed(watch));
    let passage = phase.wrapping_sub(watch.shaft.phase().within_turn());
    // The first passage that is not nearer than the fastest brake's end.
    let spare = passage.to_bits().wrapping_sub(least) & (ONE_TURN - 1);
    let (acceleration, from) = (watch.acceleration as f64, watch.ticks);
    let (way, moved) = stop(watch, phase);
    let turns_later = (way - least - spare) >> crate::units::FRACTION_BITS;
    let limits = &watch.shaft.limits().usual;
    let (jerk, most) = (limits.jerk as f64, limits.acceleration as f64);
    // Limits that are less by a part make letting go and braking longer by no more than that.
    let gentler = 4.0 / jerk + 2.0 / most;
    let stretched = gentler * (earliest.easing_ticks() + earliest.least_ticks());
    let Some(stand) = earliest.stand(way as f64) else {
        panic!(
            "stood after {} ticks, where nothing gets",
            watch.ticks - from
        );
    };
    let longer = gentler * earliest.least_ticks() * top as f64;
    let rounding = 1e-9 * moved as f64 + 1e-6;
    let spare = spare as f64;
    let (either, less) = match earliest.kind {
        // In whole ticks, from f above a multiple of the jerk, letting go gains f (1 − f/J)/2 more or less than in
        // continuous time: J/8 at most. Within gentler limits it loses a part more.
        Coasting::LetGo => {
            let coasted = stand.coasted / earliest.coasting;
            let less = gentler * acceleration.powi(2) / (2.0 * jerk);
            (coasted * jerk / 8.0, coasted * (jerk / 8.0 + less))
        }
        // By what a gentler brake goes further there is less left to creep: that may well be the beginning, which is
        // slow.
        Coasting::Slow => {
            let creeping = |way: f64| {
                let jerked = 4.0 * (way / (2.0 * jerk)).cbrt();
                jerked + 2.0 * (way / most).sqrt() + way / earliest.coasting
            };
            (0.0, creeping(spare + longer) - creeping(spare))
        }
        // The edge is met. To come to it a little later, in whole ticks and by gentler limits, is even a gain.
        Coasting::BelowBand => (f64::INFINITY, 0.0),
    };
    Found {
        over: moved as f64 - stand.ticks,
        margin: stretched + less + rounding,
        either: either + rounding,
        turns_later,
        spare,
        longer,
    }
}

/// Two ticks over the earliest at most, and not below it but for the two in which the shaft stands already; a turn
/// later only where planning within whole units makes the fastest brake too long.
pub(super) fn is_the_earliest(found: &Found) -> bool {
    let in_time = (-2.0 - found.either..=2.0 + found.margin).contains(&found.over);
    in_time && (found.turns_later == 0 || found.turns_later == 1 && found.spare <= found.longer)
}

/// A program's speeds until somewhere, where the shaft turns.
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

    /// Were it wrong, a machine that is told to park would turn on past the phase at which it could already stand.
    /// From a constant speed, whatever it is.
    #[test]
    fn a_stop_from_a_constant_speed_is_the_earliest(
        limits in any_limits(),
        part in 0.0..1.0_f64,
        phase_bits in 0..ONE_TURN,
    ) {
        let speed = (limits.creep as f64 + part * (limits.speed - limits.creep) as f64) as i64;
        let mut watch = Watch::new(limits);
        watch.start_at(speed);
        let Some(earliest) = Earliest::of(&watch) else { return Err(TestCaseError::reject("at an edge")) };
        let found = stop_at(&mut watch, Turns::from_bits(phase_bits), &earliest);
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }

    /// The same from wherever a program has got to: a speed that rises, falls or is steady, in a band or out of it.
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

    /// The same soon after another stop was called off: states that no program makes.
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
