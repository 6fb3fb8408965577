//! One tick of the whole path: program, profile, master shaft, axes, pulses and setpoints; and back
//! from the index pulses through the drift monitor to the supervisor.
//!
//! **Times.** What [`Controller::tick`] returns at one deadline is played from the next deadline on,
//! for one tick. The index pulses handed to it came between the deadline before and this one, while
//! the output of two ticks ago was played.

mod punctuality;

use crate::axes::Axis;
use crate::drift::{DriftLimits, DriftMonitor, TickPhase};
use crate::profile::{Profile, SliderCrank};
use crate::program::{Cursor, Program, ProgramBuilder};
use crate::pulse::{Paces, Planner, PulseTiming, Runs};
use crate::servo::{FeedForward, Setpoint};
use crate::settings::{DriveKind, Problem, Settings, SettingsError, turns};
use crate::shaft::{Demand, Motion, Shaft, ShaftLimits, Target};
use crate::signals::{Feedback, Output};
use crate::supervisor::{Action, Fault, FaultKind, Reaction, Seen, State, Supervisor};
use crate::units::{Amax, ONE_TURN, Phase, Turns};
use punctuality::Punctuality;

/// The control loop's state, less its waiting.
#[derive(Clone, Debug)]
pub struct Controller<const N: usize> {
    tick_hz: u32,
    profile: Profile,
    program: Program,
    cursor: Cursor,
    target: Target,
    /// The level towards which the program goes, and the speed that belongs to it.
    end: (Amax, Turns),
    shaft: Shaft,
    park: Turns,
    channels: [Channel; N],
    has_servos: bool,
    pace: Paces,
    drift: DriftMonitor<N>,
    supervisor: Supervisor,
    motion: Motion,
    ticks: u64,
    punctuality: Punctuality,
    overrun: Option<Fault>,
    /// Deadlines were missed: what the index sensors said since belongs to no known phase.
    was_late: bool,
    output: Output<N>,
}

/// One axis, from the master's turns to what its drive is told.
#[derive(Clone, Debug)]
struct Channel {
    axis: Axis,
    planner: Planner,
    reversed: bool,
    /// Of a servo axis; one without is a stepper.
    feed_forward: Option<FeedForward>,
    /// Phases of the last two outputs: the one being played, and the one before.
    playing: TickPhase,
    played: TickPhase,
}

impl<const N: usize> Settings<N> {
    /// The profile that these settings' machine has.
    pub fn profile(&self) -> Profile {
        let machine = &self.machine;
        Profile::SliderCrank(SliderCrank::new(
            machine.crank_radius_m,
            machine.lambda,
            self.tick_hz,
        ))
    }

    /// A builder of programs for these settings' machine.
    pub fn program_builder(&self) -> ProgramBuilder {
        ProgramBuilder::new(self.tick_hz, self.profile(), self.limits.speed_hz)
    }
}

