//! `[[program]]`: levels and blocks, some seconds in all.

use std::f64::consts::TAU;

use cophase_scene::file::{Segment, Shape};
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::mechanism::Mechanism;

use crate::basis::Basis;
use crate::source::{Source, at_most};

/// Greatest level that a program can ask for, m/s².
const MAX_MPS2: f64 = 10_000.0;

/// Longest time of a usual program, s, and of a long one.
const USUAL_S: f64 = 3.0;
const LONG_S: f64 = 40.0;

pub fn program(source: &mut Source, basis: &Basis) -> Vec<Segment> {
    let max_s = if source.percent(2) { LONG_S } else { USUAL_S };
    let whole_s = source.log_between(0.1, max_s);
    let count = 1 + source.below(4);
    let each_s = whole_s / count as f64;
    (0..count)
        .map(|_| entry(source, basis, each_s, 0))
        .collect()
}

/// A level, or in some cases a block, which takes about `takes_s`.
fn entry(source: &mut Source, basis: &Basis, takes_s: f64, depth: usize) -> Segment {
    const MAX_DEPTH: usize = 3;
    if depth == MAX_DEPTH || !source.percent(15) {
        return level(source, basis, takes_s);
    }
    let repeat = 1 + source.below(4);
    let inside = 1 + source.below(2);
    let each_s = takes_s / (repeat * inside) as f64;
    Segment {
        repeat: Some(repeat as u32),
        segments: Some(
            (0..inside)
                .map(|_| entry(source, basis, each_s, depth + 1))
                .collect(),
        ),
        ..Segment::default()
    }
}

fn level(source: &mut Source, basis: &Basis, takes_s: f64) -> Segment {
    let part = source.one_of(&[0.0, 0.3, 0.6, 0.6, 0.8, 1.0]);
    let part = if source.percent(70) {
        source.log_between(0.05, 1.0)
    } else {
        part
    };
    let max_mps2 = basis.max_amax_mps2().min(MAX_MPS2);
    let amax_mps2 = basis
        .mechanism
        .amax_mps2(part * basis.speed_hz * TAU)
        .min(max_mps2);
    let ramp_s = takes_s * source.between(0.1, 0.9);
    let (ramp_s, hold_s) = match source.below(12) {
        0 => (None, Some(takes_s)),
        1 => (Some(takes_s), None),
        2 => (Some(0.0), Some(takes_s)),
        _ => (Some(ramp_s), Some(takes_s - ramp_s)),
    };
    // At least a tick.
    let seconds = |s: f64| {
        if s > 0.0 {
            (s.max(0.003) * 1e4).round() * 1e-4
        } else {
            0.0
        }
    };
    Segment {
        amax_g: Some(at_most(amax_mps2 / STANDARD_GRAVITY_MPS2)),
        ramp_s: ramp_s.map(seconds),
        hold_s: hold_s.map(seconds),
        shape: source.maybe(40, |source| source.one_of(&[Shape::Smooth, Shape::Linear])),
        repeat: None,
        segments: None,
    }
}

/// Time that a program takes, s.
pub fn length_s(program: &[Segment]) -> f64 {
    let each = program
        .iter()
        .map(|entry| match (&entry.segments, entry.repeat) {
            (Some(segments), Some(repeat)) => f64::from(repeat) * length_s(segments),
            _ => entry.ramp_s.unwrap_or(0.0) + entry.hold_s.unwrap_or(0.0),
        });
    each.sum()
}
