//! amax(t) as a scene's text defines it (docs of the scene's keys), in f64 and in seconds. It uses
//! nothing of the core's program, its ticks or its fixed point.

use cophase_scene::file::{Segment, Shape};

/// The unit of `amax_g`, m/s².
const GRAVITY_MPS2: f64 = 9.80665;

/// A level, the ramp to it, and the time at it.
#[derive(Clone, Copy, Debug)]
struct Leg {
    amax_mps2: f64,
    ramp_s: f64,
    hold_s: f64,
    smooth: bool,
}

/// A program with its repeats written out.
#[derive(Clone, Debug)]
pub struct Program(Vec<Leg>);

impl Program {
    /// Makes a program from a scene's entries.
    pub fn new(entries: &[Segment]) -> Self {
        let mut legs = Vec::new();
        write_out(entries, &mut legs);
        Self(legs)
    }

    /// Duration of the program.
    pub fn duration_s(&self) -> f64 {
        self.0.iter().map(|leg| leg.ramp_s + leg.hold_s).sum()
    }

    /// Requested level.
    pub fn amax_mps2(&self, t_s: f64) -> f64 {
        let (mut since_s, mut from) = (t_s, 0.0);
        for leg in &self.0 {
            if since_s < leg.ramp_s {
                let x = since_s / leg.ramp_s;
                let part = if leg.smooth {
                    // The quintic with zero first and second derivative at both ends.
                    x.powi(3) * (x * (6.0 * x - 15.0) + 10.0)
                } else {
                    x
                };
                return from + (leg.amax_mps2 - from) * part;
            }
            from = leg.amax_mps2;
            since_s -= leg.ramp_s + leg.hold_s;
            if since_s < 0.0 {
                break;
            }
        }
        from
    }

    /// ∫ f(t) dt by Simpson's rule between the corners of the program, 2,000 intervals each. There f
    /// is as smooth as a polynomial's root, and the rule's error is below 1e-12.
    pub fn integral(&self, from_s: f64, to_s: f64, f: impl Fn(f64) -> f64) -> f64 {
        const INTERVALS: u32 = 2000;
        let mut corners = vec![from_s];
        let mut t_s = 0.0;
        for leg in &self.0 {
            for span_s in [leg.ramp_s, leg.hold_s] {
                t_s += span_s;
                if t_s > corners[corners.len() - 1] + 1e-9 && t_s < to_s - 1e-9 {
                    corners.push(t_s);
                }
            }
        }
        corners.push(to_s);
        let piece = |a: f64, b: f64| {
            let h = (b - a) / f64::from(INTERVALS);
            let weight = |i: u32| match i {
                0 | INTERVALS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let sum: f64 = (0..=INTERVALS)
                .map(|i| weight(i) * f(a + h * f64::from(i)))
                .sum();
            sum * h / 3.0
        };
        corners.windows(2).map(|pair| piece(pair[0], pair[1])).sum()
    }
}

fn write_out(entries: &[Segment], legs: &mut Vec<Leg>) {
    for entry in entries {
        if let Some(segments) = &entry.segments {
            for _ in 0..entry.repeat.expect("a block is repeated") {
                write_out(segments, legs);
            }
            continue;
        }
        legs.push(Leg {
            amax_mps2: entry.amax_g.expect("a level") * GRAVITY_MPS2,
            ramp_s: entry.ramp_s.unwrap_or(0.0),
            hold_s: entry.hold_s.unwrap_or(0.0),
            smooth: entry.shape != Some(Shape::Linear),
        });
    }
}
