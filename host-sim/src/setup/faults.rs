//! Checks of `[[fault]]` and `[noise]`: the values that each kind takes, and the machines on which it can occur.
//!
//! A fault that moves a crank needs cranks that can move one by one. A cam shaft is always at its commanded phase, and on the rigid
//! model level all cranks are on one shaft.

use cophase_scene::SceneError;
use cophase_scene::file::{Axes, FaultAt, FaultName, Lines, MIN_ENABLE_LOSS_US, Noise, Scene};
use cophase_scene::keys;

/// Keys of a `[[fault]]` that a kind takes, beside `at_s` and `kind`.
struct Takes {
    needed: &'static [&'static str],
    may: &'static [&'static str],
}

const fn takes(kind: FaultName) -> Takes {
    use FaultName as Kind;
    let (needed, may): (&[_], &[_]) = match kind {
        Kind::LostSteps => (&["axis"], &["cycles"]),
        Kind::Slip => (&["axis", "rate_deg_per_s"], &["for_s"]),
        Kind::Stuck | Kind::DriveAlarm => (&["axis"], &["for_s"]),
        Kind::Runaway => (&["axis", "speed_hz"], &["for_s"]),
        Kind::IndexMissing | Kind::IndexExtra => (&["axis"], &["count"]),
        Kind::SwappedWiring => (&["axis", "with", "lines"], &[]),
        Kind::Reversed | Kind::StepFifoUnderrun => (&["axis"], &[]),
        Kind::EncoderGlitch => (&["axis", "counts"], &["for_s"]),
        Kind::Overrun => (&[], &["count"]),
        Kind::EnableLoss | Kind::StopInput => (&[], &["for_s"]),
        Kind::LoadStep => (&["axis", "torque_nm"], &["for_s"]),
    };
    Takes { needed, may }
}

/// Returns the keys, each with true if a fault has it.
fn given(fault: &FaultAt) -> [(&'static str, bool); 10] {
    [
        ("axis", fault.axis.is_some()),
        ("with", fault.with.is_some()),
        ("lines", fault.lines.is_some()),
        ("cycles", fault.cycles.is_some()),
        ("rate_deg_per_s", fault.rate_deg_per_s.is_some()),
        ("speed_hz", fault.speed_hz.is_some()),
        ("count", fault.count.is_some()),
        ("counts", fault.counts.is_some()),
        ("torque_nm", fault.torque_nm.is_some()),
        ("for_s", fault.for_s.is_some()),
    ]
}

/// Returns the fix for a missing key.
fn requirement(key: &str) -> &'static str {
    match key {
        "axis" => "the number of the axis that it befalls",
        "with" => "the number of the other axis",
        "lines" => "\"drive\" or \"sensors\"",
        "rate_deg_per_s" => "how fast the crank slips, positive behind",
        "speed_hz" => "how fast it turns, rev/s",
        "counts" => "how many counts the reading is off",
        _ => "the torque, N·m",
    }
}

/// Fills in the defaults of keys.
pub(super) fn fill(scene: &mut Scene) {
    for fault in &mut scene.fault {
        match fault.kind {
            FaultName::LostSteps => fault.cycles = fault.cycles.or(Some(1)),
            FaultName::IndexExtra => fault.count = fault.count.or(Some(1)),
            FaultName::Overrun => fault.count = fault.count.or(Some(3)),
            _ => {}
        }
    }
}

/// Checks the noise and all faults against the scene, apart from what depends on the model level. Returns the first error of each.
pub(super) fn check(scene: &Scene) -> Vec<SceneError> {
    let faults = scene.fault.iter().enumerate().map(|(i, fault)| {
        check_keys(i, fault)?;
        check_numbers(i, fault)?;
        check_axes(i, fault, scene)
    });
    let noise = check_noise(&scene.noise, &scene.axes);
    std::iter::once(noise)
        .chain(faults)
        .filter_map(Result::err)
        .collect()
}

fn check_noise(noise: &Noise, axes: &Axes) -> Result<(), SceneError> {
    if noise.encoder_counts > 0.0 && !axes.encoder {
        return Err(SceneError::for_key(
            "noise.encoder_counts",
            "is noise of encoders, and none is read: set axes.encoder = true, or leave it out",
        ));
    }
    Ok(())
}

fn at(i: usize, key: &str) -> String {
    format!("fault[{i}].{key}")
}

