//! Periodic cubic spline through equally spaced points: the curve of a cam table.
//!
//! The curve gives the position y of an axis, in turns, over one turn x of the master. After a turn it continues *net* whole turns
//! further. With n points, segment i has u = n x − i from 0 to 1. With the *bends* m = y″/6n² at the points,
//!
//! ```text
//! y(u) = yᵢ + u (yᵢ₊₁ − yᵢ) − u (1 − u) (2 mᵢ + mᵢ₊₁ + u (mᵢ₊₁ − mᵢ))
//! mᵢ₋₁ + 4 mᵢ + mᵢ₊₁ = yᵢ₋₁ − 2 yᵢ + yᵢ₊₁
//! ```
//!
//! so that y, y′ and y″ are continuous. The second line is solved in integers by repeated sweeps (Gauss-Seidel). Each sweep
//! divides the error by four, and no scratch memory is needed.
//!
//! Numbers of the tick are integers: positions have 48 fraction bits. A bend is a 30-bit mantissa with a scale for the whole curve,
//! so a position is within 2⁻²⁹ of the largest bend from the exact spline (tested).

use core::hash::{Hash, Hasher};

use super::bounds::Bounds;
use crate::functions::{multiply, multiply_high, multiply_long, multiply_q30, normalised};
use crate::units::{FRACTION_BITS, ONE_TURN, Turns};

/// Greatest number of points of a curve.
pub const MAX_CAM_POINTS: usize = 96;
/// Least number of points of a curve.
pub const MIN_CAM_POINTS: usize = 4;

/// Sweeps after which the error is below a unit of the last place: 4⁻³² of the first guess.
const SWEEPS: u32 = 32;
/// Bits of a bend's mantissa. The sum of three bends fits 32 bits.
const BEND_BITS: u32 = 29;

/// Curve of a cam table, in integers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spline {
    /// Positions of the points, and of the first one a turn later.
    positions: heapless::Vec<i64, { MAX_CAM_POINTS + 1 }>,
    /// Bends at the same points, in units of 2^`scale`.
    bends: heapless::Vec<i32, { MAX_CAM_POINTS + 1 }>,
    scale: u32,
}

/// Extremes of a curve's derivatives over a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extremes {
    /// Least y′, turns of the axis per turn of the master.
    pub min_slope: f64,
    /// Greatest |y′|, |y″| and |y‴|: turns of the axis per turn, turn² and turn³ of the master.
    pub max: Bounds,
}

/// Segment of a curve, and the place in it.
struct Place {
    from: i64,
    to: i64,
    bend: i32,
    next_bend: i32,
    /// Part of the segment, 2³² to the whole.
    part: u32,
}

impl Spline {
    /// Curve without points, which stands still.
    pub const NONE: Self = Self {
        positions: heapless::Vec::new(),
        bends: heapless::Vec::new(),
        scale: 0,
    };

    /// Replaces the curve by the one through `points`, turns, that goes on by `net_turns` in each turn. The points must have been checked.
    #[cold]
    pub fn fit(&mut self, points: &[f64], net_turns: i32) {
        self.positions.clear();
        self.bends.clear();
        let bits = |turns: f64| libm::round(turns * ONE_TURN as f64) as i64;
        let first = points.first().map_or(0, |&first| bits(first));
        let last = first + i64::from(net_turns) * ONE_TURN;
        for position in points.iter().map(|&point| bits(point)).chain([last]) {
            let pushed = self
                .positions
                .push(position)
                .and(self.bends.push(0).map_err(i64::from));
            debug_assert!(pushed.is_ok(), "checked settings have no more points");
        }
        let count = self.segments();
        // No bend exceeds half of the largest second difference.
        let max = (0..count).map(|i| self.second_difference(i).unsigned_abs());
        let bits = u64::BITS - (max.max().unwrap_or(0) / 2).leading_zeros();
        self.scale = bits.saturating_sub(BEND_BITS);
        for _ in 0..SWEEPS {
            for i in 0..count {
                let neighbours = self.bend(i + count - 1) + self.bend(i + 1);
                let rest = (self.second_difference(i) >> self.scale) - neighbours;
                if let Some(bend) = self.bends.get_mut(i) {
                    *bend = ((rest + 2) >> 2) as i32;
                }
            }
        }
        let first = self.bends.first().copied().unwrap_or(0);
        if let Some(last) = self.bends.last_mut() {
            *last = first;
        }
    }

