//! Corrections of phase errors for the core. Gains of the cross-coupling that a scene does not give are derived.

use cophase_core::settings::CorrectionSettings;
use cophase_scene::SceneError;
use cophase_scene::file::Scene;

use crate::drives::coupling::{APART, Plant};
use crate::machines::Machine;

pub(super) fn correction(
    scene: &Scene,
    machine: &dyn Machine,
) -> Result<CorrectionSettings, SceneError> {
    let given = &scene.correction;
    let both = given.coupling.is_some() && given.coupling_per_s.is_some();
    let gains = if given.couple && !both {
        let gains = servos(scene, machine)?.gains().ok_or_else(|| {
            SceneError::for_key(
                "correction.couple",
                format!(
                    "the drives of [axes.servo] leave no room for a coupling that keeps {APART} away from swinging; damp them \
                     (a higher velocity_gain_nms, a lower position_gain_per_s), raise control.tick_hz, or give \
                     correction.coupling and correction.coupling_per_s"
                ),
            )
        })?;
        (gains.proportional, gains.per_s)
    } else {
        (0.0, 0.0)
    };
    Ok(CorrectionSettings {
        gain: given.gain,
        prove_wiring: given.prove_wiring,
        coupling: given.coupling.unwrap_or(gains.0),
        coupling_per_s: given.coupling_per_s.unwrap_or(gains.1),
    })
}

/// Returns the data of a scene's servos for the cross-coupling. They move shafts whose part adds no known inertia by that of their rotors
/// alone.
///
/// # Errors
/// The scene lacks the gains of its drives, or the inertia of its rotors.
pub fn servos(scene: &Scene, machine: &dyn Machine) -> Result<Plant, SceneError> {
    let axes = &scene.axes;
    let servo = axes.servo.ok_or_else(|| {
        SceneError::for_key(
            "axes.servo",
            "missing; correction.couple derives its gains from those of the drives, so give [axes.servo], or \
             correction.coupling and correction.coupling_per_s themselves",
        )
    })?;
    if axes.rotor_inertia_kgm2 <= 0.0 {
        return Err(SceneError::for_key(
            "axes.rotor_inertia_kgm2",
            "is 0; correction.couple derives its gains from the rotors' inertia, so give it, or correction.coupling and \
             correction.coupling_per_s themselves",
        ));
    }
    // In terms of the motors, the load of a shaft is divided by the squared turns of its motor per shaft turn.
    let gears = (0..axes.count).map(|number| scene.resolved(number).gear.ratio());
    let min_turns = gears.fold(f64::INFINITY, f64::min);
    let load_kgm2 = machine.carried_kgm2().unwrap_or(0.0) / (min_turns * min_turns);
    Ok(Plant {
        servo,
        min_kgm2: axes.rotor_inertia_kgm2,
        max_kgm2: axes.rotor_inertia_kgm2 + load_kgm2,
        tick_hz: f64::from(scene.control.tick_hz),
    })
}
