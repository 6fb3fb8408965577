//! One motor with its crank: its response to pulses or setpoints, and the passages of its index flag.
//!
//! A stepper counts rising edges, as its drive does, so that its phase is a whole number of steps. Above its pull-out torque it loses the
//! field. While the load is too large, it makes none of the commanded travel. It then locks to the field again, whole electrical cycles
//! (four full steps) behind, or ahead if the load drives it. This is the slowest way in which a real stepper loses steps, with the
//! smallest number of lost steps.
//!
//! A servo is at its setpoint, and moves evenly between setpoints. A servo that takes pulses counts them as a stepper's drive does, and
//! never slips.

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
    /// Last commanded position of a servo.
    commanded: Option<Phase>,
    /// Completed slip of the motor, in steps.
    slipped: i64,
    /// Slip since the motor lost the field, in steps, until the field holds it again.
    slipping: i64,
    overload: Overload,
    /// Largest fraction of the pull-out torque that was required, and the speed at that time, rev/s.
    torque_used: Option<(f64, f64)>,
    /// Commanded travel of the drive, turns; only if torque moves the cranks.
    commanded_turns: f64,
    /// Part of this travel that the drive gave up while it was off, turns.
    cleared_turns: f64,
    /// Whole electrical cycles slipped.
    lost_cycles: i64,
    travelled_turns: f64,
}

/// Motion of a crank within a tick.
#[derive(Clone, Copy)]
enum Turning<'a> {
    /// Evenly, over this number of cycles.
    Evenly(u32),
    /// According to the runs of the tick: edge by edge, or evenly for a servo.
    By(&'a Runs),
}

/// Effect of the load on a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overload {
    /// The motor keeps step.
    None,
    /// The load requires more torque than the motor can give.
    Driving,
    /// The load drives the motor with more torque than it can hold.
    Driven,
}

impl SimulatedAxis {
    /// Creates an axis at power-up. The loop assumes the crank at `home_turns`, and it is `start_turns` further. The crank makes `ratio`
    /// turns per master turn.
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

    /// Position of the crank, turns since power-up, in its own sense.
    pub fn turns(&self) -> f64 {
        self.origin_turns + self.travelled_turns
    }

    /// Crank turns per master turn.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Steps that the drive has counted since power-up, in its own sense; none if it takes no pulses.
    pub fn counted_steps(&self) -> Option<i64> {
        let takes_pulses = self.drive.takes_pulses();
        takes_pulses.then(|| self.pulses.counted())
    }

    /// Electrical cycles slipped since power-up: negative behind the field, positive ahead of it.
    pub fn slipped_cycles(&self) -> i64 {
        self.lost_cycles
    }

    /// Largest fraction of the pull-out torque that was required of the motor, and the speed at that time, rev/s.
    pub fn torque_used(&self) -> Option<(f64, f64)> {
        self.torque_used
    }

    /// Torque that a motion requires of the motor, N·m: its share of the load, its friction, and the inertia of its rotor.
    pub fn required_nm(&self, share_nm: f64, acceleration_rad_s2: f64, speed_hz: f64) -> f64 {
        // A machine at rest does not work against friction.
        let friction_nm = if speed_hz == 0.0 {
            0.0
        } else {
            self.friction_nm
        };
        share_nm + friction_nm + self.rotor_inertia_kgm2 * acceleration_rad_s2 * self.ratio
    }

    /// Compares the torque that the motion of this tick needs with the torque that the motor has. Returns the needed torque, N·m.
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

    /// Ends an overload: a motor that is off gives no torque.
    pub fn switch_off(&mut self) {
        self.overload = Overload::None;
    }

    /// Takes the command of the drive in a tick, for machines whose cranks are moved by torque.
    ///
    /// The count of pulses bounds the command to one step either way. Within that it follows `command_turns`, the phase from which the
    /// pulses are made. Whole steps that are sampled once per tick beat with the ticks. They excite the rotor at frequencies that the true
    /// edge times do not contain.
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

    /// Travel of the field since power-up, turns: the commanded travel less the part that the drive gave up while it was off.
    fn field_turns(&self) -> f64 {
        self.commanded_turns - self.cleared_turns
    }

