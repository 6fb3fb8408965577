//! The closed form of the braking distance, compared with the brake.

use super::*;
use crate::shaft::blend::State;
use crate::shaft::easing::Easing;
use crate::shaft::gain::Step;

/// Any state from which the shaft can brake: accelerations up to the usual limit, which is above that of the brake.
fn any_state(
    limits: impl Strategy<Value = ShaftLimits>,
) -> impl Strategy<Value = (ShaftLimits, State)> {
    let part = prop_oneof![4 => 0.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.0)];
    (limits, part, -1.0..1.0_f64, 0_u32..4).prop_filter_map(
        "too slow to let the acceleration go",
        |(limits, part, acceleration, kind)| {
            let (ramp, usual) = (&limits.parking, &limits.usual);
            let max = match kind {
                0 => usual.jerk.min(usual.acceleration),
                _ => usual.acceleration,
            };
            let acceleration = (acceleration * max as f64) as i64;
            let speed = match kind {
                // The speed is just enough for the release.
                1 => ramp.let_go(acceleration.abs()),
                _ => (part * part * limits.speed as f64) as i64,
            };
            let state = State {
                speed: speed.min(limits.speed),
                acceleration,
            };
            ramp.can_brake(state.speed, acceleration)
                .then_some((limits, state))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 1_000_000, ..ProptestConfig::default() })]

    /// If this fails, a stop misses its phase by the error of the distance, even if that is a single unit.
    #[test]
    fn braking_distance_is_the_sum_of_speeds((limits, from) in any_state(any_limits())) {
        let ramp = &limits.parking;
        let expected = ramp.braking_distance(from.speed, from.acceleration);
        let (mut state, mut distance, mut ticks) = (from, 0_i64, 0);
        let mut near = Step::ZERO;
        while (state.speed, state.acceleration) != (0, 0) {
            let next = state.braked(ramp, &mut near);
            prop_assert!(next.speed >= 0, "back from {state:?}");
            prop_assert!((next.acceleration - state.acceleration).abs() <= ramp.jerk);
            prop_assert!(next.acceleration.abs() <= ramp.acceleration.max(state.acceleration.abs()));
            state = next;
            distance = distance.wrapping_add(state.speed);
            ticks += 1;
            prop_assert!(ticks < 1_000_000);
        }
        prop_assert_eq!(distance, expected, "from {:?} over {} ticks", from, ticks);
    }

    /// The longest ramps that settings accept, by a step of induction; nothing overflows.
    #[test]
    fn a_tick_of_braking_shortens_the_distance_by_its_speed(
        (limits, state) in any_state(any_limit_settings().prop_map(|(hz, settings)| ShaftLimits::from_settings(&settings, hz))),
        braking in 0_u32..50,
    ) {
        let distance = |state: State| limits.parking.braking_distance(state.speed, state.acceleration);
        let mut state = state;
        let mut near = Step::ZERO;
        for _ in 0..=braking {
            let next = state.braked(&limits.parking, &mut near);
            prop_assert!(next.speed >= 0);
            prop_assert_eq!(distance(state), distance(next).wrapping_add(next.speed), "{:?}", state);
            state = next;
        }
    }

    /// If this fails, a stop begins to brake too late and comes a turn later.
    #[test]
    fn easing_takes_no_more_slack_than_computed((limits, state) in any_state(any_limits())) {
        let easing = Easing::new(state, &limits);
        prop_assume!(easing.is_ready(state, &limits));
        let later = easing.step(state, &limits, &mut { Near::ZERO });
        let distance = |state: State| limits.parking.braking_distance(state.speed, state.acceleration);
        let taken = distance(later).wrapping_add(later.speed).wrapping_sub(distance(state));
        prop_assert!(taken <= easing.longest_distance(state), "{taken} from {state:?} to {easing:?}");
    }
}
