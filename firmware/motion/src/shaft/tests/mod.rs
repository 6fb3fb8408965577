//! Properties of the shaft, checked only on the phases of its ticks.

mod at_phase;
mod braking;
mod earliest;
mod how_late;
mod shortest;

use super::*;
use crate::settings::{BandSettings, LimitSettings};
use crate::units::ONE_TURN;
use proptest::prelude::*;
use std::vec::Vec;

/// A shaft whose differences of phases are checked against the limits in each tick.
#[derive(Clone)]
struct Watch {
    shaft: Shaft,
    speed: i64,
    acceleration: i64,
    ticks: u64,
    /// A fault stop has been demanded and is not over.
    fault_stop: bool,
}

impl Watch {
    fn new(limits: ShaftLimits) -> Self {
        Self {
            shaft: Shaft::new(limits),
            speed: 0,
            acceleration: 0,
            ticks: 0,
            fault_stop: false,
        }
    }

    /// Starts at a speed, without a ramp.
    fn start_at(&mut self, speed: i64) {
        self.shaft.speed = speed;
        self.shaft.mode = Mode::Follow;
        self.speed = speed;
    }

    fn advance(&mut self, demand: Demand) -> Motion {
        let before = self.shaft.phase();
        self.fault_stop |= demand == Demand::Stop(None);
        let motion = self.shaft.advance(demand);
        let speed = self.shaft.phase().since(before).to_bits();
        let acceleration = speed - self.speed;
        let jerk = acceleration - self.acceleration;
        let limits = self.shaft.limits();
        let ramp = if self.fault_stop {
            &limits.fault
        } else {
            &limits.usual
        };
        assert!(
            speed >= 0,
            "tick {}: the shaft turns back by {speed}",
            self.ticks
        );
        assert!(speed <= limits.speed, "tick {}: speed {speed}", self.ticks);
        assert!(
            acceleration.abs() <= ramp.acceleration,
            "tick {}: acceleration {acceleration} over {}",
            self.ticks,
            ramp.acceleration
        );
        assert!(
            jerk.abs() <= ramp.jerk,
            "tick {}: jerk {jerk} over {}",
            self.ticks,
            ramp.jerk
        );
        assert_eq!(motion.speed.to_bits(), speed);
        assert_eq!(motion.acceleration.to_bits(), acceleration);
        self.fault_stop &= !motion.at_rest;
        self.speed = speed;
        self.acceleration = acceleration;
        self.ticks += 1;
        motion
    }

    fn advance_to_rest(&mut self, demand: Demand, max_ticks: u64) {
        for _ in 0..max_ticks {
            if self.advance(demand).at_rest {
                return;
            }
        }
        panic!("no rest within {max_ticks} ticks");
    }
}

/// Ticks from one constant speed to another, by the regulator itself.
fn ticks_between(limits: &ShaftLimits, from: i64, to: i64) -> u64 {
    let (mut speed, mut acceleration, mut ticks) = (from, 0, 0);
    let mut near = Near::ZERO;
    while speed != to || acceleration != 0 {
        acceleration = regulator::acceleration(
            &limits.usual,
            speed,
            acceleration,
            Aim::steady(to),
            0,
            i64::MAX / 4,
            &mut near,
        );
        speed += acceleration;
        ticks += 1;
    }
    ticks
}

fn limits(
    tick_hz: u32,
    speed_hz: f64,
    acceleration: f64,
    jerk: f64,
    bands: &[(f64, f64)],
) -> ShaftLimits {
    let settings = LimitSettings {
        speed_hz,
        acceleration_hz_per_s: acceleration,
        jerk_hz_per_s2: jerk,
        stop_acceleration_hz_per_s: acceleration,
        stop_jerk_hz_per_s2: jerk,
        homing_speed_hz: (speed_hz / 20.0).min(1.0),
        bands: bands
            .iter()
            .map(|&(from_hz, to_hz)| BandSettings { from_hz, to_hz })
            .collect(),
    };
    ShaftLimits::from_settings(&settings, tick_hz)
}

