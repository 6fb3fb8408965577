//! The filter against trains of pulses whose edges are known.
//!
//! Widths and ticks are small numbers of cycles, so that changes often fall on a tick's border. As on the board, no tick is shorter than
//! [`MAX_TICK_SHARE`] widths, and a filter whose lines are all quiet is skipped.

use super::*;
use proptest::prelude::*;
use std::vec::Vec;

/// Stretches of a line from time 0 on: the length of each, at the filter's first level and the other one in turn.
type Stretches = Vec<i64>;

/// Filter of one line.
struct Single(IndexFilter<1>);

impl Single {
    fn new(width: u32, level: bool) -> Self {
        Self(IndexFilter::new(width, 1, level.into()))
    }

    fn change(&mut self, cycle: i32, level: bool) {
        self.0.change(cycle.min(-LONG_AGO), level.into());
    }

    fn end_tick(&mut self, cycles: u32) -> Option<IndexPulse> {
        let mut pulses = IndexPulses::NONE;
        if self.0.is_pending() {
            self.0.end_tick(cycles, &mut pulses);
        }
        pulses.of(0)
    }
}

/// Plays a line through a filter, cut into ticks whose lengths repeat, until long after its end. Returns each pulse as
/// the time of its edge and the end of the tick in which it was reported.
///
/// A change on a border is reported before or after the border, as `late_border` selects in turn.
fn play(
    mut filter: Single,
    stretches: &[i64],
    ticks: &[u32],
    late_border: &[bool],
) -> Vec<(i64, i64)> {
    let mut edges: Vec<(i64, bool)> = Vec::new();
    let (mut at, mut level) = (0, filter.0.levels != 0);
    for &stretch in stretches {
        at += stretch;
        level = !level;
        edges.push((at, level));
    }
    let mut edges = edges.into_iter().enumerate().peekable();
    let mut pulses = Vec::new();
    let mut start = 0_i64;
    for &tick in ticks.iter().cycle() {
        let end = start + i64::from(tick);
        while let Some((_, (at, level))) = edges
            .next_if(|&(i, (at, _))| at < end || at == end && !late_border[i % late_border.len()])
        {
            filter.change((at - start) as i32, level);
        }
        if let Some(pulse) = filter.end_tick(tick) {
            pulses.push((start + i64::from(pulse.cycle), end));
        }
        start = end;
        if edges.peek().is_none() && start > at + 10_000 {
            break;
        }
    }
    pulses
}

/// A pulse with glitches before it and dropouts in it.
#[derive(Clone, Debug)]
struct Pulse {
    /// High glitches in the gap before. Each has the length of the low stretch before it beyond the width, and its own
    /// length.
    glitches: Vec<(i64, i64)>,
    gap: i64,
    /// A dropout before the pulse is confirmed: length of the high stretch, then of the low stretch.
    bounce: Option<(i64, i64)>,
    /// Length of the high stretch beyond the width.
    high: i64,
    /// Dropouts after that: length of the low stretch, then of the high stretch.
    dropouts: Vec<(i64, i64)>,
}

/// Glitches and dropouts are below the width `w`, gaps of `gap` and more beyond it.
fn a_pulse(w: i64, gap: i64) -> impl Strategy<Value = Pulse> {
    let many = |first, second| proptest::collection::vec((first, second), 0..4);
    (
        many(0..3 * w, 1..w),
        gap..gap + 4 * w,
        proptest::option::of((1..w, 1..w)),
        0..5 * w,
        many(1..w, 1..3 * w),
    )
        .prop_map(|(glitches, gap, bounce, high, dropouts)| Pulse {
            glitches,
            gap,
            bounce,
            high,
            dropouts,
        })
}

/// A width, and ticks in which it may be used.
fn widths_and_ticks() -> impl Strategy<Value = (i64, Vec<u32>)> {
    (2..40_u32).prop_flat_map(|w| {
        let ticks = proptest::collection::vec(MAX_TICK_SHARE * w..8 * MAX_TICK_SHARE * w, 1..9);
        (Just(w.into()), ticks)
    })
}

