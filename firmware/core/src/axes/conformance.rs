//! Conformance tests of every follower, against numerical derivatives of its own motion and an exact sum of its turns.

use super::*;
use crate::units::{ONE_TURN, Turns};
use std::f64::consts::TAU;
use std::vec::Vec;

/// Follower with the curves that it needs.
struct Case {
    name: &'static str,
    follower: AnyFollower,
    cams: Cams,
    /// Number of points of its curve; none for a gear.
    points: Option<usize>,
}

impl Case {
    /// Returns a copy with a state of its own.
    fn copy(&self) -> Self {
        Self {
            name: self.name,
            follower: self.follower.clone(),
            cams: self.cams.clone(),
            points: self.points,
        }
    }

    /// Greatest rounding of a position, turns: as documented, 2⁻²⁹ of the largest bend of a curve, and a unit of the last place.
    fn rounding(&self) -> f64 {
        let unit = 1.0 / ONE_TURN as f64;
        let Some(points) = self.points else {
            return unit;
        };
        let at_a_turn_a_second = Bounds {
            speed: 1.0,
            ..Bounds::ZERO
        };
        let curve = self.follower.bounds(&at_a_turn_a_second, &self.cams);
        let bend = curve.acceleration / (6 * points * points) as f64;
        unit + bend / f64::from(1 << 29)
    }
}

/// Every follower, with settings at both ends of their ranges and between.
fn all() -> Vec<Case> {
    let gear = FollowerSettings::gear;
    let cam =
        |table, shift_turns| FollowerSettings::CamTable(CamTableSettings { table, shift_turns });
    let master = Bounds {
        speed: 20.0,
        acceleration: 20.0,
        jerk: 200.0,
    };
    let tables = tables();
    let mut cams = NO_CAMS;
    for (curve, cam) in cams.iter_mut().zip(&tables) {
        cam.check(&master).unwrap();
        curve.fit(&cam.points_turns, cam.net_turns);
    }
    [
        ("direct", FollowerSettings::DIRECT),
        ("gear 7:3", gear((7, 3))),
        ("gear 1:1000", gear((1, 1000))),
        ("gear 1000:1", gear((1000, 1))),
        ("cam that comes back", cam(0, 0.0)),
        ("cam that comes back, shifted", cam(0, -0.7)),
        ("cam of a turn in four points", cam(1, 0.25)),
    ]
    .into_iter()
    .map(|(name, follower)| {
        follower.check(&tables).expect("sound settings");
        Case {
            name,
            follower: follower.follower(&cams),
            cams: cams.clone(),
            points: match follower {
                FollowerSettings::Gear(_) => None,
                FollowerSettings::CamTable(own) => {
                    Some(tables[usize::from(own.table)].points_turns.len())
                }
            },
        }
    })
    .collect()
}

/// A smooth table of the most points that comes back, and one of the fewest points that makes a turn backward.
fn tables() -> [CamSettings; 2] {
    let points = (0..MAX_CAM_POINTS).map(|i| {
        let x = TAU * i as f64 / MAX_CAM_POINTS as f64;
        3.0 * (x.sin() + 0.2 * (3.0 * x).cos())
    });
    [
        CamSettings {
            net_turns: 0,
            max_speed_hz: 1000.0,
            max_acceleration_hz_per_s: 1e6,
            points_turns: points.collect(),
        },
        CamSettings {
            net_turns: -1,
            max_speed_hz: 1000.0,
            max_acceleration_hz_per_s: 1e6,
            points_turns: [0.0, -0.3, -0.4, -0.8].into_iter().collect(),
        },
    ]
}

fn turns(bits: i64) -> Turns {
    Turns::from_bits(bits)
}

/// Motion of an axis over one tick, for `turns` of the master.
fn advance(case: &mut Case, turns: i64) -> i64 {
    if case.follower.is_direct() {
        return turns;
    }
    let turns = Turns::from_bits(turns);
    case.follower.advance(turns, &case.cams).to_bits()
}

