//! The earliest stop at a phase, next to the shaft's.
//!
//! *Reference.* In continuous time (see [`super::shortest`]) let the acceleration a go first, then coast at the speed
//! c = V + a|a|/2J that is left, then brake in the least time T(c), over c T(c)/2, the ramp being symmetric. Coasting is
//! as long as the way to the passage asks for; the first passage is the first that is not nearer than the two ramps
//! reach. From a constant speed, and from one that still rises, no stop is earlier that does not speed up: the fastest
//! brake lets the acceleration go as well, and what comes after is the greatest speed at every moment. From a speed
//! that falls a stop could be earlier, by braking on; how much is measured.
//!
//! The way that n ticks cover is v − a/6 less than that of n units of continuous time, and in the last two of them the
//! shaft stands already. So it moves for two ticks less than the reference at the least.

use super::shortest::least_ticks;
use super::*;

/// Letting go, coasting and braking, ticks and units of 2⁻⁴⁸ turn.
struct Reference {
    coasting: f64,
    /// Ticks of the two ramps, without coasting.
    ramps: f64,
    /// Ticks of the last one.
    last_ramp: f64,
    /// Turns that the ramps cover.
    way: f64,
}

impl Reference {
    fn new(watch: &Watch) -> Self {
        let ramp = &watch.shaft.limits().usual;
        let (jerk, v, a) = (
            ramp.jerk as f64,
            watch.speed as f64,
            watch.acceleration as f64,
        );
        let speed = v - a / 2.0;
        let letting_go = a.abs() / jerk;
        let coasting = speed + a * letting_go / 2.0;
        let last_ramp = least_ticks(ramp, coasting, 0.0);
        let first_way = letting_go * (speed + a * letting_go / 3.0);
        Self {
            coasting,
            ramps: letting_go + last_ramp,
            last_ramp,
            way: first_way + coasting * last_ramp / 2.0 - v + a / 6.0,
        }
    }

    /// The first passage, a whole number of turns after the one `ahead`, that is not too near.
    fn first(&self, ahead: f64) -> f64 {
        let turn = ONE_TURN as f64;
        ahead + turn * ((self.way - ahead) / turn).ceil()
    }

    fn ticks(&self, way: f64) -> f64 {
        self.ramps + (way - self.way) / self.coasting
    }
}

/// How a stop went.
#[derive(Debug)]
struct Found {
    /// Ticks over the reference's for the same passage.
    over: f64,
    /// Turns later than the reference's first passage.
    turns_later: i64,
    /// Ticks that are allowed for what planning within whole units costs, and for the coasting speed being whole jerks from the
    /// speed now.
    margin: f64,
    /// By how many ticks of coasting the reference's passage was not too near.
    spare: f64,
    /// How many of these the shaft may need: one for letting go in whole ticks, one for a ramp that is two longer, and what
    /// a coasting speed off by up to J/8 adds to the ramp's way.
    needed: f64,
    moved: u64,
}

fn stop_at(watch: &mut Watch, phase: Turns) -> Found {
    let reference = Reference::new(watch);
    let from = watch.shaft.phase();
    let ahead = phase.wrapping_sub(from.within_turn()).to_bits() & (ONE_TURN - 1);
    let first = reference.first(ahead as f64);
    let (mut moved, mut ticks, mut way) = (0, 0, 0.0);
    let most = 10.0 + 3.0 * (reference.ticks(first) + ONE_TURN as f64 / reference.coasting);
    loop {
        let motion = watch.advance(Demand::Stop(Some(phase)));
        ticks += 1;
        way += motion.speed.to_bits() as f64;
        if motion.speed.to_bits() > 0 {
            moved = ticks;
        }
        if motion.at_rest {
            break;
        }
        assert!((ticks as f64) < most, "no rest after {ticks} ticks");
    }
    assert_eq!(watch.shaft.phase().within_turn(), phase);
    let turns_later = ((way - first) / ONE_TURN as f64).round();
    let limits = &watch.shaft.limits().usual;
    let (most, jerk) = (limits.acceleration as f64, limits.jerk as f64);
    let planning = reference.last_ramp * (4.0 / jerk + 2.0 / most);
    let coasted = (way - reference.way).abs() / reference.coasting;
    Found {
        over: moved as f64 - reference.ticks(first + turns_later * ONE_TURN as f64),
        turns_later: turns_later as i64,
        margin: planning + jerk / 8.0 / reference.coasting * (coasted + 2.0),
        spare: (first - reference.way) / reference.coasting,
        needed: 2.0 + planning + jerk / 8.0 / reference.coasting * (reference.last_ramp + 2.0),
        moved,
    }
}

/// Two ticks over the reference at most: a ramp of whole ticks is up to two longer than the shortest. A turn later only
/// where the passage was so near that such a ramp reaches past it.
fn is_the_earliest(found: &Found) -> bool {
    let rounding = 1e-9 * found.moved as f64 + 1e-6;
    let in_time = found.over <= 2.0 + found.margin + rounding;
    match found.turns_later {
        0 => in_time,
        1 => in_time && found.spare <= found.needed,
        _ => false,
    }
}

