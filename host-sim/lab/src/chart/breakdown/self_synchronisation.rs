//! Self-synchronisation: unbalanced shafts on one box, each with a free motor, or kept in phase by the controller.
//!
//! Failure: free motors are coupled by the box. Co-rotating exciters settle at the phases at which the box moves least. Two exciters at
//! ±p from the centre of a box with mass M and pitch inertia I have opposite phases unless M p²/I is above 2 (Blekhman), and the screen
//! does not shake. Guard: the controller keeps each shaft at its commanded phase.

use std::f64::consts::TAU;
use std::sync::Arc;

use cophase_methods::Scheme;
use cophase_scene::library;
use host_sim::drives::{Field, Induction, Motor};
use host_sim::dynamics::Driven;
use host_sim::dynamics::plant::PlantRotors;
use host_sim::machines::screen::{Screen, Sufficient};

use super::panel::{Curve, Shown, failing, guarded};
use super::runs::{built_in, run};
use crate::chart::ChartError;
use crate::chart::axis::Axis;

/// Positions of two and of four shafts along the box from its centre, m.
pub const TWO_M: &[f64] = &[-0.6, 0.6];
/// See [`TWO_M`].
pub const FOUR_M: &[f64] = &[-0.9, -0.3, 0.3, 0.9];

/// Time, s, and resultant of the exciters: the length of the mean of their unit vectors; 1 if all are in phase.
pub type Resultant = Vec<(f64, f64)>;

/// Speed of the shafts, rad/s, and time that is shown, s.
const OMEGA_RAD_S: f64 = 14.0 * TAU;
const END_S: f64 = 20.0;
const STEP_S: f64 = 2e-4;
/// Rotor of each shaft, kg·m², and difference between neighbours at the start, rad.
const ROTOR_KGM2: f64 = 3.0;
const APART_RAD: f64 = 0.2;

/// Returns the box of scene `screen`, with shafts at these positions that share its exciter mass.
///
/// # Errors
/// The scene is missing, or has no screen.
pub fn screen(places_m: &[f64]) -> Result<Screen, ChartError> {
    let scene = library::find("screen").map(|built_in| built_in.scene());
    let table = scene.and_then(|scene| scene.screen);
    let table = table.ok_or_else(|| ChartError("no built-in scene `screen`".to_owned()))?;
    let length_m = 1e-3 * table.length_mm;
    let shafts = table.shafts_mm.len() as f64;
    Ok(Screen {
        box_kg: table.box_kg,
        pitch_kgm2: table.box_kg * length_m * length_m / 12.0,
        block_kg: table.block_kg * shafts / places_m.len() as f64,
        eccentricity_m: 1e-3 * table.eccentricity_mm,
        places_m: places_m.to_vec(),
        stiffness_n_per_m: 1e3 * table.stiffness_n_per_mm,
        zeta: table.zeta,
        springs_m: 0.5 * length_m,
        gravity_mps2: table.gravity_mps2,
        phases_turns: vec![0.0; places_m.len()],
        top_hz: f64::INFINITY,
        common_limit_turns: 0.5,
        sufficient: Sufficient::default(),
    })
}

fn resultant(angles_rad: &[f64]) -> f64 {
    let sum = |of: fn(f64) -> f64| angles_rad.iter().map(|angle| of(*angle)).sum::<f64>();
    sum(f64::cos).hypot(sum(f64::sin)) / angles_rad.len() as f64
}

