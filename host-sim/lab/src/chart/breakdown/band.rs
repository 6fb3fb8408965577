//! Slow crossing of a band: a frame on soft springs, and a shaft that must pass its resonance.
//!
//! Failure: the slower the crossing, the more the resonance builds up. It builds up completely if the shaft dwells there. Guard: a
//! forbidden band. A program that requests a speed inside gets the nearer edge, and the limits determine the time inside.

use super::panel::{Curve, Shown, failing};
use super::runs::run;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;
use crate::chart::{ChartError, Size};
use host_sim::sim::Outcome;
use host_sim::sim::events::EventKind;

const SCENE: &str = r#"
name = "band"
fidelity = "elastic"
[machine]
crank_radius_mm = 5
lambda = 0.25
load_kg = 1
mount_radius_mm = 200
[frame]
mass_kg = 20
suspension_n_per_mm = 120
suspension_zeta = 0.02
[control]
settle_s = 0.02
[limits]
speed_hz = 40
acceleration_hz_per_s = ACCELERATION
jerk_hz_per_s2 = JERK
homing_speed_hz = 5
BAND
[axes]
count = 3
drive = "servo"
steps_per_turn = 8192
index = false
rotor_inertia_kgm2 = 0.1
servo = { position_gain_per_s = 50, velocity_gain_nms = 10 }
[[program]]
amax_g = AMAX
ramp_s = 0.1
hold_s = HOLD
"#;

/// Band, rev/s. Its middle is above the resonance, so a program that requests the resonance is held at the lower edge.
pub const BAND_HZ: (f64, f64) = (10.2, 14.2);
/// Resonance of the frame with its load, √(120 N/mm / 21 kg), rev/s.
pub const RESONANCE_HZ: f64 = 12.031;
/// Time from rest to the full acceleration, s, which sets the jerk. At the greatest acceleration here, half of that time has passed
/// before the shaft gains 2 rev/s.
const FULL_AFTER_S: f64 = 0.05;
const DWELL_S: f64 = 4.0;
/// Acceleration for measurements that do not depend on it, rev/s².
const USUAL_HZ_PER_S: f64 = 20.0;

/// Returns a scene that requests a speed.
pub fn scene(speed_hz: f64, acceleration_hz_per_s: f64, has_band: bool) -> String {
    let omega = std::f64::consts::TAU * speed_hz;
    let amax_g = 0.005 * omega * omega * 1.25 / 9.80665;
    let band = format!(
        "band = [{{ from_hz = {}, to_hz = {} }}]",
        BAND_HZ.0, BAND_HZ.1
    );
    let hold_s = if speed_hz > BAND_HZ.1 {
        speed_hz / acceleration_hz_per_s + 0.2
    } else {
        DWELL_S
    };
    SCENE
        .replace("ACCELERATION", &acceleration_hz_per_s.to_string())
        .replace("JERK", &(acceleration_hz_per_s / FULL_AFTER_S).to_string())
        .replace("BAND", if has_band { &band } else { "" })
        .replace("AMAX", &format!("{amax_g:.6}"))
        .replace("HOLD", &hold_s.to_string())
}

/// Crossing of the band.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Acceleration of the shaft, rev/s².
    pub hz_per_s: f64,
    /// Largest displacement of the frame, µm.
    pub frame_um: f64,
    /// Time in the band, upwards, s.
    pub inside_s: f64,
}

/// Measured results.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Crossings by acceleration, the lowest first.
    pub crossings: Vec<Crossing>,
    /// Largest displacement of the frame while a machine without a band dwells at its resonance, µm.
    pub dwelling_um: f64,
    /// The same with the band, which holds it at its edge, µm.
    pub held_um: f64,
    /// Time for which it was held, s, as in the report.
    pub held_s: Option<f64>,
}

/// Runs the scenes.
///
/// # Errors
/// A scene does not run.
pub fn measure(size: Size) -> Result<Facts, ChartError> {
    let accelerations: &[f64] = match size {
        Size::Small => &[5.0, 20.0, 80.0],
        Size::Full => &[
            1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 80.0,
        ],
    };
    let mut crossings = Vec::new();
    for &hz_per_s in accelerations {
        let outcome = run(&scene(20.0, hz_per_s, true), &mut |_| {})?;
        let inside = outcome
            .record
            .events
            .iter()
            .find_map(|event| match event.what {
                EventKind::BandCrossed {
                    in_s,
                    upwards: true,
                } => Some(in_s),
                _ => None,
            });
        crossings.push(Crossing {
            hz_per_s,
            frame_um: frame_um(&outcome),
            inside_s: inside.unwrap_or(f64::INFINITY),
        });
    }
    let dwelling = run(&scene(RESONANCE_HZ, USUAL_HZ_PER_S, false), &mut |_| {})?;
    let held = run(&scene(RESONANCE_HZ, USUAL_HZ_PER_S, true), &mut |_| {})?;
    let held_s = held
        .record
        .events
        .iter()
        .find_map(|event| match event.what {
            EventKind::HeldAtBand { for_s } => Some(for_s),
            _ => None,
        });
    Ok(Facts {
        crossings,
        dwelling_um: frame_um(&dwelling),
        held_um: frame_um(&held),
        held_s,
    })
}

fn frame_um(outcome: &Outcome) -> f64 {
    let frame = outcome.record.figures.frame;
    frame.map_or(0.0, |frame| frame.displacement_worst_um)
}

pub(super) fn shown(size: Size) -> Result<Shown, ChartError> {
    let facts = measure(size)?;
    let crossings = facts.crossings.iter();
    let mut crossed = failing(
        crossings
            .map(|measured| (measured.hz_per_s, measured.frame_um))
            .collect(),
    );
    crossed.marked = true;
    let (slow, fast) = (
        &facts.crossings[0],
        facts.crossings[facts.crossings.len() - 1],
    );
    Ok(Shown {
        key: "band",
        title: "Crossing a resonance too slowly".to_owned(),
        x: Axis::log("acceleration of the shaft, rev/s²", 1.0, 100.0),
        y: Axis::linear("largest way of the frame, µm", 0.0, 6500.0),
        curves: vec![
            Curve::new("crossing the band, µm", crossed),
            Curve::level("dwelling in it, µm", facts.dwelling_um),
            Curve::level("held at its edge, µm", facts.held_um),
        ],
        levels: vec![
            Level::at_y(facts.dwelling_um, "dwelling at resonance, without a band"),
            Level::at_y(facts.held_um, "the same request,  held at the band's edge"),
        ],
        says: format!(
            "Dwelling at its resonance moves the frame by {:.1} mm; crossed at {:.0} rev/s² it goes {:.1} mm, at {:.0} rev/s² {:.1} mm, \
             and a machine that is held at its band's edge {:.1} mm.",
            facts.dwelling_um / 1e3,
            slow.hz_per_s,
            slow.frame_um / 1e3,
            fast.hz_per_s,
            fast.frame_um / 1e3,
            facts.held_um / 1e3
        ),
    })
}
