//! The closed form of the braking distance, compared with the brake.

use super::*;
use crate::shaft::blend::State;
use crate::shaft::easing::Easing;

/// Any state from which the shaft can brake: accelerations up to the usual limit, which is above that of the brake.
fn any_state(
    limits: impl Strategy<Value = ShaftLimits>,
) -> impl Strategy<Value = (ShaftLimits, State)> {
    let part = prop_oneof![4 => 0.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.0)];
    (limits, part, -1.0..1.0_f64, 0_u32..4).prop_filter_map(
        "too slow to let the acceleration go",
        |(limits, part, acceleration, kind)| {
            let (ramp, usual) = (&limits.parking, &limits.usual);
            let most = match kind {
                0 => usual.jerk.min(usual.acceleration),
                _ => usual.acceleration,
            };
            let acceleration = (acceleration * most as f64) as i64;
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

    /// An error of a unit would make a stop miss its phase by as much.
    #[test]
    fn the_way_of_a_brake_is_its_sum((limits, from) in any_state(any_limits())) {
        let ramp = &limits.parking;
        let want = ramp.braking_way(from.speed, from.acceleration);
        let (mut state, mut way, mut ticks) = (from, 0_i64, 0);
        while (state.speed, state.acceleration) != (0, 0) {
            let next = state.braked(ramp);
            prop_assert!(next.speed >= 0, "back from {state:?}");
            prop_assert!((next.acceleration - state.acceleration).abs() <= ramp.jerk);
            prop_assert!(next.acceleration.abs() <= ramp.acceleration.max(state.acceleration.abs()));
            state = next;
            way = way.wrapping_add(state.speed);
            ticks += 1;
            prop_assert!(ticks < 1_000_000);
        }
        prop_assert_eq!(way, want, "from {:?} over {} ticks", from, ticks);
    }

    /// The longest ramps that settings accept, by a step of induction; nothing overflows.
    #[test]
    fn a_tick_of_braking_takes_its_speed_of_the_way(
        (limits, state) in any_state(any_limit_settings().prop_map(|(hz, settings)| ShaftLimits::of(&settings, hz))),
        braking in 0_u32..50,
    ) {
        let way = |state: State| limits.parking.braking_way(state.speed, state.acceleration);
        let mut state = state;
        for _ in 0..=braking {
            let next = state.braked(&limits.parking);
            prop_assert!(next.speed >= 0);
            prop_assert_eq!(way(state), way(next).wrapping_add(next.speed), "{:?}", state);
            state = next;
        }
    }

    /// If this were wrong, a stop would begin to brake too late and come a turn later.
    #[test]
    fn easing_takes_no_more_of_the_slack_than_is_reckoned_with((limits, state) in any_state(any_limits())) {
        let easing = Easing::new(state, &limits);
        prop_assume!(easing.is_ready(state, &limits));
        let later = easing.step(state, &limits);
        let way = |state: State| limits.parking.braking_way(state.speed, state.acceleration);
        let taken = way(later).wrapping_add(later.speed).wrapping_sub(way(state));
        prop_assert!(taken <= easing.most_way(state), "{taken} from {state:?} to {easing:?}");
    }
}
