//! Commanded phases and the limits of a platform: a random scene is refused, or its platform stays within its limits in every tick.
//!
//! The judge knows the cranks of a run without faults, which stand at their whole steps, and no code of the loop or of the simulator. It has its own positions of the mechanisms,
//! its own plane through the corners, and its own warp.

use std::f64::consts::{PI, TAU};

use cophase_tests::{SceneBuilder, bench_scene};
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer, simulate};

/// Number of random scenes. Each runs until its slowest trim, of 30°, has moved in.
const SCENES: u64 = 300;
/// Part of a limit by which settings may exceed it, for the angles between those that are computed, and for whole steps of a trim.
const ROUNDING: f64 = 1e-3;

/// Steps per turn of most cranks. One in eight has another number.
const STEPS: u32 = 20_000;

/// Rate of the trims, degrees per second, and their largest part that a crank has ahead of the others. They take turns, so six cranks make
/// 0.06° in each tick of their slots, and as many whole steps.
const TRIM_RATE_DEG_PER_S: f64 = 20.0;
const SLOT_DEG: f64 = 0.06;

/// Random numbers of one scene (xorshift).
struct Draw(u64);

impl Draw {
    fn new(seed: u64) -> Self {
        let mut draw = Self((seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        for _ in 0..8 {
            draw.part();
        }
        draw
    }

    fn part(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn one_in(&mut self, count: u32) -> bool {
        self.part() * f64::from(count) < 1.0
    }
}

#[derive(Clone, Copy, Debug)]
enum Mechanism {
    SliderCrank {
        lambda: f64,
    },
    ScotchYoke,
    CrankRocker {
        crank: f64,
        coupler: f64,
        ground: f64,
    },
}

impl Mechanism {
    fn draw(draw: &mut Draw) -> Self {
        match (draw.part() * 3.0) as u32 {
            0 => Self::SliderCrank {
                lambda: draw.between(0.1, 0.6),
            },
            1 => Self::ScotchYoke,
            _ => Self::CrankRocker {
                crank: draw.between(0.2, 0.42),
                coupler: 1.5,
                ground: 2.0,
            },
        }
    }

    /// Travel of a corner at a crank angle, per crank radius, or per radian of the rocker. Its origin has no effect on a tilt.
    fn travel(self, angle: f64) -> f64 {
        match self {
            Self::SliderCrank { lambda } => {
                angle.cos() + (1.0 / (lambda * lambda) - angle.sin().powi(2)).sqrt()
            }
            Self::ScotchYoke => angle.cos(),
            Self::CrankRocker {
                crank,
                coupler,
                ground,
            } => {
                // At angle 0 crank and coupler are in line, above the ground link: a triangle with sides of this length, the ground, and 1.
                let line = crank + coupler;
                let zero = ((line * line + ground * ground - 1.0) / (2.0 * line * ground)).acos();
                let (pin_x, pin_y) = (crank * (zero + angle).cos(), crank * (zero + angle).sin());
                let to_pin = (pin_x - ground).hypot(pin_y);
                let pin_angle = PI - pin_y.atan2(ground - pin_x);
                let beside = ((1.0 + to_pin * to_pin - coupler * coupler) / (2.0 * to_pin)).acos();
                pin_angle - beside
            }
        }
    }

    fn keys(self, radius_mm: f64) -> String {
        match self {
            Self::SliderCrank { lambda } => {
                format!("crank_radius_mm = {radius_mm}\nlambda = {lambda}\n")
            }
            Self::ScotchYoke => {
                format!("mechanism = \"scotch-yoke\"\ncrank_radius_mm = {radius_mm}\n")
            }
            Self::CrankRocker {
                crank,
                coupler,
                ground,
            } => format!(
                "mechanism = \"crank-rocker\"\nscrew_lead_mm = {}\ncrank_ratio = {crank}\ncoupler_ratio = {coupler}\nground_ratio = {ground}\n",
                TAU * radius_mm
            ),
        }
    }
}

/// Largest slope of a mechanism's travel over the crank angle.
fn steepest(mechanism: Mechanism) -> f64 {
    let step = TAU / 720.0;
    let at = |i: i32| mechanism.travel(step * f64::from(i));
    (0..720)
        .map(|i| (at(i + 1) - at(i)).abs() / step)
        .fold(0.0, f64::max)
}

/// Platform of a random scene, and its largest tilt and warp so far.
#[derive(Debug)]
struct Judge {
    mechanism: Mechanism,
    /// Radius of the cranks over that of the circle on which they stand, in thousandths.
    radii: f64,
    tilt_mrad: f64,
    warp_deg: f64,
}

/// Coefficients of the plane z = a + b cos θ + c sin θ closest to values at equal angles θ of a circle, by the normal equations. Two points
/// have a line through them.
fn plane(values: &[f64]) -> [f64; 3] {
    if let [one, other] = values {
        return [0.5 * (one + other), 0.5 * (one - other), 0.0];
    }
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for (i, value) in values.iter().enumerate() {
        let theta = TAU * i as f64 / values.len() as f64;
        let row = nalgebra::Vector3::new(1.0, theta.cos(), theta.sin());
        normal += row * row.transpose();
        right += row * *value;
    }
    let solved = normal.lu().solve(&right).expect("three corners or more");
    [solved[0], solved[1], solved[2]]
}

impl Observer for Judge {
    fn tick(&mut self, moment: &Moment<'_>) {
        let cranks = moment.actual_turns;
        let heights: Vec<f64> = cranks
            .iter()
            .map(|turns| self.mechanism.travel(TAU * turns))
            .collect();
        let [_, x, y] = plane(&heights);
        self.tilt_mrad = self.tilt_mrad.max(self.radii * x.hypot(y));
        let leads: Vec<f64> = cranks
            .iter()
            .map(|turns| 360.0 * ((turns - cranks[0] + 0.5).rem_euclid(1.0) - 0.5))
            .collect();
        let [mean, x, y] = plane(&leads);
        for (i, lead) in leads.iter().enumerate() {
            let theta = TAU * i as f64 / leads.len() as f64;
            let off = lead - mean - x * theta.cos() - y * theta.sin();
            self.warp_deg = self.warp_deg.max(off.abs());
        }
    }
}

/// Scene with its limits on tilt, mrad, and warp, degrees.
struct Case {
    machine: SceneBuilder,
    mechanism: Mechanism,
    radii: f64,
    tilt_mrad: f64,
    warp_deg: f64,
    /// Largest step of a crank, degrees.
    step_deg: f64,
    /// True if trims may undo offsets, wholly or in part. A run may tilt less than such a scene can, because trims move in whether the cranks turn or not.
    may_undo: bool,
}

/// Returns the random scene of a seed. Its offsets and trims tilt the platform by up to some times its limit.
fn case(seed: u64) -> Case {
    let draw = &mut Draw::new(seed);
    let count = 2 + (draw.part() * 5.0) as usize;
    let mechanism = Mechanism::draw(draw);
    let radius_mm = draw.log_between(1.0, 50.0);
    let mount_mm = draw.log_between(2.0, 100.0) * radius_mm.max(5.0);
    let tilt_mrad = draw.log_between(0.2, 100.0);
    let radii = 1e3 * radius_mm / mount_mm;
    // Largest lead, degrees: one that tilts by some limits. Any two cranks stay less than half a turn apart.
    let lead_deg = ((tilt_mrad / radii).to_degrees() * draw.between(0.0, 4.0)).min(45.0);
    let warp_deg = (lead_deg * draw.between(0.2, 3.0)).clamp(0.01, 90.0);
    let mut machine = bench_scene()
        .without("machine")
        .set("fidelity", "kinematic")
        .with(&format!(
            "[machine]\n{}load_kg = 0.1",
            mechanism.keys(radius_mm)
        ))
        .set("machine.mount_radius_mm", mount_mm)
        .with(&format!(
            "control.park_deg = {:.1}",
            draw.between(0.0, 359.0)
        ))
        .set("drift.tilt_limit_mrad", tilt_mrad)
        .set("drift.warp_limit_deg", warp_deg)
        .set("drift.reading_error_deg", 0.01)
        .set("correction.gain", if draw.one_in(2) { 0.3 } else { 0.0 })
        .set("correction.prove_wiring", draw.one_in(3))
        .with("limits = { speed_hz = 8, jerk_hz_per_s2 = 400, homing_speed_hz = 4 }")
        .set("axes.count", count as i64)
        .set("axes.steps_per_turn", STEPS)
        .set("axes.trim_limit_deg", 36)
        .set("axes.trim_rate_deg_per_s", TRIM_RATE_DEG_PER_S)
        // About 3 rev/s.
        .program([(radius_mm * 1e-3 * (3.0 * TAU).powi(2) / 9.81, 0.3, 2.2)]);
    let common_deg = if draw.one_in(3) {
        draw.between(-90.0, 90.0)
    } else {
        0.0
    };
    let (are_offset, are_trimmed) = (!draw.one_in(3), !draw.one_in(3));
    // Trims that undo offsets, in some scenes.
    let undo = draw.one_in(4);
    // A step is no more than a fifth of what tilts to the limit, or the monitor cannot find that a crank is within it.
    let coarsest = (5.0 * 360.0 / (tilt_mrad / radii).to_degrees()).clamp(200.0, 20_000.0);
    let mut min = STEPS;
    for number in 0..count {
        let own = draw.between(-lead_deg, lead_deg);
        let offset_deg = common_deg + if are_offset { own } else { 0.0 };
        let trim_deg = match (are_trimmed, undo) {
            (false, _) => 0.0,
            (true, true) => -own,
            (true, false) => draw.between(-lead_deg, lead_deg),
        }
        .clamp(-30.0, 30.0);
        let reversed = draw.one_in(3);
        let steps = if draw.one_in(8) {
            draw.log_between(coarsest, 50_000.0) as u32
        } else {
            STEPS
        };
        min = min.min(steps);
        machine = machine
            .axis(number, "reversed", reversed)
            .axis(number, "steps_per_turn", steps)
            .axis(number, "offset_deg", offset_deg)
            .axis(number, "trim_deg", trim_deg);
    }
    Case {
        machine,
        mechanism,
        radii,
        tilt_mrad,
        warp_deg,
        step_deg: 360.0 / f64::from(min),
        may_undo: are_offset && are_trimmed,
    }
}

/// Runs a scene that was accepted, and returns what the judge saw.
fn judged(case: &Case, checked: &Checked, seed: u64) -> Judge {
    let mut judge = Judge {
        mechanism: case.mechanism,
        radii: case.radii,
        tilt_mrad: 0.0,
        warp_deg: 0.0,
    };
    let outcome = simulate(checked, &mut judge, |_, _| {}).expect("it runs");
    assert!(outcome.fault.is_none(), "{seed}: {:?}", outcome.fault);
    assert!(outcome.record.axes[0].command_turns.abs() > 2.0, "{seed}");
    judge
}

/// If this fails, a scene is accepted whose commanded phases alone tilt or warp the platform beyond the limits that the user reads; or one is
/// refused whose platform would stay within them.
#[test]
fn commanded_phases_keep_platform_limits_or_are_refused() {
    let (mut accepted, mut refused, mut close) = (0, 0, 0);
    for seed in 0..SCENES {
        let case = case(seed);
        match case.machine.check() {
            Ok(checked) => {
                let judge = judged(&case, &checked, seed);
                assert!(
                    judge.tilt_mrad <= case.tilt_mrad * (1.0 + ROUNDING)
                        && judge.warp_deg <= case.warp_deg * (1.0 + ROUNDING),
                    "{seed}: {} of {} mrad, {}° of {}°\n{}",
                    judge.tilt_mrad,
                    case.tilt_mrad,
                    judge.warp_deg,
                    case.warp_deg,
                    case.machine.text()
                );
                close += usize::from(judge.tilt_mrad > 0.5 * case.tilt_mrad);
                accepted += 1;
            }
            Err(error) => {
                let said = error.to_string();
                if !said.contains("machine.allow_commanded_tilt") {
                    // The tilts that prove the wiring exceed a limit by themselves.
                    assert!(said.contains("proving the wiring"), "{seed}: {said}");
                    continue;
                }
                let meant = case
                    .machine
                    .clone()
                    .set("machine.allow_commanded_tilt", true);
                let checked = match meant.check() {
                    Ok(checked) => checked,
                    // This needs room for its own tilts, even so.
                    Err(error) => {
                        let said = error.to_string();
                        assert!(said.contains("proving the wiring"), "{seed}: {said}");
                        continue;
                    }
                };
                refused += 1;
                if case.may_undo {
                    continue;
                }
                let judge = judged(&case, &checked, seed);
                // Two cranks by a slot and a step, in opposite directions, at the steepest part of the mechanism.
                let apart_deg = SLOT_DEG + case.step_deg;
                let slot_mrad =
                    case.radii * 2.0 * apart_deg.to_radians() * steepest(case.mechanism);
                assert!(
                    judge.tilt_mrad + slot_mrad > case.tilt_mrad * (1.0 - ROUNDING)
                        || judge.warp_deg + 2.0 * apart_deg > case.warp_deg * (1.0 - ROUNDING),
                    "{seed}: {said}, but {judge:?}"
                );
            }
        }
    }
    println!(
        "{accepted} accepted, {close} of them above half of their limit on tilt; {refused} refused"
    );
    assert!(accepted > SCENES / 5 && refused > SCENES / 5 && close > 20);
}