/// Limits over the whole range of settings, with ramps short enough to be run often.
fn any_limits() -> impl Strategy<Value = ShaftLimits> {
    (
        any_limit_settings(),
        prop::collection::vec(0.1..0.9_f64, 0..=8),
    )
        .prop_filter_map(
            "ramps of 100,000 ticks at most",
            |((tick_hz, settings), mut edges)| {
                let speed = settings.speed_hz;
                let acceleration = settings.reachable_acceleration_hz_per_s();
                let ramp_s = speed / acceleration + acceleration / settings.jerk_hz_per_s2;
                if ramp_s * f64::from(tick_hz) > 100_000.0 {
                    return None;
                }
                edges.sort_by(f64::total_cmp);
                let bands: Vec<_> = edges
                    .chunks_exact(2)
                    .map(|pair| (pair[0] * speed, pair[1] * speed))
                    .filter(|(from, to)| to - from > 1e-3 * speed)
                    .collect();
                let bands = bands
                    .iter()
                    .map(|&(from_hz, to_hz)| BandSettings { from_hz, to_hz });
                Some(ShaftLimits::from_settings(
                    &LimitSettings {
                        bands: bands.collect(),
                        ..settings
                    },
                    tick_hz,
                ))
            },
        )
}

/// Settings over the whole range that their own check accepts, up to its bounds.
fn any_limit_settings() -> impl Strategy<Value = (u32, LimitSettings)> {
    (
        prop::sample::select(std::vec![500_u32, 1000, 2000, 5000, 10_000]),
        1.0..200.0_f64,
        (0.0..1.0_f64, 0.0..1.0_f64),
        // Part by which a fault stop may be harder. In every third case it equals the usual stop.
        prop_oneof![1 => Just((0.0, 0.0)), 2 => (0.0..1.0_f64, 0.0..1.0_f64)],
    )
        .prop_filter_map(
            "what is refused",
            |(tick_hz, speed_hz, (a, j), (stop_a, stop_j))| {
                let hz = f64::from(tick_hz);
                let between =
                    |low: f64, high: f64, part: f64| (low.ln() + (high / low).ln() * part).exp();
                let (max, max_jerk) = (speed_hz * hz, speed_hz * hz * hz);
                let acceleration_hz_per_s = between(0.01, max, a);
                let jerk_hz_per_s2 = between(0.01, max_jerk, j);
                let settings = LimitSettings {
                    speed_hz,
                    acceleration_hz_per_s,
                    jerk_hz_per_s2,
                    stop_acceleration_hz_per_s: between(acceleration_hz_per_s, max, stop_a)
                        .clamp(acceleration_hz_per_s, max),
                    stop_jerk_hz_per_s2: between(jerk_hz_per_s2, max_jerk, stop_j)
                        .clamp(jerk_hz_per_s2, max_jerk),
                    homing_speed_hz: (speed_hz / 20.0).min(1.0),
                    bands: heapless::Vec::new(),
                };
                settings.check(hz).is_ok().then_some((tick_hz, settings))
            },
        )
}

/// Programs of speeds as fractions of the greatest: ramps and holds, as `(to, ramp, hold)`.
fn any_speeds() -> impl Strategy<Value = Vec<(f64, u32, u32)>> {
    prop::collection::vec((0.0..1.0_f64, 0_u32..4000, 0_u32..4000), 1..6)
}

fn targets(limits: &ShaftLimits, speeds: &[(f64, u32, u32)]) -> Vec<Target> {
    let top = limits.speed as f64;
    let mut from = 0.0;
    let mut now = Turns::ZERO;
    let mut targets = Vec::new();
    for &(to, ramp, hold) in speeds {
        let end = Turns::from_bits((to * top) as i64);
        for tick in 1..=ramp + hold {
            let part = if tick >= ramp {
                1.0
            } else {
                f64::from(tick) / f64::from(ramp)
            };
            let next = Turns::from_bits(((from + (to - from) * part) * top) as i64);
            targets.push(Target { now, next, end });
            now = next;
        }
        from = to;
    }
    targets
}

