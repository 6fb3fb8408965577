//! What counts as named rightly: one table, from what was put in to what may be told of it.
//!
//! An index sensor is heard once a turn, and an encoder all the time; so what can be told of a crank depends on which of them it
//! has. What cannot be told apart by what there is, is not asked to be.

use cophase_core::supervisor::FaultKind;

use crate::scene::file::{Drive, FaultAt, FaultName, Scene};

/// What is known of the run that decides which names are right.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// The axis has an encoder.
    pub has_encoder: bool,
    /// It is a stepper's.
    pub is_stepper: bool,
    /// The fault came before align was over: what was before it is not known, so that a jump is a place too far out.
    pub in_align: bool,
    /// The crank was past its limit.
    pub is_past: bool,
    /// The two axes of a swap are mounted the other way round from each other: what drives one forward drives the other back.
    pub opposed: bool,
    /// Their index flags stand at different places.
    pub flags_apart: bool,
    /// The crank stood, and the machine with it, before it had passed its flag once more.
    pub stood_first: bool,
}

/// What may be told of a fault: any of these kinds.
pub fn accepted(fault: &FaultAt, at: Circumstances) -> Vec<FaultKind> {
    use FaultKind as Kind;
    let mut names = match fault.kind {
        FaultName::LostSteps => vec![Kind::LostSteps],
        // Seen once a turn, a crank that gains on its command slips ahead, or runs away.
        FaultName::Slip
            if !at.has_encoder && fault.rate_deg_per_s.is_some_and(|rate| rate < 0.0) =>
        {
            vec![Kind::Slip, Kind::Runaway]
        }
        FaultName::Slip => vec![Kind::Slip],
        // Without an encoder, a crank that stands and a sensor that is dead are the same.
        FaultName::Stuck if !at.has_encoder => match fault.for_s {
            None => vec![Kind::Silent],
            // It goes on before its pulse is overdue, and is behind: a stepper by whole cycles.
            Some(_) => vec![Kind::Silent, Kind::LostSteps, Kind::Slip],
        },
        FaultName::Stuck => match fault.for_s {
            Some(_) if at.is_stepper => vec![Kind::Stuck, Kind::LostSteps],
            _ => vec![Kind::Stuck],
        },
        FaultName::Runaway if at.has_encoder => vec![Kind::Runaway],
        // Seen once a turn, a crank that gains on its command walks ahead of it.
        FaultName::Runaway => vec![Kind::Runaway, Kind::Slip],
        // Where nothing else watches, a pulse that is overdue stops the machine, mostly before the next could tell.
        FaultName::IndexMissing if at.has_encoder && !at.in_align => vec![Kind::IndexMissing],
        FaultName::IndexMissing => match fault.count {
            None if !at.in_align => vec![Kind::Silent],
            _ => vec![Kind::IndexMissing, Kind::Silent],
        },
        FaultName::IndexExtra => vec![Kind::IndexExtra],
        FaultName::SwappedWiring => {
            let mut names = vec![Kind::SwappedWiring];
            if at.opposed && at.has_encoder {
                names.push(Kind::Reversed);
            }
            // Before anything is moved, each of the two is seen where the other's flag is; or both turn back, as they are mounted
            // the other way round from each other, and pass their flags elsewhere.
            if at.flags_apart || at.opposed && !at.has_encoder {
                names.push(Kind::TooFarOut);
            }
            names
        }
        FaultName::Reversed => vec![Kind::Reversed],
        FaultName::EncoderGlitch => vec![Kind::EncoderGlitch],
        FaultName::DriveAlarm => vec![Kind::DriveAlarm],
        FaultName::Overrun => vec![Kind::Overrun],
        FaultName::RunDry => vec![Kind::RanDry],
        FaultName::EnableLoss => vec![Kind::EnableLost],
        FaultName::StopInput => vec![Kind::StopInput],
        // Nothing is wrong with a motor that has torque enough; with one that has not, it loses steps, or lags.
        FaultName::LoadStep => vec![
            Kind::LostSteps,
            Kind::Slip,
            Kind::CommonLag,
            Kind::Tilt,
            Kind::Warp,
        ],
    };
    let moves_crank = matches!(
        fault.kind,
        FaultName::LostSteps | FaultName::Slip | FaultName::Stuck | FaultName::Runaway
    );
    // Its pulse is overdue, and where it would have come nobody sees any more.
    if moves_crank && !at.has_encoder && at.stood_first {
        names.push(Kind::Silent);
    }
    // The first pulse that is heard is where a crank is found.
    if at.in_align && (moves_crank || fault.kind == FaultName::IndexExtra) {
        names.push(Kind::TooFarOut);
    }
    if at.in_align && moves_crank && at.is_past {
        names.extend([Kind::Tilt, Kind::Warp]);
    }
    names
}

