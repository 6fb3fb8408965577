//! Realistic machines, by seed. Their motors have from a part to several times the torque that the load requires. Their
//! tolerances are from far too tight to far too wide.

use std::f64::consts::TAU;
use std::fmt::Write;

use cophase_core::mechanism::CrankRockerSettings;
use cophase_lab::design::crank_rocker::{Requirement, design};
use cophase_scene::library;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Random generator of one scene.
struct Draw(ChaCha8Rng);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// Draws evenly on a logarithmic scale.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn chance(&mut self, of: f64) -> bool {
        self.0.random_bool(of)
    }
}

/// Returns the keys of a mechanism whose platform moves by about the given number of millimetres either way.
type Mechanism = fn(&mut Draw, f64) -> String;

/// Scene with slider-cranks for a seed, as TOML.
pub fn slider_crank(seed: u64) -> String {
    scene(seed, |draw, radius_mm| {
        let lambda = draw.between(0.1, 0.45);
        format!("crank_radius_mm = {radius_mm:.4}\nlambda = {lambda:.3}")
    })
}

/// Scene with crank-rockers for a seed, as TOML: linkages that the design command finds and the controller accepts.
pub fn crank_rocker(seed: u64) -> String {
    scene(seed, |draw, radius_mm| {
        loop {
            let swing_deg = draw.between(30.0, 80.0);
            let requirement = Requirement {
                swing_deg,
                pressure_deg: draw.between(0.1, 0.45) * swing_deg,
                time_ratio: draw.between(0.8, 0.97),
                screw_lead_mm: None,
            };
            let Ok(found) = design(&requirement) else {
                continue;
            };
            let settings = CrankRockerSettings {
                crank: found.linkage.crank,
                coupler: found.linkage.coupler,
                ground: found.linkage.ground,
            };
            if settings.check().is_err() {
                continue;
            }
            return format!(
                "mechanism = \"crank-rocker\"\nscrew_lead_mm = {:.3}\ncrank_ratio = {:.6}\ncoupler_ratio = {:.6}\n\
                 ground_ratio = {:.6}",
                720.0 * radius_mm / swing_deg,
                settings.crank,
                settings.coupler,
                settings.ground
            );
        }
    })
}

/// Built-in scene with the numbers of these keys varied by up to a quarter. The changes, which shorten runs or lift limits, apply first.
fn varied(name: &str, seed: u64, changes: &[(&str, &str)], keys: &[&str]) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let mut text = library::find(name)
        .expect("a built-in scene")
        .text
        .to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{name}: {from}");
        text = text.replacen(from, to, 1);
    }
    for key in keys {
        let place = format!("{key} = ");
        let from = text.find(&place).unwrap_or_else(|| panic!("{name}: {key}")) + place.len();
        let to = from
            + text[from..]
                .find(|c: char| !c.is_ascii_digit() && c != '.')
                .unwrap_or(0);
        let value: f64 = text[from..to].parse().expect("a number");
        let value = value * draw.scale(0.8, 1.25);
        text.replace_range(from..to, &format!("{value:.6}"));
    }
    text
}

/// Screen with other masses, springs, blocks and motors.
pub fn screen(seed: u64) -> String {
    let keys = [
        "box_kg",
        "block_kg",
        "eccentricity_mm",
        "stiffness_n_per_mm",
        "rotor_inertia_kgm2",
        "friction_nm",
        "velocity_gain_nms",
        "amax_g",
    ];
    // Without a torque limit nothing saturates. A higher speed limit keeps variations from being refused.
    let changes = [
        (", limit_nm = 399, following_error_deg = 30", ""),
        ("speed_hz = 15", "speed_hz = 25"),
    ];
    varied("screen", seed, &changes, &keys)
}

/// Jaw crusher with another flywheel, jaw, rock and motor.
pub fn crusher(seed: u64) -> String {
    let keys = [
        "jaw_kg",
        "rock_kn",
        "rotor_inertia_kgm2",
        "rated_nm",
        "rated_slip_hz",
        "position_gain_per_s",
    ];
    // The rock acts from turn 14 on, and the run is shorter.
    let changes = [
        ("[24, 54]", "[14, 22]"),
        ("hold_s = 10", "hold_s = 2"),
        ("common_limit_deg = 25", "common_limit_deg = 120"),
        (", following_error_deg = 60", ""),
    ];
    varied("jaw-crusher", seed, &changes, &keys)
}

