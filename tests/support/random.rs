//! Random small scenes: any number of axes, mixed drives, gears and offsets, programs with repeats and
//! bands, and all kinds of events.

use std::f64::consts::{FRAC_PI_2, TAU};

use cophase_tests::scripted::{command, input};
use cophase_tests::{SceneBuilder, bench_scene};
use proptest::prelude::*;

/// Settings of an axis, from the scene's text alone.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Crank turns per master turn.
    pub ratio: (u32, u32),
    /// Motor turns and crank turns that belong together.
    pub gear: (u32, u32),
    /// In eighths of a turn, which are exact in binary.
    pub offset_eighths: i64,
    /// Steps or counts.
    pub steps_per_turn: u32,
    /// Mounted the other way round.
    pub reversed: bool,
    /// Driven by setpoints.
    pub servo: bool,
}

/// Percent of the greatest speed, ramp in ms, hold in ms, and true if the ramp is linear.
type Level = (u32, u32, u32, bool);

/// Number of repeats, and the repeated levels.
type Block = (u32, Vec<Level>);

/// Numbers from which a scene is written.
#[derive(Clone, Debug)]
pub struct Plan {
    tick_hz: u32,
    speed_hz: u32,
    acceleration: u32,
    jerk: u32,
    bands: bool,
    /// The axes.
    pub axes: Vec<Axis>,
    program: Vec<Block>,
    /// Time of each event, ms, and its kind.
    happens: Vec<(u32, u32)>,
    /// Times at which the loop is late, ms, and delays, in tenths of a tick.
    late: Vec<(u32, u32)>,
}

const RADIUS_M: f64 = 0.012;
const LAMBDA: f64 = 0.25;

impl Plan {
    /// The scene.
    pub fn scene(&self) -> SceneBuilder {
        let mut scene = self
            .machine()
            .with("control = { park_deg = 75, settle_s = 0.02 }")
            .set("control.tick_hz", self.tick_hz)
            .set("limits.speed_hz", self.speed_hz)
            .set("limits.acceleration_hz_per_s", self.acceleration)
            .set("limits.jerk_hz_per_s2", self.jerk)
            .set("limits.homing_speed_hz", 4)
            .set("axes.count", self.axes.len() as i64)
            .set("axes.steps_per_turn", 1600);
        if self.bands {
            let edge = |share: f64| share * f64::from(self.speed_hz);
            scene = scene.with(&format!(
                "limits.band = [{{ from_hz = {}, to_hz = {} }}, {{ from_hz = {}, to_hz = {} }}]",
                edge(0.3),
                edge(0.4),
                edge(0.6),
                edge(0.65)
            ));
        }
        for (i, axis) in self.axes.iter().enumerate() {
            scene = scene
                .axis(i, "reversed", axis.reversed)
                .axis(i, "drive", if axis.servo { "servo" } else { "stepper" })
                .axis(i, "steps_per_turn", axis.steps_per_turn)
                .axis(i, "ratio", vec![axis.ratio.0, axis.ratio.1])
                .axis(i, "gear", vec![axis.gear.0, axis.gear.1])
                .axis(i, "offset_deg", axis.offset_eighths * 45)
                .axis(i, "index_deg", axis.offset_eighths * 45);
        }
        scene.with(&self.program()).with(&self.events())
    }

    /// Machine of the scene. Ratios are for machines without a platform: cams that accelerate as the crank.
    fn machine(&self) -> SceneBuilder {
        if self.axes.iter().all(|axis| axis.ratio.0 == axis.ratio.1) {
            return bench_scene()
                .set("machine.allow_commanded_tilt", true)
                .set("machine.crank_radius_mm", RADIUS_M * 1e3)
                .set("machine.lambda", LAMBDA);
        }
        // A cycloid over half a turn accelerates by at most 2 H ω²/π.
        bench_scene()
            .without("machine")
            .with("cam = { law = \"cycloid\", rise_deg = 180, dwell_deg = 0, return_deg = 180 }")
            .set("cam.rise_mm", RADIUS_M * (1.0 + LAMBDA) * FRAC_PI_2 * 1e3)
    }

