//! Recorder of a simulated run: besides the samples of the loop it sees the truth, tick by tick.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Command, State};
use cophase_core::units::{Amax, Turns};
use cophase_link::sample::Sample;
use cophase_scene::file::{FaultAt, FaultName, InputLine};
use cophase_scene::units::{degrees, mps2, speed_hz};

use super::Moment;
use super::coast::Coast;
use super::corrections::Corrections;
use super::event_watch::{EventWatch, NewEvents};
use super::events::{Event, EventKind, StoppedBy};
use super::forces::record_forces;
use super::hold::FaultHold;
use super::off_command::OffCommand;
use super::record::{Holding, RunRecord};
use super::recorder::{RunRecorder, raise};
use crate::checked::Checked;
use crate::mechanism::SquareLaw;
use crate::simulated_machine::SimulatedMachine;

/// Recorder of a simulated run.
#[derive(Clone, Debug)]
pub struct TruthRecorder {
    /// Coasting of cranks whose drives were switched off.
    pub coast: Coast,
    /// Platform that the drives hold after a fault.
    pub fault_hold: FaultHold,
    /// True if the torques of the motors and their effects are recorded. They have to be computed for it.
    pub records_forces: bool,
    run: RunRecorder,
    /// Law that converts a speed to an amplitude.
    law: SquareLaw,
    /// Amplitude at the speed of the last tick, m/s².
    speed_mps2: f64,
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

impl TruthRecorder {
    /// Creates the recorder of a run that has not begun.
    pub fn new(checked: &Checked) -> Self {
        let law = checked.law();
        let tick_hz = checked.scene.control.tick_hz;
        let mut run = RunRecorder::new(checked.scene.axes.count, tick_hz, 1);
        let figures = &mut run.record.figures;
        figures.phase_spread_worst_deg = Some(0.0);
        figures.phase_spread_rms_deg = Some(0.0);
        figures.warp_worst_deg = Some(0.0);
        figures.holding = Some(Holding::default());
        figures.tilt_limit_mrad = checked.tilt_limit_mrad();
        figures.tilt_worst_mrad = figures.tilt_limit_mrad.map(|_| 0.0);
        Self {
            coast: Coast::new(checked),
            fault_hold: FaultHold::default(),
            records_forces: false,
            law,
            speed_mps2: law.amax_mps2(0.0),
            running_ticks: 0,
            spread_squares: 0.0,
            stop_requested: false,
            state: None,
            event_watch: EventWatch::default(),
            corrections: Corrections::new(checked.scene.drift.reading_error_deg, run.sample_s),
            off_command: OffCommand::new(checked),
            band: None,
            held: None,
            lag: None,
            level: Amax::ZERO,
            level_ticks: 0,
            run,
        }
    }

    /// Takes in one tick.
    pub fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let t_s = moment.start_ns as f64 * 1e-9;
        if self.run.tick(telemetry.state as u8, telemetry.motion.speed) {
            self.speed_mps2 = amax_mps2(self.law, self.run.speed_hz);
        }
        self.cranks(moment, t_s);
        if self.records_forces {
            record_forces(moment, &mut self.run.record);
        }
        self.limits(moment, t_s);
        self.level(moment);
        if let Some(new_events) = self.event_watch.tick(telemetry) {
            self.publish(new_events, telemetry, t_s);
        }
        if let Some(Event { t_s, what }) = self.corrections.tick(telemetry, t_s) {
            self.run.record.note(t_s, what);
        }
        if self.state != Some(telemetry.state) {
            self.state = Some(telemetry.state);
            self.enter(telemetry.state, moment, t_s);
        }
    }