fn check_keys(i: usize, fault: &FaultAt) -> Result<(), SceneError> {
    let Takes { needed, may } = takes(fault.kind);
    for (key, given) in given(fault) {
        let needs = needed.contains(&key);
        if needs && !given {
            return Err(SceneError::for_key(
                at(i, key),
                format!(
                    "missing; \"{}\" needs {}",
                    fault.kind.name(),
                    requirement(key)
                ),
            ));
        }
        if given && !needs && !may.contains(&key) {
            let all: Vec<&str> = needed.iter().chain(may).copied().collect();
            return Err(SceneError::for_key(
                at(i, key),
                format!(
                    "\"{}\" takes no {key}; beside at_s it takes {}; leave this out",
                    fault.kind.name(),
                    all.join(", ")
                ),
            ));
        }
    }
    Ok(())
}

fn check_numbers(i: usize, fault: &FaultAt) -> Result<(), SceneError> {
    if let Some(for_s) = fault.for_s {
        let min_s = MIN_ENABLE_LOSS_US as f64 * 1e-6;
        if fault.kind == FaultName::EnableLoss && for_s < min_s {
            return Err(SceneError::for_key(
                at(i, "for_s"),
                format!(
                    "{for_s} s is too short: a controller takes an enable loss of less than {min_s} s for noise; give {min_s} or more"
                ),
            ));
        }
    }
    let zero = [
        ("cycles", fault.cycles == Some(0)),
        ("rate_deg_per_s", fault.rate_deg_per_s == Some(0.0)),
        ("counts", fault.counts == Some(0)),
        ("torque_nm", fault.torque_nm == Some(0.0)),
    ];
    let Some((key, _)) = zero.into_iter().find(|(_, is_zero)| *is_zero) else {
        return Ok(());
    };
    let (low, high) =
        keys::row(&at(i, key)).map_or((f64::MIN, f64::MAX), |row| (row.low, row.high));
    Err(SceneError::for_key(
        at(i, key),
        format!("0 is no fault; give a number from {low} to {high} other than 0"),
    ))
}

fn check_axes(i: usize, fault: &FaultAt, scene: &Scene) -> Result<(), SceneError> {
    for (key, axis) in [("axis", fault.axis), ("with", fault.with)] {
        if axis.is_some_and(|axis| axis >= scene.axes.count) {
            return Err(SceneError::for_key(
                at(i, key),
                format!(
                    "there is no axis {}; with axes.count = {} they are 0 to {}",
                    axis.unwrap_or_default(),
                    scene.axes.count,
                    scene.axes.count - 1
                ),
            ));
        }
    }
    let Some(axis) = fault.axis else {
        return Ok(());
    };
    let takes_pulses = |axis| scene.resolved(axis).drive.kind().takes_pulses();
    let wrong = |key: &str, problem: String| Err(SceneError::for_key(at(i, key), problem));
    match fault.kind {
        FaultName::SwappedWiring if fault.with == Some(axis) => wrong(
            "with",
            format!("{axis} is the fault's `axis` itself; give the other axis of the two"),
        ),
        FaultName::SwappedWiring
            if fault.lines == Some(Lines::Drive)
                && fault.with.is_some_and(|with| takes_pulses(with) != takes_pulses(axis)) =>
        {
            wrong(
                "with",
                "one of the two takes pulses and the other setpoints, whose lines fit no other; give two of a kind".to_owned(),
            )
        }
        FaultName::LostSteps if !scene.resolved(axis).drive.kind().is_open_loop() => wrong(
            "axis",
            format!("axis {axis} is a servo, and \"lost-steps\" is a fault of steppers; give the axis of one"),
        ),
        FaultName::StepFifoUnderrun if !takes_pulses(axis) => wrong(
            "axis",
            format!(
                "axis {axis} is a servo that takes setpoints, and has no FIFO for \"step-fifo-underrun\" to empty; give an axis \
                 that takes pulses"
            ),
        ),
        FaultName::EncoderGlitch if !scene.axes.encoder => wrong(
            "kind",
            "no encoder is read that could be off: set axes.encoder = true".to_owned(),
        ),
        FaultName::IndexMissing | FaultName::IndexExtra if scene.resolved(axis).index_deg.is_none() => wrong(
            "axis",
            format!("axis {axis} has no index sensor; give it one with index = true, or another axis"),
        ),
        _ => Ok(()),
    }
}
