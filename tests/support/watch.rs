//! State of the loop in each tick, with all axes compared bit by bit.

use cophase_core::supervisor::{Fault, State};
use cophase_core::units::{Amax, Phase};
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

/// One tick of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Start of the tick, ns since power-up.
    pub start_ns: u64,
    /// The supervisor's state.
    pub state: State,
    /// The fault that is latched.
    pub fault: Option<Fault>,
    /// Amplitude that the program requests.
    pub program: Amax,
    /// True if a command holds the program's time.
    pub holding: bool,
    /// The master's phase at the tick's end.
    pub phase: Phase,
    /// Its speed in the tick, in units of 2⁻⁴⁸ turn a tick.
    pub speed: i64,
    /// True if the shaft was inside a forbidden band.
    pub crossing: bool,
    /// Steps of axis 0 at the tick's end.
    pub steps: i64,
    /// True if the drives were on.
    pub drives_enabled: bool,
    /// Deadlines missed, and met late, so far.
    pub missed: u32,
    /// See `missed`.
    pub late: u32,
}

/// A watched run.
#[derive(Clone, Debug)]
pub struct Watched {
    /// Its ticks, in order.
    pub ticks: Vec<Tick>,
    /// End of the run.
    pub outcome: Outcome,
}

impl Watched {
    /// The first tick at or after a time.
    ///
    /// # Panics
    /// If the run was over by then.
    pub fn at(&self, t_s: f64) -> &Tick {
        let ns = (t_s * 1e9).round() as u64;
        let tick = self.ticks.iter().find(|tick| tick.start_ns >= ns);
        tick.unwrap_or_else(|| panic!("the run was over before {t_s} s"))
    }

    /// The states that the run went through, in order.
    pub fn states(&self) -> Vec<State> {
        let mut states: Vec<State> = self.ticks.iter().map(|tick| tick.state).collect();
        states.dedup();
        states
    }

    /// The last tick.
    ///
    /// # Panics
    /// If there was none.
    pub fn last(&self) -> &Tick {
        self.ticks.last().expect("a run has ticks")
    }
}

/// Runs a scene in which all axes are alike (but for their sense of rotation), and watches it.
///
/// # Panics
/// If the axes' commanded phases or steps differ at any tick, from each other or from the master's.
pub fn watch(checked: &Checked) -> Watched {
    let mut eyes = Eyes(Vec::new());
    let outcome = simulate(checked, &mut eyes, |_, _| {}).expect("a checked scene runs");
    Watched {
        ticks: eyes.0,
        outcome,
    }
}

struct Eyes(Vec<Tick>);

impl Observer for Eyes {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        for axis in 0..moment.axis_count() {
            let at = moment.start_ns;
            assert_eq!(
                telemetry.axis_phase(axis),
                telemetry.phase,
                "at {at} ns: axis {axis} out of phase"
            );
            assert_eq!(
                telemetry.steps(axis),
                telemetry.steps(0),
                "at {at} ns: axis {axis} a step apart"
            );
        }
        self.0.push(Tick {
            start_ns: moment.start_ns,
            state: telemetry.state,
            fault: telemetry.fault,
            program: telemetry.amax_requested,
            holding: telemetry.holding,
            phase: telemetry.phase,
            speed: telemetry.motion.speed.to_bits(),
            crossing: telemetry.motion.crossing_band,
            steps: telemetry.steps(0),
            drives_enabled: moment.drives_enabled,
            missed: telemetry.limits.missed_deadlines,
            late: telemetry.limits.late_deadlines,
        });
    }
}
