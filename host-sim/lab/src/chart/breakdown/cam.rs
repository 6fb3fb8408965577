//! Flexible cam shaft: masses and springs between cam and pusher amplify the law's acceleration. An electronic cam has none of them.
//!
//! Failure: at 450 turns per minute, the wrapper's shaft, arm and link oscillate, and the acceleration of its pusher exceeds that of its
//! law. Guard: a motor on a screw for each pusher, which follows the same law as a cam table. The remaining error is that of the table's
//! spline.

use cophase_methods::problems::{Cam, Law};
use host_sim::sim::{Moment, Observer, simulate};

use super::panel::{Curve, Shown, failing, guarded, requested};
use super::runs::{built_in, check};
use crate::chart::ChartError;
use crate::chart::axis::Axis;

/// Angle of the cam, degrees, and acceleration of the first pusher there, m/s², over the last turn at full speed.
pub type Turn = Vec<(f64, f64)>;

/// Measured accelerations.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Acceleration of the law.
    pub law: Turn,
    /// Acceleration on the flexible cam shaft.
    pub shaft: Turn,
    /// Acceleration on a screw that follows a cam table.
    pub screw: Turn,
}

/// Built-in scene `electronic-cam` at the wrapper's speed. Screws of 100 mm per turn keep the step rate low.
///
/// # Errors
/// There is no such scene.
pub fn electronic() -> Result<String, ChartError> {
    let changes = [
        ("screw_lead_mm = 20", "screw_lead_mm = 100"),
        ("turns = 4.2", "turns = 0.84"),
        ("turns = -4.2", "turns = -0.84"),
        ("speed_hz = 1.5", "speed_hz = 8"),
        ("acceleration_hz_per_s = 2", "acceleration_hz_per_s = 10"),
        ("jerk_hz_per_s2 = 20", "jerk_hz_per_s2 = 100"),
        ("steps_per_turn = 1600", "steps_per_turn = 6400"),
        ("amax_g = 0.5567", "amax_g = 31.31"),
        ("hold_s = 3", "hold_s = 1"),
    ];
    built_in("electronic-cam", &changes)
}

/// Collects the last whole turn at the greatest speed.
#[derive(Default)]
struct LastTurn {
    ticks: Vec<(f64, f64, f64)>,
}

impl Observer for LastTurn {
    fn tick(&mut self, moment: &Moment<'_>) {
        let tick_s = (moment.end_ns - moment.start_ns) as f64 * 1e-9;
        let speed_hz = cophase_scene::units::turns(moment.telemetry.motion.speed) / tick_s;
        if let Some(pusher) = moment.machine.follower().parts().first() {
            let tick = (moment.master_turns, speed_hz, pusher.accel_mps2);
            self.ticks.push(tick);
        }
    }
}

fn last_turn(text: &str) -> Result<Turn, ChartError> {
    let checked = check(text)?;
    let mut observed = LastTurn::default();
    simulate(&checked, &mut observed, |_, _| {})?;
    let top_hz = observed.ticks.iter().map(|tick| tick.1).fold(0.0, f64::max);
    let fast: Vec<_> = observed
        .ticks
        .iter()
        .filter(|tick| tick.1 > top_hz * (1.0 - 1e-6))
        .collect();
    let end = fast.last().map_or(0.0, |tick| tick.0).floor();
    let within = |tick: &&&(f64, f64, f64)| (end - 1.0..end).contains(&tick.0);
    Ok(fast
        .iter()
        .filter(within)
        .map(|tick| ((tick.0 - end + 1.0) * 360.0, tick.2))
        .collect())
}

/// Runs both scenes.
///
/// # Errors
/// A scene is refused.
pub fn measure() -> Result<Facts, ChartError> {
    let shaft = last_turn(&built_in("wrapper", &[])?)?;
    let cam = Cam::wrapper(Law::ModifiedSine);
    let law = (0..720)
        .map(|half| f64::from(half) * 0.5)
        .map(|deg| (deg, cam.at(deg / 360.0 * cam.cycle_s()).acceleration))
        .collect();
    Ok(Facts {
        law,
        shaft,
        screw: last_turn(&electronic()?)?,
    })
}

/// Returns the greatest acceleration of a turn, m/s².
pub fn peak(turn: &Turn) -> f64 {
    turn.iter()
        .map(|(_, accel)| accel.abs())
        .fold(0.0, f64::max)
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let facts = measure()?;
    let law = peak(&facts.law);
    let over = |turn: &Turn| 100.0 * (peak(turn) / law - 1.0);
    Ok(Shown {
        key: "cam",
        title: "Cam shaft and electronic cam: acceleration of a pusher over a turn".to_owned(),
        x: Axis::linear("angle of the cam, degrees", 0.0, 360.0),
        y: Axis::linear("acceleration of the pusher, m/s²", -400.0, 400.0),
        curves: vec![
            Curve::new("law, m/s²", requested(facts.law.clone())),
            Curve::new("flexible cam shaft, m/s²", failing(facts.shaft.clone())),
            Curve::new("electronic cam, m/s²", guarded(facts.screw.clone())),
        ],
        levels: Vec::new(),
        says: format!(
            "At 450 turns a minute the flexible cam shaft adds {:.1} % to the law's greatest acceleration of {law:.0} m/s², and the electronic cam {:.1} %.",
            over(&facts.shaft),
            over(&facts.screw),
        ),
    })
}
