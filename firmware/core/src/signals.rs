//! Input and output of the control loop at a deadline.

use crate::monitor::{IndexPulses, Modes};
use crate::pulse::{Run, Runs, Sharing};
use crate::servo::Setpoint;
use crate::shaft::Motion;
use crate::supervisor::{Command, Fault, RefusedCommand, SafetyInputs, State};
use crate::units::{Amax, AxisSet, MAX_AXES, PerAxis, Phase, Turns};

/// Feedback that the loop reads at a deadline.
#[derive(Clone, Debug)]
pub struct Feedback {
    /// Index pulses of the tick that is over.
    pub index: IndexPulses,
    /// Counts of the motors' encoders at the deadline, in the motors' own sense, wrapping. They start at any value at
    /// power-up. The entry of an axis without an encoder is ignored.
    pub encoder: PerAxis<i32>,
    /// Axes whose drives give an alarm.
    pub alarms: AxisSet,
    /// Axis whose step FIFO ran empty within a tick that had been submitted in full.
    pub fifo_underrun: Option<usize>,
    /// Enable and stop inputs.
    pub inputs: SafetyInputs,
    /// Command, if one arrived.
    pub command: Option<Command>,
}

impl Feedback {
    /// Feedback that contains at most a command: no pulse, no alarm, and inputs that let the machine run.
    pub const fn with_command(command: Option<Command>) -> Self {
        Self {
            index: IndexPulses::NONE,
            encoder: [0; MAX_AXES],
            alarms: 0,
            fifo_underrun: None,
            inputs: SafetyInputs {
                enable: true,
                stop: false,
            },
            command,
        }
    }
}

/// Output of the loop, to be played from the next deadline on.
#[derive(Clone, Debug)]
pub struct Output {
    /// Plans of the last tick and of the one before, each at the number of the first axis that plays it. Hardware may read the older ones
    /// until it plays the newer ones.
    plans: [PerAxis<Runs>; 2],
    /// True if the second of them is the newer one.
    second_is_newer: bool,
    /// Setpoints of servo axes; those of stepper axes are zero.
    pub setpoints: PerAxis<Setpoint>,
    /// True if the drives must be on.
    pub drives_enabled: bool,
    /// Sync output, high in the first half of each turn of the master: a trigger for an oscilloscope.
    pub sync: bool,
    /// State of the loop, for traces and logs.
    pub telemetry: Telemetry,
}

impl Output {
    /// Pulses of an axis; a servo axis that takes setpoints has one pause. An axis that is not there has no runs.
    ///
    /// They stay unchanged at their place in memory while the next tick is planned, so that hardware can still read them.
    #[inline]
    pub fn runs(&self, axis: usize) -> &[Run] {
        self.all_runs().nth(axis).unwrap_or_default()
    }

    /// [`Self::runs`] of each axis.
    #[inline]
    pub fn all_runs(&self) -> impl Iterator<Item = &[Run]> {
        let [first, second] = &self.plans;
        let plans = if self.second_is_newer { second } else { first };
        let sharing = self.sharing();
        // Most axes play the plan of the axis before.
        let (mut plan, mut runs): (_, &[Run]) = (MAX_AXES, &[]);
        (0..MAX_AXES).map(move |axis| {
            let first = sharing.first(axis);
            if first != plan {
                plan = first;
                runs = plans.get(plan).map_or(&[], |runs| &runs[..]);
            }
            runs
        })
    }

    /// Takes the plans of the tick before the last, to be replaced by those of a new tick.
    #[inline(always)]
    pub(crate) const fn begin_plans(&mut self) {
        self.second_is_newer = !self.second_is_newer;
    }

    /// Plan of the tick that was begun last, for an axis that is the first to play it.
    #[inline(always)]
    pub(crate) fn plan_mut(&mut self, axis: usize) -> Option<(&mut Runs, &mut i64)> {
        let [first, second] = &mut self.plans;
        let plans = if self.second_is_newer { second } else { first };
        plans
            .get_mut(axis)
            .zip(self.telemetry.plan_steps.get_mut(axis))
    }

    /// Which axes have the same [`Self::runs`].
    pub const fn sharing(&self) -> Sharing {
        self.telemetry.sharing
    }

    /// Output of a loop that has not begun, whose axes are `lead` turns ahead of the master.
    pub(crate) const fn idle(lead: PerAxis<Turns>) -> Self {
        Self {
            plans: [const { [const { Runs::new() }; MAX_AXES] }; 2],
            second_is_newer: false,
            setpoints: [Setpoint::ZERO; MAX_AXES],
            drives_enabled: false,
            sync: true,
            telemetry: Telemetry::idle(lead),
        }
    }

    /// Resets the output to that of a loop that has not begun, whose axes are `lead` turns ahead of the master.
    #[cold]
    pub(crate) fn reset(&mut self, lead: PerAxis<Turns>) {
        for runs in self.plans.as_flattened_mut() {
            runs.clear();
        }
        self.setpoints = [Setpoint::ZERO; MAX_AXES];
        self.drives_enabled = false;
        self.sync = true;
        self.telemetry = Telemetry::idle(lead);
    }
}

