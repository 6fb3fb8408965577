//! Questions that a scene answers about itself: values of an axis, and what its faults touch.

use cophase_core::settings::Transmission;

use super::{AxisOverrides, Drive, FaultAt, FaultName, Lines, Scene};

impl Scene {
    /// Index of the first fault that moves a crank away from its command.
    pub fn moving_fault(&self) -> Option<usize> {
        self.fault.iter().position(FaultAt::moves_crank)
    }

    /// True if faults or noise change the commands of the drives or the loads of the cranks.
    pub fn touches_drives(&self) -> bool {
        self.noise.load_nm != 0.0
            || self.has_wrong_drive()
            || self.fault.iter().any(FaultAt::touches_drives)
    }

    /// True if a drive needs other steps for a turn than the settings say.
    pub fn has_wrong_drive(&self) -> bool {
        let differs = |own: &AxisOverrides| own.drive_steps_per_turn.is_some();
        self.axis.iter().any(differs)
    }

    /// Returns axis `number` with its own values, and those of `[axes]` where it has none.
    pub fn resolved(&self, number: usize) -> Axis<'_> {
        static NONE: AxisOverrides = AxisOverrides::new(0);
        let common = &self.axes;
        let own = self.axis.iter().find(|own| own.number == number);
        let own = own.unwrap_or(&NONE);
        let (motor_turns, crank_turns) = own.gear.unwrap_or(common.gear);
        let index_deg = own.index_deg.unwrap_or(common.index_deg);
        Axis {
            drive: own.drive.unwrap_or(common.drive),
            steps_per_turn: own.steps_per_turn.unwrap_or(common.steps_per_turn),
            gear: Transmission {
                motor_turns,
                crank_turns,
            },
            ratio: own.ratio.unwrap_or(common.ratio),
            offset_deg: own.offset_deg.unwrap_or(common.offset_deg),
            index_deg: own.index.unwrap_or(common.index).then_some(index_deg),
            friction_nm: own.friction_nm.unwrap_or(common.friction_nm),
            own,
        }
    }

    /// Returns the sensors from which the controller reads phases, for lists: `index`, `encoder`, both, or `none`.
    pub fn sensors(&self) -> String {
        let axes = &self.axes;
        let has_index = |&number: &usize| self.resolved(number).index_deg.is_some();
        let sensing = (0..axes.count).filter(has_index).count();
        let index = match sensing {
            0 => None,
            _ if sensing == axes.count => Some("index".to_owned()),
            _ => Some(format!("{sensing} index")),
        };
        let encoder = axes.encoder.then(|| "encoder".to_owned());
        let all: Vec<String> = index.into_iter().chain(encoder).collect();
        if all.is_empty() {
            "none".to_owned()
        } else {
            all.join(", ")
        }
    }

    /// Returns the corrections of phase errors, for lists: `trim` in each turn, `coupling` in each tick, both, or `none`.
    pub fn corrects(&self) -> String {
        let given = &self.correction;
        let is_coupled = given.couple
            || [given.coupling, given.coupling_per_s]
                .into_iter()
                .flatten()
                .any(|gain| gain != 0.0);
        let all: Vec<&str> = [("trim", given.gain != 0.0), ("coupling", is_coupled)]
            .into_iter()
            .filter_map(|(name, is_on)| is_on.then_some(name))
            .collect();
        if all.is_empty() {
            "none".to_owned()
        } else {
            all.join(", ")
        }
    }
}

/// Axis as the machine has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis<'a> {
    /// Drive.
    pub drive: Drive,
    /// Steps, or encoder counts, per turn of the motor.
    pub steps_per_turn: u32,
    /// Belt or gearbox.
    pub gear: Transmission,
    /// Crank turns per master turn, as numerator and denominator.
    pub ratio: (u32, u32),
    /// Crank phase relative to the master's, degrees.
    pub offset_deg: f64,
    /// Crank phase of the index sensor, degrees; `None` without a sensor.
    pub index_deg: Option<f64>,
    /// Friction torque at the crank, N·m.
    pub friction_nm: f64,
    /// Its `[[axis]]`, for keys that `[axes]` does not have.
    pub own: &'a AxisOverrides,
}

impl Axis<'_> {
    /// Steps, or encoder counts, per turn of the crank.
    pub fn steps_per_crank_turn(&self) -> f64 {
        f64::from(self.steps_per_turn) * self.gear.ratio()
    }
}

impl AxisOverrides {
    /// Returns true if an `[[axis]]` entry of this axis has its own value for a key.
    pub fn has(&self, name: &str) -> bool {
        toml::Table::try_from(self).is_ok_and(|own| own.contains_key(name))
    }
}

impl FaultAt {
    /// True if the fault moves a crank away from its command.
    pub fn moves_crank(&self) -> bool {
        match self.kind {
            FaultName::LostSteps
            | FaultName::Slip
            | FaultName::Stuck
            | FaultName::Runaway
            | FaultName::Reversed
            | FaultName::StepFifoUnderrun => true,
            FaultName::SwappedWiring => self.lines == Some(Lines::Drive),
            _ => false,
        }
    }

    /// True if the fault acts between the loop and the drives, or on the cranks.
    pub fn touches_drives(&self) -> bool {
        self.moves_crank() || self.kind == FaultName::LoadStep
    }
}
