//! Equations of motion of a user's scene, with the method and the step that integrate them.

use std::iter::once;

use cophase_methods::problems::{Cam, Chain};
use cophase_methods::{Equations, Scheme};
use cophase_scene::file::Fidelity;
use cophase_scene::{Scene, SceneError};
use host_sim::checked::Checked;
use host_sim::dynamics::Mode;
use host_sim::fidelity;
use host_sim::machines::cam::{cam_of, damped, links};
use host_sim::model_level::{LADDER, available};
use host_sim::simulated_machine::SimulatedMachine;

/// Scene on a model level that is integrated.
pub struct Integrated {
    /// Scene on the model level that a run takes.
    pub checked: Checked,
    /// Equations at power-up.
    pub equations: Box<dyn Equations>,
    /// Number of positions at the start of a state that are compared: the shafts' angles, or the masses' positions of a follower.
    pub compared: usize,
    /// Unit of these positions.
    pub unit: &'static str,
    /// Modes with which a step is checked, the fastest first. Those of cranks and shafts are upper bounds.
    pub modes: Vec<Mode>,
    /// Method that a run takes.
    pub scheme: Scheme,
    /// Steps in a control tick that a run takes.
    pub steps: u32,
    /// Control tick, s.
    pub tick_s: f64,
}

impl Integrated {
    /// Chooses model level, method and step as a run of the scene does.
    ///
    /// # Errors
    /// The model level of the scene integrates nothing, or a run refuses the scene.
    pub fn new(checked: &Checked) -> Result<Self, SceneError> {
        let checked = fidelity::check(checked.clone())?;
        let machine = SimulatedMachine::new(&checked)?;
        let (scheme, steps) = (machine.method()).ok_or_else(|| not_integrated(&checked))?;
        let tick_s = 1.0 / f64::from(checked.settings.tick_hz);
        Ok(match machine.rotors() {
            Some(rotors) => {
                let driven = rotors.driven().clone();
                let fastest = driven.fastest_mode();
                let others = driven.own_modes().into_iter();
                let others = others.filter(|mode| *mode != fastest);
                Self {
                    modes: once(fastest).chain(others).collect(),
                    compared: driven.angles(),
                    unit: "rad",
                    equations: Box::new(driven),
                    checked,
                    scheme,
                    steps,
                    tick_s,
                }
            }
            None => {
                let chain = chain_of(&checked.scene)?;
                let modes = chain.modes().into_iter().rev().map(|mode| Mode {
                    omega_rad_s: mode.omega_rad_s,
                    zeta: mode.zeta,
                });
                Self {
                    modes: modes.filter(|mode| mode.omega_rad_s > 0.0).collect(),
                    compared: chain.dimension() / 2,
                    unit: "m",
                    equations: Box::new(chain),
                    checked,
                    scheme,
                    steps,
                    tick_s,
                }
            }
        })
    }

    /// Step that a run takes, s.
    pub fn step_s(&self) -> f64 {
        self.tick_s / f64::from(self.steps)
    }

    /// Methods that suit the equations, the simplest first.
    pub fn schemes(&self) -> impl Iterator<Item = Scheme> {
        let all = Scheme::ALL.into_iter();
        all.filter(|scheme| scheme.suits(self.equations.as_ref()))
    }
}

/// Returns the elastic chain behind the cams of a scene, at rest at the beginning of the rise.
///
/// # Errors
/// The scene has none.
pub fn chain_of(scene: &Scene) -> Result<Chain, SceneError> {
    let lacking = || SceneError::for_key("cam.masses_kg", "missing; give the followers' masses");
    let shaft = scene.cam.as_ref().ok_or_else(lacking)?;
    let links = links(shaft)?.ok_or_else(lacking)?;
    let cam: Cam = cam_of(shaft);
    Ok(Chain::with_links(cam, damped(shaft.damper), &links))
}

/// Returns the error that nothing is integrated, with the model levels on which something is, or what they lack.
fn not_integrated(checked: &Checked) -> SceneError {
    let taken = checked.fidelity.name();
    let is_integrated = |level: &Fidelity| {
        let machine = checked.on(*level).and_then(|on| SimulatedMachine::new(&on));
        machine.is_ok_and(|machine| machine.method().is_some())
    };
    let levels: Vec<_> = available(checked)
        .into_iter()
        .filter(is_integrated)
        .map(|level| format!("\"{}\"", level.name()))
        .collect();
    let fix = if levels.is_empty() {
        // The lowest level that the machine has, and that is not another name of this one.
        let higher = LADDER
            .into_iter()
            .filter(|level| *level > Fidelity::QuasiStatic);
        let mut errors = higher.filter_map(|level| checked.on(level).err());
        match errors.find(|error| error.key != "fidelity") {
            None => format!("{} has no other level", checked.machine.name()),
            Some(lacking) => {
                // The error may propose to stay on this level.
                let problem = lacking.problem.split_once("; or let fidelity");
                let problem = problem.map_or(&*lacking.problem, |(problem, _)| problem);
                format!("for another level {}: {problem}", lacking.key)
            }
        }
    } else {
        format!("let fidelity be {}", levels.join(" or "))
    };
    SceneError::for_key(
        "fidelity",
        format!(
            "the {taken} model level, which this scene takes, integrates nothing, so it has no method, step or modes; {fix}"
        ),
    )
}
