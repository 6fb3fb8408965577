//! Checks of a scene's values that the core does not have, or has in another form.

use cophase_core::settings::{MAX_BANDS, Transmission};
use cophase_scene::file::{self, AxisOverrides, Scene};
use cophase_scene::{SceneError, in_range};

use crate::drives::{DriveModel, check_keys};
use crate::dynamics::MOST_STEPS;
use crate::output::Output;

/// Largest torque, N·m: more than a motor for a platform of 50 kg needs.
const MOST_FRICTION_NM: f64 = 1000.0;

pub(super) fn check_overrides(
    scene: &Scene,
    entry: usize,
    overrides: &AxisOverrides,
) -> Result<(), SceneError> {
    let key = |name: &str| format!("axis[{entry}].{name}");
    if overrides.number >= scene.axes.count {
        return Err(SceneError::at(
            key("number"),
            format!(
                "there is no axis {}; with axes.count = {} they are 0 to {}",
                overrides.number,
                scene.axes.count,
                scene.axes.count - 1
            ),
        ));
    }
    if scene.axis[..entry]
        .iter()
        .any(|other| other.number == overrides.number)
    {
        return Err(SceneError::at(
            key("number"),
            format!(
                "axis {} has an [[axis]] of its own already; put both into one",
                overrides.number
            ),
        ));
    }
    if let Some(friction_nm) = overrides.friction_nm {
        in_range(&key("friction_nm"), friction_nm, 0.0, MOST_FRICTION_NM)?;
    }
    in_range(&key("start_deg"), overrides.start_deg, -180.0, 180.0)?;
    in_range(&key("trim_deg"), overrides.trim_deg, -36.0, 36.0)?;
    in_range(&key("pull_out_scale"), overrides.pull_out_scale, 0.0, 10.0)?;
    let Some(steps) = overrides.drive_steps_per_turn else {
        return Ok(());
    };
    in_range(&key("drive_steps_per_turn"), f64::from(steps), 4.0, 1e6)?;
    let has_crank = scene.cam.is_none() && overrides.cam.is_none();
    if has_crank && scene.drive(overrides.number).kind().takes_pulses() {
        return Ok(());
    }
    Err(SceneError::at(
        key("drive_steps_per_turn"),
        "is a drive's own count of pulses for a turn of its crank, and this axis has no such drive; leave it out",
    ))
}

/// Checks belts and gearboxes alone, as the models of all machines divide by them.
pub(super) fn check_gears(scene: &Scene) -> Result<(), SceneError> {
    let own = scene.axis.iter().enumerate();
    let own = own.filter_map(|(entry, own)| Some((format!("axis[{entry}].gear"), own.gear?)));
    for (key, gear) in std::iter::once(("axes.gear".to_owned(), scene.axes.gear)).chain(own) {
        let most = Transmission::MAX_TURNS;
        if [gear.0, gear.1]
            .iter()
            .any(|turns| !(1..=most).contains(turns))
        {
            let problem = format!(
                "[{}, {}] is not [motor turns, crank turns] of 1 to {most} each; a belt from 57 teeth on the crank to 11 on the motor is \
                 [57, 11]",
                gear.0, gear.1
            );
            return Err(SceneError::at(key, problem));
        }
    }
    Ok(())
}

