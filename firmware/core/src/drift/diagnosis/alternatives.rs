//! Causes that the sensors of an axis cannot distinguish from the one that a fault is named by.

use crate::settings::AxisSettings;
use crate::supervisor::FaultKind;

/// Other faults that look like `kind` to the sensors of an axis. A fault that belongs to no axis has none.
///
/// Three facts are behind the table, and `docs/faults.md` explains them under *What cannot be distinguished*. An index sensor shows one
/// angle per turn and nothing between. Positions show no forces. Before homing, a crank has no known place.
pub fn alternatives(kind: FaultKind, axis: &AxisSettings) -> impl Iterator<Item = FaultKind> {
    let alike = alike(kind, axis.encoder, axis.index_turns.is_some());
    alike.iter().copied().filter(move |&other| other != kind)
}

/// The kinds that look alike, which may include `kind`.
fn alike(kind: FaultKind, has_encoder: bool, has_index: bool) -> &'static [FaultKind] {
    use FaultKind as Kind;
    const MOVED: &[FaultKind] = &[Kind::LostSteps, Kind::Slip, Kind::Stuck, Kind::Runaway];
    const TURNED_BACK: &[FaultKind] = &[Kind::Stuck, Kind::Reversed];
    match kind {
        // No pulse comes from a crank that stands or has moved, and none from a dead sensor. Before homing, nor does an encoder show which.
        Kind::IndexTimeout => &[
            Kind::Stuck,
            Kind::IndexMissing,
            Kind::LostSteps,
            Kind::Slip,
            Kind::Runaway,
        ],
        // A crank that was held for exactly a turn passes its flag in place again.
        Kind::IndexMissing if !has_encoder => &[Kind::Stuck],
        // A crank that gains passes its flag early, whatever drives it.
        Kind::Runaway if !has_encoder => &[Kind::Slip],
        Kind::IndexExtra if !has_encoder => &[Kind::Slip, Kind::Runaway],
        // A crank that was held for a time is behind when it follows again, that of a stepper by whole electrical cycles.
        Kind::LostSteps | Kind::Slip if !has_encoder => MOVED,
        // Without an index, lost counts look like a crank that moved.
        Kind::LostSteps if !has_index => &[Kind::Stuck, Kind::Reversed, Kind::EncoderGlitch],
        Kind::Slip if !has_index => &[Kind::EncoderGlitch],
        // A crank that was held or driven back follows again at whole electrical cycles, and one that turns back slowly stands at first.
        Kind::LostSteps | Kind::Stuck => TURNED_BACK,
        Kind::Reversed => &[Kind::SwappedWiring],
        // The alarm line does not show why the drive raised it.
        Kind::DriveAlarm => &[Kind::Stuck],
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