impl<const N: usize> Controller<N> {
    /// A controller at power-up: idle, every axis at its offset.
    ///
    /// # Errors
    /// The first setting that is wrong.
    pub fn new(settings: &Settings<N>, program: Program) -> Result<Self, SettingsError> {
        settings.check()?;
        let tick_hz = settings.tick_hz;
        let hz = f64::from(tick_hz);
        let limits = ShaftLimits::new(&settings.limits, tick_hz);
        let timing = PulseTiming::new(&settings.pulse, tick_hz)?;
        let mut feed_forward = [None; N];
        for (i, (axis, slot)) in settings.axes.iter().zip(&mut feed_forward).enumerate() {
            let ratio = f64::from(axis.ratio.0) / f64::from(axis.ratio.1);
            // Trim comes on top of what the gear makes.
            let speed_hz = settings.limits.speed_hz * ratio + axis.trim_rate_hz;
            let place = |error: SettingsError| error.on_entry(i);
            if speed_hz > 0.5 * hz {
                let problem = Problem::TooFastForTick {
                    turns_per_tick: speed_hz / hz,
                };
                return Err(place(SettingsError::new("axes.ratio", problem)));
            }
            match axis.drive {
                DriveKind::Stepper => timing.check_rate(axis, speed_hz, tick_hz).map_err(place)?,
                DriveKind::Servo => {
                    PulseTiming::check_counts(axis, speed_hz, tick_hz).map_err(place)?;
                    let acceleration =
                        settings.limits.reachable_stop_acceleration_hz_per_s() * ratio;
                    *slot = Some(FeedForward::new(
                        &settings.machine,
                        N,
                        axis.rotor_inertia_kgm2,
                        tick_hz,
                        turns(speed_hz / hz),
                        turns(acceleration / hz / hz),
                    )?);
                }
            }
        }
        let channels: [Channel; N] = core::array::from_fn(|i| {
            let axis = Axis::new(&settings.axes[i], tick_hz);
            let still = TickPhase::still(axis.phase());
            Channel {
                axis,
                planner: Planner::new(timing, settings.axes[i].steps_per_turn),
                reversed: settings.axes[i].reversed,
                feed_forward: feed_forward[i],
                playing: still,
                played: still,
            }
        });
        let index = core::array::from_fn(|i| settings.axes[i].index_turns.map(turns));
        Ok(Self {
            tick_hz,
            profile: settings.profile(),
            program,
            cursor: Cursor::new(),
            target: Target::steady(Turns::ZERO),
            end: (Amax::ZERO, Turns::ZERO),
            shaft: Shaft::new(limits),
            park: Phase::from_turns(turns(settings.park_turns)).within_turn(),
            has_servos: feed_forward.iter().any(Option::is_some),
            pace: Paces::new(timing.tick()),
            drift: DriftMonitor::new(
                DriftLimits::new(&settings.drift, &settings.machine),
                index,
                timing.tick(),
            ),
            supervisor: Supervisor::new(libm::ceil(settings.settle_s * hz) as u32),
            motion: Motion {
                at_rest: true,
                ..Motion::default()
            },
            ticks: 0,
            punctuality: Punctuality::default(),
            overrun: None,
            was_late: false,
            output: Output::idle(core::array::from_fn(|i| channels[i].axis.phase())),
            channels,
        })
    }

    /// Control ticks a second.
    pub const fn tick_hz(&self) -> u32 {
        self.tick_hz
    }

    /// Whether an axis is mounted the other way round: its DIR is to be turned. One that is not there is not.
    pub fn is_reversed(&self, axis: usize) -> bool {
        self.channels
            .get(axis)
            .is_some_and(|channel| channel.reversed)
    }

    /// The program, and the place in it.
    pub const fn program(&self) -> (&Program, &Cursor) {
        (&self.program, &self.cursor)
    }

    /// Goes to a place in the program, ticks from its start. Takes effect like a jump of the level:
    /// the shaft follows within its limits.
    pub fn seek(&mut self, elapsed: u64) {
        self.cursor.seek(&self.program, elapsed);
    }

    /// The profile, for converting between speed and amax.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Sets an axis's trim; says whether its limit allowed all of it. An axis that is not there has
    /// no trim: false.
    pub fn set_trim(&mut self, axis: usize, turns: Turns) -> bool {
        self.channels
            .get_mut(axis)
            .is_some_and(|channel| channel.axis.trim_mut().set(turns))
    }

    /// Takes note of a deadline that was met late, by over half a tick or not, after `missed` deadlines
    /// that were not met at all.
    ///
    /// While deadlines are missed the step hardware has nothing to play: all axes stand, and go on
    /// from where they stood. No phase is lost by that, and none is made up for: the machine's time
    /// is behind by as many ticks.
    pub fn late(&mut self, missed: u32, over_half: bool) {
        let limits = &mut self.output.telemetry.limits;
        limits.late_deadlines = limits.late_deadlines.saturating_add(u32::from(over_half));
        if missed == 0 {
            return;
        }
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        for channel in &mut self.channels {
            channel.playing = TickPhase::still(channel.axis.phase());
            channel.played = channel.playing;
        }
        self.stood(missed);
    }

