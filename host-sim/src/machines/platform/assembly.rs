//! Fit of a platform on its cranks. More than three cranks over-constrain it, and their heights may differ from
//! its plane only as far as the rods bend.

use std::f64::consts::TAU;

use cophase_core::settings::Settings;
use cophase_scene::SceneError;

use crate::dynamics::{Corners, Driven, MAX};

/// Largest deflection of the rods, m. A scene that bends them further is refused, whatever torque the motors
/// have.
const MAX_BENT_M: f64 = 1e-3;

/// Turns of the master that are checked, and positions in each. The ratios are those of small whole numbers.
const TURNS: u32 = 8;
const PLACES: u32 = 64;

/// Refuses cranks that are commanded so far apart that no motor can turn them against the rods.
///
/// # Errors
/// Names the key that sets them apart, the deflection of the rods, and the torque that it takes.
pub(super) fn check(
    driven: &Driven,
    settings: &Settings,
    apart: Option<&str>,
) -> Result<(), SceneError> {
    let Some(body) = driven.body() else {
        return Ok(());
    };
    let axes = &settings.axes;
    let ratios = axes.iter().map(|axis| axis.follower.constant_ratio());
    let Some(ratios) = ratios.collect::<Option<Vec<_>>>() else {
        return Ok(()); // cam tables are for screws
    };
    let smaller = "take smaller differences, at most three cranks, or a lower machine.rod_n_per_um if the rods are softer";
    let (key, fix) = match apart {
        Some("ratio") => ("ratio", "turn all cranks alike, or take at most three"),
        Some("offset_deg") => ("offset_deg", smaller),
        Some("trim_deg") => ("trim_deg", smaller),
        _ => return Ok(()),
    };
    if body.axes() <= 3 {
        return Ok(());
    }
    let corners = Corners::new(body.axes(), body.mount_radius_m);
    for place in 0..TURNS * PLACES {
        let master = f64::from(place) / f64::from(PLACES);
        let mut heights = [0.0; MAX];
        let mut levers = [0.0; MAX];
        for (i, (ratio, axis)) in ratios.iter().zip(axes).enumerate() {
            let trim_turns = settings.trims_turns.get(i).copied().unwrap_or_default();
            let crank = body.crank((master * ratio + axis.offset_turns + trim_turns) * TAU);
            (heights[i], levers[i]) = (crank.height_m, crank.lever_m);
        }
        let plane = corners.plane(&heights[..body.axes()]);
        for (i, motor) in driven.motors().iter().enumerate() {
            let bent_m = (heights[i] - corners.height(&plane, i)).abs();
            let torque_nm = body.rod_n_per_m * bent_m * levers[i].abs();
            let max_nm = motor.max_nm(0.0);
            if bent_m > MAX_BENT_M || torque_nm > max_nm {
                let of = match max_nm.is_finite() {
                    true => format!(", where its motor has {max_nm:.0} N·m"),
                    false => String::new(),
                };
                return Err(SceneError::for_key(
                    format!("axes.{key}"),
                    format!(
                        "has cranks apart on a platform that more than three hold: the rods would bend by {:.2} mm, and crank {i} would \
                         have to give {torque_nm:.0} N·m{of}; {fix}",
                        bent_m * 1e3
                    ),
                ));
            }
        }
    }
    Ok(())
}