/// Five-bar arm with other masses, path speed and drives, ten times as fast.
pub fn five_bar(seed: u64) -> String {
    let keys = [
        "tool_kg",
        "speed_mm_per_s",
        "lift_n",
        "rotor_inertia_kgm2",
        "friction_nm",
        "position_gain_per_s",
        "velocity_gain_nms",
    ];
    let changes = [
        ("speed_mm_per_s = 21.0526", "speed_mm_per_s = 210"),
        ("blend_s = 0.5", "blend_s = 0.1"),
        ("contact = { force_n = 5 }", ""),
        ("speed_hz = 0.1", "speed_hz = 1"),
        ("acceleration_hz_per_s = 0.1", "acceleration_hz_per_s = 2"),
        ("jerk_hz_per_s2 = 1", "jerk_hz_per_s2 = 20"),
        ("homing_speed_hz = 0.05", "homing_speed_hz = 0.5"),
        ("hold_s = 40", "hold_s = 4"),
        (", limit_nm = 4.46", ""),
    ];
    varied("five-bar", seed, &changes, &keys)
}

/// Flexible followers with other masses, springs and speeds.
pub fn wrapper(seed: u64) -> String {
    let keys = ["rise_mm", "rise_deg", "return_deg", "rotor_inertia_kgm2"];
    let changes = [
        ("rise_deg = 120", "rise_deg = 110"),
        ("return_deg = 105", "return_deg = 95"),
        ("dwell_deg = 135", "dwell_deg = 90"),
        ("speed_hz = 8", "speed_hz = 30"),
        ("amax_g = 31.31", "amax_g = 20"),
        ("hold_s = 3", "hold_s = 1"),
    ];
    varied("wrapper", seed, &changes, &keys)
}

fn scene(seed: u64, mechanism: Mechanism) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let mut text = String::new();
    write(&mut text, seed, &mut draw, mechanism).expect("writing to a string does not fail");
    text
}

fn write(text: &mut String, seed: u64, draw: &mut Draw, mechanism: Mechanism) -> std::fmt::Result {
    let axes = draw.0.random_range(2..=6_usize);
    let radius_mm = draw.scale(3.0, 15.0);
    let load_kg = draw.scale(1.0, 20.0);
    let top_hz = draw.scale(4.0, 30.0);
    let tick_hz = [1000, 1000, 1000, 2000, 2000, 4000][draw.0.random_range(0..6_usize)];
    let has_frame = draw.chance(0.25);
    writeln!(
        text,
        "name = \"machine-{seed}\"\n[control]\ntick_hz = {tick_hz}"
    )?;
    writeln!(
        text,
        "[machine]\nallow_commanded_tilt = true\n{}",
        mechanism(draw, radius_mm)
    )?;
    writeln!(
        text,
        "load_kg = {load_kg:.3}\nmount_radius_mm = {:.1}",
        draw.between(80.0, 400.0)
    )?;
    writeln!(text, "rod_n_per_um = {:.1}", draw.scale(10.0, 150.0))?;
    if draw.chance(0.3) {
        writeln!(text, "platform = \"below\"")?;
    }
    if draw.chance(0.2) {
        writeln!(text, "rods = \"elastic\"")?;
    }
    if has_frame {
        writeln!(text, "[frame]\nmass_kg = {:.1}", draw.scale(20.0, 300.0))?;
        writeln!(text, "suspension_n_per_mm = {:.1}", draw.scale(20.0, 600.0))?;
        writeln!(text, "suspension_zeta = {:.3}", draw.between(0.03, 0.3))?;
    }
    questions(text, has_frame, draw)?;
    writeln!(text, "[limits]\nspeed_hz = {:.4}", 1.1 * top_hz)?;
    writeln!(
        text,
        "acceleration_hz_per_s = {:.3}",
        top_hz * draw.between(2.0, 5.0)
    )?;
    writeln!(
        text,
        "jerk_hz_per_s2 = {:.1}\nhoming_speed_hz = 4",
        100.0 * top_hz
    )?;
    writeln!(
        text,
        "[drift]\ntilt_limit_mrad = 60\nwarp_limit_deg = 40\ncommon_limit_deg = 40"
    )?;

    let omega = TAU * top_hz;
    let radius_m = radius_mm * 1e-3;
    let peak_nm = load_kg / axes as f64 * radius_m * (9.8 + 0.6 * radius_m * omega * omega);
    let rotor = draw.scale(1e-4, 5e-3);
    let whole = rotor + load_kg / axes as f64 * radius_m * radius_m;
    let friction = peak_nm * draw.scale(0.005, 0.2);
    let turned = draw.chance(0.1) && axes <= 3;
    writeln!(
        text,
        "[axes]\ncount = {axes}\nsteps_per_turn = 3200\nrotor_inertia_kgm2 = {rotor:.3e}"
    )?;
    writeln!(text, "friction_nm = {friction:.4}")?;
    let is_stepper = draw.chance(0.5);
    if is_stepper {
        let torque = peak_nm * draw.scale(0.8, 8.0);
        let ends = top_hz * draw.between(1.15, 2.0);
        writeln!(
            text,
            "drive = \"stepper\"\ndamping_nms = {:.4}",
            whole * draw.scale(4.0, 200.0)
        )?;
        writeln!(
            text,
            "pull_out = [[0, {torque:.3}], [{ends:.3}, {:.3}]]",
            0.8 * torque
        )?;
    } else {
        writeln!(text, "drive = \"servo\"\n[axes.servo]")?;
        writeln!(text, "position_gain_per_s = {:.1}", draw.scale(30.0, 300.0))?;
        writeln!(
            text,
            "velocity_gain_nms = {:.4}",
            whole * draw.scale(60.0, 800.0)
        )?;
        if draw.chance(0.3) {
            writeln!(text, "integral_s = {:.4}", draw.scale(0.02, 0.3))?;
        }
        if draw.chance(0.4) {
            writeln!(text, "limit_nm = {:.3}", peak_nm * draw.scale(1.0, 8.0))?;
        }
        if draw.chance(0.3) {
            writeln!(
                text,
                "velocity_feed_forward = {:.3}",
                draw.between(0.5, 1.0)
            )?;
        }
    }
    for axis in 0..axes {
        if !draw.chance(0.35) {
            continue;
        }
        writeln!(
            text,
            "[[axis]]\nnumber = {axis}\nfriction_nm = {:.4}",
            friction + peak_nm * draw.scale(0.01, 0.3)
        )?;
        if is_stepper && draw.chance(0.3) {
            writeln!(text, "pull_out_scale = {:.3}", draw.between(0.5, 1.0))?;
        }
        if draw.chance(0.2) {
            writeln!(text, "start_deg = {:.3}", draw.between(-0.5, 0.5))?;
        }
        if turned {
            writeln!(text, "offset_deg = {:.1}", draw.between(-90.0, 90.0))?;
        }
    }
    // Implicit methods take fewer steps, because each step costs as much as dozens of RK4 steps.
    if draw.chance(0.1) {
        writeln!(
            text,
            "[method]\nname = \"rk4\"\nsteps_per_tick = {}",
            draw.0.random_range(8..=32)
        )?;
    } else if draw.chance(0.1) {
        let method = ["sdirk4", "implicit-midpoint"][draw.0.random_range(0..2_usize)];
        writeln!(
            text,
            "[method]\nname = \"{method}\"\nsteps_per_tick = {}",
            draw.0.random_range(1..=4)
        )?;
    }
    for _ in 0..draw.0.random_range(1..=2) {
        let speed = omega * draw.between(0.3, 1.0);
        let amax_g = (radius_m * speed * speed / 9.80665).max(0.02);
        writeln!(text, "[[program]]\namax_g = {amax_g:.4}")?;
        writeln!(
            text,
            "ramp_s = {:.3}\nhold_s = {:.3}",
            draw.between(0.2, 0.5),
            draw.between(0.1, 0.3)
        )?;
    }
    Ok(())
}

