//! Statistics of a run, gathered tick by tick.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Command, State};
use cophase_core::units::{Amax, PerAxis, Turns};
use cophase_scene::file::{FaultAt, FaultName, InputLine};
use cophase_scene::units::{degrees, mps2, speed_hz};

use super::Moment;
use super::coast::Coast;
use super::corrections::Corrections;
use super::event_watch::{EventWatch, NewEvents};
use super::events::{Event, EventKind, StoppedBy};
use super::forces::PeakForces;
use super::hold::FaultHold;
use super::off_command::OffCommand;
use crate::checked::Checked;
use crate::drives::SimulatedAxis;
use crate::dynamics::plant::Figure;
use crate::machines::follower::Peaks;
use crate::mechanism::SquareLaw;
use crate::simulated_machine::SimulatedMachine;

/// Accuracy of amax while the program holds it and the shaft has reached its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holding {
    /// Duration of all such holds, s.
    pub held_s: f64,
    /// Largest relative error of the platform's acceleration amplitude.
    pub worst_relative: f64,
}

/// Motion of a frame, and the force that it passed to the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FramePeaks {
    /// Static sag under its own weight and the load, µm. Displacements are counted from there.
    pub sag_um: f64,
    /// Largest force on the ground beyond the weight at rest, N.
    pub worst_ground_n: f64,
    /// Largest displacement of any point on the mount circle from rest, µm.
    pub worst_um: f64,
}

/// Statistics of a run.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// Events in order of time; the first [`MOST_EVENTS`] of them.
    pub events: Vec<Event>,
    /// Number of further events.
    pub events_left_out: usize,
    /// Largest difference between the phase errors of two cranks while the drives were on, degrees.
    pub worst_spread_deg: f64,
    /// Root mean square of this difference while running, degrees.
    pub rms_spread_deg: f64,
    /// Largest tilt of the platform while the drives were on, mrad.
    pub worst_tilt_mrad: f64,
    /// Largest deviation of a crank from the plane of all cranks, degrees, while the drives were on.
    pub worst_warp_deg: f64,
    /// Accuracy of steady holds.
    pub holding: Holding,
    /// Largest speed, rev/s.
    pub top_speed_hz: f64,
    /// Largest acceleration amplitude that the commanded speed causes, m/s².
    pub top_amax_mps2: f64,
    /// Time in each state, s: idle, homing, run, stop, parked, fault.
    pub time_in_state_s: [f64; 6],
    /// Steps or counts commanded, for each axis.
    pub steps: Vec<i64>,
    /// Turns commanded, and turns made, for each axis.
    pub turns: Vec<(f64, f64)>,
    /// Peak phase error that the loop measured, for each axis, degrees.
    pub phase_error_peak_deg: Vec<f64>,
    /// Correction of each axis at the end of the run, degrees.
    pub correction_deg: Vec<f64>,
    /// Electrical cycles slipped, for each axis, by its motor itself.
    pub slipped_cycles: Vec<i64>,
    /// Electrical cycles that faults of the scene took from each axis.
    pub injected_cycles: Vec<i64>,
    /// Error of each shaft that ended off its command, turns: positive ahead; 0 for the others.
    pub off_command_turns: Vec<f64>,
    /// True of each shaft that made less than half of the motion that the program commanded.
    pub stood: Vec<bool>,
    /// Largest fraction of its pull-out torque that was required of each axis, and the speed at that time, rev/s; none if
    /// torque is not compared.
    pub torque_used: Vec<Option<(f64, f64)>>,
    /// Largest torque that each motor gave, N·m; empty if torque does not move the cranks.
    pub worst_torque_nm: Vec<f64>,
    /// Largest acceleration of the platform itself while running, m/s²; 0 if torque does not move the cranks.
    pub worst_accel_mps2: f64,
    /// Motion of the frame, if it moves.
    pub frame: Option<FramePeaks>,
    /// Peak values of each follower; empty if the axes are not cam shafts.
    pub followers: Vec<Peaks>,
    /// Figures of a machine with its own plant model, at the end of the run.
    pub figures: Vec<Figure>,
    /// Warnings of a machine with its own plant model.
    pub machine_warnings: Vec<String>,
    /// Coasting of cranks whose drives were switched off.
    pub coast: Coast,
    /// Platform that the drives held after a fault.
    pub fault_hold: FaultHold,
    /// Number of faults that the loop reported.
    pub reported: u32,
    /// Cause of the last stop.
    pub stopped_by: Option<StoppedBy>,
    /// Deadlines met more than half a tick late.
    pub late_deadlines: u32,
    /// Deadlines missed completely.
    pub missed_deadlines: u32,

    /// Law that converts a speed to an amplitude.
    law: SquareLaw,
    /// Speed in the last tick, and the values computed from it: most ticks have the speed of the one before.
    speed: Turns,
    speed_hz: f64,
    speed_mps2: f64,
    /// True if the shaft was faster after the last change of its speed than before.
    is_rising: bool,
    tick_hz: u32,
    tick_s: f64,
    running_ticks: u64,
    spread_squares: f64,
    stop_requested: bool,
    state: Option<State>,
    event_watch: EventWatch,
    corrections: Corrections,
    off_command: OffCommand,
    /// Time at which the shaft entered a band, s, and true if its speed was rising then.
    band: Option<(f64, bool)>,
    held: Option<f64>,
    lag: Option<(f64, f64)>,
    level: Amax,
    level_ticks: u64,
}