/// Checks values of machines in which torque moves the cranks.
pub(super) fn check_torque(scene: &Scene) -> Result<(), SceneError> {
    /// Range of a rod's stiffness: a softer one is a spring, and a stiffer one exceeds steel of that size.
    const RODS_N_PER_UM: (f64, f64) = (0.01, 10_000.0);
    let file::Scene { axes, method, .. } = scene;
    if let Some(steps) = method.steps_per_tick {
        let most = f64::from(MOST_STEPS);
        in_range("method.steps_per_tick", f64::from(steps), 1.0, most)?;
    }
    if let Some(machine) = &scene.machine {
        let (least, most) = RODS_N_PER_UM;
        in_range("machine.rod_n_per_um", machine.rod_n_per_um, least, most)?;
        in_range("machine.rod_zeta", machine.rod_zeta, 0.0, MOST_ZETA)?;
        if let Some(inertia_kgm2) = machine.tilt_inertia_kgm2 {
            in_range("machine.tilt_inertia_kgm2", inertia_kgm2, 1e-6, 1000.0)?;
        }
    }
    in_range("axes.damping_nms", axes.damping_nms, 0.0, 1000.0)?;
    if let Some(servo) = &axes.servo {
        let (position, velocity) = (servo.position_gain_per_s, servo.velocity_gain_nms);
        in_range("axes.servo.position_gain_per_s", position, 1e-3, 1e5)?;
        in_range("axes.servo.velocity_gain_nms", velocity, 1e-6, 1e5)?;
        if let Some(integral_s) = servo.integral_s {
            in_range("axes.servo.integral_s", integral_s, 1e-5, 1e3)?;
        }
        if let Some(limit_nm) = servo.limit_nm {
            in_range("axes.servo.limit_nm", limit_nm, 1e-3, 1e5)?;
        }
        let share = servo.velocity_feed_forward;
        in_range("axes.servo.velocity_feed_forward", share, 0.0, 1.0)?;
        if let Some(window_deg) = servo.following_error_deg {
            in_range("axes.servo.following_error_deg", window_deg, 0.01, 180.0)?;
        }
    }
    if let Some(motor) = &axes.induction {
        in_range("axes.induction.rated_nm", motor.rated_nm, 1e-3, 1e6)?;
        in_range(
            "axes.induction.rated_slip_hz",
            motor.rated_slip_hz,
            1e-4,
            10.0,
        )?;
        in_range(
            "axes.induction.breakdown_ratio",
            motor.breakdown_ratio,
            1.1,
            10.0,
        )?;
        let gain = motor.position_gain_per_s;
        in_range("axes.induction.position_gain_per_s", gain, 1e-3, 1e3)?;
        if let Some(window_deg) = motor.following_error_deg {
            in_range(
                "axes.induction.following_error_deg",
                window_deg,
                0.01,
                180.0,
            )?;
        }
    }
    match &scene.frame {
        Some(frame) => check_frame(frame),
        None => Ok(()),
    }
}

/// Largest damping ratio of a rod. With more, it returns slowly and does not act as a spring.
const MOST_ZETA: f64 = 2.0;

fn check_frame(frame: &file::Frame) -> Result<(), SceneError> {
    let layer = |at: &str, mass_kg, inertia_kgm2: Option<f64>, spring, zeta| {
        let (spring_key, n_per_mm) = spring;
        let (zeta_key, zeta) = zeta;
        in_range(&format!("{at}.mass_kg"), mass_kg, 0.01, 1e6)?;
        if let Some(inertia_kgm2) = inertia_kgm2 {
            let key = format!("{at}.tilt_inertia_kgm2");
            in_range(&key, inertia_kgm2, 1e-6, 1e7)?;
        }
        in_range(&format!("{at}.{spring_key}"), n_per_mm, 1e-3, 1e9)?;
        in_range(&format!("{at}.{zeta_key}"), zeta, 0.0, MOST_ZETA)
    };
    layer(
        "frame",
        frame.mass_kg,
        frame.tilt_inertia_kgm2,
        ("suspension_n_per_mm", frame.suspension_n_per_mm),
        ("suspension_zeta", frame.suspension_zeta),
    )?;
    let Some(foundation) = &frame.foundation else {
        return Ok(());
    };
    layer(
        "frame.foundation",
        foundation.mass_kg,
        foundation.tilt_inertia_kgm2,
        ("ground_n_per_mm", foundation.ground_n_per_mm),
        ("ground_zeta", foundation.ground_zeta),
    )
}

/// Checks the tolerances of questions. A tolerance of 0 would require an exact model.
pub(super) fn check_questions(questions: &file::Questions) -> Result<(), SceneError> {
    for output in Output::ALL {
        if let Some(tolerance) = output.tolerance(questions) {
            in_range(&format!("questions.{}", output.key()), tolerance, 1e-9, 1e6)?;
        }
    }
    Ok(())
}

