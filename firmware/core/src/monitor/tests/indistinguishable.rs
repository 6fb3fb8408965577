//! Pairs of machines whose pulses are the same: a sound one, and one with a fault that an index alone cannot show.

use super::*;

/// Ticks per turn, and ticks that are played: homing, and some turns more.
const TICKS: u32 = 2000;
const PLAYED: u32 = 5 * TICKS;

/// Beginning and length of the flag of the crank that differs, turns. The gate is 0.0053 turns. Flags may be wider, or narrower.
const FLAGS: [(f64, f64); 3] = [(0.4, 0.2), (0.49, 0.02), (0.498, 0.004)];

/// Tick of each pulse of a line, whose level follows the position of a crank over its flag.
fn pulses((begins, length): (f64, f64), position: impl Fn(f64) -> f64) -> Vec<u32> {
    // In the middle of a tick, no flag has an end.
    let at = |tick: u32| position((f64::from(tick) - 0.5) / f64::from(TICKS));
    let is_high = |tick: u32| (at(tick) - begins).rem_euclid(1.0) < length;
    let rises = (1..=PLAYED).filter(|&tick| is_high(tick) && !is_high(tick - 1));
    rises.collect()
}

/// Findings of a monitor of three cranks, of which the last has these pulses and the others are sound, and the phase error of the last.
fn found_by(flag: (f64, f64), last: &[u32]) -> (Vec<(i32, FaultKind, bool)>, f64) {
    let mut settings = settings(3, 3.0, 5.0, 15.0);
    settings.axes[2].index_turns = Some(flag.0);
    settings.axes[2].index_width_turns = flag.1;
    let mut cranks = Cranks::new(configured(&settings), 1.0 / f64::from(TICKS));
    let mut tick = 0;
    let mut found = Vec::new();
    for _ in 0..PLAYED {
        tick += 1;
        let is_pulse = last.contains(&tick);
        let own = |i: usize, _: f64, pulse: Option<IndexPulse>| {
            let last = is_pulse.then_some(IndexPulse { cycle: 0 });
            if i == 2 { last } else { pulse }
        };
        let new = cranks.turn_with(1, |_, _| 0.0, own);
        found.extend(
            new.iter()
                .map(|(tick, finding)| (*tick, finding.fault.kind, finding.within_limits)),
        );
    }
    (found, cranks.monitor.phase_error()[2].to_num())
}

/// If this fails, an index alone distinguishes a crank that turns back from one that turns right, and the monitor can stop the first. The
/// two are mirror images in the middle of the flag, so that the width of the flag shows nothing.
#[test]
fn a_crank_that_turns_back_makes_the_pulses_of_one_that_was_left_elsewhere() {
    for flag in FLAGS {
        let ahead = 2.0 * flag.0 + flag.1 - 1.0;
        let back = pulses(flag, |phase| -phase);
        assert_eq!(back, pulses(flag, |phase| phase + ahead), "{flag:?}");
        // Both turn as commanded, ahead and back.
        let swings = |phase: f64| (phase / 2.0).sin();
        let sound = pulses(flag, |phase| swings(phase) + ahead);
        assert_eq!(pulses(flag, |phase| -swings(phase)), sound, "{flag:?}");
        let (found, error) = found_by(flag, &back);
        assert_eq!(found, [], "{flag:?}");
        assert!((error - ahead).abs() < 0.002, "{flag:?}: {error}");
    }
}

/// If this fails, an index alone distinguishes a crank that gains a whole turn from a sound one whose line gets one pulse of noise.
#[test]
fn a_crank_that_gains_a_whole_turn_makes_the_pulses_of_a_sound_one_and_noise() {
    for flag in FLAGS {
        let fast = pulses(flag, |phase| phase + ((phase - 1.1) / 0.25).clamp(0.0, 1.0));
        let mut sound = pulses(flag, |phase| phase);
        let noise = fast.iter().copied().find(|tick| !sound.contains(tick));
        sound.extend(noise);
        sound.sort_unstable();
        assert_eq!(fast, sound, "{flag:?}");
        let (found, error) = found_by(flag, &fast);
        let kinds: Vec<_> = found
            .iter()
            .map(|&(_, kind, within_limits)| (kind, within_limits))
            .collect();
        assert_eq!(kinds, [(FaultKind::IndexExtra, true)], "{flag:?}");
        assert!(error.abs() < 0.002, "{flag:?}: {error}");
    }
}
