//! Figures by which a motor and its gear are chosen: electrical cycle at the crank, step rate, torque at the motor, inertia ratio.

use cophase_core::settings::Transmission;
use host_sim::checked::Checked;
use host_sim::drives::AtCrank;
use host_sim::operating_range::OperatingRange;
use serde::Serialize;

/// Figures of the motor of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MotorFigures {
    /// Turns of the motor, and of the crank in that time.
    gear: [u32; 2],
    /// Electrical cycle of a stepper, degrees of the crank.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub electrical_cycle_deg: Option<f64>,
    /// Largest step rate, or rate of counts, of the axis: at the limit of the master's speed, without the motion of phase offsets, 1/s.
    pub step_rate_max_hz: f64,
    /// Largest torque that is required of the motor, N·m at its own shaft: at the program's greatest speed, while the shaft accelerates at
    /// its limit. It is known under a platform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_required_nm: Option<f64>,
    /// Largest inertia of the load over a turn of the crank, reflected to the motor, over the motor's own. It is known under a platform, for
    /// a motor whose inertia is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia_ratio: Option<f64>,
}

impl MotorFigures {
    /// Figures of all motors of a scene.
    pub fn of_all(checked: &Checked) -> Vec<Self> {
        let range = OperatingRange::new(checked).ok().flatten();
        let count = checked.settings.axes.len();
        (0..count)
            .map(|number| Self::new(checked, range.as_ref(), number))
            .collect()
    }

    fn new(checked: &Checked, range: Option<&OperatingRange>, number: usize) -> Self {
        let settings = &checked.settings;
        let axis = &settings.axes[number];
        let Transmission {
            motor_turns,
            crank_turns,
        } = axis.gear;
        let own_kgm2 = AtCrank::new(&checked.scene, number).rotor_inertia_kgm2;
        let acceleration = settings.limits.acceleration_hz_per_s;
        Self {
            gear: [motor_turns, crank_turns],
            electrical_cycle_deg: axis
                .drive
                .is_open_loop()
                .then(|| axis.cycle_turns() * 360.0),
            step_rate_max_hz: settings.axis_bounds(axis).speed
                * axis.steps_per_crank_turn().to_f64(),
            torque_required_nm: range
                .map(|range| range.required_nm(number, range.top_hz, acceleration)),
            // Both are those at the crank.
            inertia_ratio: (checked.machine.carried_kgm2())
                .filter(|_| own_kgm2 > 0.0)
                .map(|load_kgm2| load_kgm2 / own_kgm2),
        }
    }
}

impl MotorFigures {
    /// The figures in words. `axis` names what the motor turns: a crank, a shaft or a cam.
    fn words(&self, axis: &str) -> String {
        let mut parts = Vec::new();
        let [motor_turns, axis_turns] = self.gear;
        if motor_turns != axis_turns {
            parts.push(format!("{motor_turns} turns to {axis_turns} of the {axis}"));
        }
        parts.push(format!(
            "up to {:.0} {}/s at limits.speed_hz",
            self.step_rate_max_hz,
            self.unit()
        ));
        if let Some(cycle_deg) = self.electrical_cycle_deg {
            parts.push(format!(
                "an electrical cycle of {cycle_deg:.3}° at the {axis}"
            ));
        }
        if let Some(torque_nm) = self.torque_required_nm {
            parts.push(format!("{torque_nm:.3} N·m required in the steepest ramp"));
        }
        if let Some(ratio) = self.inertia_ratio {
            parts.push(format!("inertia of the load over its own {ratio:.2}"));
        }
        parts.join(", ")
    }

    /// Unit of the step rate.
    const fn unit(&self) -> &'static str {
        match self.electrical_cycle_deg {
            Some(_) => "steps",
            None => "counts",
        }
    }
}

/// Lines about all motors: one for each group of motors with equal figures.
pub fn lines(checked: &Checked) -> Vec<String> {
    let all: Vec<String> = MotorFigures::of_all(checked)
        .iter()
        .map(|figures| figures.words(checked.machine.axis_noun()))
        .collect();
    let mut kinds: Vec<(&String, Vec<usize>)> = Vec::new();
    for (axis, figures) in all.iter().enumerate() {
        match kinds.iter_mut().find(|(kind, _)| *kind == figures) {
            Some((_, axes)) => axes.push(axis),
            None => kinds.push((figures, vec![axis])),
        }
    }
    let is_one = kinds.len() == 1;
    let line = |(figures, axes): &(&String, Vec<usize>)| {
        let axes: Vec<String> = axes.iter().map(ToString::to_string).collect();
        let which = if is_one {
            "Each motor".to_owned()
        } else {
            format!("Motor {}", axes.join(", "))
        };
        format!("{which}: {figures}.")
    };
    kinds.iter().map(line).collect()
}
