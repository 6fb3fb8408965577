//! Rates of false alarms, for rates that no simulation reaches. Each is a number of alarms a turn, one axis, no change.
//!
//! | rule | method |
//! | --- | --- |
//! | gate | the tail of the difference of two readings; an upper bound where readings are correlated |
//! | windows | a Markov chain of the means at steps; means of different windows are taken as independent and normal |
//! | range | 1 over the mean time, an integral; readings are taken as independent |
//! | CUSUM | independent readings: the Markov chain of D. Brook and D. A. Evans, *An approach to the probability distribution of CUSUM run length*, Biometrika 59 (1972). The rate is the flow to the alarm in its quasi-stationary state |
//! | CUSUM with correlated readings, GLR | importance sampling after D. Q. Naiman and C. E. Priebe, *Computing scan statistic p values using importance sampling*, J. Comput. Graph. Statist. 10 (2001) |
//!
//! The last one: an alarm is a sum over some length, ending at some turn, that exceeds its limit. Such sums come in clumps. The rate of
//! clumps is the rate of sums, times the mean of 1 over the size of a clump that has a given sum. The readings of a clump are drawn under the
//! condition that the sum exceeds its limit.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::noise::{Errors, Noise, SIGMA, normal_tail};
use super::rules::{LONGEST, Rule, Shape, Sums, WINDOW, lengths};

/// Effort of a computation.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// States of a Markov chain.
    pub states: usize,
    /// Clumps that are drawn.
    pub clumps: u64,
}

/// Returns the false alarms a turn, if a method is known: with uniform errors none is, for a GLR.
pub fn rate(rule: Rule, threshold: f64, noise: Noise, effort: Effort) -> Option<f64> {
    match (rule, noise) {
        (Rule::Gate, _) => Some(gate(threshold, noise)),
        (Rule::Windows, _) => Some(windows(threshold, noise, effort.states)),
        (Rule::Range, _) => Some(range(threshold, noise)),
        (Rule::Cusum { k }, _) if noise.is_independent() => {
            Some(cusum(k, threshold, noise, effort.states))
        }
        (_, Noise::Uniform) => None,
        (Rule::Cusum { k }, _) => {
            // The most likely length of an alarm is h/k.
            let longest = (4.0 * threshold / k) as usize + 16;
            let limit = |length: usize| threshold + k * length as f64;
            Some(clumps(Shape::Step, longest, &limit, noise, effort.clumps))
        }
        (Rule::GlrStep | Rule::GlrSlope, _) => {
            let shape = if rule == Rule::GlrStep {
                Shape::Step
            } else {
                Shape::Slope
            };
            let limit = |length| threshold * SIGMA * shape.norm(length);
            Some(clumps(shape, LONGEST, &limit, noise, effort.clumps))
        }
    }
}

/// Returns the threshold with a rate of false alarms a turn, to 2 %; `None` if there is none above zero.
pub fn threshold(rule: Rule, required: f64, noise: Noise, effort: Effort) -> Option<f64> {
    let excess = |threshold: f64| {
        let rate = rate(rule, threshold, noise, effort)?;
        Some((rate / required).max(1e-300).ln())
    };
    let mut low = (1e-3, excess(1e-3)?);
    if low.1 < 0.0 {
        return None;
    }
    let mut high = (0.5, excess(0.5)?);
    while high.1 > 0.0 {
        low = high;
        let further = 1.5 * high.0;
        high = (further, excess(further)?);
    }
    // False position with halving (Illinois), in the logarithm of the rate.
    for _ in 0..60 {
        let next = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let at = excess(next)?;
        if at.abs() < 0.02 {
            return Some(next);
        }
        if at > 0.0 {
            low = (next, at);
            high.1 *= 0.5;
        } else {
            high = (next, at);
            low.1 *= 0.5;
        }
    }
    Some(f64::midpoint(low.0, high.0))
}

fn gate(width: f64, noise: Noise) -> f64 {
    match noise {
        Noise::Uniform => (1.0 - 0.5 * width).max(0.0).powi(2),
        Noise::Normal { .. } => 2.0 * normal_tail(width / (SIGMA * 2.0_f64.sqrt())),
    }
}