    #[cold]
    fn publish(&mut self, new_events: NewEvents, telemetry: &Telemetry, t_s: f64) {
        if let Some(refused) = new_events.refused {
            self.run.record.note(t_s, EventKind::Refused(refused));
        }
        if let Some(fault) = new_events.reported {
            self.run.record.reported += 1;
            self.run.record.note(t_s, EventKind::Reported(fault));
        }
        if let Some(fault) = new_events.latched {
            let leading_deg = telemetry.modes.tilt_direction_deg();
            let leading_deg = leading_deg.map(|deg| deg.rem_euclid(360.0));
            self.run
                .record
                .note(t_s, EventKind::Fault { fault, leading_deg });
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
        let record = &mut self.run.record;
        record.stopped_by = stopped_by.or(record.stopped_by);
        let what = if state == State::Run {
            self.stop_requested = false;
            // The first tick of the program has already ended.
            let from_s = telemetry.program_ticks.saturating_sub(1) as f64 * self.run.sample_s;
            EventKind::Running { from_s }
        } else if state == State::Fault {
            let holds = moment.drives_enabled;
            EventKind::Stopped { holds }
        } else {
            EventKind::State(state)
        };
        self.run.record.note(t_s, what);
    }

    /// Records a command.
    pub fn commanded(&mut self, t_s: f64, command: Command) {
        self.stop_requested |= command == Command::Stop;
        self.run.record.note(t_s, EventKind::Commanded(command));
    }

    /// Records a change of a safety input.
    pub fn input(&mut self, t_s: f64, line: InputLine, active: bool) {
        self.stop_requested |= line == InputLine::Stop && active;
        self.run.record.note(t_s, EventKind::Input { line, active });
    }

    /// Records a fault that the scene injects.
    pub fn injected(&mut self, t_s: f64, fault: FaultAt) {
        self.stop_requested |= fault.kind == FaultName::StopInput;
        self.run.record.note(t_s, EventKind::Injected(fault));
    }

    /// Takes in the positions of the cranks.
    fn cranks(&mut self, moment: &Moment<'_>, t_s: f64) {
        let record = &mut self.run.record;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, error) in moment.errors().enumerate() {
            low = if error < low { error } else { low };
            raise(&mut high, error);
            let cycles = moment.machine.axes[i].slipped_cycles();
            // A motor that is off has no field to slip against.
            if cycles != record.axes[i].motor_slips && moment.drives_enabled {
                record.axes[i].motor_slips = cycles;
                record.note(t_s, EventKind::Slipped { axis: i, cycles });
            }
        }
        let peaks = moment.machine.follower().peaks();
        for (axis, peaks) in record.axes.iter_mut().zip(peaks) {
            axis.follower = Some(axis.follower.unwrap_or_default().or(*peaks));
        }
        self.coast.tick(moment, record);
        if self.fault_hold.tick(moment, &mut record.figures) {
            record.note(t_s, EventKind::LetGo);
        }
        if !moment.drives_enabled {
            return;
        }
        self.off_command.tick(moment, self.run.speed_hz);
        let figures = &mut self.run.record.figures;
        let spread_deg = (high - low) * 360.0;
        if let Some(spread_worst_deg) = &mut figures.phase_spread_worst_deg {
            raise(spread_worst_deg, spread_deg);
        }
        if let Some(tilt_worst_mrad) = &mut figures.tilt_worst_mrad {
            moment.raise_tilt(tilt_worst_mrad);
        }
        // The plane is the closest to all errors: with up to six axes, none deviates from it by more than √6/2 of the spread.
        if let Some(warp_worst_deg) = &mut figures.warp_worst_deg
            && 1.25 * spread_deg > *warp_worst_deg
        {
            let machine = moment.machine;
            let warp_deg = machine.warp_deg(moment.actual_turns, moment.aim_turns);
            raise(warp_worst_deg, warp_deg);
        }
        if moment.telemetry.state == State::Run {
            self.running_ticks += 1;
            self.spread_squares += spread_deg * spread_deg;
        }
    }

