//! Run of a scene whose every tick is folded into an envelope.

use std::f64::consts::TAU;

use cophase_core::mechanism::{AnyMechanism, Mechanism};
use cophase_core::supervisor::State;
use cophase_core::units::Turns;
use cophase_files::trace::Envelope;
use cophase_scene::SceneError;
use cophase_scene::file::Noise;
use cophase_scene::units::{mps2, speed_hz, turns};
use host_sim::checked::Checked;
use host_sim::model_level::LADDER;
use host_sim::setup;
use host_sim::sim::{Moment, Observer, simulate_first};

use crate::answer::{Answer, Ended, Limits, Scene};

/// Number of values of a tick. In order: amax requested and commanded (m/s²), speed (rad/s), acceleration of the shaft (rad/s²). Three
/// flags, 1 or 0: the speed lags behind the program because of the acceleration limit, it is held at the edge of a forbidden band, it
/// crosses such a band. Last, the number of the supervisor's state.
pub const CHANNELS: usize = 8;

/// Ticks between two reports of the envelope.
const REPORT_TICKS: u64 = 1 << 16;

/// Checks a scene's text and previews it. The envelope has at most `max_buckets` buckets, and the run at most `max_ticks` ticks.
///
/// `report` receives the growing preview at intervals, and the expected number of ticks.
///
/// The previewed machine has no faults, noise or late deadlines. Its model level is the lowest that it has, because
/// model levels change the motion of the machine, and not the commands.
pub fn compute(
    text: &str,
    max_buckets: usize,
    max_ticks: u64,
    report: impl FnMut(&Preview, u64),
) -> (Answer, Envelope) {
    let run = || {
        let checked = undisturbed(setup::checked_from_text(text, None)?)?;
        run(&checked, max_buckets, max_ticks, report)
    };
    run().unwrap_or_else(|error: SceneError| {
        (Answer::refused(error), Envelope::new(CHANNELS, max_buckets))
    })
}

/// Returns the same scene without disturbances of its machine, on the lowest model level that it has.
fn undisturbed(mut checked: Checked) -> Result<Checked, SceneError> {
    checked.scene.fault.clear();
    checked.scene.late.clear();
    checked.scene.noise = Noise::default();
    let lowest = LADDER.iter().find_map(|&level| checked.on(level).ok());
    Ok(lowest.unwrap_or(checked))
}

fn run(
    checked: &Checked,
    max_buckets: usize,
    max_ticks: u64,
    report: impl FnMut(&Preview, u64),
) -> Result<(Answer, Envelope), SceneError> {
    let expected_ticks = host_sim::sim::expected_ticks(checked)?;
    let mut observer = Reporting {
        preview: Preview::new(checked, max_buckets),
        report,
        expected_ticks,
    };
    let outcome = simulate_first(max_ticks, checked, &mut observer, |_, _| {})?;
    let preview = observer.preview;
    let ended = Ended {
        state: outcome.state.name(),
        fault: outcome.fault.map(|fault| fault.kind.name()),
        is_cut_off: matches!(outcome.state, State::Homing | State::Run | State::Stop),
    };
    let scene = results(checked, &preview, expected_ticks, ended)?;
    Ok((Answer::previewed(scene), preview.envelope))
}

/// The results of a scene.
fn results(
    checked: &Checked,
    preview: &Preview,
    expected_ticks: u64,
    ended: Ended,
) -> Result<Scene, SceneError> {
    let tick_s = 1.0 / f64::from(checked.settings.tick_hz);
    let limits = &checked.settings.limits;
    let program_ticks = checked.controller()?.program().0.duration();
    Ok(Scene {
        name: checked.scene.name.clone(),
        program_s: program_ticks as f64 * tick_s,
        expected_s: expected_ticks as f64 * tick_s,
        previewed_s: preview.envelope().span().map_or(0.0, |(_, last_s)| last_s),
        ended,
        limits: Limits {
            speed_rad_s: limits.speed_hz * TAU,
            amax_mps2: preview.amax_at(limits.speed_hz),
            acceleration_rad_s2: limits.reachable_acceleration_hz_per_s() * TAU,
            bands_rad_s: limits
                .bands
                .iter()
                .map(|band| (band.from_hz * TAU, band.to_hz * TAU))
                .collect(),
        },
    })
}

/// The envelope of a run so far, and its greatest values.
pub struct Preview {
    envelope: Envelope,
    mechanism: AnyMechanism,
    tick_hz: u32,
    /// Ticks that are in the envelope.
    pub ticks: u64,
}

impl Preview {
    fn new(checked: &Checked, max_buckets: usize) -> Self {
        Self {
            envelope: Envelope::new(CHANNELS, max_buckets),
            mechanism: checked.settings.mechanism(),
            tick_hz: checked.settings.tick_hz,
            ticks: 0,
        }
    }

    /// Returns amax at a speed in rev/s, m/s².
    fn amax_at(&self, speed_hz: f64) -> f64 {
        let speed = Turns::saturating_from_num(speed_hz / f64::from(self.tick_hz));
        mps2(self.mechanism.amax(speed))
    }

    /// Returns the envelope so far.
    pub const fn envelope(&self) -> &Envelope {
        &self.envelope
    }
}

impl Observer for Preview {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let motion = &telemetry.motion;
        let hz = f64::from(self.tick_hz);
        let flag = |is_set: bool| f64::from(u8::from(is_set));
        let values: [f64; CHANNELS] = [
            mps2(telemetry.amax_requested),
            mps2(self.mechanism.amax(motion.speed)),
            speed_hz(motion.speed, self.tick_hz) * TAU,
            turns(motion.acceleration) * hz * hz * TAU,
            flag(motion.lagging),
            flag(motion.held_at_band),
            flag(motion.crossing_band),
            f64::from(telemetry.state as u8),
        ];
        self.envelope.push(moment.end_ns as f64 * 1e-9, &values);
        self.ticks += 1;
    }
}

/// A preview that is reported while it grows.
struct Reporting<R> {
    preview: Preview,
    report: R,
    expected_ticks: u64,
}

impl<R: FnMut(&Preview, u64)> Observer for Reporting<R> {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.preview.tick(moment);
        if self.preview.ticks.is_multiple_of(REPORT_TICKS) {
            (self.report)(&self.preview, self.expected_ticks);
        }
    }
}
