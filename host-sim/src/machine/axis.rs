//! One motor with its crank: what it makes of pulses or setpoints, and when its index passes.
//!
//! A stepper counts rising edges, as its drive does, so that its phase is a whole number of steps. Past
//! its pull-out torque it loses the field: for as long as the load is too large it makes none of the
//! commanded travel, and catches the field again whole electrical cycles (four full steps) behind;
//! or ahead, where the load drives it. That is the slowest way to lose steps there is in reality, and
//! the smallest number of lost steps.
//!
//! A servo is where its setpoint is, moving evenly between setpoints. One that takes pulses counts them as a stepper's drive
//! does, and slips never.

use cophase_core::pulse::Runs;
use cophase_core::servo::Setpoint;
use cophase_core::settings::AxisSettings;
use cophase_core::units::Phase;

use super::drive::AxisDrive;
use super::flag::{Extra, Flag, Met};
use super::index::Passed;
use super::played::Plan;
use super::pulse_counter::PulseCounter;
use super::rotors::DriveCommand;
use crate::units::{nearest, nm, turns};

/// One motor with its crank.
#[derive(Clone, Debug)]
pub struct SimulatedAxis {
    drive: AxisDrive,
    reversed: bool,
    steps_per_turn: f64,
    rotor_inertia_kgm2: f64,
    friction_nm: f64,
    ratio: f64,
    /// Commanded phase at step 0, turns.
    home_turns: f64,
    /// Crank phase at step 0, turns.
    origin_turns: f64,
    flag: Option<Flag>,
    pulses: PulseCounter,
    /// Where a servo was commanded to be last.
    commanded: Option<Phase>,
    /// What the motor has slipped, in steps.
    slipped: i64,
    /// What it is slipping right now, in steps, since it lost the field.
    slipping: i64,
    overload: Overload,
    /// Largest part of the pull-out torque that was required, and at which speed.
    torque_used: Option<(f64, f64)>,
    /// How far the drive was commanded to go, turns; where torque moves the cranks.
    commanded_turns: f64,
    /// What of that the drive gave up while it was off, turns.
    cleared_turns: f64,
    /// Whole electrical cycles slipped.
    lost_cycles: i64,
    travelled_turns: f64,
}

/// How a crank turns within a tick.
#[derive(Clone, Copy)]
enum Turning<'a> {
    /// Evenly, in so many cycles.
    Evenly(u32),
    /// As the runs of the tick have it: by their edges, or evenly where it is a servo's.
    By(&'a Runs),
}

/// What the load makes of a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overload {
    /// It keeps step.
    None,
    /// The motor would have to give more than it can.
    Driving,
    /// The load drives the motor with more than it can hold.
    Driven,
}

impl SimulatedAxis {
    /// At power-up. The loop believes the crank at `home_turns`, and it is `start_turns` further. It makes `ratio` turns per master turn.
    pub fn new(
        settings: &AxisSettings,
        home_turns: f64,
        ratio: f64,
        drive: AxisDrive,
        start_turns: f64,
        friction_nm: f64,
        flag: Option<Flag>,
    ) -> Self {
        Self {
            drive,
            reversed: settings.reversed,
            steps_per_turn: f64::from(settings.steps_per_turn),
            rotor_inertia_kgm2: settings.rotor_inertia_kgm2,
            friction_nm,
            ratio,
            home_turns,
            origin_turns: home_turns + start_turns,
            flag,
            pulses: PulseCounter::new(),
            commanded: None,
            slipped: 0,
            slipping: 0,
            overload: Overload::None,
            torque_used: None,
            commanded_turns: 0.0,
            cleared_turns: 0.0,
            lost_cycles: 0,
            travelled_turns: 0.0,
        }
    }

    /// Where the crank is, turns since power-up, in its own sense.
    pub fn turns(&self) -> f64 {
        self.origin_turns + self.travelled_turns
    }

    /// Crank turns per master turn.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Steps that its drive has counted since power-up, in its own sense; none if it takes no pulses.
    pub fn counted_steps(&self) -> Option<i64> {
        let takes_pulses = self.drive.takes_pulses();
        takes_pulses.then(|| self.pulses.counted())
    }

    /// Electrical cycles slipped since power-up: negative behind, positive ahead of the field.
    pub fn slipped_cycles(&self) -> i64 {
        self.lost_cycles
    }

    /// The largest part of its pull-out torque that was required of the motor, and at which speed, rev/s.
    pub fn torque_used(&self) -> Option<(f64, f64)> {
        self.torque_used
    }