/// Largest number of events that are kept. This is enough for any single scene, and a campaign uses only the numbers.
pub const MOST_EVENTS: usize = 10_000;

impl Statistics {
    /// Creates the statistics of a run that has not begun.
    pub fn new(checked: &Checked) -> Self {
        let law = checked.law();
        let axes = checked.scene.axes.count;
        Self {
            events: Vec::new(),
            events_left_out: 0,
            worst_spread_deg: 0.0,
            rms_spread_deg: 0.0,
            worst_tilt_mrad: 0.0,
            worst_warp_deg: 0.0,
            holding: Holding::default(),
            top_speed_hz: 0.0,
            top_amax_mps2: 0.0,
            time_in_state_s: [0.0; 6],
            steps: Vec::new(),
            turns: Vec::new(),
            phase_error_peak_deg: Vec::new(),
            correction_deg: Vec::new(),
            slipped_cycles: vec![0; axes],
            injected_cycles: vec![0; axes],
            off_command_turns: vec![0.0; axes],
            stood: vec![false; axes],
            torque_used: Vec::new(),
            worst_torque_nm: Vec::new(),
            worst_accel_mps2: 0.0,
            frame: None,
            followers: Vec::new(),
            figures: Vec::new(),
            machine_warnings: Vec::new(),
            coast: Coast::new(checked),
            fault_hold: FaultHold::default(),
            reported: 0,
            stopped_by: None,
            late_deadlines: 0,
            missed_deadlines: 0,
            law,
            speed: Turns::ZERO,
            speed_hz: 0.0,
            speed_mps2: law.amax_mps2(0.0),
            is_rising: false,
            tick_hz: checked.scene.control.tick_hz,
            tick_s: 1.0 / f64::from(checked.scene.control.tick_hz),
            running_ticks: 0,
            spread_squares: 0.0,
            stop_requested: false,
            state: None,
            event_watch: EventWatch::default(),
            corrections: Corrections::new(
                checked.scene.drift.reading_error_deg,
                1.0 / f64::from(checked.scene.control.tick_hz),
            ),
            off_command: OffCommand::new(checked),
            band: None,
            held: None,
            lag: None,
            level: Amax::ZERO,
            level_ticks: 0,
        }
    }

    /// Electrical cycles by which an axis left its command: negative behind.
    pub fn cycles_off(&self, axis: usize) -> i64 {
        self.slipped_cycles[axis] - self.injected_cycles[axis]
    }

    /// Time at which the first motor slipped or the first fault latched, s; none if neither happened.
    pub fn first_effect_s(&self) -> Option<f64> {
        let first = self.events.iter().find(|event| {
            matches!(
                event.what,
                EventKind::Slipped { .. } | EventKind::Fault { .. }
            )
        });
        first.map(|event| event.t_s)
    }