    /// Takes over the position that the crank has reached in a tick of `cycles`. Returns the events at its index sensor, if there are
    /// any. Their times are those of a crank that turns evenly.
    pub fn moved(&mut self, turns: f64, cycles: u32, energised: bool) -> Option<Passed> {
        let passed = self.moved_under(turns, self.field_turns(), cycles, energised);
        if self.drive.follows_rotor(energised) {
            self.cleared_turns = self.commanded_turns - self.travelled_turns;
        }
        passed
    }

    /// Does the same as [`Self::moved`] for a field that has travelled `field_turns` since power-up, whatever the drive's command was.
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

    /// Moves the crank back at once, without its sensor detecting the motion.
    pub fn fall_back(&mut self, turns: f64) {
        self.travelled_turns -= turns;
    }

    /// Adds index pulses that no flag causes.
    pub fn add_pulses(&mut self, extra: Extra) {
        if let Some(flag) = &mut self.flag {
            flag.add(extra);
        }
    }

    /// Flag of the index sensor, if the axis has one.
    pub fn flag(&self) -> Option<&Flag> {
        self.flag.as_ref()
    }

    /// Travel of the crank since power-up, turns.
    pub fn travelled_turns(&self) -> f64 {
        self.travelled_turns
    }

    /// Steps, or encoder counts, per turn of the crank.
    pub fn steps_per_turn(&self) -> f64 {
        self.steps_per_turn
    }

    /// True if the motor is mounted in the reversed sense.
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    /// Drive of the axis.
    pub fn drive(&self) -> &AxisDrive {
        &self.drive
    }

    /// Length of an electrical cycle of the stepper, turns; none for a servo.
    pub fn cycle_turns(&self) -> Option<f64> {
        let cycle_steps = self.drive.cycle_steps()?;
        Some(cycle_steps as f64 / self.steps_per_turn)
    }

    /// Effect of the load on the motor, from the last comparison of torques.
    pub fn overload(&self) -> Overload {
        self.overload
    }

    /// Travel of a servo's setpoint, turns. The first setpoint gives the position at which the loop assumes the crank.
    fn follow(&mut self, setpoint: &Setpoint) -> f64 {
        let position = self.own(setpoint).position;
        let commanded = self.commanded.replace(position).unwrap_or(position);
        turns(position.since(commanded))
    }

    /// Converts a setpoint to the axis's own sense.
    fn own(&self, setpoint: &Setpoint) -> Setpoint {
        if self.reversed {
            setpoint.reversed()
        } else {
            *setpoint
        }
    }

    /// Plays one tick. Returns the events at the index sensor in it, if there are any.
    #[inline(always)] // Inlined, because axes are independent of each other and the division is slow.
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
                self.slipped -= counted; // the field is off: the crank keeps its position
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

    /// Returns the events at the sensor on the travel from `before`, if there are any. If pulses moved the crank forward, a rise is at the
    /// edge that brought the flag. All other times are those of a crank that turns evenly.
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

    /// Applies a slip to `counted` steps of the field.
    #[cold]
    fn slip(&mut self, counted: i64) {
        let Some(cycle_steps) = self.drive.cycle_steps() else {
            return;
        };
        match self.overload {
            Overload::Driving => self.slipping -= counted,
            Overload::Driven => self.slipping += counted,
            Overload::None => {
                // The nearest position at which the field holds the rotor again.
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
        // While it slips, the rotor stands against the field, or runs at twice the speed. Only complete cycles are counted.
        let whole = self.slipping / cycle_steps * cycle_steps;
        self.lost_cycles += whole / cycle_steps;
        self.slipped += whole;
        self.slipping -= whole;
    }

    /// Returns the cycle of the rising edge that took the crank to `place`, or beyond it.
    fn when(&self, runs: &Runs, place: f64) -> u32 {
        let beyond = ((self.turns() - place) * self.steps_per_turn + 1e-6).floor() as i64;
        self.pulses.cycle_before(runs, beyond)
    }
}