    /// Torque that a motion requires of the motor, N·m: its share of the load's, its friction, and what turns its rotor.
    pub fn required_nm(&self, share_nm: f64, acceleration_rad_s2: f64, speed_hz: f64) -> f64 {
        // A machine that stands does not work against friction.
        let friction_nm = if speed_hz == 0.0 {
            0.0
        } else {
            self.friction_nm
        };
        share_nm + friction_nm + self.rotor_inertia_kgm2 * acceleration_rad_s2 * self.ratio
    }

    /// Compares what this tick's motion needs with what the motor has; what it needs, N·m.
    pub fn load(&mut self, share_nm: f64, acceleration_rad_s2: f64, speed_hz: f64) -> f64 {
        let needed = self.required_nm(share_nm, acceleration_rad_s2, speed_hz);
        let AxisDrive::Stepper { pull_out, .. } = &self.drive else {
            return needed;
        };
        let most = pull_out.torque_nm(speed_hz * self.ratio);
        let used = needed.abs() / most;
        if self.torque_used.is_none_or(|(worst, _)| used > worst) {
            self.torque_used = Some((used, speed_hz * self.ratio));
        }
        self.overload = if needed > most {
            Overload::Driving
        } else if needed < -most {
            Overload::Driven
        } else {
            Overload::None
        };
        needed
    }

    /// Takes the command of the drive in a tick: for machines whose cranks move by torque, and not as commanded.
    ///
    /// Pulses have the command where their count is, and in between where the phase is that they are made of,
    /// `command_turns`: seen at ticks alone, steps would beat with these, and shake the rotor at frequencies that
    /// edges, which have their own times, do not have.
    pub fn command(
        &mut self,
        plan: &mut Plan<'_>,
        setpoint: &Setpoint,
        command_turns: f64,
    ) -> DriveCommand {
        let torque_nm = if self.drive.takes_pulses() {
            self.pulses.count(plan.runs, &mut plan.tally);
            let counted = self.pulses.counted() as f64;
            let commanded = (command_turns - self.home_turns) * self.steps_per_turn;
            self.commanded_turns =
                commanded.clamp(counted - 1.0, counted + 1.0) / self.steps_per_turn;
            0.0
        } else {
            self.commanded_turns += self.follow(setpoint);
            nm(self.own(setpoint).torque)
        };
        DriveCommand {
            turns: self.origin_turns + self.field_turns(),
            torque_nm,
        }
    }

    /// How far the field went from where it was at power-up, turns: as commanded, less what a drive that was off gave up.
    fn field_turns(&self) -> f64 {
        self.commanded_turns - self.cleared_turns
    }

    /// Takes over where the crank has come to in a tick of `cycles`; the cycle at which the index flag came, if it
    /// did, as if it had turned evenly.
    pub fn moved(&mut self, turns: f64, cycles: u32, energised: bool) -> Option<Passed> {
        let passed = self.moved_under(turns, self.field_turns(), cycles, energised);
        if self.drive.follows_rotor(energised) {
            self.cleared_turns = self.commanded_turns - self.travelled_turns;
        }
        passed
    }

    /// The same, where the field went `field_turns` from where it was at power-up, whatever the drive's command was.
    pub fn moved_under(
        &mut self,
        turns: f64,
        field_turns: f64,
        cycles: u32,
        energised: bool,
    ) -> Option<Passed> {
        let before = self.turns();
        self.travelled_turns = turns - self.origin_turns;
        if let Some(cycle_steps) = self.drive.cycle_steps() {
            let behind = (self.travelled_turns - field_turns) * self.steps_per_turn;
            self.lost_cycles = nearest(behind / cycle_steps as f64);
        }
        if let Some(error) = self.drive.following_error() {
            error.update(field_turns - self.travelled_turns, energised);
        }
        self.pass(before, Turning::Evenly(cycles))
    }

    /// Puts the crank elsewhere at once: it falls back without its sensor seeing it.
    pub fn fall_back(&mut self, turns: f64) {
        self.travelled_turns -= turns;
    }

    /// Has index pulses come that no flag makes.
    pub fn add_pulses(&mut self, extra: Extra) {
        if let Some(flag) = &mut self.flag {
            flag.add(extra);
        }
    }

    /// What its index sensor sees, if it has one.
    pub fn flag(&self) -> Option<&Flag> {
        self.flag.as_ref()
    }

    /// How far the crank has gone since power-up, turns.
    pub fn travelled_turns(&self) -> f64 {
        self.travelled_turns
    }

    /// Steps, or counts, to a turn of the crank.
    pub fn steps_per_turn(&self) -> f64 {
        self.steps_per_turn
    }

