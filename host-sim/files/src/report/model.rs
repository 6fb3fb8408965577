//! Part of the report about the machine's equations: model level and method.

use cophase_scene::file::MethodName;
use host_sim::checked::Checked;
use host_sim::checked::Judged;
use host_sim::model_level::Bounds;
use host_sim::sim::Outcome;
use serde::Serialize;

#[derive(Clone, Debug, Serialize)]
pub struct FidelityReport<'a> {
    model_level: &'static str,
    why: &'a str,
    left_out: String,
    /// Largest distance of the moved part from its position with the oscillation that quasi-static rods replace.
    #[serde(skip_serializing_if = "Option::is_none")]
    quasi_static_rods_um: Option<f64>,
    /// Requested outputs, with the accuracy of this model level.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    outputs: Vec<OutputReport>,
}

#[derive(Clone, Debug, Serialize)]
struct OutputReport {
    /// Key in `[questions]`, with the unit of the numbers.
    output: &'static str,
    tolerance: f64,
    /// Value in running and stopping; `None` if the model level does not compute it.
    value: Option<f64>,
    /// Bound on its error; `None` if there is none.
    bound: Option<f64>,
    /// Difference from another model level in a sample of the scene.
    measured: Option<f64>,
    against: Option<&'static str>,
    /// Error by the method's step, as the sample shows it; `None` if nothing is integrated.
    step_error: Option<f64>,
}

impl OutputReport {
    fn new(judged: &Judged) -> Self {
        Self {
            output: judged.output.key(),
            tolerance: judged.tolerance,
            value: judged.value,
            bound: judged.bound,
            measured: judged.measured.map(|(off, _)| off),
            against: judged.measured.map(|(_, model_level)| model_level.name()),
            step_error: judged.step_error,
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct MethodReport {
    name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps_per_tick: Option<u32>,
    /// Permitted relative error of oscillations by the step, if the step was chosen for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolution: Option<f64>,
    why: String,
}

impl<'a> FidelityReport<'a> {
    pub fn new(checked: &'a Checked) -> Self {
        Self {
            model_level: checked.fidelity.name(),
            why: checked.why(),
            left_out: checked.machine.left_out(checked.fidelity),
            quasi_static_rods_um: quasi_static_rods_um(checked),
            outputs: judged(checked).iter().map(OutputReport::new).collect(),
        }
    }
}

impl MethodReport {
    pub fn new(checked: &Checked, outcome: &Outcome) -> Self {
        Self {
            name: outcome
                .method
                .map_or("closed form", |(scheme, _)| scheme.facts().name),
            steps_per_tick: outcome.method.map(|(_, steps)| steps),
            resolution: outcome
                .method
                .filter(|_| checked.scene.method.steps_per_tick.is_none())
                .map(|_| checked.resolution),
            why: about_method(checked, outcome),
        }
    }
}

/// Returns the reason for the method, in words.
fn about_method(checked: &Checked, outcome: &Outcome) -> String {
    if outcome.method.is_some() && checked.scene.method.name != MethodName::Auto {
        "the scene sets it".to_owned()
    } else if let Some(own) = checked.machine.about_method(checked.fidelity) {
        own.to_owned()
    } else if checked.moves_by_torque() {
        "accurate where the step resolves every mode: as long as what swings fastest stays right to the resolution".to_owned()
    } else {
        format!(
            "{}s are where pulses and setpoints put them: nothing is integrated",
            checked.machine.axis_noun()
        )
    }
}

/// Returns the requested outputs and their accuracy; nothing if the scene sets its model level.
pub fn judged(checked: &Checked) -> &[Judged] {
    checked
        .choice
        .as_ref()
        .map_or(&[], |choice| &choice.judged[..])
}

fn quasi_static_rods_um(checked: &Checked) -> Option<f64> {
    let bounds = Bounds::new(checked).ok()?;
    bounds.quasi_static_um(checked.fidelity)
}