    /// Takes note that the last output was handed over `missed` ticks late, and is played by that much
    /// later. As with [`Self::late`], the machine stands meanwhile, and is behind.
    pub const fn held_over(&mut self, missed: u32) {
        let limits = &mut self.output.telemetry.limits;
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        self.stood(missed);
    }

    const fn stood(&mut self, missed: u32) {
        self.was_late = true;
        if self.punctuality.missed(missed) {
            self.overrun = Some(Fault::new(FaultKind::Overrun));
        }
    }

    /// Begins in the fault state: for what is known before the first tick.
    pub const fn begin_with(&mut self, fault: Fault) {
        self.supervisor.begin_with(fault);
    }

    /// Plays one tick.
    ///
    /// Never inlined: as part of a task that holds a controller for each number of axes it would be made
    /// for a frame of kilobytes, at twice the time; and this is the name by which the image's checks find it.
    #[inline(never)]
    pub fn tick(&mut self, feedback: &Feedback<N>) -> &Output<N> {
        let seen = self.observe(feedback);
        let before = self.supervisor.state();
        let action = self
            .supervisor
            .step(feedback.inputs, feedback.command, seen);
        self.enter(before, self.supervisor.state());
        let demand = self.demand(action);
        self.motion = self.shaft.advance(demand);
        self.drive(action != Action::Stand);
        self.report(action);
        self.ticks += 1;
        self.punctuality.met();
        &self.output
    }

    /// What has been seen since the last tick.
    #[inline(never)]
    fn observe(&mut self, feedback: &Feedback<N>) -> Seen {
        let drift = if core::mem::take(&mut self.was_late) {
            self.drift.disregard(&feedback.index);
            Ok(())
        } else {
            let played = core::array::from_fn(|axis| &self.channels[axis].played);
            self.drift.observe(&feedback.index, &played)
        };
        let alarm = feedback.alarm.iter().fold(false, |any, alarm| any | alarm);
        let all_is_well =
            !alarm && drift.is_ok() && feedback.ran_dry.is_none() && self.overrun.is_none();
        let fault = if all_is_well {
            None
        } else {
            self.blame(feedback, drift.err())
        };
        Seen {
            fault,
            reaction: Reaction::Stop,
            refines: false,
            at_rest: self.motion.at_rest,
            aligned: self.drift.is_aligned(),
            program_done: self.cursor.is_done(&self.program),
            tick: self.ticks,
            phase: self.shaft.phase(),
        }
    }

    /// Which of all that is wrong is told, when the drift monitor says `drift`.
    #[cold]
    #[inline(never)] // a fault has 48 bytes, to be moved about only where there is one
    fn blame(&mut self, feedback: &Feedback<N>, drift: Option<Fault>) -> Option<Fault> {
        let dry = feedback
            .ran_dry
            .map(|axis| Fault::new(FaultKind::RanDry).on_axis(axis));
        let alarm = feedback.alarm.iter().position(|&alarm| alarm);
        let alarm = alarm.map(|axis| Fault::new(FaultKind::DriveAlarm).on_axis(axis));
        dry.or(self.overrun.take()).or(alarm).or(drift)
    }

    /// Sets up for a state that was just entered.
    fn enter(&mut self, before: State, now: State) {
        if before == now {
            return;
        }
        match now {
            // Whatever the cranks did while the drives were off, only their index pulses tell.
            State::Align if before == State::Idle => {
                self.drift.reset();
                self.cursor = Cursor::new();
                self.target = Target::steady(Turns::ZERO);
            }
            State::Run if before == State::Parked => {
                if self.cursor.is_done(&self.program) {
                    self.cursor = Cursor::new();
                }
                self.target = Target::steady(Turns::ZERO);
            }
            _ => {}
        }
    }

