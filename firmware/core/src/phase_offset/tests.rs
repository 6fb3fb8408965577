use super::*;
use crate::settings::sample;
use proptest::prelude::*;
use std::vec::Vec;

/// Offsets of axes with these steps per turn.
fn offsets(steps_per_turn: &[u32], rate_hz: f64, limit_turns: f64) -> PhaseOffsets {
    let mut settings = sample::settings(steps_per_turn.len());
    for (axis, &steps) in settings.axes.iter_mut().zip(steps_per_turn) {
        axis.steps_per_turn = steps;
        axis.trim_rate_hz = rate_hz;
        axis.trim_limit_turns = limit_turns;
    }
    let mut offsets = PhaseOffsets::new();
    offsets.configure(&settings);
    offsets
}

/// Moves all axes to their targets. Returns the steps that each has made, and the ticks.
fn finish(offsets: &mut PhaseOffsets) -> (PerAxis<f64>, u32) {
    let (mut made, mut ticks) = ([0_i128; MAX_AXES], 0);
    while !offsets.is_idle() {
        if let Some(motion) = offsets.advance(true) {
            made[motion.axis] += i128::from(motion.half_steps);
        }
        ticks += 1;
        assert!(ticks < 1_000_000, "the move does not end");
    }
    (made.map(|made| made as f64 / STEP as f64), ticks)
}

proptest! {
    /// If this fails, an axis does not end on the whole step nearest to its target, or axes of equal steps no longer have the sum zero.
    #[test]
    fn moves_end_on_whole_steps(
        count in 2_usize..=6,
        steps_per_turn in 200_u32..20_000,
        rate_hz in 0.001_f64..1.0,
        parts in prop::collection::vec(-0.016_f64..0.016, 6),
    ) {
        let mut offsets = offsets(&std::vec![steps_per_turn; count], rate_hz, 0.1);
        let mut target = [Turns::ZERO; MAX_AXES];
        let mut rest = Turns::ZERO;
        for (target, part) in target.iter_mut().zip(&parts).take(count - 1) {
            *target = Turns::from_num(*part);
            rest -= *target;
        }
        target[count - 1] = rest;
        offsets.go_to(&target);
        let (made, _) = finish(&mut offsets);
        prop_assert_eq!(made.iter().sum::<f64>(), 0.0);
        for ((made, target), now) in made.iter().zip(&target).zip(offsets.now()) {
            prop_assert_eq!(made.fract(), 0.0);
            let exact = target.to_num::<f64>() * f64::from(steps_per_turn);
            prop_assert!((made - exact).abs() < 1.0, "{made} of {exact}");
            let moved = now.to_num::<f64>() * f64::from(steps_per_turn);
            prop_assert!((made - moved).abs() < 1e-6, "{made} of {moved}");
        }
    }

    /// If this fails, the user's and the controller's part together exceed the limit of an axis, in some order or by rounding.
    #[test]
    fn user_and_controller_offsets_share_one_limit(
        user in -0.03_f64..0.03,
        controller in -0.03_f64..0.03,
        limit_turns in 0.0_f64..0.03,
        user_first: bool,
    ) {
        let mut offsets = offsets(&[400, 700], 1.0, limit_turns);
        let controller = Turns::from_num(controller);
        let target = [controller, -controller, Turns::ZERO, Turns::ZERO, Turns::ZERO, Turns::ZERO];
        let user = Turns::from_num(user);
        let mut whole = true;
        if user_first {
            whole = offsets.set_user(0, user);
        }
        let is_within = offsets.beyond_limit(&target).is_none();
        if is_within {
            offsets.go_to(&target);
        }
        if !user_first {
            whole = offsets.set_user(0, user);
        }
        let mut moved = [0_i128; 2];
        for _ in 0..200_000 {
            if let Some(motion) = offsets.advance(true) {
                moved[motion.axis] += i128::from(motion.half_steps);
                for (moved, steps) in moved.iter().zip([400.0, 700.0]) {
                    let turns = *moved as f64 / STEP as f64 / steps;
                    prop_assert!(turns.abs() <= limit_turns + 1e-12, "{turns} of {limit_turns}");
                }
            }
        }
        prop_assert!(offsets.is_idle());
        if whole && is_within {
            let exact = (user + controller).to_num::<f64>() * 400.0;
            prop_assert!((moved[0] as f64 / STEP as f64 - exact).abs() <= 2.0);
        }
    }
}

