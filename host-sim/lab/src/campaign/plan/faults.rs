//! Faults of cases. The kind is drawn first, each with equal probability, then the machine, then the size and the time of the fault.

use cophase_scene::Scene;
use cophase_scene::file::{FaultAt, FaultName, Lines};

use super::machines::Driven;
use super::stream::{Stream, rounded};
use crate::campaign::geometry::Geometry;

/// Kinds of faults that are drawn.
pub const KINDS: [FaultName; 15] = [
    FaultName::LostSteps,
    FaultName::Slip,
    FaultName::Stuck,
    FaultName::Runaway,
    FaultName::IndexMissing,
    FaultName::IndexExtra,
    FaultName::SwappedWiring,
    FaultName::Reversed,
    FaultName::EncoderGlitch,
    FaultName::DriveAlarm,
    FaultName::Overrun,
    FaultName::StepFifoUnderrun,
    FaultName::EnableLoss,
    FaultName::StopInput,
    FaultName::LoadStep,
];

/// Returns true if a kind is possible on axes with these drives and sensors.
pub const fn befalls(kind: FaultName, driven: Driven) -> bool {
    match kind {
        FaultName::LostSteps => matches!(driven, Driven::Stepper | Driven::WatchedStepper),
        FaultName::StepFifoUnderrun => !matches!(driven, Driven::Servo),
        // An index alone cannot show the direction of rotation: its pulses come once a turn in either direction.
        FaultName::Reversed | FaultName::EncoderGlitch => driven.has_encoder(),
        _ => true,
    }
}

/// Returns true if a kind can be detected only where homing proves the wiring.
pub const fn needs_proof(kind: FaultName) -> bool {
    matches!(kind, FaultName::SwappedWiring)
}

/// Returns true if a kind needs cranks that torque moves.
pub const fn needs_torque(kind: FaultName) -> bool {
    matches!(kind, FaultName::LoadStep)
}

/// Times at which a fault may come, s since power-up, and the speed of the machine then.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Earliest time of a fault in *homing*.
    pub homing_s: f64,
    /// Latest time of a fault in *homing*, and earliest in *run*: about when homing ends.
    pub run_s: f64,
    /// Latest time of a fault. What is left of the program is long enough to detect it.
    pub end_s: f64,
    /// Speed of the highest level, rev/s.
    pub level_hz: f64,
}

/// Number of standard deviations of the difference between two readings that noise does not exceed.
const NOISES: f64 = 5.0;

/// Faults that come during homing, percent.
const IN_HOMING_PERCENT: u32 = 10;

