//! What goes wrong in a case: the kind is drawn first, each as often as any other, then the machine, then how large and when.

use super::machines::Driven;
use super::stream::{Stream, rounded};
use crate::campaign::geometry::Geometry;
use host_sim::scene::Scene;
use host_sim::scene::file::{Drive, FaultAt, FaultName, Lines};

/// All kinds.
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

/// Whether a kind makes sense for axes that are driven so.
pub const fn befalls(kind: FaultName, driven: Driven) -> bool {
    match kind {
        FaultName::LostSteps => matches!(driven, Driven::Stepper | Driven::WatchedStepper),
        FaultName::StepFifoUnderrun => !matches!(driven, Driven::Servo),
        // Of an axis with an index alone, which way round it turns cannot be detected: its pulses come once a turn either way.
        FaultName::Reversed | FaultName::EncoderGlitch => driven.has_encoder(),
        _ => true,
    }
}

/// Whether a kind can be detected only where homing proves which wire goes where.
pub const fn needs_proof(kind: FaultName) -> bool {
    matches!(kind, FaultName::SwappedWiring)
}

/// Whether a kind needs cranks that torque moves.
pub const fn needs_torque(kind: FaultName) -> bool {
    matches!(kind, FaultName::LoadStep)
}

/// When faults may come, s since power-up, and how the machine turns then.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// In *homing*: from here,
    pub homing_s: f64,
    /// and in *run* from about here,
    pub run_s: f64,
    /// to here, with time left for what was done to be detected.
    pub end_s: f64,
    /// Speed of the highest level, rev/s.
    pub level_hz: f64,
}

/// So many standard deviations of what two readings differ by are no chance.
const NOISES: f64 = 5.0;

/// One in so many hundred comes during homing.
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
    // How far a crank goes until it is detected by its platform, degrees.
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
            // The limit is reached after 20 ms to a second, if the slip goes on for so long.
            let until_s = stream.log_between(0.02, 1.0);
            let rate = stream.sign() * limit_deg / until_s;
            fault.rate_deg_per_s = Some(rounded(rate, 3));
            fault.for_s = Some(rounded(until_s * stream.between(0.3, 3.0), 4));
        }
        FaultName::Stuck => fault.for_s = seldom_for(stream, 0.05, 0.5),
        FaultName::Runaway => {
            let mut ratio = stream.between(1.1, 2.0);
            fault.for_s = seldom_for(stream, 0.05, 0.5);
            // Of an axis with an index alone, which way round it turns cannot be detected.
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
            // From what no reading is off by (four tolerances, each of two steps besides), and no tick goes, to half a turn.
            let per_turn = f64::from(scene.axes.steps_per_turn);
            let tick_turns = window.level_hz / f64::from(scene.control.tick_hz);
            let tolerance = scene.drift.reading_error_deg / 360.0 + 2.0 / per_turn;
            let noise = NOISES * 2.0_f64.sqrt() * scene.noise.encoder_counts / per_turn;
            let least = (4.0 * tolerance + noise + 2.0 * tick_turns).min(0.25);
            let counts = stream.log_between(least * per_turn, 0.5 * per_turn);
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
            // Up to half as much again as the most that is required of the motor; what is left of its torque is as much.
            let required_nm = geometry.map_or(1.0, |geometry| {
                let omega = std::f64::consts::TAU * window.level_hz;
                geometry.most_torque_nm(omega, 0.0) / axes as f64
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

/// For good, or in one of two cases for a time.
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

/// How an axis is driven and watched.
pub fn driven(scene: &Scene, axis: usize) -> Driven {
    match scene.drive(axis) {
        Drive::Servo => Driven::Servo,
        // Two wires more give it what a servo on a fieldbus has.
        Drive::PulseServo | Drive::Induction if scene.axes.encoder => Driven::Servo,
        Drive::PulseServo | Drive::Induction => Driven::PulseServo,
        Drive::Stepper if scene.axes.encoder => Driven::WatchedStepper,
        Drive::Stepper => Driven::Stepper,
    }
}

/// Axes that a kind can befall.
pub fn axes_for(scene: &Scene, kind: FaultName) -> Vec<usize> {
    (0..scene.axes.count)
        .filter(|&axis| befalls(kind, driven(scene, axis)))
        .collect()
}

/// One of several axes; the first axis, of none, for which nothing is drawn in the end.
fn one_of(stream: &mut Stream, axes: &[usize]) -> usize {
    match axes {
        [] => 0,
        axes => stream.one_of(axes),
    }
}