    /// Records the limits that became active, with the beginning and the extent of each.
    fn limits(&mut self, moment: &Moment<'_>, t_s: f64) {
        let (motion, limits) = (&moment.telemetry.motion, &moment.telemetry.limits);
        // A speed inside a band differs from one outside. So the speed changes in the ticks in which it enters and leaves.
        match (motion.crossing_band, self.band) {
            (true, None) => self.band = Some((t_s, self.run.is_rising)),
            (false, Some((since_s, entered_upwards))) => {
                self.band = None;
                let in_s = t_s - since_s;
                let what = if self.run.is_rising == entered_upwards {
                    EventKind::BandCrossed {
                        in_s,
                        upwards: self.run.is_rising,
                    }
                } else {
                    EventKind::TurnedBackInBand {
                        in_s,
                        entered_upwards,
                    }
                };
                self.run.record.note(since_s, what);
            }
            _ => {}
        }
        match (motion.held_at_band, self.held) {
            (true, None) => self.held = Some(t_s),
            (false, Some(since_s)) => {
                self.held = None;
                self.run.record.note(
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
            self.run.record.note(
                since_s,
                EventKind::Lagged {
                    for_s: t_s - since_s,
                    worst_mps2,
                },
            );
        }
        let figures = &mut self.run.record.figures;
        figures.late_deadlines = limits.late_deadlines;
        if limits.missed_deadlines != figures.missed_deadlines {
            let deadlines = limits.missed_deadlines - figures.missed_deadlines;
            figures.missed_deadlines = limits.missed_deadlines;
            self.run.record.note(t_s, EventKind::Missed { deadlines });
        }
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
        if let Some(holding) = &mut self.run.record.figures.holding
            && steady
            && self.level > 0
        {
            holding.held_s += self.run.sample_s;
            let relative = (self.speed_mps2 / mps2(self.level) - 1.0).abs();
            raise(&mut holding.worst_relative_error, relative);
        }
    }

    /// Completes the record at the end of a run. Steps, phase errors and corrections are those of the last tick that was played, of
    /// `control_ticks`. `command_turns` are the commanded positions at its end. Without such a tick all are 0.
    pub fn finish(
        mut self,
        machine: &SimulatedMachine,
        control_ticks: u64,
        last: Option<&Telemetry>,
        command_turns: &[f64],
    ) -> RunRecord {
        if let Some(Event { t_s, what }) = self.corrections.finish() {
            self.run.record.note(t_s, what);
        }
        let (law, tick_hz) = (self.law, self.run.tick_hz);
        let top_mps2 = |top: Turns| amax_mps2(law, speed_hz(top, tick_hz));
        let sample = last.map(|last| Sample::new(0, last, 0, 0));
        let mut record = self.run.finish(sample.as_ref(), command_turns, top_mps2);
        record.events.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        record.control_ticks = control_ticks;
        record.is_held = self.fault_hold.is_on();
        record.is_coasting = self.coast.is_on();
        if self.running_ticks > 0 {
            record.figures.phase_spread_rms_deg =
                Some((self.spread_squares / self.running_ticks as f64).sqrt());
        }
        if let Some(own) = machine.record() {
            let mut own = own.clone_box();
            let latched = record.events.iter().filter_map(|event| match &event.what {
                EventKind::Fault { fault, .. } => Some(fault.kind),
                _ => None,
            });
            own.end(&latched.collect::<Vec<_>>());
            record.figures.machine_figures = own.figures();
            record.machine_warnings = own.warnings();
        }
        let (off_turns, stood) = (self.off_command.off_turns(), self.off_command.stood());
        for (i, (axis, simulated)) in record.axes.iter_mut().zip(&machine.axes).enumerate() {
            axis.actual_turns = Some(last.map_or(0.0, |_| simulated.turns()));
            axis.slipped_cycles = Some(axis.motor_slips - simulated.injected_cycles());
            axis.phase_error_peak_deg = last.map_or(0.0, |last| degrees(last.peak[i]));
            if let Some((used, at_hz)) = simulated.torque_used() {
                axis.pull_out_used = Some(used);
                axis.pull_out_used_at_hz = at_hz;
            }
            axis.off_command_turns = off_turns[i];
            axis.stood = stood[i];
        }
        record
    }
}

/// Returns the amplitude at a speed of the master, rev/s.
fn amax_mps2(law: SquareLaw, speed_hz: f64) -> f64 {
    law.amax_mps2(std::f64::consts::TAU * speed_hz)
}