/// State of the loop at the end of a tick.
#[derive(Clone, Debug)]
pub struct Telemetry {
    /// State of the machine.
    pub state: State,
    /// Fault that latched.
    pub fault: Option<Fault>,
    /// Amplitude that the program requests.
    pub amax_requested: Amax,
    /// Ticks of the program that are over.
    pub program_ticks: u64,
    /// Motion of the master in this tick.
    pub motion: Motion,
    /// Phase of the master at the end of the tick.
    pub phase: Phase,
    /// Commanded phases at the end of the tick, less the master's.
    pub lead: PerAxis<Turns>,
    /// Which axes share a plan.
    pub(crate) sharing: Sharing,
    /// Steps of each plan since the start, and the number of steps by which each axis is ahead of its plan.
    pub(crate) plan_steps: PerAxis<i64>,
    pub(crate) steps_ahead: PerAxis<i64>,
    /// Phase errors as last measured.
    pub phase_error: PerAxis<Turns>,
    /// Largest phase error, without sign, since power-up or [`Command::ResetPeak`].
    pub peak: PerAxis<Turns>,
    /// Spatial modes of the phase errors.
    pub modes: Modes,
    /// Trims that correct the phase errors; their sum is zero.
    pub correction: PerAxis<Turns>,
    /// Home offset: crank phase minus master phase, as found by homing.
    pub home_offset: Turns,
    /// Event of this tick. It is reported for every reaction.
    pub event: Option<Fault>,
    /// Number of events so far.
    pub event_count: u32,
    /// Command of this tick that was not possible, and had no effect.
    pub refused: Option<RefusedCommand>,
    /// True while a hold command stops the program's time.
    pub holding: bool,
    /// True while the master turns at homing speed: in homing, and in a jog.
    pub is_at_homing_speed: bool,
    /// True once homing is over.
    pub homed: bool,
    /// True once the program is over.
    pub program_done: bool,
    /// Factor on the program's amplitude, in thousandths.
    pub override_permille: u16,
    /// Deviations that are not faults.
    pub limits: Limits,
}

impl Telemetry {
    /// Commanded phase of an axis at the end of the tick; that of the master for an axis that does not exist.
    pub fn axis_phase(&self, axis: usize) -> Phase {
        let lead = self.lead.get(axis).copied().unwrap_or_default();
        self.phase.advanced(lead)
    }

    /// Steps (or encoder counts) of an axis commanded since the start, in its own sense.
    pub fn steps(&self, axis: usize) -> i64 {
        let of = |steps: &PerAxis<i64>, axis: usize| steps.get(axis).copied().unwrap_or_default();
        of(&self.plan_steps, self.sharing.first(axis.min(MAX_AXES - 1)))
            .wrapping_add(of(&self.steps_ahead, axis))
    }

    /// Lets `axes`, which play the plan of the axis `from`, play that of `first`, without a change of their steps. If `first` is one of
    /// them, it gets a plan of its own.
    pub(crate) fn share_plan(&mut self, axes: AxisSet, from: usize, first: usize) {
        if axes & 1 << first != 0 {
            let steps = self.steps(first);
            if let Some(own) = self.plan_steps.get_mut(first) {
                *own = steps;
            }
        }
        let of = |plan: usize| self.plan_steps.get(plan).copied().unwrap_or_default();
        let by = of(from).wrapping_sub(of(first));
        for (axis, ahead) in self.steps_ahead.iter_mut().enumerate() {
            if axes & 1 << axis != 0 {
                self.sharing = self.sharing.with(axis, first);
                *ahead = ahead.wrapping_add(by);
            }
        }
    }

    const fn idle(lead: PerAxis<Turns>) -> Self {
        Self {
            state: State::Idle,
            fault: None,
            amax_requested: Amax::ZERO,
            program_ticks: 0,
            motion: Motion::AT_REST,
            phase: Phase::ZERO,
            lead,
            sharing: Sharing::NONE,
            plan_steps: [0; MAX_AXES],
            steps_ahead: [0; MAX_AXES],
            phase_error: [Turns::ZERO; MAX_AXES],
            peak: [Turns::ZERO; MAX_AXES],
            modes: Modes::ZERO,
            correction: [Turns::ZERO; MAX_AXES],
            home_offset: Turns::ZERO,
            event: None,
            event_count: 0,
            refused: None,
            holding: false,
            is_at_homing_speed: false,
            homed: false,
            program_done: false,
            override_permille: 1000,
            limits: Limits {
                missed_deadlines: 0,
                late_deadlines: 0,
            },
        }
    }
}

/// Counters of exceeded limits, which are reported and do not stop the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Number of deadlines missed since the start.
    pub missed_deadlines: u32,
    /// Number of deadlines met late by over half a tick since the start.
    pub late_deadlines: u32,
}
