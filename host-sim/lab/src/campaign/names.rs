//! Right names: one table, from the injected fault to the names that may be reported for it.
//!
//! A name is right if the sensors of the axis cannot distinguish its cause from the injected one. The controller's behaviour does
//! not matter. Three facts about the sensors decide:
//! 1. An *index sensor* shows one angle, once a turn, and nothing between. A crank that stands gives no pulse, and a dead sensor gives none
//!    either. Pulses that come early show that the crank gains, but not the cause. A crank that turns back also passes its flag once a
//!    turn.
//! 2. *Positions* do not show forces. A stepper that was held follows again at whole electrical cycles, where lost steps would have put it.
//! 3. *Before homing has found a crank* its position is not known: a crank that moves looks like one that stood there at power-up.

use cophase_core::supervisor::FaultKind;
use cophase_scene::file::{FaultAt, FaultName};

/// Circumstances of a run that decide which names are right.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// True if the axis has an encoder.
    pub has_encoder: bool,
    /// True if the motor is a stepper.
    pub is_stepper: bool,
    /// True if the drive raises its alarm beyond a following-error window.
    pub watches_following_error: bool,
    /// True if the fault came before homing was over. The earlier position is not known then, so a jump looks like a place beyond the
    /// homing range.
    pub in_homing: bool,
    /// True if the crank was beyond its limit.
    pub is_beyond_limit: bool,
    /// True if the two axes of a swap are mounted in opposite directions: a command that drives one forward drives the other back.
    pub opposed: bool,
    /// True if their index flags stand at different places.
    pub flags_apart: bool,
    /// True if the crank and the machine stood before the crank had passed its flag once more.
    pub stood_first: bool,
}

/// Returns the kinds that may be reported for a fault. Any of them is right.
pub fn accepted(fault: &FaultAt, at: Circumstances) -> Vec<FaultKind> {
    use FaultKind as Kind;
    let mut names = match fault.kind {
        FaultName::LostSteps => vec![Kind::LostSteps],
        // Fact 1: early pulses show that a crank gains, but not the cause.
        FaultName::Slip
            if !at.has_encoder && fault.rate_deg_per_s.is_some_and(|rate| rate < 0.0) =>
        {
            vec![Kind::Slip, Kind::Runaway, Kind::Drift]
        }
        FaultName::Slip => vec![Kind::Slip, Kind::Drift],
        // Fact 1: without an encoder, a crank that stands and a dead sensor give the same line.
        FaultName::Stuck if !at.has_encoder => match fault.for_s {
            None => vec![Kind::IndexTimeout],
            // Fact 2: if it follows again before its next pulse, that pulse shows a crank that is behind; a stepper's by whole cycles.
            Some(_) => vec![Kind::IndexTimeout, Kind::LostSteps, Kind::Slip],
        },
        FaultName::Stuck => match fault.for_s {
            Some(_) if at.is_stepper => vec![Kind::Stuck, Kind::LostSteps],
            _ => vec![Kind::Stuck],
        },
        FaultName::Runaway if at.has_encoder => match fault.for_s {
            _ if fault.speed_hz.is_none_or(|speed_hz| speed_hz > 0.0) => vec![Kind::Runaway],
            None => vec![Kind::Reversed],
            // Fact 2: once it follows again, it is behind. Before that it may have gone back by less than the error of a reading.
            Some(_) if at.is_stepper => vec![Kind::Reversed, Kind::Stuck, Kind::LostSteps],
            Some(_) => vec![Kind::Reversed, Kind::Stuck],
        },
        // Fact 1 applies here, too.
        FaultName::Runaway => vec![Kind::Runaway, Kind::Slip],
        // Fact 1: a dead sensor and a crank that stands both give no pulse. The next pulse shows the difference, if it comes.
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
            // Fact 3: each of the two shows the other's flag, at another place. Or both turn back, as they are mounted in opposite
            // directions, and pass their flags from the other end.
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
        // A motor with enough torque carries the load. A weaker one loses steps or lags, and the positions show only that.
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
    // The drive has a sensor of its own, and the loop receives only its alarm line.
    if at.watches_following_error && matches!(fault.kind, FaultName::Stuck | FaultName::LoadStep) {
        names.push(Kind::DriveAlarm);
    }
    // Fact 1: the crank stood before its next pulse, which would have shown its position.
    if moves_crank && !at.has_encoder && at.stood_first {
        names.push(Kind::IndexTimeout);
    }
    // Fact 3 applies here.
    if at.in_homing && (moves_crank || fault.kind == FaultName::IndexExtra) {
        names.push(Kind::HomingRangeExceeded);
    }
    // Facts 1 and 3: a crank that jumps ahead between its first two pulses gives the pulses of noise and of a flag.
    let may_jump_ahead = matches!(fault.kind, FaultName::Slip | FaultName::Runaway);
    if at.in_homing && may_jump_ahead && !at.has_encoder {
        names.push(Kind::IndexExtra);
    }
    if at.in_homing && moves_crank && at.is_beyond_limit {
        names.extend([Kind::Tilt, Kind::Warp]);
    }
    names
}

/// Returns true if a kind must be reported even though no crank moves beyond a limit.
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

/// Returns true if the reported axis must be the one with the fault.
pub const fn has_axis(kind: FaultName) -> bool {
    !matches!(
        kind,
        FaultName::Overrun | FaultName::EnableLoss | FaultName::StopInput | FaultName::LoadStep
    )
}

/// Turns of a moving master after which a kind must have been reported. Faults of pulses and readings take one turn until the next pulse is
/// due, and one until it is overdue by a margin.
pub fn turns_to_report(fault: &FaultAt) -> f64 {
    match fault.kind {
        FaultName::IndexMissing | FaultName::IndexExtra | FaultName::EncoderGlitch => 2.2,
        _ => 0.0,
    }
}