/// Draws a fault of a kind for a machine.
pub fn draw(
    stream: &mut Stream,
    scene: &Scene,
    geometry: Option<&Geometry>,
    window: &Window,
    kind: FaultName,
) -> FaultAt {
    let axes = scene.axes.count;
    let axis = one_of(stream, axes_for(scene, kind).as_slice());
    // Error of one crank at which the platform reaches its limits, degrees.
    let limit_deg = geometry.map_or(scene.drift.warp_limit_deg, |geometry| {
        geometry.single_limit_turns() * 360.0
    });
    let mut fault = FaultAt::new(at_s(stream, window), kind);
    fault.axis = Some(axis);
    match kind {
        FaultName::LostSteps => {
            let cycles = stream.one_of(&[1, 1, 1, 2, 3]);
            fault.cycles = Some(if stream.percent(75) { cycles } else { -cycles });
        }
        FaultName::Slip => {
            // The slip reaches the limit after 20 ms to 1 s, if it lasts so long.
            let until_s = stream.log_between(0.02, 1.0);
            let rate = stream.sign() * limit_deg / until_s;
            fault.rate_deg_per_s = Some(rounded(rate, 3));
            fault.for_s = Some(rounded(until_s * stream.between(0.3, 3.0), 4));
        }
        FaultName::Stuck => fault.for_s = seldom_for(stream, 0.05, 0.5),
        FaultName::Runaway => {
            let mut ratio = stream.between(1.1, 2.0);
            fault.for_s = seldom_for(stream, 0.05, 0.5);
            // An index alone cannot show the direction of rotation.
            if driven(scene, axis).has_encoder() && stream.percent(50) {
                ratio = -stream.log_between(0.05, 2.0);
            }
            let speed_hz = (window.level_hz * ratio).clamp(-200.0, 200.0);
            fault.speed_hz = Some(rounded(speed_hz, 3));
        }
        FaultName::IndexMissing => {
            fault.count = stream.one_of(&[None, None, Some(1), Some(2), Some(3)]);
        }
        FaultName::IndexExtra => fault.count = Some(stream.one_of(&[1, 2, 3])),
        FaultName::SwappedWiring => {
            fault.at_s = 0.0;
            let mut others = axes_for(scene, kind);
            others.retain(|&other| other != axis && driven(scene, other) == driven(scene, axis));
            fault.with = Some(one_of(stream, &others));
            fault.lines = Some(stream.one_of(&[Lines::Drive, Lines::Sensors]));
        }
        FaultName::Reversed => fault.at_s = 0.0,
        FaultName::EncoderGlitch => {
            // The smallest glitch is more than the error of a reading and the travel of two ticks. The error of a reading is four
            // tolerances, each with two steps, and noise. The largest glitch is half a turn.
            let per_turn = scene.resolved(axis).steps_per_crank_turn();
            let tick_turns = window.level_hz / f64::from(scene.control.tick_hz);
            let tolerance = scene.drift.reading_error_deg / 360.0 + 2.0 / per_turn;
            let noise = NOISES * 2.0_f64.sqrt() * scene.noise.encoder_counts / per_turn;
            let min = (4.0 * tolerance + noise + 2.0 * tick_turns).min(0.25);
            let counts = stream.log_between(min * per_turn, 0.5 * per_turn);
            fault.counts = Some((stream.sign() * counts) as i64);
            let tick_s = 1.0 / f64::from(scene.control.tick_hz);
            fault.for_s =
                (!stream.percent(30)).then(|| rounded(stream.log_between(tick_s, 0.2), 6));
        }
        FaultName::DriveAlarm => fault.for_s = seldom_for(stream, 0.01, 0.5),
        FaultName::Overrun => {
            fault.axis = None;
            fault.count = Some(stream.one_of(&[3, 4, 5, 6]));
        }
        FaultName::StepFifoUnderrun => {}
        FaultName::EnableLoss | FaultName::StopInput => {
            fault.axis = None;
            fault.for_s = seldom_for(stream, 0.01, 0.5);
        }
        FaultName::LoadStep => {
            // The load is 5 to 50 % of the largest torque that is required of the motor. The motors of drawn machines have more than that
            // in reserve.
            let required_nm = geometry.map_or(1.0, |geometry| {
                let omega = std::f64::consts::TAU * window.level_hz;
                geometry.max_torque_nm(omega, 0.0) / axes as f64
            });
            fault.torque_nm = Some(rounded(
                stream.sign() * stream.between(0.05, 0.5) * required_nm,
                4,
            ));
            fault.for_s = seldom_for(stream, 0.02, 0.5);
        }
    }
    fault
}

/// Draws a duration, s, in one of two cases. In the other the fault is permanent.
fn seldom_for(stream: &mut Stream, low_s: f64, high_s: f64) -> Option<f64> {
    let for_s = rounded(stream.log_between(low_s, high_s), 4);
    stream.percent(50).then_some(for_s)
}

fn at_s(stream: &mut Stream, window: &Window) -> f64 {
    let at_s = if stream.percent(IN_HOMING_PERCENT) {
        stream.between(window.homing_s, window.run_s)
    } else {
        stream.between(window.run_s, window.end_s)
    };
    rounded(at_s, 6)
}

/// Returns the drive and the sensors of an axis.
pub fn driven(scene: &Scene, axis: usize) -> Driven {
    let kind = scene.resolved(axis).drive.kind();
    match (kind.is_open_loop(), scene.axes.encoder) {
        (true, false) => Driven::Stepper,
        (true, true) => Driven::WatchedStepper,
        (false, false) if kind.takes_pulses() => Driven::PulseServo,
        // With the two wires of an encoder, one that takes pulses has the same sensors as a servo on a fieldbus.
        (false, _) => Driven::Servo,
    }
}

/// Returns the axes on which a kind is possible.
pub fn axes_for(scene: &Scene, kind: FaultName) -> Vec<usize> {
    (0..scene.axes.count)
        .filter(|&axis| befalls(kind, driven(scene, axis)))
        .collect()
}

/// Draws one of several axes. Returns axis 0 if there are none; no case has such a fault in the end.
fn one_of(stream: &mut Stream, axes: &[usize]) -> usize {
    match axes {
        [] => 0,
        axes => stream.one_of(axes),
    }
}