    /// Whether the motor is mounted the other way round.
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    /// The drive.
    pub fn drive(&self) -> &AxisDrive {
        &self.drive
    }

    /// An electrical cycle of its stepper, turns; a servo has none.
    pub fn cycle_turns(&self) -> Option<f64> {
        let cycle_steps = self.drive.cycle_steps()?;
        Some(cycle_steps as f64 / self.steps_per_turn)
    }

    /// What the load makes of the motor, by what was last compared.
    pub fn overload(&self) -> Overload {
        self.overload
    }

    /// How far a servo's setpoint has moved, turns; the first says where the loop believes the crank to be.
    fn follow(&mut self, setpoint: &Setpoint) -> f64 {
        let position = self.own(setpoint).position;
        let commanded = self.commanded.replace(position).unwrap_or(position);
        turns(position.since(commanded))
    }

    /// A setpoint in the axis's own sense.
    fn own(&self, setpoint: &Setpoint) -> Setpoint {
        if self.reversed {
            setpoint.reversed()
        } else {
            *setpoint
        }
    }

    /// Plays one tick; what came before the index sensor in it, if anything did.
    #[inline(always)] // One axis is independent of the next, and its division takes long.
    pub fn play(
        &mut self,
        plan: &mut Plan<'_>,
        setpoint: &Setpoint,
        drives_enabled: bool,
    ) -> Option<Passed> {
        let before = self.turns();
        if self.drive.takes_pulses() {
            let counted = self.pulses.count(plan.runs, &mut plan.tally);
            if !drives_enabled {
                self.slipped -= counted; // the field is off: the crank stays where it is
            } else if self.overload != Overload::None || self.slipping != 0 {
                self.slip(counted);
            }
            let made = self.pulses.counted() + self.slipped;
            self.travelled_turns = made as f64 / self.steps_per_turn;
        } else {
            let commanded_turns = self.follow(setpoint);
            if drives_enabled {
                self.travelled_turns += commanded_turns;
            }
        }
        self.pass(before, Turning::By(plan.runs))
    }

    /// What the sensor sees of the way from `before`, if anything: as if the crank had turned evenly, or, where edges took it
    /// there, at the very edge that brought the flag.
    #[inline]
    fn pass(&mut self, before: f64, turning: Turning<'_>) -> Option<Passed> {
        let after = self.turns();
        let met = self.flag.as_mut()?.meet(before, after)?;
        Some(self.passed(&met, before, turning))
    }

    #[cold]
    fn passed(&self, met: &Met, before: f64, turning: Turning<'_>) -> Passed {
        let after = self.turns();
        let (cycles, edges) = match turning {
            Turning::Evenly(cycles) => (cycles, None),
            Turning::By(runs) => {
                let cycles = runs.iter().map(|run| run.cycles()).sum();
                (cycles, self.drive.takes_pulses().then_some(runs))
            }
        };
        let evenly = |place: f64| {
            let part = (place - before) / (after - before);
            (part * f64::from(cycles)) as u32
        };
        Passed {
            rise: met.rise.map(|place| match edges {
                Some(runs) if after > before => self.when(runs, place),
                _ => evenly(place),
            }),
            fall: met.fall.map(evenly),
            extra: met.extra.map(|part| (part * f64::from(cycles)) as u32),
        }
    }

    /// What the motor makes of `counted` steps of its field.
    #[cold]
    fn slip(&mut self, counted: i64) {
        let Some(cycle_steps) = self.drive.cycle_steps() else {
            return;
        };
        match self.overload {
            Overload::Driving => self.slipping -= counted,
            Overload::Driven => self.slipping += counted,
            Overload::None => {
                // The nearest place where the field holds the rotor again.
                let rest = self.slipping.rem_euclid(cycle_steps);
                let nearest = if 2 * rest >= cycle_steps {
                    cycle_steps - rest
                } else {
                    -rest
                };
                self.slipping += nearest;
                self.lost_cycles += self.slipping / cycle_steps;
                self.slipped += self.slipping;
                self.slipping = 0;
                return;
            }
        }
        // While slipping the rotor stands (or runs at twice the speed) against the field; only whole
        // cycles are booked, once they are complete.
        let whole = self.slipping / cycle_steps * cycle_steps;
        self.lost_cycles += whole / cycle_steps;
        self.slipped += whole;
        self.slipping -= whole;
    }

    /// Cycle of the rising edge that took the crank to `place`, or beyond it.
    fn when(&self, runs: &Runs, place: f64) -> u32 {
        let beyond = ((self.turns() - place) * self.steps_per_turn + 1e-6).floor() as i64;
        self.pulses.cycle_before(runs, beyond)
    }
}