/// The train's stretches, and for each pulse the times of its first edge and of its confirmation.
fn train(w: i64, pulses: &[Pulse]) -> (Stretches, Vec<(i64, i64)>) {
    let (mut stretches, mut truth) = (Vec::new(), Vec::new());
    for pulse in pulses {
        for &(before, glitch) in &pulse.glitches {
            stretches.extend([w + before, glitch]);
        }
        stretches.push(w + pulse.gap);
        let first = stretches.iter().sum();
        if let Some((high, low)) = pulse.bounce {
            stretches.extend([high, low]);
        }
        let confirmed: i64 = stretches.iter().sum::<i64>() + w;
        truth.push((first, confirmed));
        stretches.push(w + pulse.high);
        for &(low, high) in &pulse.dropouts {
            stretches.extend([low, high]);
        }
    }
    (stretches, truth)
}

proptest! {
    /// If this fails, a passage of the crank is missed, detected twice or detected at a wrong time, or a glitch is
    /// detected as a passage.
    #[test]
    fn every_pulse_is_reported_once_with_its_first_edge(
        (w, ticks, pulses) in (2..40_i64, 1..8_i64).prop_flat_map(|(w, scale)| {
            let shortest = i64::from(MAX_TICK_SHARE) * w;
            (
                Just(w),
                // No tick is so long that two pulses are confirmed in it, as those are 2 w and the gap apart.
                proptest::collection::vec(shortest as u32..=(shortest * scale) as u32, 1..9),
                proptest::collection::vec(a_pulse(w, shortest * scale), 0..9),
            )
        }),
        late_border: [bool; 7],
    ) {
        let (stretches, truth) = train(w, &pulses);
        let reported = play(Single::new(w as u32, false), &stretches, &ticks, &late_border);
        let firsts: Vec<i64> = truth.iter().map(|&(first, _)| first).collect();
        let actual: Vec<i64> = reported.iter().map(|&(at, _)| at).collect();
        prop_assert_eq!(actual, firsts);
        let max_tick = i64::from(*ticks.iter().max().unwrap());
        for (&(first, confirmed), &(_, end)) in truth.iter().zip(&reported) {
            // The report comes neither before the confirmation, nor later than the end of the tick of the confirmation.
            prop_assert!(confirmed <= end && end < confirmed + max_tick, "{first}, {confirmed}: reported at {end}");
        }
    }

    /// If this fails, noise alone or a stuck line makes pulses.
    #[test]
    fn what_never_lasts_for_the_width_is_no_pulse(
        (w, ticks) in widths_and_ticks(),
        noise in proptest::collection::vec((1..200_i64, 0.0..1.0_f64), 0..60),
        stuck: bool,
    ) {
        // Stuck low with high glitches, or stuck high with dropouts, distinguished from the first change on.
        let glitch = |part: f64| 1 + (part * (w - 1) as f64) as i64;
        let stretches: Stretches = noise
            .iter()
            .flat_map(|&(steady, part)| [steady, glitch(part).min(w - 1)])
            .collect();
        let filter = Single::new(w as u32, stuck);
        prop_assert_eq!(play(filter, &stretches, &ticks, &[false]), []);
    }

    /// For any line there is one pulse for each high stretch that counts after a low stretch that counted, except a second one in a tick.
    /// It is reported with a rise after that low stretch, at most two widths before the high stretch.
    #[test]
    fn noise_moves_a_pulse_by_two_widths_at_most(
        ((w, ticks), stretches) in widths_and_ticks().prop_flat_map(|(w, ticks)| (
            Just((w, ticks)),
            proptest::collection::vec(1..2 * w, 0..80),
        )),
    ) {
        let mut expected = Vec::new();
        let (mut at, mut counted_low, mut low_since) = (0, true, 0);
        for (i, &stretch) in stretches.iter().enumerate() {
            let high = i % 2 == 1;
            if stretch >= w && high && counted_low {
                expected.push((low_since, at));
            }
            at += stretch;
            if stretch >= w {
                counted_low = !high;
                low_since = at;
            }
        }
        if stretches.len() % 2 == 1 && counted_low {
            expected.push((low_since, at)); // it ends high and stays high
        }
        let ends = ticks.iter().cycle().scan(0, |end, &tick| {
            *end += i64::from(tick);
            Some(*end)
        });
        let mut ends = ends.peekable();
        let mut last_end = 0;
        expected.retain(|&(_, stretch)| {
            while ends.next_if(|&end| end < stretch + w).is_some() {}
            let end = *ends.peek().unwrap();
            core::mem::replace(&mut last_end, end) != end
        });
        let reported = play(Single::new(w as u32, false), &stretches, &ticks, &[false]);
        prop_assert_eq!(reported.len(), expected.len());
        for (&(actual, _), &(low_until, stretch)) in reported.iter().zip(&expected) {
            prop_assert!(low_until <= actual && actual <= stretch, "{actual} of {low_until}..{stretch}");
            prop_assert!(actual >= stretch - 2 * w, "{actual}, two widths of {w} before {stretch}");
        }
    }

    /// If this fails, a line is filtered differently beside others, or is skipped while it is not quiet. Only the lines that have a filter
    /// count. Several may change at once, and the first word may change any of them.
    #[test]
    fn a_filter_of_several_lines_reports_the_pulses_of_filters_of_each(
        (w, tick, ticks) in (1..40_u32, 0..200_u32).prop_flat_map(|(w, more)| {
            let tick = MAX_TICK_SHARE * w + more;
            let change = (0..tick as i32, any::<u32>(), any::<u32>());
            let changes = proptest::collection::vec(change, 0..6);
            (Just(w), Just(tick), proptest::collection::vec(changes, 1..40))
        }),
        lines in 1..=MAX_AXES,
        begin: u32,
    ) {
        let mut single: Vec<Single> =
            (0..lines).map(|line| Single::new(w, begin >> line & 1 != 0)).collect();
        let mut joined = IndexFilter::<MAX_AXES>::new(w, lines, begin);
        let mut levels = begin;
        for mut changes in ticks {
            changes.sort_by_key(|&(cycle, ..)| cycle);
            for (cycle, some, others) in changes {
                levels ^= some & others; // a quarter of the lines
                joined.change(cycle, levels);
                for (line, filter) in single.iter_mut().enumerate() {
                    filter.change(cycle, levels >> line & 1 != 0);
                }
            }
            let mut pulses = IndexPulses::NONE;
            if joined.is_pending() {
                joined.end_tick(tick, &mut pulses);
            }
            for (line, filter) in single.iter_mut().enumerate() {
                prop_assert_eq!(pulses.of(line), filter.end_tick(tick), "line {}", line);
            }
            prop_assert_eq!(pulses.axes() >> lines, 0);
        }
    }

    /// Times come from hardware that keeps counting. No time may make the loop panic.
    #[test]
    fn no_time_is_too_wild(
        w: u32,
        level: bool,
        calls in proptest::collection::vec((any::<i32>(), any::<bool>(), any::<u32>()), 0..40),
    ) {
        let mut filter = Single::new(w, level);
        for (cycle, level, tick) in calls {
            filter.change(cycle, level);
            filter.end_tick(tick);
        }
    }
}

/// If this fails, a tick with two pulses reports the second, or both.
#[test]
fn of_two_pulses_in_a_tick_the_first_is_reported() {
    let mut filter = Single::new(10, false);
    for (cycle, level) in [(100, true), (120, false), (140, true), (160, false)] {
        filter.change(cycle, level);
    }
    assert_eq!(filter.end_tick(1000), Some(IndexPulse { cycle: 100 }));
    assert_eq!(filter.end_tick(1000), None);
}

/// A crank that is at its sensor at power-up has not passed it.
#[test]
fn a_line_that_is_high_from_the_start_makes_no_pulse_until_it_has_been_low() {
    let mut filter = Single::new(10, true);
    assert_eq!(filter.end_tick(1000), None);
    filter.change(300, false);
    assert_eq!(filter.end_tick(1000), None);
    filter.change(995, true);
    assert_eq!(filter.end_tick(1000), None);
    assert_eq!(filter.end_tick(1000), Some(IndexPulse { cycle: -5 }));
}
