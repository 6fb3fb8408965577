//! Error of the played motion on ramps of the program.

use cophase_core::program::Cursor;
use cophase_core::supervisor::State;
use cophase_core::units::Amax;
use cophase_scene::SceneError;
use cophase_scene::units::speed_hz;
use host_sim::checked::Checked;
use host_sim::mechanism::SquareLaw;
use host_sim::sim::{Moment, Observer};

/// Level of the program at any time: levels at the fastest tick, with straight lines between them.
#[derive(Debug)]
pub struct ProgramLevels(Vec<f64>);

impl ProgramLevels {
    /// Fastest rate, Hz. At this rate, a smooth ramp of 2 s deviates from the straight lines by less than 1e-8 of its height.
    pub const TICK_HZ: u32 = 10_000;

    /// Computes the levels of a scene with ticks at [`Self::TICK_HZ`].
    ///
    /// # Errors
    /// The core refuses the scene.
    pub fn for_scene(checked: &Checked) -> Result<Self, SceneError> {
        let controller = checked.controller()?;
        let (program, _) = controller.program();
        let mut cursor = Cursor::new();
        let mut levels = vec![0.0];
        while !cursor.is_done(program) {
            levels.push(cursor.next(program).level.to_num());
        }
        Ok(Self(levels))
    }

    /// Returns the level at a time since the program's start; after its end, the last level.
    fn at(&self, t_s: f64) -> f64 {
        let place = (t_s * f64::from(Self::TICK_HZ)).max(0.0);
        let (before, part) = (place as usize, place.fract());
        let last = self.0.last().copied().unwrap_or_default();
        let level = |i: usize| self.0.get(i).copied().unwrap_or(last);
        level(before) + part * (level(before + 1) - level(before))
    }
}

/// Observer that sums the errors on ramps. Ticks in which a limit or a band holds the shaft do not count, as no rate changes
/// them.
#[derive(Debug)]
pub struct Ramp {
    levels: ProgramLevels,
    law: SquareLaw,
    tick_hz: u32,
    before: Amax,
    squares: f64,
    ticks: u64,
    top: f64,
}

impl Ramp {
    /// Creates an observer of a scene.
    pub fn new(checked: &Checked, levels: ProgramLevels) -> Self {
        Self {
            top: levels.0.iter().copied().fold(0.0, f64::max),
            levels,
            law: checked.law(),
            tick_hz: checked.scene.control.tick_hz,
            before: Amax::ZERO,
            squares: 0.0,
            ticks: 0,
        }
    }

    /// Returns the root mean square error, relative to the highest level.
    pub fn rms(&self) -> f64 {
        (self.squares / self.ticks.max(1) as f64).sqrt() / self.top
    }
}

impl Observer for Ramp {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let changes = std::mem::replace(&mut self.before, telemetry.amax_requested)
            != telemetry.amax_requested;
        let motion = &telemetry.motion;
        let kept_back = motion.lagging || motion.held_at_band || motion.crossing_band;
        if telemetry.state != State::Run || !changes || kept_back {
            return;
        }
        // The program's first tick is planned at its time 0 and played from one tick later on; its middle is half a tick
        // after that.
        let t_s = (telemetry.program_ticks as f64 + 0.5) / f64::from(self.tick_hz);
        let hz = speed_hz(motion.speed, self.tick_hz);
        let played = self.law.amax_mps2(std::f64::consts::TAU * hz);
        self.squares += (played - self.levels.at(t_s)).powi(2);
        self.ticks += 1;
    }
}
