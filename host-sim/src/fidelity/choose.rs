//! Which rung, by what is known without a run.

use cophase_core::settings::Settings;

use super::linear::{Drive, worst};
use super::{Bounds, LADDER, Output};
use crate::dynamics::Driven;
use crate::machine::{Machine, Rotors};
use crate::scene::file::{Fidelity, Questions};
use crate::scene::{Checked, SceneError};
use crate::with_axes;

/// A rung, and why.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The rung.
    pub rung: Fidelity,
    /// Why, in a sentence.
    pub why: String,
    /// What it leaves out of each output that is asked for.
    pub judged: Vec<Judged>,
}

/// An output that is asked for, and how well a rung answers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Which.
    pub output: Output,
    /// By how much it may be off, in [`Output::unit`].
    pub tolerance: f64,
    /// By how much it is off at most; infinite where nothing bounds it, none where the scene does not say enough to reckon it.
    pub bound: Option<f64>,
    /// By how much it differed over a sample, and from which rung; none before that was run.
    pub measured: Option<(f64, Fidelity)>,
}

impl Judged {
    fn is_bounded(&self) -> bool {
        self.bound.is_some_and(|bound| bound <= self.tolerance)
    }
}

/// What a scene asks: what it declares, or else whether its motors keep step, if it says what they can.
pub fn questions(checked: &Checked) -> Questions {
    let declared = checked.scene.questions;
    if declared.is_none() && !checked.scene.axes.pull_out.is_empty() {
        return Questions {
            slips: true,
            ..declared
        };
    }
    declared
}

/// How well a rung answers what is asked.
pub fn judge(bounds: Option<&Bounds>, questions: &Questions, rung: Fidelity) -> Vec<Judged> {
    let asked = Output::ALL
        .into_iter()
        .filter_map(|output| Some((output, output.tolerance(questions)?)));
    asked
        .map(|(output, tolerance)| Judged {
            output,
            tolerance,
            bound: bounds.map(|bounds| bounds.of(rung, output)),
            measured: None,
        })
        .collect()
}

/// The lowest rung whose bounds are within what is asked, of those that a scene says enough for.
///
/// # Errors
/// A question that only rungs answer for which the scene lacks something.
pub fn choose(checked: &Checked) -> Result<Choice, SceneError> {
    let questions = questions(checked);
    let bounds = bounds(checked);
    if questions.is_none() {
        return Ok(Choice {
            rung: Fidelity::Kinematic,
            why: "the scene asks nothing of torque, so only phases and what follows from them are asked"
                .to_owned(),
            judged: Vec::new(),
        });
    }
    let bounds = match bounds {
        Ok(bounds) => bounds,
        // Nothing was asked for in so many words: the torques are compared, and that is said.
        Err(_) if checked.scene.questions.is_none() => {
            return Ok(Choice {
                rung: Fidelity::QuasiStatic,
                why: "the scene gives the motors' pull-out torque, so whether they keep in step is asked; what oscillation \
                      adds to torque is not known, as it gives no rotor inertia"
                    .to_owned(),
                judged: judge(None, &questions, Fidelity::QuasiStatic),
            });
        }
        Err(lacking) => {
            let asked = judge(None, &questions, Fidelity::Rigid);
            let key = asked.first().map_or("", |judged| judged.output.key());
            return Err(SceneError::at(
                format!("questions.{key}"),
                format!(
                    "cannot be bounded: {} {}; give that, or leave the question out",
                    lacking.key, lacking.problem
                ),
            ));
        }
    };
    let rungs = available(checked);
    for &rung in &rungs {
        let judged = judge(Some(&bounds), &questions, rung);
        if judged.iter().all(Judged::is_bounded) {
            return Ok(Choice {
                why: why(&bounds, rung, rungs.last() == Some(&rung)),
                rung,
                judged,
            });
        }
    }
    let top = rungs.last().copied().unwrap_or(Fidelity::Kinematic);
    Ok(Choice {
        rung: top,
        why: "no rung's bounds are within what is asked; this is the highest that the scene says enough for".to_owned(),
        judged: judge(Some(&bounds), &questions, top),
    })
}

fn why(bounds: &Bounds, rung: Fidelity, is_top: bool) -> String {
    let worst = bounds.worst();
    let most = |used: &[f64]| used.iter().copied().fold(0.0, f64::max);
    let numbers = format!(
        "torque ratio {:.2} ({:.2} with what oscillates), frequency ratio {:.2}, lag of at most {:.2}°",
        most(&worst.torque_ratio_asked),
        most(&worst.torque_ratio),
        worst.frequency_ratio,
        worst.lag_rad.to_degrees()
    );
    if is_top {
        format!("only here is everything that is asked within its tolerance: {numbers}")
    } else {
        let name = rung.name();
        format!("what {name} leaves out stays within the tolerances: {numbers}")
    }
}

/// Rungs that the scene says enough for, the lowest first.
pub fn available(checked: &Checked) -> Vec<Fidelity> {
    LADDER
        .into_iter()
        .filter(|&rung| checked.on(rung).is_ok())
        .collect()
}

/// What bounds the rungs of a scene.
///
/// # Errors
/// What the scene lacks for that.
pub fn bounds(checked: &Checked) -> Result<Bounds, SceneError> {
    // The top rung that the scene has: with a frame, if it gives one.
    let apart = checked
        .on(Fidelity::Elastic)
        .or_else(|_| checked.on(Fidelity::Phased))?;
    with_axes!(checked.scene.axes.count, N => {
        let machine = Machine::<N>::new(&apart)?;
        let settings = apart.settings::<N>()?;
        let driven = machine.rotors().map(Rotors::driven);
        Ok(driven.map_or_else(
            || unreachable!("phased cranks are moved by torque"),
            |driven| of(&apart, &settings, driven),
        ))
    })
}

fn of<const N: usize>(checked: &Checked, settings: &Settings<N>, driven: &Driven) -> Bounds {
    let limits = &checked.scene.limits;
    let drive = Drive {
        top_rad_s: std::f64::consts::TAU * checked.top_speed_hz(),
        acceleration_rad_s2: std::f64::consts::TAU * limits.acceleration_hz_per_s,
        tick_s: 1.0 / f64::from(settings.tick_hz),
        ratios: settings
            .axes
            .iter()
            .map(|axis| f64::from(axis.ratio.0) / f64::from(axis.ratio.1))
            .collect(),
        offsets: settings.axes.iter().map(|axis| axis.offset_turns).collect(),
    };
    let standing: Vec<f64> = (0..N)
        .map(|i| {
            let apart = checked.apart(i);
            apart.map_or(0.0, |apart| (apart.start_deg + apart.trim_deg).to_radians())
        })
        .collect();
    let most = standing.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = standing.iter().copied().fold(f64::INFINITY, f64::min);
    Bounds::new(
        driven,
        &drive,
        worst(driven, &drive),
        most - least,
        super::frame::share(driven, &drive),
    )
}