    fn program(&self) -> String {
        let mut text = String::new();
        for (times, levels) in &self.program {
            text += &format!("[[program]]\nrepeat = {times}\nsegments = [\n");
            for &(percent, ramp_ms, hold_ms, linear) in levels {
                let omega = TAU * f64::from(self.speed_hz * percent) / 100.0;
                let amax_g = RADIUS_M * (1.0 + LAMBDA) * omega * omega / 9.80665;
                let shape = if linear { "linear" } else { "smooth" };
                text += &format!(
                    "{{ amax_g = {amax_g}, ramp_s = {}, hold_s = {}, shape = \"{shape}\" }},\n",
                    f64::from(ramp_ms) / 1e3,
                    f64::from(hold_ms) / 1e3
                );
            }
            text += "]\n";
        }
        text
    }

    fn events(&self) -> String {
        let mut text = String::new();
        for &(ms, what) in &self.happens {
            let at_s = |later_ms: u32| f64::from(ms + later_ms) / 1e3;
            text += &match what {
                0 => command(at_s(0), "stop"),
                1 => command(at_s(0), "stop") + &command(at_s(900), "start"),
                2 => command(at_s(0), "hold") + &command(at_s(300), "resume"),
                3 => command(at_s(0), "reset"),
                4 => input(at_s(0), "enable", false) + &input(at_s(150), "enable", true),
                _ => input(at_s(0), "stop", true) + &input(at_s(150), "stop", false),
            };
        }
        if !self.happens.is_empty() {
            text += &command(0.0, "start");
        }
        for &(ms, tenths) in &self.late {
            let by_us = tenths * 100_000 / self.tick_hz;
            let at_s = f64::from(ms) / 1e3;
            text += &format!("[[late]]\nat_s = {at_s}\nby_us = {by_us}\n");
        }
        text
    }
}

fn any_axis() -> impl Strategy<Value = Axis> {
    let ratio = prop_oneof![
        3 => Just((1, 1)),
        1 => (1_u32..=7, 1_u32..=7).prop_filter("at most 3 times as fast", |(p, q)| *p <= 3 * q),
        1 => Just((355, 113)),
    ];
    let gear = prop_oneof![
        3 => Just((1, 1)),
        1 => (1_u32..=7, 1_u32..=7),
        2 => prop::sample::select(vec![(57_u32, 11_u32), (50, 17), (20, 36), (1000, 999)]),
    ];
    let offset = prop_oneof![2 => Just(0_i64), 1 => -4_i64..=4];
    let steps = prop::sample::select(vec![1600_u32, 1600, 200, 3217]);
    (
        (ratio, gear).prop_filter("at most 5 times as fast", |((p, q), (m, c))| {
            p * m <= 5 * q * c
        }),
        offset,
        steps,
        any::<bool>(),
        prop::bool::weighted(0.3),
    )
        .prop_map(
            |((ratio, gear), offset_eighths, steps_per_turn, reversed, servo)| Axis {
                ratio,
                gear,
                offset_eighths,
                steps_per_turn,
                reversed,
                servo,
            },
        )
}

/// Any scene that the checks accept. It is short, because there are many cases.
pub fn any_plan() -> impl Strategy<Value = Plan> {
    let level = (0_u32..=98, 0_u32..=600, 20_u32..=300, any::<bool>());
    let block = (1_u32..=3, prop::collection::vec(level, 1..=2));
    (
        (
            prop::sample::select(vec![1000_u32, 2000, 4000]),
            15_u32..=45,
            30_u32..=300,
            300_u32..=9000,
        ),
        any::<bool>(),
        prop::collection::vec(any_axis(), 2..=6),
        prop::collection::vec(block, 1..=3),
        prop::collection::vec((100_u32..3000, 0_u32..=5), 0..=4),
        prop::collection::vec((50_u32..3000, 1_u32..=35), 0..=4),
    )
        .prop_map(|(numbers, bands, axes, program, happens, late)| {
            let (tick_hz, speed_hz, acceleration, jerk) = numbers;
            Plan {
                tick_hz,
                speed_hz,
                acceleration,
                jerk,
                bands,
                axes,
                program,
                happens,
                late,
            }
        })
}
