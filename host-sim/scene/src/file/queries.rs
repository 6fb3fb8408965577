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

    /// Returns the values of axis `number` that differ from those of all axes.
    pub fn overrides(&self, number: usize) -> Option<&AxisOverrides> {
        self.axis.iter().find(|own| own.number == number)
    }

    /// Returns the sensors from which the controller reads phases, for lists: `index`, `encoder`, both, or `none`.
    pub fn sensors(&self) -> String {
        let axes = &self.axes;
        let has_index = |number: &usize| {
            let own = self.overrides(*number).and_then(|own| own.index);
            own.unwrap_or(axes.index)
        };
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

    /// Returns the steps, or encoder counts, per turn of the motor of axis `number`.
    pub fn steps_per_turn(&self, number: usize) -> u32 {
        let own = self.overrides(number).and_then(|own| own.steps_per_turn);
        own.unwrap_or(self.axes.steps_per_turn)
    }

    /// Returns the steps, or encoder counts, per turn of the crank of axis `number`.
    pub fn steps_per_crank_turn(&self, number: usize) -> f64 {
        f64::from(self.steps_per_turn(number)) * self.gear(number).ratio()
    }

    /// Returns the belt or gearbox of axis `number`.
    pub fn gear(&self, number: usize) -> Transmission {
        let own = self.overrides(number).and_then(|own| own.gear);
        let (motor_turns, crank_turns) = own.unwrap_or(self.axes.gear);
        Transmission {
            motor_turns,
            crank_turns,
        }
    }

    /// Returns the drive of axis `number`.
    pub fn drive(&self, number: usize) -> Drive {
        let own = self.overrides(number).and_then(|own| own.drive);
        own.unwrap_or(self.axes.drive)
    }
}

impl AxisOverrides {
    /// Returns true if an `[[axis]]` entry of this axis has its own value for a key of [`super::Axes`].
    pub fn has(&self, name: &str) -> bool {
        match name {
            "drive" => self.drive.is_some(),
            "steps_per_turn" => self.steps_per_turn.is_some(),
            "gear" => self.gear.is_some(),
            "ratio" => self.ratio.is_some(),
            "offset_deg" => self.offset_deg.is_some(),
            "index" => self.index.is_some(),
            "cam" | "cam_shift_deg" => self.cam.is_some(),
            "index_deg" => self.index_deg.is_some(),
            "trim_deg" => true, // nothing else trims
            _ => false,
        }
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