/// If this fails, several axes move by their offsets in one tick, and the planner needs a different plan for each.
#[test]
fn one_axis_moves_at_a_time_within_its_rate() {
    let (hz, rate_hz) = (2000.0, 0.05);
    let mut offsets = offsets(&[3200; 6], rate_hz, 0.1);
    let target = [0.02, -0.01, 0.005, -0.02, 0.01, -0.005].map(Turns::from_num);
    offsets.go_to(&target);
    let mut positions: Vec<PerAxis<f64>> = Vec::new();
    let mut position = [0.0; MAX_AXES];
    while offsets.is_moving() {
        if let Some(motion) = offsets.advance(true) {
            position[motion.axis] += motion.half_steps as f64 / STEP as f64;
        }
        positions.push(position);
    }
    // No axis is faster than its rate, from any tick to the same place in the next round.
    let round = 6 * offsets.slot_ticks as usize;
    let max = rate_hz / hz * 3200.0 * round as f64;
    for (first, second) in positions.iter().zip(positions.iter().skip(round)) {
        for (first, second) in first.iter().zip(second) {
            assert!((second - first).abs() <= max + 1e-9);
        }
    }
    let duration_s = positions.len() as f64 / hz;
    let min_s = 0.02 / rate_hz;
    assert!(duration_s < 1.3 * min_s, "{duration_s} s of {min_s} s");
    // All axes are on the straight line, within the steps of one or two slots.
    for (tick, position) in positions.iter().enumerate() {
        let part = tick as f64 / positions.len() as f64;
        for (steps, target) in position.iter().zip(&target) {
            let line = part * target.to_num::<f64>() * 3200.0;
            assert!((steps - line).abs() < 4.0, "{steps} of {line}");
        }
    }
}

#[test]
fn an_interrupted_move_is_held_at_a_whole_step() {
    let mut offsets = offsets(&[3200; 3], 0.01, 0.1);
    let target = [0.01, -0.01, 0.0, 0.0, 0.0, 0.0].map(Turns::from_num);
    offsets.go_to(&target);
    let mut made = 0_i128;
    while offsets.displaced().is_none() {
        let motion = offsets.advance(true);
        made += motion.map_or(0, |motion| i128::from(motion.half_steps));
    }
    offsets.hold();
    assert!(!offsets.is_moving());
    while let Some(motion) = offsets.advance(true) {
        made += i128::from(motion.half_steps);
    }
    assert_eq!(offsets.displaced(), None);
    assert_eq!(
        made,
        i128::from(STEP),
        "the step that was begun is completed"
    );
}

#[test]
fn an_axis_that_does_not_exist_has_no_offset() {
    let mut offsets = offsets(&[3200; 2], 0.01, 0.1);
    assert!(!offsets.set_user(2, Turns::ZERO));
    assert!(offsets.set_user(1, Turns::from_num(0.099)));
    assert!(!offsets.set_user(1, Turns::from_num(0.11)));
}

proptest! {
    /// If this fails, some axes of a correction move on while others wait for a trim: the platform tilts further than at either end, or a move
    /// never ends.
    #[test]
    fn corrections_stay_together_while_trims_move(
        limit_turns in 0.02_f64..0.06,
        rate_hz in 0.01_f64..0.5,
        trims in prop::collection::vec((0..3_usize, -0.06_f64..0.06, 0..3000_u32), 4),
        corrections in prop::collection::vec((-0.02_f64..0.02, -0.02_f64..0.02, 0..3000_u32), 3),
    ) {
        let mut offsets = offsets(&[3200; 3], rate_hz, limit_turns);
        let mut trims = trims.into_iter().map(|(axis, by, at)| (at, axis, Turns::from_num(by))).collect::<Vec<_>>();
        let mut corrections = corrections.into_iter().map(|(a, b, at)| (at, a, b)).collect::<Vec<_>>();
        trims.sort_unstable_by_key(|trim| trim.0);
        corrections.sort_unstable_by_key(|correction| correction.0);
        let slot = offsets.lanes[0].slot_steps;
        let mut tick = 0;
        while tick < 3000 || !offsets.is_idle() {
            for &(_, axis, by) in trims.iter().filter(|trim| trim.0 == tick) {
                let _whole = offsets.set_user(axis, by);
            }
            for &(_, a, b) in corrections.iter().filter(|correction| correction.0 == tick) {
                let mut target = [Turns::ZERO; MAX_AXES];
                (target[0], target[1]) = (Turns::from_num(a), Turns::from_num(b));
                target[2] = Turns::ZERO - target[0] - target[1];
                if !offsets.is_moving() && offsets.beyond_limit(&target).is_none() {
                    offsets.go_to(&target);
                }
            }
            offsets.advance(true);
            let sum = offsets.now().iter().map(|turns| turns.to_num::<f64>()).sum::<f64>();
            let steps = (sum * 3200.0).abs();
            prop_assert!(steps <= 2.0 * f64::from(slot) + 1.0 + 1e-6, "{steps} steps, {slot} in a slot");
            tick += 1;
            prop_assert!(tick < 400_000, "the moves do not end");
        }
    }
}