/// The range of n readings is at most w with the probability n ∫ f(x) q(x)ⁿ⁻¹ dx, where q is the probability of x to x + w. The sum over n
/// is the mean time. For uniform errors it is 2 / (1 − w/2).
fn range(width: f64, noise: Noise) -> f64 {
    const POINTS: u32 = 4000;
    if noise == Noise::Uniform {
        return (0.5 - 0.25 * width).max(0.0);
    }
    // In standard deviations. Beyond the ends the integrand is below 1e-20 of its peak.
    const REACH: f64 = 12.0;
    let width = width / SIGMA;
    let dx = 2.0 * REACH / f64::from(POINTS);
    let mean: f64 = (0..POINTS)
        .map(|i| {
            let x = -REACH + (f64::from(i) + 0.5) * dx;
            // Both tails are small, so their sum is exact where 1 − q is not.
            let outside = normal_tail(-x) + normal_tail(x + width);
            let density = (-0.5 * x * x).exp() / TAU.sqrt();
            density * dx / (outside * outside)
        })
        .sum();
    1.0 / (1.0 + mean)
}

/// One-sided chain on the sum in `states` equal parts of 0 to h; both sides alarm equally often.
fn cusum(k: f64, h: f64, noise: Noise, states: usize) -> f64 {
    if noise.tail(k) == 0.0 {
        return 0.0;
    }
    let width = h / (states as f64 - 0.5);
    // State 0 is from −width/2 to width/2, as in Brook and Evans.
    let within = |from: f64, to: f64| noise.tail(from) - noise.tail(to);
    let up: Vec<f64> = (0..2 * states - 1)
        .map(|step| {
            let by = (step as f64 - (states as f64 - 1.0)) * width + k;
            within(by - 0.5 * width, by + 0.5 * width)
        })
        .collect();
    let to_zero: Vec<f64> = (0..states)
        .map(|from| noise.tail(from as f64 * width - 0.5 * width - k))
        .collect();
    let to_alarm: Vec<f64> = (0..states)
        .map(|from| noise.tail(h - from as f64 * width + k))
        .collect();
    let mut share = vec![0.0; states];
    share[0] = 1.0;
    let mut flow = 0.0;
    for _ in 0..10_000 {
        let mut next = vec![0.0; states];
        let mut alarms = 0.0;
        for (from, &share) in share.iter().enumerate() {
            if share < 1e-60 {
                continue;
            }
            alarms += share * to_alarm[from];
            next[0] += share * to_zero[from];
            for (to, next) in next.iter_mut().enumerate().skip(1) {
                *next += share * up[to + states - 1 - from];
            }
        }
        let kept: f64 = next.iter().sum();
        next.iter_mut().for_each(|share| *share /= kept);
        share = next;
        let is_steady = alarms > 0.0 && (alarms - flow).abs() <= 1e-6 * alarms;
        flow = alarms;
        if is_steady {
            break;
        }
    }
    2.0 * flow
}

/// Standard deviation of the mean of a window.
fn window_sigma(noise: Noise) -> f64 {
    let (n, by) = (WINDOW as f64, noise.correlation());
    let pairs: f64 = (1..WINDOW)
        .map(|apart| 2.0 * (n - apart as f64) * by.powi(apart as i32))
        .sum();
    noise.sigma() * (n + pairs).sqrt() / n
}

