//! What counts as named rightly: one table, from what was put in to what may be told of it.
//!
//! An index sensor is heard once a turn, and an encoder all the time; so what can be told of a crank depends on which of them it
//! has. What cannot be told apart by what there is, is not asked to be.

use cophase_core::supervisor::FaultKind;

use host_sim::scene::file::{FaultAt, FaultName};

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

/// Turns of the master, of a machine that moves, after which a kind must have been told: of index pulses, one until the next is
/// due, and one until that is overdue by a margin.
pub fn turns_to_tell(fault: &FaultAt) -> f64 {
    match fault.kind {
        FaultName::IndexMissing | FaultName::IndexExtra | FaultName::EncoderGlitch => 2.2,
        _ => 0.0,
    }
}
