//! Names that count as right: one table, from the injected fault to what may be reported of it.
//!
//! A name is right if the sensors of the axis cannot distinguish its cause from the injected one. Three facts about the sensors decide, and
//! nothing that the controller does:
//! 1. An *index sensor* shows one angle, once a turn, and nothing between. A crank that stands, and a dead sensor, both give no pulse. Pulses
//!    that come early show that the crank gains, and not by which cause. A crank that turns back passes its flag once a turn as well.
//! 2. *Positions* do not show forces. A stepper that was held follows again at whole electrical cycles, where lost steps would have put it.
//! 3. *Before homing has found a crank* it has no known place: one that moves looks like one that stood there at power-up.

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
        // Fact 1: early pulses show that a crank gains, and not by which cause.
        FaultName::Slip
            if !at.has_encoder && fault.rate_deg_per_s.is_some_and(|rate| rate < 0.0) =>
        {
            vec![Kind::Slip, Kind::Runaway]
        }
        FaultName::Slip => vec![Kind::Slip],
        // Fact 1: without an encoder, a crank that stands and a dead sensor give the same line.
        FaultName::Stuck if !at.has_encoder => match fault.for_s {
            None => vec![Kind::IndexTimeout],
            // Fact 2: where it follows again before its next pulse, the pulse shows a crank that is behind, a stepper's by whole cycles.
            Some(_) => vec![Kind::IndexTimeout, Kind::LostSteps, Kind::Slip],
        },
        FaultName::Stuck => match fault.for_s {
            Some(_) if at.is_stepper => vec![Kind::Stuck, Kind::LostSteps],
            _ => vec![Kind::Stuck],
        },
        FaultName::Runaway if at.has_encoder => match fault.for_s {
            _ if fault.speed_hz.is_none_or(|speed_hz| speed_hz > 0.0) => vec![Kind::Runaway],
            None => vec![Kind::Reversed],
            // Fact 2: once it follows again it is behind. How far it went back before may be less than an error of a reading.
            Some(_) if at.is_stepper => vec![Kind::Reversed, Kind::Stuck, Kind::LostSteps],
            Some(_) => vec![Kind::Reversed, Kind::Stuck],
        },
        // Fact 1 again.
        FaultName::Runaway => vec![Kind::Runaway, Kind::Slip],
        // Fact 1: no pulse is no pulse, whether the sensor is dead or the crank stands; until the next comes, if it does.
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
            // Fact 3: each of the two shows the other's flag, at another place; or both turn back, as they are mounted the other way round
            // from each other, and meet the other end of their flags.
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
        // A motor with enough torque carries the load. One without loses steps or lags, and the positions show only that.
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
    // The drive has a sensor of its own, and its alarm line is all that the loop gets of it.
    if at.watches_following_error && matches!(fault.kind, FaultName::Stuck | FaultName::LoadStep) {
        names.push(Kind::DriveAlarm);
    }
    // Fact 1: the crank stands before its next pulse, which would have shown where it is.
    if moves_crank && !at.has_encoder && at.stood_first {
        names.push(Kind::IndexTimeout);
    }
    // Fact 3.
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
