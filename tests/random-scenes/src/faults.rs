//! `[[fault]]` and `[noise]`.

use cophase_scene::file::{Axes, AxisOverrides, Drive, FaultAt, FaultName, Fidelity, Lines, Noise};

use crate::basis::{Basis, Kind};
use crate::source::Source;

/// Kinds that put a crank off its commanded phase, which neither one shaft for all cranks nor a cam shaft can show.
const MOVING: [FaultName; 7] = [
    FaultName::LostSteps,
    FaultName::Slip,
    FaultName::Stuck,
    FaultName::Runaway,
    FaultName::SwappedWiring,
    FaultName::Reversed,
    FaultName::StepFifoUnderrun,
];

const OTHERS: [FaultName; 8] = [
    FaultName::IndexMissing,
    FaultName::IndexExtra,
    FaultName::EncoderGlitch,
    FaultName::DriveAlarm,
    FaultName::Overrun,
    FaultName::EnableLoss,
    FaultName::StopInput,
    FaultName::LoadStep,
];

pub fn noise(source: &mut Source, basis: &Basis) -> Noise {
    if !source.percent(40) {
        return Noise::default();
    }
    let has_loads = moves_by_torque(basis) && basis.kinds.disturbed;
    Noise {
        seed: source.seed(),
        index_deg: source.usual((1e-3, 0.2), (0.0, 5.0)),
        index_us: source.usual((0.01, 5.0), (0.0, 50.0)),
        encoder_counts: if basis.has_encoder {
            source.usual((0.01, 0.3), (0.0, 1000.0))
        } else {
            0.0
        },
        load_nm: if has_loads && source.percent(50) {
            source.usual((1e-4, 1.0), (0.0, 1000.0))
        } else {
            0.0
        },
    }
}

/// True if torque moves the cranks, whatever level is chosen.
fn moves_by_torque(basis: &Basis) -> bool {
    basis.kind == Kind::Cranks && basis.fidelity.moves_by_torque()
}

/// Parts that a fault may act on.
struct Machine<'a> {
    basis: &'a Basis,
    axes: &'a Axes,
    apart: &'a [AxisOverrides],
}

pub fn faults(
    source: &mut Source,
    basis: &Basis,
    axes: &Axes,
    apart: &[AxisOverrides],
) -> Vec<FaultAt> {
    if !basis.kinds.disturbed || !source.percent(35) {
        return Vec::new();
    }
    let machine = Machine { basis, axes, apart };
    let count = source.one_of(&[1, 1, 1, 2, 3, 6]);
    (0..count).filter_map(|_| machine.fault(source)).collect()
}

impl Machine<'_> {
    fn fault(&self, source: &mut Source) -> Option<FaultAt> {
        let basis = self.basis;
        let may_move = basis.kind == Kind::Cranks && basis.fidelity != Fidelity::Rigid;
        let kind = if may_move && source.percent(50) {
            source.one_of(&MOVING)
        } else {
            source.one_of(&OTHERS)
        };
        let is_of_axis = !matches!(
            kind,
            FaultName::Overrun | FaultName::EnableLoss | FaultName::StopInput
        );
        let axis = self.axis(source, kind)?;
        let signed = |source: &mut Source, usual: (f64, f64), max: f64| {
            let size = source.usual(usual, (1e-3 * max, max));
            if source.percent(50) { size } else { -size }
        };
        let mut fault = FaultAt::new(basis.time_s(source), kind);
        fault.axis = is_of_axis.then_some(axis);
        match kind {
            FaultName::LostSteps => {
                let cycles = signed(source, (1.0, 5.0), 1e4).round() as i64;
                fault.cycles = source.maybe(80, |_| if cycles == 0 { 1 } else { cycles });
            }
            FaultName::Slip => {
                fault.rate_deg_per_s = Some(signed(source, (1.0, 360.0), 36_000.0));
            }
            FaultName::Runaway => {
                let max_hz = (1.5 * basis.speed_hz).min(200.0);
                fault.speed_hz = Some(signed(source, (0.1 * max_hz, max_hz), 200.0));
            }
            FaultName::IndexMissing | FaultName::IndexExtra => {
                let count = source.usual((1.0, 5.0), (1.0, 1e6)) as u32;
                fault.count = source.maybe(70, |_| count);
            }
            FaultName::SwappedWiring => {
                let with = (axis + 1 + source.below(basis.count - 1)) % basis.count;
                let alike = self.takes_pulses(axis) == self.takes_pulses(with);
                let lines = source.one_of(&[Lines::Drive, Lines::Sensors]);
                fault.with = Some(with);
                fault.lines = Some(if alike { lines } else { Lines::Sensors });
            }
            FaultName::EncoderGlitch => {
                let counts = signed(source, (1.0, 1e4), 1e9).round() as i64;
                fault.counts = Some(if counts == 0 { 1 } else { counts });
            }
            FaultName::Overrun => {
                // A million missed deadlines would take minutes.
                fault.count =
                    source.maybe(70, |source| source.usual((1.0, 10.0), (1.0, 2000.0)) as u32);
            }
            FaultName::LoadStep => {
                fault.torque_nm = Some(signed(source, (1e-3, 20.0), 1000.0));
            }
            FaultName::Stuck
            | FaultName::DriveAlarm
            | FaultName::Reversed
            | FaultName::StepFifoUnderrun
            | FaultName::EnableLoss
            | FaultName::StopInput => {}
        }
        let lasts = matches!(
            kind,
            FaultName::Slip
                | FaultName::Stuck
                | FaultName::DriveAlarm
                | FaultName::Runaway
                | FaultName::EncoderGlitch
                | FaultName::EnableLoss
                | FaultName::StopInput
                | FaultName::LoadStep
        );
        if lasts {
            fault.for_s = source.maybe(60, |source| source.usual((1e-3, 1.0), (1e-6, 1e6)));
        }
        Some(fault)
    }

    /// An axis that can have a fault of this kind, if there is one.
    fn axis(&self, source: &mut Source, kind: FaultName) -> Option<usize> {
        let can = |axis: &usize| match kind {
            FaultName::LostSteps => self.drive(*axis).kind().is_open_loop(),
            FaultName::StepFifoUnderrun => self.takes_pulses(*axis),
            FaultName::EncoderGlitch => self.basis.has_encoder,
            FaultName::IndexMissing | FaultName::IndexExtra => {
                let own = self.own(*axis).and_then(|own| own.index);
                own.unwrap_or(self.axes.index)
            }
            FaultName::LoadStep => moves_by_torque(self.basis),
            _ => true,
        };
        let axes: Vec<usize> = (0..self.basis.count).filter(can).collect();
        (!axes.is_empty()).then(|| source.one_of(&axes))
    }

    fn own(&self, axis: usize) -> Option<&AxisOverrides> {
        self.apart.iter().find(|own| own.number == axis)
    }

    fn drive(&self, axis: usize) -> Drive {
        let own = self.own(axis).and_then(|own| own.drive);
        own.unwrap_or(self.basis.drive)
    }

    fn takes_pulses(&self, axis: usize) -> bool {
        self.drive(axis).kind().takes_pulses()
    }
}