    fn demand(&mut self, action: Action) -> Demand {
        match action {
            Action::Stand => Demand::Halt,
            Action::Creep => Demand::Follow(Target::steady(self.shaft.limits().creep())),
            Action::Play => Demand::Follow(self.play()),
            Action::Hold => {
                self.target = Target::steady(self.target.next);
                Demand::Follow(self.target)
            }
            Action::Park => Demand::Stop(Some(self.park)),
            Action::StopFast => Demand::Stop(None),
        }
    }

    /// Reads one tick of the program.
    #[inline(never)]
    fn play(&mut self) -> Target {
        let reading = self.cursor.next(&self.program);
        self.output.telemetry.amax_program = reading.level;
        if self.end.0 != reading.end_level {
            self.end = (reading.end_level, self.profile.speed(reading.end_level));
        }
        self.target = Target {
            now: self.target.next,
            next: if reading.level == reading.end_level {
                self.end.1
            } else {
                self.profile.speed(reading.level)
            },
            end: self.end.1,
        };
        self.target
    }

    /// Moves the axes and makes their pulses and setpoints. While the machine is to stand, trims stand
    /// too: drives that are off would not follow them.
    #[inline(never)]
    fn drive(&mut self, moving: bool) {
        let Output {
            runs,
            setpoints,
            telemetry,
            ..
        } = &mut self.output;
        let master = moving.then_some(self.motion.speed);
        for (channel, runs) in self.channels.iter_mut().zip(runs) {
            channel.advance(master.as_ref(), &mut self.pace, runs);
        }
        if self.has_servos {
            for (channel, setpoint) in self.channels.iter().zip(setpoints) {
                if let Some(forward) = &channel.feed_forward {
                    *setpoint = channel.setpoint(forward, self.motion.acceleration);
                }
            }
        }
        let told = telemetry.axis_phase.iter_mut().zip(&mut telemetry.steps);
        for (channel, (phase, steps)) in self.channels.iter().zip(told) {
            *phase = channel.axis.phase();
            *steps = channel.planner.steps();
        }
    }

    #[inline(never)]
    fn report(&mut self, action: Action) {
        let output = &mut self.output;
        output.drives_enabled = self.supervisor.drives_enabled();
        let within = self.shaft.phase().within_turn();
        output.sync = within.to_bits() < ONE_TURN / 2;
        let telemetry = &mut output.telemetry;
        telemetry.state = self.supervisor.state();
        telemetry.fault = self.supervisor.fault();
        if !matches!(action, Action::Play | Action::Hold) {
            telemetry.amax_program = Amax::ZERO;
        }
        telemetry.program_ticks = self.cursor.elapsed();
        telemetry.holding = action == Action::Hold;
        telemetry.motion = self.motion;
        telemetry.phase = self.shaft.phase();
        telemetry.drift = *self.drift.drift();
        telemetry.modes = *self.drift.modes();
    }
}

impl Channel {
    /// Moves on with the master, if it is to move, and fills `runs`.
    #[inline(never)]
    fn advance(&mut self, master: Option<&Turns>, pace: &mut Paces, runs: &mut Runs) {
        self.played = self.playing;
        self.playing.start = self.axis.phase();
        let turns = match master {
            Some(&speed) => self.axis.advance(speed),
            None => Turns::ZERO,
        };
        self.playing.turns = turns;
        if self.feed_forward.is_none() {
            self.planner.plan(turns, pace, runs);
        } else {
            self.planner.count(turns, pace, runs);
        }
    }

    /// What a servo is told at the end of a tick in which the master accelerated.
    #[inline(never)]
    fn setpoint(&self, forward: &FeedForward, acceleration: Turns) -> Setpoint {
        let (position, velocity) = (self.axis.phase(), self.playing.turns);
        let acceleration = self.axis.gear().share(acceleration);
        let setpoint = Setpoint {
            position,
            velocity,
            torque: forward.torque(position, velocity, acceleration),
        };
        if self.reversed {
            setpoint.reversed()
        } else {
            setpoint
        }
    }
}

#[cfg(test)]
mod tests;