/// If this fails, an axis departs from the master, a little in every turn.
#[test]
fn no_travel_is_lost_over_many_turns_and_back() {
    for mut case in all() {
        let whole_turn = {
            let mut fresh = case.copy();
            (0..3000)
                .map(|_| i128::from(advance(&mut fresh, ONE_TURN)))
                .sum::<i128>()
        };
        // As many turns in ticks of odd lengths, with stretches in reverse.
        let (mut master, mut axis) = (0_i128, 0_i128);
        let mut seed = 1_u64;
        let goal = 3000 * i128::from(ONE_TURN);
        while master != goal {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let length = (seed >> 16) as i64;
            let step = if seed >> 62 == 0 { -length } else { length };
            let step = i128::from(step)
                .min(goal - master)
                .max(-i128::from(ONE_TURN));
            let step = step.min(i128::from(ONE_TURN));
            master += step;
            axis += i128::from(advance(&mut case, step as i64));
        }
        assert_eq!(axis, whole_turn, "{}", case.name);
        let back = (0..3000)
            .map(|_| i128::from(advance(&mut case, -ONE_TURN)))
            .sum::<i128>();
        assert_eq!(axis + back, 0, "{}", case.name);
    }
}

/// If this fails, axes that share a plan drift apart.
#[test]
fn equal_followers_make_equal_motions() {
    for mut case in all() {
        let mut other = case.copy();
        for tick in 0..1000 {
            let travel = ONE_TURN / 300 + tick;
            assert_eq!(advance(&mut case, travel), advance(&mut other, travel));
            assert!(case.follower == other.follower, "{}", case.name);
        }
        advance(&mut case, 12_345);
        let differs = case.follower != other.follower;
        assert!(
            differs || advance(&mut case, 999) == advance(&mut other, 999),
            "{}",
            case.name
        );
    }
}

/// Ticks of each of the four parts of [`jerk`], and its size: from ONE_TURN/20,000 a tick the speed rises to about three times that.
const PART: usize = 4000;

/// Jerk of the master: its acceleration goes up, down, and back to zero, and its speed comes back.
fn jerk(tick: usize) -> i64 {
    [1750, -1750, -1750, 1750][tick / PART % 4]
}

/// If this fails, settings are accepted that exceed the step hardware or the setpoint of a servo, or the torque of a servo belongs to
/// another motion.
#[test]
fn bounds_hold_and_accelerations_are_second_differences() {
    for mut case in all() {
        let mut speed = ONE_TURN / 20_000;
        let mut acceleration = 0_i64;
        let mut max = Bounds::ZERO;
        let mut positions: Vec<i64> = Vec::new();
        let mut given: Vec<f64> = Vec::new();
        let mut position = 0;
        for tick in 0..8 * PART {
            acceleration += jerk(tick);
            speed += acceleration;
            position += advance(&mut case, speed);
            positions.push(position);
            let now = case
                .follower
                .acceleration(turns(speed), turns(acceleration), &case.cams);
            given.push(now.to_num());
            let of = |bits: i64| (bits as f64 / ONE_TURN as f64).abs();
            max = max.or(&Bounds {
                speed: of(speed),
                acceleration: of(acceleration),
                jerk: of(jerk(tick)),
            });
        }
        let bounds = case.follower.bounds(&max, &case.cams);
        let differences = |of: &[i64]| of.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>();
        let float = |bits: i64| bits as f64 / ONE_TURN as f64;
        let velocity = differences(&positions);
        let accelerations = differences(&velocity);
        let jerks = differences(&accelerations);
        // A third difference has eight times the rounding of a position.
        let rounding = 8.0 * case.rounding();
        let max = |of: &[i64]| of.iter().map(|&bits| float(bits).abs()).fold(0.0, f64::max);
        for (what, actual, bound) in [
            ("speed", max(&velocity), bounds.speed),
            ("acceleration", max(&accelerations), bounds.acceleration),
            ("jerk", max(&jerks), bounds.jerk),
        ] {
            assert!(
                actual <= bound + rounding,
                "{}: {what} {actual:e} over {bound:e}",
                case.name
            );
            assert!(
                bound <= 30.0 * actual + rounding,
                "{}: {what} {bound:e} bounds {actual:e}",
                case.name
            );
        }
        // The second difference lies half a tick from the speed that it is computed with, and a tick from the acceleration.
        for (i, &second) in accelerations.iter().enumerate() {
            let error = (float(second) - given[i + 1]).abs();
            assert!(
                error <= bounds.jerk + rounding,
                "{} at {i}: {:e} for {:e}",
                case.name,
                float(second),
                given[i + 1]
            );
        }
    }
}