/// Chain from step to step, on the mean at the last step and the number of steps in a row, one direction; the other alarms equally often.
/// At a mean m the next step takes 1 / P(further than `step` from m) windows.
fn windows(step: f64, noise: Noise, states: usize) -> f64 {
    if noise == Noise::Uniform && step >= 0.5 {
        return 0.0;
    }
    // In standard deviations of a mean.
    const REACH: f64 = 10.0;
    let step = step / window_sigma(noise);
    let width = 2.0 * REACH / states as f64;
    let at = |state: usize| -REACH + (state as f64 + 0.5) * width;
    let mass: Vec<f64> = (0..states)
        .map(|state| normal_tail(at(state) - 0.5 * width) - normal_tail(at(state) + 0.5 * width))
        .collect();
    let moves: Vec<f64> = (0..states)
        .map(|from| normal_tail(at(from) + step) + normal_tail(step - at(from)))
        .collect();
    // By steps in a row upward, 0 after a step downward.
    let mut shares = vec![vec![0.0; states]; 4];
    shares[0] = mass.clone();
    let mut rate = 0.0;
    for _ in 0..1000 {
        let mut next = vec![vec![0.0; states]; 4];
        let (mut alarms, mut turns) = (0.0, 0.0);
        for (row, shares) in shares.iter().enumerate() {
            for (from, &share) in shares.iter().enumerate() {
                if share < 1e-100 || moves[from] == 0.0 {
                    continue;
                }
                turns += share / moves[from];
                for to in 0..states {
                    let by = at(to) - at(from);
                    let part = share * mass[to] / moves[from];
                    if by > step {
                        if row == 3 {
                            alarms += part;
                        } else {
                            next[row + 1][to] += part;
                        }
                    } else if by < -step {
                        next[0][to] += part;
                    }
                }
            }
        }
        let kept: f64 = next.iter().flatten().sum();
        if kept == 0.0 {
            return 0.0;
        }
        next.iter_mut().flatten().for_each(|share| *share /= kept);
        shares = next;
        let found = alarms / turns;
        let is_steady = found > 0.0 && (found - rate).abs() <= 1e-4 * found;
        rate = found;
        if is_steady {
            break;
        }
    }
    2.0 * rate / WINDOW as f64
}

/// Sums of one length.
struct Template {
    length: usize,
    limit: f64,
    sigma: f64,
    /// Probability that the sum exceeds its limit.
    tail: f64,
}

fn clumps(
    shape: Shape,
    longest: usize,
    limit: &dyn Fn(usize) -> f64,
    noise: Noise,
    draws: u64,
) -> f64 {
    let templates: Vec<_> = lengths(longest)
        .into_iter()
        .map(|length| {
            let covariance = covariances(shape, length, 0, 0, noise.correlation());
            let variance: f64 = covariance
                .iter()
                .enumerate()
                .map(|(i, covariance)| shape.weight(i + 1) * covariance)
                .sum();
            let (limit, sigma) = (limit(length), variance.sqrt());
            let tail = normal_tail(limit / sigma);
            Template {
                length,
                limit,
                sigma,
                tail,
            }
        })
        .collect();
    let all: f64 = templates.iter().map(|template| template.tail).sum();
    if all == 0.0 {
        return 0.0;
    }
    let parts: f64 = (0..draws)
        .into_par_iter()
        .map(|draw| part_of_clump(shape, &templates, all, noise, draw))
        // An ordered sum has the same bits each time.
        .collect::<Vec<_>>()
        .iter()
        .sum();
    2.0 * all * parts / draws as f64
}

/// Covariances of readings with a weighted sum of `length` readings, from `before` turns before these to `after` turns after them.
fn covariances(
    shape: Shape,
    length: usize,
    before: usize,
    after: usize,
    correlation: f64,
) -> Vec<f64> {
    let turns = before + length + after;
    let weight = |turn: usize| {
        if (before..before + length).contains(&turn) {
            shape.weight(turn - before + 1)
        } else {
            0.0
        }
    };
    let mut found = vec![0.0; turns];
    let (mut earlier, mut later) = (0.0, 0.0);
    for (turn, found) in found.iter_mut().enumerate() {
        earlier = earlier * correlation + weight(turn);
        *found += earlier;
    }
    for (turn, found) in found.iter_mut().enumerate().rev() {
        *found += later;
        later = (later + weight(turn)) * correlation;
    }
    found.iter_mut().for_each(|found| *found *= SIGMA * SIGMA);
    found
}