    /// Hashes the numbers of points and bends, and their scale.
    #[inline(always)]
    pub(crate) fn hash_lengths(&self, hasher: &mut impl Hasher) {
        let Self {
            positions,
            bends,
            scale,
        } = self;
        (positions.len(), bends.len(), scale).hash(hasher);
    }

    /// Hashes a point and its bend. Returns false for the point after the last.
    #[inline(always)]
    pub(crate) fn hash_point(&self, point: usize, hasher: &mut impl Hasher) -> bool {
        match (self.positions.get(point), self.bends.get(point)) {
            // Beyond their capacity there are none, even if their number is wrong.
            (Some(position), Some(bend)) if point <= MAX_CAM_POINTS => {
                (position, bend).hash(hasher);
                true
            }
            _ => false,
        }
    }

    fn segments(&self) -> usize {
        self.positions.len().saturating_sub(1)
    }

    #[cold]
    fn bend(&self, i: usize) -> i64 {
        let count = self.segments().max(1);
        i64::from(self.bends.get(i % count).copied().unwrap_or(0))
    }

    #[cold]
    fn second_difference(&self, i: usize) -> i64 {
        let at = |i: usize| self.positions.get(i).copied().unwrap_or(0);
        let before = match i.checked_sub(1) {
            Some(before) => at(before),
            None => at(self.segments().saturating_sub(1)) - self.net(),
        };
        before - 2 * at(i) + at(i + 1)
    }

    /// Travel in one turn of the master: whole turns, 2⁻⁴⁸.
    pub(super) fn net(&self) -> i64 {
        match (self.positions.first(), self.positions.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0,
        }
    }

    /// Position at a phase of the master, 0 ≤ phase < 2⁴⁸. Turns, 2⁻⁴⁸.
    pub(super) fn position(&self, phase: u64) -> i64 {
        let place = self.place(phase);
        let straight = place.from + share(place.to - place.from, place.part);
        // The weight has 32 fraction bits and is at most ¼, so the product has two bits more than a bend.
        let weight = multiply_high(place.part, place.part.wrapping_neg());
        let sag = multiply_q30(place.sum(), weight as i32);
        straight - ((i64::from(sag) << self.scale) >> 2)
    }

    #[inline]
    fn place(&self, phase: u64) -> Place {
        // There are at most 2⁷ segments, so this is below 2⁵⁵.
        let at = multiply_long(phase, self.segments() as u32);
        let segment = (at >> FRACTION_BITS) as usize;
        let position = |i: usize| self.positions.get(i).copied().unwrap_or(0);
        let bend = |i: usize| self.bends.get(i).copied().unwrap_or(0);
        Place {
            from: position(segment),
            to: position(segment + 1),
            bend: bend(segment),
            next_bend: bend(segment + 1),
            part: (at >> (FRACTION_BITS - 32)) as u32,
        }
    }

    /// Acceleration at a phase: y′ α + y″ ω². Turns a tick², for the master's speed (turns a tick) and acceleration (turns a tick²).
    pub(super) fn acceleration(&self, phase: u64, speed: Turns, acceleration: Turns) -> Turns {
        let count = self.segments() as i64;
        let place = self.place(phase);
        let bits = |bend: i32| i64::from(bend) << self.scale;
        // y′/n = Δy − (1 − 2u) q − u (1 − u) q′, with the sum q and its derivative q′ = mᵢ₊₁ − mᵢ.
        let sum = bits(place.sum());
        let weight = multiply_high(place.part, place.part.wrapping_neg());
        let tilt = sum - 2 * share(sum, place.part);
        let slope =
            place.to - place.from - tilt - share(bits(place.next_bend) - bits(place.bend), weight);
        let bend = bits(place.bend) + share(bits(place.next_bend) - bits(place.bend), place.part);
        let by_acceleration = product(slope * count, acceleration.to_bits());
        let by_speed = product(
            6 * count * count * bend,
            product(speed.to_bits(), speed.to_bits()),
        );
        Turns::from_bits(by_acceleration + by_speed)
    }