/// If this fails, a lag in a band counts as one elsewhere, or one far from any band as one within. From 4 rev/s a shaft reaches
/// √(4² + 2 · 10) = 6 rev/s within a turn at 10 rev/s².
#[test]
fn a_band_extends_by_the_speed_gained_in_a_turn() {
    let settings = LimitSettings {
        speed_hz: 20.0,
        acceleration_hz_per_s: 10.0,
        jerk_hz_per_s2: 1000.0,
        stop_acceleration_hz_per_s: 10.0,
        stop_jerk_hz_per_s2: 1000.0,
        homing_speed_hz: 1.0,
        bands: [(3.0, 4.0), (12.0, 14.0)]
            .map(|(from_hz, to_hz)| BandSettings { from_hz, to_hz })
            .into_iter()
            .collect(),
    };
    for tick_hz in [500, 2000, 10_000] {
        let limits = ShaftLimits::from_settings(&settings, tick_hz);
        let is_at = |hz: f64| limits.is_at_band(Turns::from_num(hz / f64::from(tick_hz)));
        let top = 216_f64.sqrt();
        for hz in [3.001, 3.5, 4.0, 5.0, 5.99, 12.001, 13.0, top - 0.01] {
            assert!(is_at(hz), "{hz} rev/s, {tick_hz} ticks/s");
        }
        for hz in [0.0, 1.0, 2.999, 6.01, 9.0, 11.999, top + 0.01, 20.0] {
            assert!(!is_at(hz), "{hz} rev/s, {tick_hz} ticks/s");
        }
    }
}

proptest! {
    /// Limits hold for every request, however often the shaft is stopped and started in between.
    #[test]
    fn limits_hold_for_any_program_and_any_stop(
        limits in any_limits(),
        speeds in any_speeds(),
        stops in prop::collection::vec((0_usize..20_000, prop::option::of(0.0..1.0_f64), 1_usize..3000), 0..4),
    ) {
        let targets = targets(&limits, &speeds);
        let mut watch = Watch::new(limits);
        for (tick, &target) in targets.iter().enumerate() {
            let stop = stops.iter().find(|&&(at, _, ticks)| (at..at + ticks).contains(&tick));
            watch.advance(match stop {
                Some(&(_, phase, _)) => Demand::Stop(phase.map(Turns::from_num)),
                None => Demand::Follow(target),
            });
        }
        watch.advance_to_rest(Demand::Stop(None), 1_000_000);
    }

    /// A stop from any point of a program ends exactly at its phase. It takes no longer than a turn (at the coasting
    /// speed) and the ramps.
    #[test]
    fn stops_hit_their_phase_exactly(
        limits in any_limits(),
        speeds in any_speeds(),
        cut in any::<prop::sample::Index>(),
        phase_bits in 0..ONE_TURN,
    ) {
        let targets = targets(&limits, &speeds);
        prop_assume!(!targets.is_empty());
        let mut watch = Watch::new(limits.clone());
        for &target in &targets[..=cut.index(targets.len())] {
            watch.advance(Demand::Follow(target));
        }
        let phase = Turns::from_bits(phase_bits);
        let settled = easing::Easing::new(watch.shaft.state(), &limits).coasting;
        let settling = 2 * ticks_between(&limits, 0, limits.speed);
        let turn = (ONE_TURN / settled) as u64;
        let ramp = ticks_between(&limits, settled, 0);
        watch.advance_to_rest(Demand::Stop(Some(phase)), settling + turn + ramp + 4);
        prop_assert_eq!(watch.shaft.phase().within_turn(), phase);
    }

    /// With the longest ramps that settings accept, planning a stop from full speed never overflows, and its sums end
    /// at the phase.
    #[test]
    fn the_longest_ramps_can_be_planned((tick_hz, settings) in any_limit_settings(), phase_bits in 0..ONE_TURN) {
        let mut watch = Watch::new(ShaftLimits::from_settings(&settings, tick_hz));
        watch.start_at(watch.shaft.limits.speed);
        for _ in 0..200_000 {
            if watch.advance(Demand::Stop(Some(Turns::from_bits(phase_bits)))).at_rest {
                prop_assert_eq!(watch.shaft.phase().within_turn().to_bits(), phase_bits);
                break;
            }
        }
    }

    /// Each visit of a band ends within the time that the limits need from constant speed at one edge to constant speed
    /// at the other. A tick at either edge is added, as a visit need not start on the edge.
    #[test]
    fn bands_are_crossed_as_fast_as_limits_allow(limits in any_limits(), speeds in any_speeds()) {
        let targets = targets(&limits, &speeds);
        let mut watch = Watch::new(limits.clone());
        let max: Vec<u64> =
            limits.bands.iter().map(|band| ticks_between(&limits, band.from, band.to) + 2).collect();
        let mut visit = None;
        for &target in &targets {
            let speed = watch.advance(Demand::Follow(target)).speed.to_bits();
            let inside = limits.bands.iter().position(|band| band.from < speed && speed < band.to);
            visit = match (inside, visit) {
                (Some(band), Some((before, ticks))) if before == band => Some((band, ticks + 1)),
                (Some(band), _) => Some((band, 1)),
                (None, _) => None,
            };
            if let Some((band, ticks)) = visit {
                prop_assert!(ticks <= max[band], "{ticks} ticks in a band that takes {}", max[band]);
            }
        }
    }

    /// The shaft reaches a constant requested speed exactly (or the nearer edge of its band).
    #[test]
    fn steady_speeds_are_reached_exactly(limits in any_limits(), part in 0.0..1.0_f64) {
        let requested = (part * limits.speed as f64) as i64;
        let mut watch = Watch::new(limits.clone());
        for _ in 0..ticks_between(&limits, 0, limits.speed) * 2 {
            watch.advance(Demand::Follow(Target::steady(Turns::from_bits(requested))));
        }
        let near = match limits.bands.iter().find(|band| band.from < requested && requested < band.to) {
            Some(band) if requested - band.from >= band.to - requested => band.to,
            Some(band) => band.from,
            None => requested,
        };
        prop_assert_eq!(watch.speed, near);
        prop_assert_eq!(watch.acceleration, 0);
    }
}

