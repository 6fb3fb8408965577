//! What goes into the loop at a deadline, and what comes out of it.

use crate::drift::{IndexPulse, Modes};
use crate::pulse::{Runs, Sharing};
use crate::servo::Setpoint;
use crate::shaft::Motion;
use crate::supervisor::{Command, Fault, SafetyInputs, State};
use crate::units::{Amax, MAX_AXES, PerAxis, Phase, Turns};

/// What the loop reads from outside at a deadline.
#[derive(Clone, Debug)]
pub struct Feedback {
    /// Index pulses of the tick that is over.
    pub index: PerAxis<Option<IndexPulse>>,
    /// Counts of the motors' encoders at the deadline, in the motors' own sense, wrapping, from wherever they were at
    /// power-up. Of an axis without an encoder it is not looked at.
    pub encoder: PerAxis<i32>,
    /// Alarm outputs of the drives.
    pub alarm: PerAxis<bool>,
    /// An axis whose step hardware ran out of pulses within a tick that it had been given whole.
    pub ran_dry: Option<usize>,
    /// The enable and stop inputs.
    pub inputs: SafetyInputs,
    /// A command, if one came.
    pub command: Option<Command>,
}

impl Feedback {
    /// Nothing but, perhaps, a command: no pulse, no alarm, and inputs that let the machine run.
    pub const fn of(command: Option<Command>) -> Self {
        Self {
            index: [None; MAX_AXES],
            encoder: [0; MAX_AXES],
            alarm: [false; MAX_AXES],
            ran_dry: None,
            inputs: SafetyInputs {
                enable: true,
                stop: false,
            },
            command,
        }
    }
}

/// What the loop writes to the outside, to be played from the next deadline on.
#[derive(Clone, Debug)]
pub struct Output {
    /// Plans, each at the number of the first axis that plays it.
    pub(crate) plans: PerAxis<Runs>,
    pub(crate) sharing: Sharing,
    /// Setpoints of servo axes; those of stepper axes are zero.
    pub setpoints: PerAxis<Setpoint>,
    /// The drives are to be on.
    pub drives_enabled: bool,
    /// High in the first half of each turn of the master: an oscilloscope's trigger.
    pub sync: bool,
    /// What the loop knows, for traces and logs.
    pub telemetry: Telemetry,
}

impl Output {
    /// The pulses of an axis; a servo axis has one pause. One that is not there has none.
    #[inline]
    pub fn runs(&self, axis: usize) -> &Runs {
        const NO_RUNS: &Runs = &Runs::new();
        if axis >= MAX_AXES {
            return NO_RUNS;
        }
        self.plans.get(self.sharing.first(axis)).unwrap_or(NO_RUNS)
    }

    /// Which axes have the same [`Self::runs`].
    pub const fn sharing(&self) -> Sharing {
        self.sharing
    }

    /// Of a loop that has not begun, its axes at these phases.
    pub(crate) const fn idle(axis_phase: PerAxis<Phase>) -> Self {
        Self {
            plans: [const { Runs::new() }; MAX_AXES],
            sharing: Sharing::NONE,
            setpoints: [Setpoint::ZERO; MAX_AXES],
            drives_enabled: false,
            sync: true,
            telemetry: Telemetry::idle(axis_phase),
        }
    }

    /// Sets back what the loop has not begun to write, for axes at these phases.
    pub(crate) fn reset(&mut self, axis_phase: PerAxis<Phase>) {
        for runs in &mut self.plans {
            runs.clear();
        }
        self.sharing = Sharing::NONE;
        self.setpoints = [Setpoint::ZERO; MAX_AXES];
        self.drives_enabled = false;
        self.sync = true;
        self.telemetry = Telemetry::idle(axis_phase);
    }
}

/// What the loop knows at the end of a tick.
#[derive(Clone, Debug)]
pub struct Telemetry {
    /// What the machine is doing.
    pub state: State,
    /// The fault that latched.
    pub fault: Option<Fault>,
    /// What the program asks for.
    pub amax_program: Amax,
    /// Ticks of the program that are over.
    pub program_ticks: u64,
    /// The master's motion in this tick.
    pub motion: Motion,
    /// The master's phase at the tick's end.
    pub phase: Phase,
    /// Commanded phases at the tick's end.
    pub axis_phase: PerAxis<Phase>,
    /// Steps (or encoder counts) commanded since the start, in each axis's own sense.
    pub steps: PerAxis<i64>,
    /// Drift as last measured.
    pub drift: PerAxis<Turns>,
    /// The largest of it, without sign, since power-up or [`Command::ResetPeak`].
    pub peak: PerAxis<Turns>,
    /// Its modes.
    pub modes: Modes,
    /// What corrects it: trims, the sum of which is zero.
    pub correction: PerAxis<Turns>,
    /// Where the master's phase is zero, seen from the cranks': align found them so far ahead of where they were believed.
    pub datum: Turns,
    /// What was seen in this tick and is told, whatever is done about it.
    pub incident: Option<Fault>,
    /// How many there have been.
    pub incidents: u32,
    /// Whether the program's time stands still on command.
    pub holding: bool,
    /// What is out of the ordinary but no fault.
    pub limits: Limits,
}

impl Telemetry {
    const fn idle(axis_phase: PerAxis<Phase>) -> Self {
        Self {
            state: State::Idle,
            fault: None,
            amax_program: Amax::ZERO,
            program_ticks: 0,
            motion: Motion::AT_REST,
            phase: Phase::ZERO,
            axis_phase,
            steps: [0; MAX_AXES],
            drift: [Turns::ZERO; MAX_AXES],
            peak: [Turns::ZERO; MAX_AXES],
            modes: Modes::ZERO,
            correction: [Turns::ZERO; MAX_AXES],
            datum: Turns::ZERO,
            incident: None,
            incidents: 0,
            holding: false,
            limits: Limits {
                missed_deadlines: 0,
                late_deadlines: 0,
            },
        }
    }
}

/// Limits that bit: reported, and gone on from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Deadlines missed altogether since the start.
    pub missed_deadlines: u32,
    /// Deadlines met late by over half a tick since the start.
    pub late_deadlines: u32,
}
