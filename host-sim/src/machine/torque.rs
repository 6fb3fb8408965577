//! From a scene to cranks that are moved by torque.

use cophase_core::settings::Settings;

use super::{Chosen, PullOut, Rotors, SimulatedAxis, Told};
use crate::dynamics::{Body, Driven, Freedom, Motor, Phased, Rigid, Servo, Stepper};
use crate::mechanism::slider_crank::{Load, SliderCrank};
use crate::scene::file::{Drive, Fidelity};
use crate::scene::{Checked, SceneError};

/// Full steps to an electrical cycle.
const FULL_STEPS: f64 = 4.0;

/// The cranks of a scene whose rung has them moved by torque; none on the others.
///
/// # Errors
/// What the rung needs and the scene does not say.
pub fn rotors<const N: usize>(
    checked: &Checked,
    settings: &Settings<N>,
    pull_out: &PullOut,
    axes: &mut [SimulatedAxis; N],
) -> Result<Option<Rotors>, SceneError> {
    if !matches!(checked.fidelity, Fidelity::Rigid | Fidelity::Phased) {
        return Ok(None);
    }
    let motors = (0..N)
        .map(|i| motor(checked, settings, pull_out, i))
        .collect::<Result<Vec<_>, _>>()?;
    let body = body(checked, settings)?;
    let freedom = if checked.fidelity == Fidelity::Rigid {
        Freedom::Rigid(Rigid::new(body))
    } else {
        Freedom::Phased(Box::new(Phased::new(body)))
    };
    let told = axes.iter().map(|axis| Told {
        turns: axis.turns(),
        torque_nm: 0.0,
    });
    let tick_s = 1.0 / f64::from(settings.tick_hz);
    let method = &checked.scene.method;
    let chosen = Chosen {
        scheme: method.name.scheme(),
        steps_per_tick: method.steps_per_tick,
    };
    Rotors::new(Driven::new(freedom, motors), told.collect(), tick_s, chosen)
        .map(Some)
        .map_err(|problem| SceneError::at("method", problem))
}

fn body<const N: usize>(checked: &Checked, settings: &Settings<N>) -> Result<Body, SceneError> {
    let machine = &checked.scene.machine;
    let radius_m = machine.crank_radius_mm / 1e3;
    let mount_m = machine.mount_radius_mm / 1e3;
    let mechanism = SliderCrank::new(radius_m, radius_m / checked.lambda)
        .map_err(|error| SceneError::at("machine.lambda", error.to_string()))?;
    let disc_kgm2 = machine.load_kg * mount_m * mount_m / 4.0;
    let rotors_kgm2: Vec<f64> = settings
        .axes
        .iter()
        .map(|axis| axis.rotor_inertia_kgm2)
        .collect();
    if rotors_kgm2.contains(&0.0) {
        return Err(SceneError::at(
            "axes.rotor_inertia_kgm2",
            format!(
                "is 0; fidelity = \"{}\" moves rotors by torque, so give their inertia, or let fidelity be \"kinematic\"",
                checked.fidelity.name()
            ),
        ));
    }
    let friction = |i| {
        let apart = checked.apart(i).and_then(|apart| apart.friction_nm);
        apart.unwrap_or(checked.scene.axes.friction_nm)
    };
    Ok(Body {
        mechanism,
        load: Load {
            mass_kg: machine.load_kg,
            gravity_mps2: machine.gravity_mps2,
            platform: machine.platform.into(),
        },
        tilt_inertia_kgm2: machine.tilt_inertia_kgm2.unwrap_or(disc_kgm2),
        rotors_kgm2,
        mount_radius_m: mount_m,
        rod_n_per_m: machine.rod_n_per_um * 1e6,
        friction_nm: (0..N).map(friction).collect(),
    })
}

fn motor<const N: usize>(
    checked: &Checked,
    settings: &Settings<N>,
    pull_out: &PullOut,
    i: usize,
) -> Result<Motor, SceneError> {
    let axes = &checked.scene.axes;
    let apart = checked.apart(i);
    let needed = |key: &str, what: &str| {
        SceneError::at(
            format!("axes.{key}"),
            format!(
                "missing; fidelity = \"{}\" moves rotors by torque, so give {what}, or let fidelity be \"kinematic\"",
                checked.fidelity.name()
            ),
        )
    };
    match apart.and_then(|apart| apart.drive).unwrap_or(axes.drive) {
        Drive::Stepper => {
            if axes.pull_out.is_empty() {
                return Err(needed(
                    "pull_out",
                    "the motors' pull-out torque as [[speed_hz, torque_nm], …]",
                ));
            }
            let scale = apart.map_or(1.0, |apart| apart.pull_out_scale);
            Ok(Motor::Stepper(Stepper {
                pull_out: pull_out.scaled(scale),
                cycles_per_turn: f64::from(axes.full_steps_per_turn) / FULL_STEPS,
                damping_nms: axes.damping_nms,
            }))
        }
        Drive::Servo => {
            let stiffness_nm = axes
                .servo_stiffness_nm
                .ok_or_else(|| needed("servo_stiffness_nm", "the drives' stiffness"))?;
            let rotor = settings.axes[i].rotor_inertia_kgm2;
            let critical = 2.0 * (stiffness_nm * rotor).sqrt();
            Ok(Motor::Servo(Servo {
                stiffness_nm,
                damping_nms: axes.servo_damping_nms.unwrap_or(critical),
                limit_nm: axes.servo_limit_nm.unwrap_or(f64::INFINITY),
            }))
        }
    }
}