/// Draws a sum that exceeds its limit, and the readings around it; returns 1 over the number of sums that do so.
fn part_of_clump(shape: Shape, templates: &[Template], all: f64, noise: Noise, draw: u64) -> f64 {
    let mut errors = Errors::new(noise, draw);
    let mut left = all * errors.uniform();
    let chosen = templates
        .iter()
        .find(|template| {
            left -= template.tail;
            left <= 0.0
        })
        .unwrap_or(&templates[0]);
    let z = errors.normal_above(chosen.limit / chosen.sigma);
    // Sums that overlap the chosen one by little exceed their limits rarely.
    let margin = 2 * chosen.length + 64;
    let longest = templates.last().map_or(1, |template| template.length);
    let before = margin + longest.min(4 * chosen.length + 64);
    let drawn: Vec<f64> = (0..before + chosen.length + margin)
        .map(|_| errors.draw())
        .collect();
    let mut sums = Sums::new(shape);
    drawn.iter().for_each(|&x| sums.add(x));
    let end = before + chosen.length;
    let missing = z * chosen.sigma - sums.sum(end, chosen.length);
    let covariance = covariances(shape, chosen.length, before, margin, noise.correlation());
    let mut sums = Sums::new(shape);
    for (x, covariance) in drawn.iter().zip(covariance) {
        sums.add(x + covariance * missing / (chosen.sigma * chosen.sigma));
    }
    let count = (end - margin..=end + margin)
        .flat_map(|turn| templates.iter().map(move |template| (turn, template)))
        .filter(|(turn, template)| {
            template.length <= *turn && sums.sum(*turn, template.length) > template.limit
        })
        .count();
    1.0 / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const EFFORT: Effort = Effort {
        states: 120,
        clumps: 300,
    };

    /// Alarms a turn by simulation. The detector begins anew after each.
    fn simulated(rule: Rule, threshold: f64, noise: Noise, alarms: u32) -> f64 {
        let mut errors = Errors::new(noise, 7);
        let mut turns = 0_u32;
        for _ in 0..alarms {
            let mut detector = rule.detector(threshold);
            turns += 1;
            while !detector(errors.draw()) {
                turns += 1;
            }
        }
        f64::from(alarms) / f64::from(turns)
    }

    fn agrees(rule: Rule, noise: Noise, required: f64, within: f64) {
        let threshold = threshold(rule, required, noise, EFFORT).unwrap();
        let found = simulated(rule, threshold, noise, 100);
        let ratio = found / required;
        assert!(
            (1.0 / within..within).contains(&ratio),
            "{} {}: {ratio} at {threshold}",
            rule.name(),
            noise.name()
        );
    }

    /// J. M. Lucas and R. B. Crosier, Fast initial response for CUSUM quality-control schemes, Technometrics 24 (1982): 465 readings in both
    /// directions, with k of half a standard deviation and h of five.
    #[test]
    fn the_rate_of_cusum_is_the_published_one() {
        let noise = Noise::Normal { correlation: 0.0 };
        let found = cusum(0.5 * SIGMA, 5.0 * SIGMA, noise, EFFORT.states);
        assert!((465.0 * found - 1.0).abs() < 0.02, "{}", 1.0 / found);
    }

    #[test]
    fn rates_of_independent_readings_are_those_of_a_simulation() {
        for noise in [Noise::Uniform, Noise::Normal { correlation: 0.0 }] {
            for rule in [Rule::Range, Rule::Cusum { k: 0.25 }] {
                agrees(rule, noise, 1e-3, 1.3);
            }
            agrees(Rule::Windows, noise, 2e-5, 1.4);
        }
        let noise = Noise::Normal { correlation: 0.0 };
        agrees(Rule::GlrSlope, noise, 1e-4, 1.4);
    }

    #[test]
    fn rates_of_correlated_readings_are_those_of_a_simulation() {
        let noise = Noise::Normal { correlation: 0.9 };
        agrees(Rule::Cusum { k: 0.25 }, noise, 1e-4, 1.5);
        agrees(Rule::GlrStep, noise, 1e-4, 1.5);
    }
}
