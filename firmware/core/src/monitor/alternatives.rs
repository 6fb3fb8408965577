//! Faults that the sensors of an axis cannot distinguish from the one that is named.

use crate::settings::{AxisSettings, DriveKind};
use crate::supervisor::{Fault, FaultKind};

/// Other kinds of faults that look like `fault` to the sensors of its axis.
///
/// Three facts are behind the table, and `docs/faults.md` explains them under *What cannot be distinguished*. An index sensor shows one
/// angle per turn and nothing between. Positions show no forces. Before homing, a crank has no known place.
pub fn alternatives(fault: &Fault, axis: &AxisSettings) -> impl Iterator<Item = FaultKind> {
    let kind = fault.kind;
    let has_cycles = axis.cycle_steps > 0;
    let alike = alike(fault, axis.encoder, axis.index_turns.is_some(), axis.drive);
    let alike = alike.iter().copied();
    alike.filter(move |&other| other != kind && (has_cycles || other != FaultKind::LostSteps))
}

/// True if a fault of an axis with an index alone may be that of a drive that runs away.
pub(crate) fn may_run_away(fault: &Fault) -> bool {
    alike(fault, false, true, DriveKind::Stepper).contains(&FaultKind::Runaway)
}

/// The kinds that look alike to these sensors.
fn alike(
    fault: &Fault,
    has_encoder: bool,
    has_index: bool,
    drive: DriveKind,
) -> &'static [FaultKind] {
    use FaultKind as Kind;
    let is_behind = fault.size < 0;
    match fault.kind {
        // No pulse comes from a crank that stands or has moved, and none from a dead sensor.
        Kind::IndexTimeout if !has_encoder => &[
            Kind::Stuck,
            Kind::IndexMissing,
            Kind::LostSteps,
            Kind::Slip,
            Kind::Runaway,
        ],
        // A crank that was held for exactly a turn passes its flag in place again.
        Kind::IndexMissing if !has_encoder => &[Kind::Stuck],
        // An encoder shows the motor, but not a crank that slipped on its shaft.
        Kind::IndexTimeout => &[Kind::IndexMissing, Kind::Slip],
        Kind::IndexMissing => &[Kind::Slip],
        // A crank that gains passes its flag early, whatever drives it. Noise looks like an additional passage.
        Kind::Runaway if !has_encoder => &[Kind::Slip, Kind::IndexExtra],
        Kind::IndexExtra if !has_encoder => &[Kind::Slip, Kind::Runaway],
        // A slip may be a whole number of electrical cycles by chance. A crank that was held for a time is behind when it follows again.
        Kind::LostSteps | Kind::Slip if !has_encoder && is_behind => &[Kind::Slip, Kind::Stuck],
        Kind::LostSteps | Kind::Slip if !has_encoder => &[Kind::Slip, Kind::Runaway],
        // Without an index, lost counts look like a crank that moved.
        Kind::LostSteps if !has_index => &[Kind::Stuck, Kind::Reversed, Kind::EncoderGlitch],
        // A crank that was held or driven back follows again at whole electrical cycles, and one that turns back slowly stands at first.
        Kind::LostSteps | Kind::Stuck => &[Kind::Stuck, Kind::Reversed],
        // A few lost counts pass as motion.
        Kind::Slip => &[Kind::EncoderGlitch],
        Kind::Reversed => &[Kind::SwappedWiring],
        // A crank that slips slowly on its shaft walks, as a sensor does that moves on its bracket.
        Kind::Drift => &[Kind::Slip],
        // A servo drive may raise its alarm because its motor does not follow.
        Kind::DriveAlarm if !drive.is_open_loop() => &[Kind::Stuck],
        Kind::HomingRangeExceeded => &[
            Kind::LostSteps,
            Kind::Slip,
            Kind::Stuck,
            Kind::Runaway,
            Kind::Reversed,
            Kind::IndexExtra,
            Kind::SwappedWiring,
        ],
        // The cranks are beyond a limit, and nothing shows yet what moved them.
        Kind::Tilt | Kind::Warp => &[
            Kind::LostSteps,
            Kind::Slip,
            Kind::Stuck,
            Kind::Runaway,
            Kind::Reversed,
        ],
        _ => &[],
    }
}
