//! Names that count as right: one table, from the fault that was injected to what may be reported of it.
//!
//! An index sensor is detected once a turn, and an encoder all the time; so what can be reported of a crank depends on which of them it
//! has. What the sensors cannot distinguish need not be distinguished.

use cophase_core::supervisor::FaultKind;

use host_sim::scene::file::{FaultAt, FaultName};

/// What is known of the run that decides which names are right.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// The axis has an encoder.
    pub has_encoder: bool,
    /// It is a stepper's.
    pub is_stepper: bool,
    /// Its drive raises its alarm beyond a following-error window.
    pub watches_following_error: bool,
    /// The fault came before homing was over: what was before it is not known, so that a jump is a place beyond the homing range.
    pub in_homing: bool,
    /// The crank was beyond its limit.
    pub is_beyond_limit: bool,
    /// The two axes of a swap are mounted the other way round from each other: what drives one forward drives the other back.
    pub opposed: bool,
    /// Their index flags stand at different places.
    pub flags_apart: bool,
    /// The crank stood, and the machine with it, before it had passed its flag once more.
    pub stood_first: bool,
}

/// Kinds that may be reported of a fault: any of them.
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
            None => vec![Kind::IndexTimeout],
            // It goes on before its pulse is overdue, and is behind: a stepper by whole cycles.
            Some(_) => vec![Kind::IndexTimeout, Kind::LostSteps, Kind::Slip],
        },
        FaultName::Stuck => match fault.for_s {
            Some(_) if at.is_stepper => vec![Kind::Stuck, Kind::LostSteps],
            _ => vec![Kind::Stuck],
        },
        FaultName::Runaway if at.has_encoder => match fault.for_s {
            _ if fault.speed_hz.is_none_or(|speed_hz| speed_hz > 0.0) => vec![Kind::Runaway],
            None => vec![Kind::Reversed],
            // It goes on before it has gone back far enough, and is behind: a stepper by whole cycles.
            Some(_) if at.is_stepper => vec![Kind::Reversed, Kind::Stuck, Kind::LostSteps],
            Some(_) => vec![Kind::Reversed, Kind::Stuck],
        },
        // Seen once a turn, a crank that gains on its command walks ahead of it.
        FaultName::Runaway => vec![Kind::Runaway, Kind::Slip],
        // Where nothing else watches, a pulse that is overdue stops the machine, mostly before the next could show it.
        FaultName::IndexMissing if at.has_encoder && !at.in_homing => vec![Kind::IndexMissing],
        FaultName::IndexMissing => match fault.count {
            None if !at.in_homing => vec![Kind::IndexTimeout],
            _ => vec![Kind::IndexMissing, Kind::IndexTimeout],
        },
        FaultName::IndexExtra => vec![Kind::IndexExtra],
        FaultName::SwappedWiring => {
            let mut names = vec![Kind::SwappedWiring];
            if at.opposed && at.has_encoder {
                names.push(Kind::Reversed);
            }
            // Before anything is moved, each of the two is detected where the other's flag is; or both turn back, as they are mounted
            // the other way round from each other, and pass their flags elsewhere.
            if at.flags_apart || at.opposed && !at.has_encoder {
                names.push(Kind::HomingRangeExceeded);
            }
            names
        }
        FaultName::Reversed => vec![Kind::Reversed],
        FaultName::EncoderGlitch => vec![Kind::EncoderGlitch],
        FaultName::DriveAlarm => vec![Kind::DriveAlarm],
        FaultName::Overrun => vec![Kind::Overrun],
        FaultName::StepFifoUnderrun => vec![Kind::StepFifoUnderrun],
        FaultName::EnableLoss => vec![Kind::EnableLost],
        FaultName::StopInput => vec![Kind::StopInput],
        // Nothing is wrong with a motor that has torque enough; with one that has not, it loses steps, or lags.
        FaultName::LoadStep => vec![
            Kind::LostSteps,
            Kind::Slip,
            Kind::CommonLag,
            Kind::Capture,
            Kind::Tilt,
            Kind::Warp,
        ],
    };
    let moves_crank = matches!(
        fault.kind,
        FaultName::LostSteps | FaultName::Slip | FaultName::Stuck | FaultName::Runaway
    );
    // Its drive detects before the loop that it does not follow.
    if at.watches_following_error && matches!(fault.kind, FaultName::Stuck | FaultName::LoadStep) {
        names.push(Kind::DriveAlarm);
    }
    // Its pulse is overdue, and where it would have come nobody sees any more.
    if moves_crank && !at.has_encoder && at.stood_first {
        names.push(Kind::IndexTimeout);
    }
    // The first pulse that is detected is where a crank is found.
    if at.in_homing && (moves_crank || fault.kind == FaultName::IndexExtra) {
        names.push(Kind::HomingRangeExceeded);
    }
    if at.in_homing && moves_crank && at.is_beyond_limit {
        names.extend([Kind::Tilt, Kind::Warp]);
    }
    names
}

/// Returns whether a kind must be reported even though no crank moves beyond a limit.
pub const fn must_be_reported(kind: FaultName) -> bool {
    !matches!(
        kind,
        FaultName::LostSteps
            | FaultName::Slip
            | FaultName::Stuck
            | FaultName::Runaway
            | FaultName::LoadStep
    )
}

/// Returns whether the reported axis must be the one that the fault befell.
pub const fn has_axis(kind: FaultName) -> bool {
    !matches!(
        kind,
        FaultName::Overrun | FaultName::EnableLoss | FaultName::StopInput | FaultName::LoadStep
    )
}

/// Turns of the master, of a machine that moves, after which a kind must have been reported: of index pulses, one until the next is
/// due, and one until that is overdue by a margin.
pub fn turns_to_report(fault: &FaultAt) -> f64 {
    match fault.kind {
        FaultName::IndexMissing | FaultName::IndexExtra | FaultName::EncoderGlitch => 2.2,
        _ => 0.0,
    }
}
