//! The files that a run writes, read back by readers other than their writers, and the page that it draws.

mod files;
mod page;

use std::f64::consts::TAU;

use cophase_files::trace::{AxisRow, Row};

const GRAVITY_MPS2: f64 = 9.81;
/// The crank for which R ω² is 100 g at 31 Hz.
const RADIUS_M: f64 = 100.0 * GRAVITY_MPS2 / (31.0 * 31.0 * TAU * TAU);
const TICK_S: f64 = 0.0005;

/// Returns the requested level at a time, g: 0, 20, 60, 40, 100, 0, with smooth ramps of 3 s.
fn program_g(t_s: f64) -> f64 {
    const LEVELS: [(f64, f64); 5] = [
        (2.0, 20.0),
        (14.0, 60.0),
        (26.0, 40.0),
        (36.0, 100.0),
        (52.0, 0.0),
    ];
    let mut level = 0.0;
    for (from_s, to_g) in LEVELS {
        let x = ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
        level += (to_g - level) * x * x * (3.0 - 2.0 * x);
    }
    level
}

/// A minute of mixing on three axes. With `slips`, axis 2 loses four full steps (7.2°) at each of those times, and the machine stops
/// after the third.
fn mixing(slips: &[f64], mut each: impl FnMut(&Row)) {
    let mut phase_turns = 0.0;
    let mut amax_commanded_mps2 = 0.0_f64;
    let fault_s = slips.get(2).map_or(f64::INFINITY, |t| t + 0.05);
    for tick in 0..120_000_u32 {
        let t_s = f64::from(tick) * TICK_S;
        let requested = program_g(t_s) * GRAVITY_MPS2;
        let target = if t_s > fault_s { 0.0 } else { requested };
        // The commanded amplitude follows with a limited rate.
        amax_commanded_mps2 += (target - amax_commanded_mps2).clamp(-0.22, 0.22);
        let omega_rad_s = (amax_commanded_mps2 / RADIUS_M).sqrt();
        phase_turns += omega_rad_s / TAU * TICK_S;
        let state = match t_s {
            t if t < 1.0 => "idle",
            t if t < 2.0 => "homing",
            t if t > fault_s && omega_rad_s > 1.0 => "stop",
            t if t > fault_s => "fault",
            t if t < 52.0 => "run",
            _ if omega_rad_s > 1.0 => "stop",
            _ => "parked",
        };
        let speed = omega_rad_s / 190.0;
        let axes: Vec<AxisRow> = (0..3_u32)
            .map(|i| {
                let slipped = slips.iter().filter(|&&at| i == 2 && t_s > at).count();
                // A lag that grows with speed and that trim corrects at intervals: a sawtooth.
                let saw = (t_s / (1.3 + 0.4 * f64::from(i))).fract() * 0.12 * speed;
                let phase_error_deg = saw + f64::from(i) * 0.02 * speed - 7.2 * slipped as f64;
                AxisRow {
                    steps: (phase_turns * 1600.0) as i64,
                    command_turns: phase_turns,
                    actual_turns: phase_turns + phase_error_deg / 360.0,
                    phase_error_deg,
                    is_overdue: false,
                }
            })
            .collect();
        let (sin, cos) = (phase_turns * TAU).sin_cos();
        let spread = (axes[2].phase_error_deg - axes[0].phase_error_deg) / 360.0 * TAU;
        let states = ["idle", "homing", "run", "stop", "parked", "fault"];
        let state_code = states.iter().position(|name| *name == state).unwrap() as u8;
        each(&Row {
            t_s,
            state,
            state_code,
            amax_requested_mps2: requested,
            amax_commanded_mps2,
            omega_rad_s,
            phase_turns,
            tilt_x_mrad: 8.0 * spread * sin,
            tilt_y_mrad: 5.0 * spread * cos + 0.01 * sin,
            warp_deg: 0.0,
            z_m: RADIUS_M * cos,
            accel_mps2: -amax_commanded_mps2 * cos,
            amax_actual_mps2: amax_commanded_mps2,
            pitch_mrad: 0.0,
            axes,
        });
    }
}

fn axes(count: usize) -> Vec<AxisRow> {
    vec![AxisRow::default(); count]
}