/// Whether a kind must be told even though no crank moves past a limit.
pub const fn must_be_told(kind: FaultName) -> bool {
    !matches!(
        kind,
        FaultName::LostSteps
            | FaultName::Slip
            | FaultName::Stuck
            | FaultName::Runaway
            | FaultName::LoadStep
    )
}

/// Whether the axis that is told must be the one that it befell.
pub const fn has_axis(kind: FaultName) -> bool {
    !matches!(
        kind,
        FaultName::Overrun | FaultName::EnableLoss | FaultName::StopInput | FaultName::LoadStep
    )
}

/// Whether the axis that a fault befalls is a stepper's.
pub fn is_stepper(scene: &Scene, fault: &FaultAt) -> bool {
    let apart = fault.axis.and_then(|axis| scene.apart(axis));
    apart
        .and_then(|apart| apart.drive)
        .unwrap_or(scene.axes.drive)
        == Drive::Stepper
}

/// Whether an extra pulse that comes so far after the place where the axis meets its flag, turns of the crank, is nothing that
/// anyone sees, or that matters: within a gate of that place it is taken for the flag's own, and the flag for the same passage,
/// which has the crank be off by less than a gate for a turn; and while the flag is before the sensor its line is high already.
pub fn is_in_place(scene: &Scene, fault: &FaultAt, off_turns: f64) -> bool {
    let flag_turns = scene.axes.index_width_deg / 360.0;
    let gate = gate_turns(scene, fault);
    (-gate..=gate.max(flag_turns)).contains(&off_turns)
}

/// The width of a place that the drift monitor is set up with (docs/faults.md), from the scene's numbers: four times what a reading
/// is off by, a step either way with it; of a stepper no more than leaves the nearest lost cycle apart from it.
fn gate_turns(scene: &Scene, fault: &FaultAt) -> f64 {
    let reading = scene.drift.reading_deg / 360.0 + 2.0 / f64::from(scene.axes.steps_per_turn);
    if !is_stepper(scene, fault) {
        return 4.0 * reading;
    }
    let half_cycle = 2.0 / f64::from(scene.axes.full_steps_per_turn);
    let sure = half_cycle - reading;
    let most = if sure < 2.0 * reading {
        half_cycle
    } else {
        sure
    };
    most.min(4.0 * reading)
}

/// Turns of the master, of a machine that moves, after which a kind must have been told: of index pulses, one until the next is
/// due, and one until that is overdue by a margin.
pub fn turns_to_tell(fault: &FaultAt) -> f64 {
    match fault.kind {
        FaultName::IndexMissing | FaultName::IndexExtra | FaultName::EncoderGlitch => 2.2,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::library;

    /// Were the place too wide, pulses that the loop must tell of would be let pass; were it too narrow, it would be blamed for what no
    /// line shows. Of 3200 steps and 0.25° a gate is 4 (0.25 + 0.225) = 1.9°, of 200 full steps no more than 3.6 - 0.475 = 3.125°.
    #[test]
    fn a_place_is_a_gate_wide_and_as_long_as_its_flag() {
        let mut scene = library::find("default").unwrap().scene();
        scene.axes.steps_per_turn = 3200;
        scene.axes.full_steps_per_turn = 200;
        scene.drift.reading_deg = 0.25;
        let fault = FaultAt {
            at_s: 1.0,
            kind: FaultName::IndexExtra,
            axis: Some(0),
            with: None,
            lines: None,
            cycles: None,
            rate_deg_per_s: None,
            speed_hz: None,
            count: Some(1),
            counts: None,
            torque_nm: None,
            for_s: None,
        };
        let is_in = |scene: &Scene, deg: f64| is_in_place(scene, &fault, deg / 360.0);
        scene.axes.index_width_deg = 0.0;
        for (deg, expected) in [(-1.95, false), (-1.85, true), (1.85, true), (1.95, false)] {
            assert_eq!(is_in(&scene, deg), expected, "{deg}");
        }
        scene.axes.index_width_deg = 6.0;
        for (deg, expected) in [(-1.95, false), (5.9, true), (6.1, false)] {
            assert_eq!(is_in(&scene, deg), expected, "{deg}");
        }
        scene.axes.full_steps_per_turn = 800;
        scene.axes.index_width_deg = 0.0;
        // Half a cycle is 0.9°, less a reading 0.425°: less than two readings differ by, so that half a cycle it is.
        assert!(is_in(&scene, 0.89) && !is_in(&scene, 0.91));
    }
}