/// Runs free motors at the working speed, nearly in phase at first: induction motors on the mains, without a control loop.
///
/// # Errors
/// The method is refused.
pub fn free(places_m: &[f64]) -> Result<Resultant, ChartError> {
    let n = places_m.len();
    let on = PlantRotors::new(
        vec![ROTOR_KGM2; n],
        vec![0.0; n],
        Arc::new(screen(places_m)?),
    );
    let motor = Motor::Induction(Induction::new(200.0, 0.3 * TAU, 2.0, 0.0));
    let mut driven = Driven::new(Box::new(on), vec![motor; n]);
    driven.energised = true;
    for field in &mut driven.fields {
        *field = Field {
            omega_rad_s: OMEGA_RAD_S,
            ..Field::default()
        };
    }
    let angles: Vec<f64> = (0..n).map(|i| i as f64 * APART_RAD).collect();
    let mut state = driven.at_rest(&angles);
    let positions = driven.positions();
    state[positions..positions + n].fill(OMEGA_RAD_S);
    let mut method = Scheme::Rk4.prepare(&driven, STEP_S)?;
    let mut shown = Vec::new();
    for step in 0..(END_S / STEP_S) as u32 {
        let t_s = f64::from(step) * STEP_S;
        if step % 250 == 0 {
            shown.push((t_s, resultant(&state[..n])));
        }
        // The field's angle has no effect without a position gain.
        method.step(&driven, t_s, &mut state)?;
    }
    Ok(shown)
}

/// Returns scene `screen` with shafts at these positions, whose friction differs, held for the time that is shown.
fn scene(places_m: &[f64]) -> Result<String, ChartError> {
    let n = places_m.len();
    let places: Vec<String> = places_m.iter().map(|m| format!("{:.0}", 1e3 * m)).collect();
    let shafts = format!("shafts_mm = [{}]", places.join(", "));
    let stiff = "[[axis]]\nnumber = 1\nfriction_nm = 60\n\n[[program]]";
    let changes = [
        ("[screen]", "fidelity = \"phased\"\n[screen]"),
        ("shafts_mm = [-600, 600]", &shafts),
        ("block_kg = 83", &format!("block_kg = {}", 166.0 / n as f64)),
        ("count = 2", &format!("count = {n}")),
        ("hold_s = 1", &format!("hold_s = {END_S}")),
        ("[[program]]", stiff),
    ];
    built_in("screen", &changes)
}

/// Runs shafts with the controller, from the time at which they have their working speed.
///
/// # Errors
/// The scene is refused.
pub fn forced(places_m: &[f64]) -> Result<Resultant, ChartError> {
    let text = scene(places_m)?;
    let mut shown = Resultant::new();
    let mut from_s = None;
    run(&text, &mut |now| {
        if now.speed_hz * TAU < 0.999 * OMEGA_RAD_S {
            return;
        }
        let t_s = now.t_s - *from_s.get_or_insert(now.t_s);
        let ahead = now.ahead_turns[..places_m.len()].iter();
        let angles: Vec<f64> = ahead.map(|turns| turns * TAU).collect();
        shown.push((t_s, resultant(&angles)));
    })?;
    Ok(shown.into_iter().step_by(100).collect())
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let (free_two, free_four) = (free(TWO_M)?, free(FOUR_M)?);
    let (two, four) = (forced(TWO_M)?, forced(FOUR_M)?);
    let last = |resultant: &Resultant| resultant.last().map_or(f64::NAN, |point| point.1);
    let min = |resultant: &Resultant| {
        resultant
            .iter()
            .map(|point| point.1)
            .fold(f64::MAX, f64::min)
    };
    let (free_two_end, free_four_end) = (last(&free_two), last(&free_four));
    let (min_two, min_four) = (min(&two), min(&four));
    Ok(Shown {
        key: "self-synchronisation",
        title: "Exciters of a screen: kept in phase, and self-synchronised".to_owned(),
        x: Axis::linear("time at 14 rev/s, s", 0.0, END_S),
        y: Axis::linear("resultant of the exciters, of all in phase", 0.0, 1.05),
        curves: vec![
            Curve::new("two free motors", failing(free_two)),
            Curve::new("four free motors", super::panel::requested(free_four)),
            Curve::new("two under the controller", guarded(two)),
            Curve::new("four under the controller", super::panel::second(four)),
        ],
        levels: Vec::new(),
        says: format!(
            "Free motors settle where the box moves least, with {free_two_end:.2} (two) and {free_four_end:.2} (four) of the resultant; the controller keeps at least \
             {min_two:.4} and {min_four:.4}, with 60 N·m of friction on one shaft.",
        ),
    })
}