    /// Second derivative at a part of the turn from 0 to 1, turns per turn².
    #[cold]
    pub fn second_derivative(&self, part: f64) -> f64 {
        let count = self.segments() as f64;
        let place = part * count;
        let segment = (libm::floor(place) as usize).min(self.segments().saturating_sub(1));
        let u = place - segment as f64;
        let bend = |i: usize| (self.bend(i) << self.scale) as f64 / ONE_TURN as f64;
        6.0 * count * count * ((1.0 - u) * bend(segment) + u * bend(segment + 1))
    }

    /// Upper bounds on the axis's speed, acceleration and jerk, from those of the master.
    ///
    /// Applies the chain rule: v = y′ ω, a = y′ α + y″ ω², j = y′ J + 3 y″ ω α + y‴ ω³.
    #[cold]
    pub(super) fn bounds(&self, master: &Bounds) -> Bounds {
        let curve = self.extremes().max;
        let Bounds {
            speed,
            acceleration,
            jerk,
        } = *master;
        Bounds {
            speed: curve.speed * speed,
            acceleration: curve.speed * acceleration + curve.acceleration * speed * speed,
            jerk: curve.speed * jerk
                + 3.0 * curve.acceleration * speed * acceleration
                + curve.jerk * speed * speed * speed,
        }
    }

    /// Extremes of the curve's derivatives over a turn.
    #[cold]
    pub(super) fn extremes(&self) -> Extremes {
        let count = self.segments() as f64;
        let turns = |bits: i64| bits as f64 / ONE_TURN as f64;
        let mut extremes = Extremes {
            min_slope: f64::INFINITY,
            max: Bounds::ZERO,
        };
        let steps = self.positions.windows(2).zip(self.bends.windows(2));
        for (positions, bends) in steps {
            let ([from, to], [bend, next]) = (positions, bends) else {
                continue;
            };
            let bend = turns(i64::from(*bend) << self.scale);
            let next = turns(i64::from(*next) << self.scale);
            let change = next - bend;
            // The slope is extreme at the ends and where the bend is zero; the bend at the ends.
            let zero = bend / (bend - next);
            let inner = if zero > 0.0 && zero < 1.0 { zero } else { 0.0 };
            for u in [0.0, inner, 1.0] {
                let sum = 2.0 * bend + next + u * change;
                let sag = (1.0 - 2.0 * u) * sum + u * (1.0 - u) * change;
                let slope = count * (turns(to - from) - sag);
                extremes.min_slope = extremes.min_slope.min(slope);
                extremes.max = extremes.max.or(&Bounds {
                    speed: slope.abs(),
                    acceleration: (6.0 * count * count * (bend + u * change)).abs(),
                    jerk: (6.0 * count * count * count * change).abs(),
                });
            }
        }
        extremes
    }
}

impl Place {
    /// Sum 2 mᵢ + mᵢ₊₁ + u (mᵢ₊₁ − mᵢ), in units of a bend.
    #[inline]
    fn sum(&self) -> i32 {
        let change = self.next_bend - self.bend;
        2 * self.bend + self.next_bend + multiply_q30(change, (self.part >> 2) as i32)
    }
}

/// Part of a number, 2³² to the whole; rounded towards zero. The number is below 2⁶² in magnitude.
#[inline]
fn share(whole: i64, part: u32) -> i64 {
    let size = whole.unsigned_abs();
    let share = multiply((size >> 32) as u32, part) + u64::from(multiply_high(size as u32, part));
    if whole < 0 {
        -(share as i64)
    } else {
        share as i64
    }
}

