//! Random small scenes: any number of axes, mixed drives, gears and offsets, programs with repeats and
//! bands, and all kinds of events.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

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
    /// The scene file.
    pub fn text(&self) -> String {
        let mut text = format!(
            "name = \"random\"\n{}\n\
             [control]\ntick_hz = {}\npark_deg = 75\nsettle_s = 0.02\n\
             [limits]\nspeed_hz = {}\nacceleration_hz_per_s = {}\njerk_hz_per_s2 = {}\nhoming_speed_hz = 4\n",
            self.machine(),
            self.tick_hz,
            self.speed_hz,
            self.acceleration,
            self.jerk
        );
        if self.bands {
            let edge = |share: f64| share * f64::from(self.speed_hz);
            text += &format!(
                "band = [{{ from_hz = {}, to_hz = {} }}, {{ from_hz = {}, to_hz = {} }}]\n",
                edge(0.3),
                edge(0.4),
                edge(0.6),
                edge(0.65)
            );
        }
        text += &format!(
            "[axes]\ncount = {}\ndrive = \"stepper\"\nsteps_per_turn = 1600\n",
            self.axes.len()
        );
        for (i, axis) in self.axes.iter().enumerate() {
            text += &format!(
                "[[axis]]\nnumber = {i}\nreversed = {}\ndrive = \"{}\"\nsteps_per_turn = {}\n\
                 ratio = [{}, {}]\ngear = [{}, {}]\noffset_deg = {}\nindex_deg = {}\n",
                axis.reversed,
                if axis.servo { "servo" } else { "stepper" },
                axis.steps_per_turn,
                axis.ratio.0,
                axis.ratio.1,
                axis.gear.0,
                axis.gear.1,
                axis.offset_eighths * 45,
                axis.offset_eighths * 45
            );
        }
        for (times, levels) in &self.program {
            text += &format!("[[program]]\nrepeat = {times}\nsegments = [\n");
            for &(percent, ramp_ms, hold_ms, linear) in levels {
                let omega = TAU * f64::from(self.speed_hz * percent) / 100.0;
                let amax_g = RADIUS_M * (1.0 + LAMBDA) * omega * omega / 9.80665;
                let shape = if linear { "linear" } else { "smooth" };
                let _ = writeln!(
                    text,
                    "{{ amax_g = {amax_g}, ramp_s = {}, hold_s = {}, shape = \"{shape}\" }},",
                    f64::from(ramp_ms) / 1e3,
                    f64::from(hold_ms) / 1e3
                );
            }
            text += "]\n";
        }
        for &(ms, what) in &self.happens {
            let mut command = |later_ms: u32, name: &str| {
                let at_s = f64::from(ms + later_ms) / 1e3;
                let _ = writeln!(text, "[[command]]\nat_s = {at_s}\ndo = \"{name}\"");
            };
            match what {
                0 => command(0, "stop"),
                1 => {
                    command(0, "stop");
                    command(900, "start");
                }
                2 => {
                    command(0, "hold");
                    command(300, "resume");
                }
                3 => command(0, "reset"),
                _ => {
                    let line = if what == 4 { "enable" } else { "stop" };
                    for (later_ms, active) in [(0, what != 4), (150, what == 4)] {
                        let at_s = f64::from(ms + later_ms) / 1e3;
                        let _ = writeln!(
                            text,
                            "[[input]]\nat_s = {at_s}\nline = \"{line}\"\nactive = {active}"
                        );
                    }
                }
            }
        }
        if !self.happens.is_empty() {
            text += "[[command]]\nat_s = 0\ndo = \"start\"\n";
        }
        for &(ms, tenths) in &self.late {
            let by_us = tenths * 100_000 / self.tick_hz;
            let _ = writeln!(
                text,
                "[[late]]\nat_s = {}\nby_us = {by_us}",
                f64::from(ms) / 1e3
            );
        }
        text
    }
}

impl Plan {
    /// Machine of the scene. Ratios are for machines without a platform: cams that accelerate as the crank.
    fn machine(&self) -> String {
        if self.axes.iter().all(|axis| axis.ratio.0 == axis.ratio.1) {
            let radius_mm = RADIUS_M * 1e3;
            return format!(
                "[machine]\nallow_commanded_tilt = true\ncrank_radius_mm = {radius_mm}\nlambda = {LAMBDA}\nload_kg = 5"
            );
        }
        // A cycloid over half a turn accelerates by at most 2 H ω²/π.
        let rise_mm = RADIUS_M * (1.0 + LAMBDA) * FRAC_PI_2 * 1e3;
        format!(
            "[cam]\nlaw = \"cycloid\"\nrise_mm = {rise_mm}\nrise_deg = 180\ndwell_deg = 0\nreturn_deg = 180"
        )
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