/// A program within the limits is followed without any lag once its rate has been met.
#[test]
fn a_ramp_is_followed_exactly_and_not_overshot() {
    let limits = limits(2000, 60.0, 50.0, 500.0, &[]);
    let targets = targets(&limits, &[(0.5, 4000, 1000), (0.9, 4000, 1000)]);
    let mut watch = Watch::new(limits);
    for (tick, &target) in targets.iter().enumerate() {
        let motion = watch.advance(Demand::Follow(target));
        assert!(motion.speed <= target.end, "tick {tick}: overshoot");
        let settled = (1000..3500).contains(&tick) || (6000..8500).contains(&tick);
        if settled {
            assert_eq!(motion.speed, target.next, "tick {tick}");
        }
    }
}

/// A stop while stopping, and a stop at rest, change nothing. The shaft can follow again from there.
#[test]
fn a_stop_during_a_stop_changes_nothing() {
    let limits = limits(2000, 60.0, 100.0, 2000.0, &[(20.0, 25.0)]);
    let mut watch = Watch::new(limits);
    let full = Demand::Follow(Target::steady(Turns::from_num(0.02)));
    let at = Turns::from_num(0.25);
    for first in 0..400 {
        for _ in 0..first * 5 {
            watch.advance(full);
        }
        for _ in 0..first {
            watch.advance(Demand::Stop(Some(at)));
        }
        for _ in 0..(first % 7) {
            watch.advance(Demand::Stop(None));
        }
        watch.advance_to_rest(Demand::Stop(Some(at)), 100_000);
        assert!(watch.advance(Demand::Stop(Some(at))).at_rest);
        assert_eq!(watch.speed, 0);
    }
}