    /// Takes in one tick.
    pub fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let t_s = moment.start_ns as f64 * 1e-9;
        self.time_in_state_s[telemetry.state as usize] += self.tick_s;
        if telemetry.motion.speed != self.speed {
            self.is_rising = telemetry.motion.speed > self.speed;
            self.speed = telemetry.motion.speed;
            self.speed_hz = speed_hz(self.speed, self.tick_hz);
            let omega_rad_s = std::f64::consts::TAU * self.speed_hz;
            self.speed_mps2 = self.law.amax_mps2(omega_rad_s);
            raise(&mut self.top_speed_hz, self.speed_hz);
            raise(&mut self.top_amax_mps2, self.speed_mps2);
        }
        self.cranks(moment, t_s);
        self.limits(moment, t_s);
        self.level(moment);
        if let Some(new_events) = self.event_watch.tick(telemetry) {
            self.publish(new_events, telemetry, t_s);
        }
        if let Some(Event { t_s, what }) = self.corrections.tick(telemetry, t_s) {
            self.note(t_s, what);
        }
        if self.state != Some(telemetry.state) {
            self.state = Some(telemetry.state);
            self.enter(telemetry.state, moment, t_s);
        }
    }

    #[cold]
    fn publish(&mut self, new_events: NewEvents, telemetry: &Telemetry, t_s: f64) {
        if let Some(refused) = new_events.refused {
            self.note(t_s, EventKind::Refused(refused));
        }
        if let Some(fault) = new_events.reported {
            self.reported += 1;
            self.note(t_s, EventKind::Reported(fault));
        }
        if let Some(fault) = new_events.latched {
            let leading_deg = telemetry.modes.tilt_direction_deg();
            let leading_deg = leading_deg.map(|deg| deg.rem_euclid(360.0));
            self.note(t_s, EventKind::Fault { fault, leading_deg });
        }
    }

    fn enter(&mut self, state: State, moment: &Moment<'_>, t_s: f64) {
        let telemetry = moment.telemetry;
        // A fault may switch the drives off in any state, even during a stop with another cause.
        let stopped_by = match state {
            State::Fault => Some(StoppedBy::Fault),
            State::Stop => Some(match telemetry.fault {
                Some(_) => StoppedBy::Fault,
                None if self.stop_requested => StoppedBy::Request,
                None => StoppedBy::ProgramEnd,
            }),
            _ => None,
        };
        self.stopped_by = stopped_by.or(self.stopped_by);
        let what = if state == State::Run {
            self.stop_requested = false;
            // The first tick of the program has already ended.
            let from_s = telemetry.program_ticks.saturating_sub(1) as f64 * self.tick_s;
            EventKind::Running { from_s }
        } else if state == State::Fault {
            let holds = moment.drives_enabled;
            EventKind::Stopped { holds }
        } else {
            EventKind::State(state)
        };
        self.note(t_s, what);
    }

    /// Records a command.
    pub fn commanded(&mut self, t_s: f64, command: Command) {
        self.stop_requested |= command == Command::Stop;
        self.note(t_s, EventKind::Commanded(command));
    }

    /// Records a change of a safety input.
    pub fn input(&mut self, t_s: f64, line: InputLine, active: bool) {
        self.stop_requested |= line == InputLine::Stop && active;
        self.note(t_s, EventKind::Input { line, active });
    }

    /// Records a fault that the scene injects.
    pub fn injected(&mut self, t_s: f64, fault: FaultAt) {
        self.stop_requested |= fault.kind == FaultName::StopInput;
        self.note(t_s, EventKind::Injected(fault));
    }

    /// Takes in the positions of the cranks.
    fn cranks(&mut self, moment: &Moment<'_>, t_s: f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, error) in moment.errors().enumerate() {
            low = if error < low { error } else { low };
            raise(&mut high, error);
            let slipped = moment.machine.axes[i].slipped_cycles();
            // A motor that is off has no field to slip against.
            if slipped != self.slipped_cycles[i] && moment.drives_enabled {
                self.slipped_cycles[i] = slipped;
                self.note(
                    t_s,
                    EventKind::Slipped {
                        axis: i,
                        cycles: slipped,
                    },
                );
            }
        }
        let peaks = moment.machine.follower().peaks();
        self.followers.resize(peaks.len(), Peaks::default());
        for (worst, peaks) in self.followers.iter_mut().zip(peaks) {
            *worst = worst.or(*peaks);
        }
        self.coast.tick(moment);
        if self.fault_hold.tick(moment) {
            self.note(t_s, EventKind::LetGo);
        }
        if !moment.drives_enabled {
            return;
        }
        self.off_command.tick(moment, self.speed_hz);
        let spread_deg = (high - low) * 360.0;
        raise(&mut self.worst_spread_deg, spread_deg);
        moment.raise_tilt(&mut self.worst_tilt_mrad);
        // The plane is the closest to all errors: with up to six axes, none deviates from it by more than √6/2 of the spread.
        if 1.25 * spread_deg > self.worst_warp_deg {
            let machine = moment.machine;
            let warp_deg = machine.warp_deg(moment.actual_turns, moment.aim_turns);
            raise(&mut self.worst_warp_deg, warp_deg);
        }
        if moment.telemetry.state == State::Run {
            self.running_ticks += 1;
            self.spread_squares += spread_deg * spread_deg;
        }
    }

    /// Takes over the torques of the motors and their effects.
    pub(super) fn take(&mut self, forces: PeakForces) {
        self.worst_torque_nm = forces.worst_torque_nm;
        self.worst_accel_mps2 = forces.worst_accel_mps2;
        self.frame = forces.frame;
    }

    /// Records the limits that became active, with the beginning and the extent of each.
    fn limits(&mut self, moment: &Moment<'_>, t_s: f64) {
        let (motion, limits) = (&moment.telemetry.motion, &moment.telemetry.limits);
        // A speed inside a band differs from one outside. So the speed changes in the ticks in which it enters and leaves.
        match (motion.crossing_band, self.band) {
            (true, None) => self.band = Some((t_s, self.is_rising)),
            (false, Some((since_s, entered_upwards))) => {
                self.band = None;
                let in_s = t_s - since_s;
                let what = if self.is_rising == entered_upwards {
                    EventKind::BandCrossed {
                        in_s,
                        upwards: self.is_rising,
                    }
                } else {
                    EventKind::TurnedBackInBand {
                        in_s,
                        entered_upwards,
                    }
                };
                self.note(since_s, what);
            }
            _ => {}
        }
        match (motion.held_at_band, self.held) {
            (true, None) => self.held = Some(t_s),
            (false, Some(since_s)) => {
                self.held = None;
                self.note(
                    since_s,
                    EventKind::HeldAtBand {
                        for_s: t_s - since_s,
                    },
                );
            }
            _ => {}
        }
        // Only the run state has a program that the shaft can lag behind.
        if motion.lagging && moment.telemetry.state == State::Run {
            let off = (self.speed_mps2 - mps2(moment.telemetry.amax_requested)).abs();
            let (since_s, worst) = self.lag.unwrap_or((t_s, 0.0));
            self.lag = Some((since_s, worst.max(off)));
        } else if let Some((since_s, worst_mps2)) = self.lag.take() {
            self.note(
                since_s,
                EventKind::Lagged {
                    for_s: t_s - since_s,
                    worst_mps2,
                },
            );
        }
        if limits.missed_deadlines != self.missed_deadlines {
            let deadlines = limits.missed_deadlines - self.missed_deadlines;
            self.missed_deadlines = limits.missed_deadlines;
            self.note(t_s, EventKind::Missed { deadlines });
        }
        self.late_deadlines = limits.late_deadlines;
    }

    /// Takes in how accurately the level is held.
    fn level(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        if telemetry.state != State::Run || telemetry.amax_requested != self.level {
            self.level = telemetry.amax_requested;
            self.level_ticks = 0;
            return;
        }
        self.level_ticks += 1;
        let steady = telemetry.motion.acceleration == 0
            && !telemetry.motion.held_at_band
            && !telemetry.motion.lagging
            && self.level_ticks > 2;
        if steady && self.level > 0 {
            self.holding.held_s += self.tick_s;
            let relative = (self.speed_mps2 / mps2(self.level) - 1.0).abs();
            raise(&mut self.holding.worst_relative, relative);
        }
    }

    /// Completes the statistics at the end of a run. Steps, phase errors and corrections are those of the last tick that was
    /// played. `command_turns` are the commanded positions at its end. Without such a tick all are 0.
    pub fn finish(
        &mut self,
        machine: &SimulatedMachine,
        last: Option<&Telemetry>,
        command_turns: &[f64],
    ) {
        if let Some(record) = machine.record() {
            let mut record = record.clone_box();
            let latched = self.events.iter().filter_map(|event| match &event.what {
                EventKind::Fault { fault, .. } => Some(fault.kind),
                _ => None,
            });
            record.end(&latched.collect::<Vec<_>>());
            self.figures = record.figures();
            self.machine_warnings = record.warnings();
        }
        self.torque_used = machine
            .axes
            .iter()
            .map(SimulatedAxis::torque_used)
            .collect();
        let axes = 0..machine.axes.len();
        self.injected_cycles = (machine.axes.iter())
            .map(SimulatedAxis::injected_cycles)
            .collect();
        self.off_command_turns = self.off_command.off_turns().to_vec();
        self.stood = self.off_command.stood().to_vec();
        self.steps = axes
            .clone()
            .map(|i| last.map_or(0, |last| last.steps(i)))
            .collect();
        let played = |i: usize| match last {
            Some(_) => (command_turns[i], machine.axes[i].turns()),
            None => (0.0, 0.0),
        };
        self.turns = axes.clone().map(played).collect();
        let in_degrees = |angles: fn(&Telemetry) -> &PerAxis<Turns>| {
            let of = |i| last.map_or(0.0, |last| degrees(angles(last)[i]));
            axes.clone().map(of).collect()
        };
        self.phase_error_peak_deg = in_degrees(|last| &last.peak);
        self.correction_deg = in_degrees(|last| &last.correction);
        if self.running_ticks > 0 {
            self.rms_spread_deg = (self.spread_squares / self.running_ticks as f64).sqrt();
        }
        if let Some(Event { t_s, what }) = self.corrections.finish() {
            self.note(t_s, what);
        }
        self.events.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
    }

    fn note(&mut self, t_s: f64, what: EventKind) {
        if self.events.len() < MOST_EVENTS {
            self.events.push(Event { t_s, what });
        } else {
            self.events_left_out += 1;
        }
    }
}

/// Raises `most` to `value`, unless that is NaN. `f64::max` does the same in more instructions.
pub(super) fn raise(most: &mut f64, value: f64) {
    if value > *most {
        *most = value;
    }
}