/// Scene of a machine with much friction for a seed, as TOML: two to four cranks with rods of either kind, some on a frame, with
/// steppers, servos or induction motors. Each crank has a friction from 0 to 5 N·m. Tolerances are so narrow that torque moves the cranks.
/// Nothing disturbs them.
pub fn rubbing(seed: u64) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_rubbing(&mut text, seed, &mut draw);
    text
}

fn write_rubbing(text: &mut String, seed: u64, draw: &mut Draw) -> std::fmt::Result {
    let axes = draw.0.random_range(2..=4_usize);
    let radius_mm = draw.scale(3.0, 15.0);
    let load_kg = draw.scale(1.0, 20.0);
    let top_hz = draw.scale(4.0, 15.0);
    let has_frame = draw.chance(0.4);
    writeln!(
        text,
        "name = \"rubbing-{seed}\"\n[control]\ntick_hz = 1000\nsettle_s = 0.02\n[machine]"
    )?;
    writeln!(
        text,
        "crank_radius_mm = {radius_mm:.4}\nlambda = {:.3}\nload_kg = {load_kg:.3}\nmount_radius_mm = {:.1}",
        draw.between(0.1, 0.45),
        draw.between(80.0, 400.0)
    )?;
    writeln!(text, "rod_n_per_um = {:.2}", draw.scale(1.0, 200.0))?;
    let rods = ["elastic", "quasi-static"][usize::from(draw.chance(0.4))];
    writeln!(text, "rods = \"{rods}\"")?;
    if has_frame {
        writeln!(text, "[frame]\nmass_kg = {:.1}", draw.scale(20.0, 300.0))?;
        writeln!(text, "suspension_n_per_mm = {:.1}", draw.scale(20.0, 600.0))?;
        writeln!(text, "suspension_zeta = {:.3}", draw.between(0.03, 0.3))?;
    }
    writeln!(
        text,
        "[questions]\nlag_deg = {:.5}\nspread_deg = {:.5}\ntorque_percent = {:.3}",
        draw.scale(1e-4, 1e-1),
        draw.scale(1e-4, 1e-1),
        draw.scale(0.05, 5.0)
    )?;
    if has_frame {
        writeln!(text, "ground_percent = {:.3}", draw.scale(0.1, 5.0))?;
    }
    writeln!(
        text,
        "[limits]\nspeed_hz = {:.4}\nacceleration_hz_per_s = {:.3}\njerk_hz_per_s2 = {:.1}\nhoming_speed_hz = 4",
        1.1 * top_hz,
        top_hz * draw.between(3.0, 8.0),
        200.0 * top_hz
    )?;
    writeln!(
        text,
        "[drift]\ntilt_limit_mrad = 100\nwarp_limit_deg = 60\ncommon_limit_deg = 90\nreading_error_deg = 3"
    )?;
    let omega = TAU * top_hz;
    let radius_m = radius_mm * 1e-3;
    let peak_nm = load_kg / axes as f64 * radius_m * (9.8 + 0.6 * radius_m * omega * omega);
    let frictions: Vec<f64> = (0..axes)
        .map(|_| {
            if draw.chance(0.1) {
                0.0
            } else {
                draw.between(0.0, 5.0)
            }
        })
        .collect();
    let max_nm = frictions
        .iter()
        .copied()
        .fold(peak_nm, |sum, friction| sum.max(peak_nm + friction));
    let rotor = draw.scale(1e-4, 5e-3);
    let whole = rotor + load_kg / axes as f64 * radius_m * radius_m;
    writeln!(
        text,
        "[axes]\ncount = {axes}\nsteps_per_turn = 3200\nrotor_inertia_kgm2 = {rotor:.3e}"
    )?;
    match draw.0.random_range(0..3_usize) {
        0 => {
            let torque = max_nm * draw.scale(1.5, 6.0);
            writeln!(
                text,
                "drive = \"stepper\"\ndamping_nms = {:.4}\npull_out = [[0, {torque:.3}], [{:.3}, {:.3}]]",
                whole * draw.scale(20.0, 200.0),
                top_hz * draw.between(1.3, 2.0),
                0.8 * torque
            )?;
        }
        1 => {
            let rated_nm = max_nm * draw.scale(1.0, 20.0);
            writeln!(
                text,
                "drive = \"induction\"\nindex = false\ninduction = {{ rated_nm = {rated_nm:.3}, rated_slip_hz = {:.3}, breakdown_ratio = {:.3}, position_gain_per_s = {:.2} }}",
                draw.scale(0.1, 2.0),
                draw.between(1.5, 3.5),
                draw.scale(5.0, 30.0)
            )?;
        }
        _ => {
            writeln!(
                text,
                "drive = \"servo\"\n[axes.servo]\nposition_gain_per_s = {:.1}\nvelocity_gain_nms = {:.4}",
                draw.scale(30.0, 300.0),
                whole * draw.scale(60.0, 800.0)
            )?;
            if draw.chance(0.3) {
                writeln!(text, "integral_s = {:.4}", draw.scale(0.02, 0.3))?;
            }
        }
    }
    for (axis, friction) in frictions.iter().enumerate() {
        writeln!(
            text,
            "[[axis]]\nnumber = {axis}\nfriction_nm = {friction:.4}"
        )?;
    }
    let speed = omega * draw.between(0.3, 1.0);
    let amax_g = (radius_m * speed * speed / 9.80665).max(0.02);
    writeln!(
        text,
        "[[program]]\namax_g = {amax_g:.4}\nramp_s = {:.3}\nhold_s = {:.3}",
        draw.between(0.2, 0.4),
        draw.between(0.1, 0.2)
    )
}

fn questions(text: &mut String, has_frame: bool, draw: &mut Draw) -> std::fmt::Result {
    let mut requested = String::new();
    let mut request = |key: &str, chance: f64, low: f64, high: f64| {
        if draw.chance(chance) {
            let tolerance = draw.scale(low, high);
            let _ = writeln!(requested, "{key} = {tolerance:.4}");
        }
    };
    request("lag_deg", 0.6, 0.02, 6.0);
    request("spread_deg", 0.6, 0.02, 3.0);
    request("tilt_mrad", 0.6, 0.004, 1.0);
    request("amax_percent", 0.6, 1.0, 50.0);
    request("torque_percent", 0.6, 1.0, 20.0);
    if has_frame {
        request("ground_percent", 0.4, 1.0, 20.0);
    }
    if draw.chance(0.4) || requested.is_empty() {
        requested.push_str("slips = true\n");
    }
    write!(text, "[questions]\n{requested}")
}