pub(super) fn check_times(scene: &Scene) -> Result<(), SceneError> {
    const MOST_S: f64 = 1e6;
    if scene.link.timeout_s == 0.0 && scene.link.reaction != file::LossReaction::default() {
        let problem = "has no effect without link.timeout_s, the time without a frame after which the host is lost; give it, or leave both out";
        return Err(SceneError::at("link.reaction", problem));
    }
    for (i, command) in scene.command.iter().enumerate() {
        in_range(&format!("command[{i}].at_s"), command.at_s, 0.0, MOST_S)?;
    }
    for (i, input) in scene.input.iter().enumerate() {
        in_range(&format!("input[{i}].at_s"), input.at_s, 0.0, MOST_S)?;
    }
    for (i, late) in scene.late.iter().enumerate() {
        in_range(&format!("late[{i}].at_s"), late.at_s, 0.0, MOST_S)?;
        in_range(&format!("late[{i}].by_us"), late.by_us, 0.0, 1e6)?;
    }
    let axes = &scene.axes;
    in_range("axes.friction_nm", axes.friction_nm, 0.0, MOST_FRICTION_NM)?;
    in_range(
        "axes.full_steps_per_turn",
        f64::from(axes.full_steps_per_turn),
        4.0,
        65_536.0,
    )?;
    if scene.limits.band.len() > MAX_BANDS {
        return Err(SceneError::at(
            "limits.band",
            format!(
                "{} bands are more than the {MAX_BANDS} that the shaft keeps; join neighbours",
                scene.limits.band.len()
            ),
        ));
    }
    if let Some(scope) = scene.scope {
        in_range("scope.from_s", scope.from_s, 0.0, MOST_S)?;
        in_range("scope.to_s", scope.to_s, 0.0, MOST_S)?;
        if scope.to_s <= scope.from_s {
            return Err(SceneError::at(
                "scope.to_s",
                format!(
                    "{} is not after scope.from_s = {}; swap or part them",
                    scope.to_s, scope.from_s
                ),
            ));
        }
    }
    Ok(())
}

/// Checks forbidden bands as a whole. The core would report one edge at a time.
pub(super) fn check_bands(limits: &file::Limits) -> Result<(), SceneError> {
    for (i, band) in limits.band.iter().enumerate() {
        if band.from_hz <= limits.homing_speed_hz && band.to_hz >= limits.speed_hz {
            return Err(SceneError::at(
                format!("limits.band[{i}]"),
                format!(
                    "the band covers all speeds from limits.homing_speed_hz = {} to limits.speed_hz = {} rev/s, so \
                     that none is left to run at; let it begin above the one and end below the other",
                    limits.homing_speed_hz, limits.speed_hz
                ),
            ));
        }
    }
    Ok(())
}

/// Checks that keys of drives have an effect.
pub(super) fn check_drives(scene: &Scene) -> Result<(), SceneError> {
    let axes = &scene.axes;
    check_keys(scene)?;
    for (entry, own) in scene.axis.iter().enumerate() {
        if own.pull_out_scale == 1.0 {
            continue;
        }
        let problem = if axes.pull_out.is_empty() {
            "scales nothing: axes.pull_out is missing; give the motors' torque as [[speed_hz, torque_nm], …]"
        } else if !DriveModel::of(scene.drive(own.number)).uses("axes.pull_out") {
            "scales the torque at which a stepper loses its step, and this axis is a servo; leave it out"
        } else {
            continue;
        };
        let key = format!("axis[{entry}].pull_out_scale");
        return Err(SceneError::at(key, problem));
    }
    if axes.pull_out.is_empty() {
        return Ok(());
    }
    let mut steps = (0..axes.count)
        .filter(|&number| scene.drive(number).kind().is_open_loop())
        .map(|number| scene.steps_per_turn(number));
    match steps.find(|steps| steps % axes.full_steps_per_turn != 0) {
        Some(steps) => Err(SceneError::at(
            "axes.steps_per_turn",
            format!(
                "{steps} is not a whole number of microsteps to each of axes.full_steps_per_turn = {}; a stepper \
                 that loses its step slips by four of those",
                axes.full_steps_per_turn
            ),
        )),
        None => Ok(()),
    }
}