/// Without bands, whose edges a stop goes to first.
fn free(mut limits: ShaftLimits) -> ShaftLimits {
    limits.bands.clear();
    limits
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..ProptestConfig::default() })]

    /// Were it wrong, a machine that is told to park would turn on past the phase at which it could already stand.
    #[test]
    fn a_stop_from_a_constant_speed_is_at_the_first_passage(
        limits in any_limits(),
        part in 0.0..1.0_f64,
        phase_bits in 0..ONE_TURN,
    ) {
        let limits = free(limits);
        let speed = (limits.creep as f64 + part * (limits.speed - limits.creep) as f64) as i64;
        let mut watch = Watch::new(limits);
        // At the speed from the first tick: how it got there is of no matter.
        watch.shaft.speed = speed;
        watch.shaft.mode = Mode::Follow;
        watch.speed = speed;
        let found = stop_at(&mut watch, Turns::from_bits(phase_bits));
        prop_assert!(found.over >= -2.0 - 1e-6 - 1e-9 * found.moved as f64, "{found:?}");
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }

    /// The same from a speed that rises, or falls: there the reference is what lets the acceleration go first.
    #[test]
    fn a_stop_from_a_ramp_is_at_the_first_passage_once_the_ramp_is_let_go(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
        phase_bits in 0..ONE_TURN,
    ) {
        let limits = free(limits);
        let targets = targets(&limits, &speeds);
        prop_assume!(!targets.is_empty());
        let mut watch = Watch::new(limits.clone());
        for &target in &targets[..=cut.index(targets.len())] {
            watch.advance(Demand::Follow(target));
        }
        prop_assume!(Reference::new(&watch).coasting >= limits.creep as f64 + limits.usual.jerk as f64);
        let found = stop_at(&mut watch, Turns::from_bits(phase_bits));
        prop_assert!(is_the_earliest(&found), "{found:?}");
    }
}

/// The least time to stand from where a shaft is, and the way that it takes.
fn braking_on(watch: &Watch) -> (f64, f64) {
    let ramp = &watch.shaft.limits().usual;
    let (most, jerk) = (ramp.acceleration as f64, ramp.jerk as f64);
    let (mut v, mut a) = (watch.speed as f64, watch.acceleration as f64);
    v -= a / 2.0;
    let all = least_ticks(ramp, v, a);
    let peak = (jerk * (v + a * a / (2.0 * jerk))).sqrt().min(most);
    let (first, last) = ((a + peak) / jerk, peak / jerk);
    let mut way = -(watch.speed as f64) + a / 6.0;
    for (ticks, jerk) in [(first, -jerk), (all - first - last, 0.0), (last, jerk)] {
        way += ticks * (v + ticks * (a / 2.0 + ticks * jerk / 6.0));
        v += ticks * (a + ticks * jerk / 2.0);
        a += ticks * jerk;
    }
    (all, way)
}

/// What letting go first costs where the speed falls: against braking on at once, and coasting for what is then left to
/// the passage at the present speed. It is at most the time that goes into letting go and taking up the acceleration again,
/// A/J, and a turn at the speed that is left. Prints what was found.
#[test]
fn a_stop_from_a_falling_speed_is_later_by_no_more_than_letting_go_and_a_turn() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let machine = (20.0..100.0_f64, 20.0..200.0_f64, 10.0..100.0_f64);
    let cases = (
        machine,
        any_speeds(),
        any::<prop::sample::Index>(),
        0..ONE_TURN,
    );
    let (mut falling, mut others) = (std::vec![], std::vec![]);
    while falling.len() < 2000 {
        let tree = cases.new_tree(&mut runner).expect("a case");
        let ((speed_hz, acceleration, per_s), speeds, cut, phase_bits) = tree.current();
        let limits = limits(2000, speed_hz, acceleration, acceleration * per_s, &[]);
        let targets = targets(&limits, &speeds);
        if targets.is_empty() {
            continue;
        }
        let mut watch = Watch::new(limits.clone());
        for &target in &targets[..=cut.index(targets.len())] {
            watch.advance(Demand::Follow(target));
        }
        let reference = Reference::new(&watch);
        if reference.coasting < (limits.creep + limits.usual.jerk) as f64 {
            continue;
        }
        let (turn, speed) = (ONE_TURN as f64, watch.speed as f64);
        let (least, way) = braking_on(&watch);
        let phase = Turns::from_bits(phase_bits);
        let ahead = phase
            .wrapping_sub(watch.shaft.phase().within_turn())
            .to_bits()
            & (ONE_TURN - 1);
        let first = ahead as f64 + turn * ((way - ahead as f64) / turn).ceil();
        let a = watch.acceleration;
        let found = stop_at(&mut watch, phase);
        let late = found.moved as f64 - (least + (first - way) / speed.max(reference.coasting));
        if a < 0 {
            let letting_go = limits.usual.acceleration as f64 / limits.usual.jerk as f64;
            let most = letting_go + turn / reference.coasting + 2.0 + found.margin;
            // Coasting is slower than the present speed, at which the bound has it.
            let slower = (first + turn - way) * (1.0 / reference.coasting - 1.0 / speed);
            assert!(
                late <= most + slower,
                "{late} ticks late, over {most} and {slower}"
            );
            falling.push((late, found.turns_later));
        } else {
            others.push((late, found.turns_later));
        }
    }
    for (name, mut found) in [("falling", falling), ("steady or rising", others)] {
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |part: f64| found[((found.len() - 1) as f64 * part) as usize].0;
        let turns = found.iter().filter(|found| found.1 > 0).count();
        std::println!(
            "{name}: {} stops; ticks late: least {:.1}, half {:.1}, nine of ten {:.1}, most {:.1}; {turns} a turn after the reference",
            found.len(),
            at(0.0),
            at(0.5),
            at(0.9),
            at(1.0)
        );
    }
}