/// Product of two numbers with 48 fraction bits, each taken to 32 significant bits. The result must fit.
fn product(a: i64, b: i64) -> i64 {
    let (size_a, up_a) = normalised(a.unsigned_abs());
    let (size_b, up_b) = normalised(b.unsigned_abs());
    let size = multiply(size_a, size_b);
    // a b = size · 2^(64 − up_a − up_b), of which 48 bits are shifted out.
    let up = 64 - FRACTION_BITS as i32 - up_a as i32 - up_b as i32;
    let size = match up {
        ..=-64 => 0,
        -63..=0 => size >> -up,
        _ => size << up,
    };
    if (a < 0) == (b < 0) {
        size as i64
    } else {
        -(size as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use std::vec::Vec;

    fn turns(bits: i64) -> f64 {
        bits as f64 / ONE_TURN as f64
    }

    /// Phase of a part of the turn, 0 to 1.
    fn phase(part: f64) -> u64 {
        (part * ONE_TURN as f64) as u64
    }

    /// Position on the periodic spline through `count` points of cos(2πfx), in Hermite form. Its slopes obey
    /// s₋ + 4 s + s₊ = 3 (y₊ − y₋)/h, which a wave solves in closed form.
    fn wave(count: usize, frequency: f64, part: f64) -> f64 {
        let h = 1.0 / count as f64;
        let step = TAU * frequency * h;
        let at = |i: f64| (step * i).cos();
        let slope = |i: f64| -3.0 * step.sin() * (step * i).sin() / (2.0 + step.cos());
        let (i, u) = ((part * count as f64).floor(), (part * count as f64).fract());
        let (v, w) = (u * u, u * u * u);
        (2.0 * w - 3.0 * v + 1.0) * at(i)
            + (w - 2.0 * v + u) * slope(i)
            + (3.0 * v - 2.0 * w) * at(i + 1.0)
            + (w - v) * slope(i + 1.0)
    }

    /// If this fails, axes follow another curve than the one whose bounds were checked.
    #[test]
    fn the_spline_of_a_wave_matches_its_closed_form() {
        for (count, frequency) in [(4, 1.0), (5, 1.0), (17, 3.0), (90, 2.0), (96, 47.0)] {
            let at = |i: usize| (TAU * frequency * i as f64 / count as f64).cos();
            let points: Vec<f64> = (0..count).map(at).collect();
            let mut spline = Spline::NONE;
            spline.fit(&points, 0);
            // Second differences are at most 4, so bends are at most 2.
            let tolerance = 2.0 / f64::from(1 << 29);
            for i in 0..2000 {
                let part = (f64::from(i) + 0.37) / 2000.0;
                let error = turns(spline.position(phase(part))) - wave(count, frequency, part);
                assert!(error.abs() < tolerance, "{count} points, {part}: {error:e}");
            }
            for (i, &point) in points.iter().enumerate() {
                let exact = (point * ONE_TURN as f64).round() as i64;
                // The phase of the point, rounded up to a unit.
                let place = ((i as u64) << FRACTION_BITS).div_ceil(count as u64);
                let error = spline.position(place) - exact;
                assert!(
                    error.abs() <= 1 << (spline.scale + 1),
                    "{count} points, {i}: {error}"
                );
            }
        }
    }

    /// If this fails, net travel is wrong, and the curve has a kink at the end of each turn.
    #[test]
    fn a_straight_line_stays_straight() {
        for net_turns in [-1000, -1, 1, 7, 1000] {
            let points: Vec<f64> = (0..64)
                .map(|i| 0.25 + f64::from(net_turns * i) / 64.0)
                .collect();
            let mut spline = Spline::NONE;
            spline.fit(&points, net_turns);
            assert_eq!(spline.net(), i64::from(net_turns) * ONE_TURN);
            let Extremes {
                min_slope,
                max: steepest,
            } = spline.extremes();
            assert_eq!(min_slope, f64::from(net_turns));
            assert_eq!(steepest.speed, f64::from(net_turns.abs()));
            assert_eq!(steepest.acceleration, 0.0);
            for i in 0..1000 {
                let part = f64::from(i) / 1000.0;
                let error =
                    turns(spline.position(phase(part))) - 0.25 - part * f64::from(net_turns);
                assert!(
                    error.abs() < 1e-10 * f64::from(net_turns.abs()),
                    "{net_turns}: {error:e}"
                );
            }
        }
    }

    /// If this fails, a dip between two points is not detected, and an axis with an index can pass its flag backward.
    #[test]
    fn a_dip_between_points_makes_the_least_slope_negative() {
        let mut spline = Spline::NONE;
        // Points rise, but the curve overshoots after the steep part.
        let points = [0.0, 0.01, 0.02, 0.03, 0.5, 0.97, 0.98, 0.99];
        spline.fit(&points, 1);
        assert!(spline.extremes().min_slope < 0.0);
        let min = (0..8000).map(|i| {
            let at = |i: i32| spline.position(phase(f64::from(i) / 8001.0));
            at(i + 1) - at(i)
        });
        assert!(min.min().unwrap() < 0);
    }
}
