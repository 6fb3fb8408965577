//! One motor with its crank: its response to pulses or setpoints, and the passages of its index flag.
//!
//! The command of a drive moves its *field*: the position at which the motor would hold its rotor. The crank is behind its motor by the
//! slip on the shaft. Travel that a fault takes from the field, the rotor or the crank is kept apart from the command, so that a crank
//! without a fault is exactly where its command is.
//!
//! A stepper counts rising edges, as its drive does, so that its phase is a whole number of steps. Above its pull-out torque, or while its
//! crank is stuck, it loses the field and makes none of the commanded travel. It then locks to the field again, whole electrical cycles
//! (four full steps) behind, or ahead if the load drives it. This is the slowest way in which a real stepper loses steps, with the
//! smallest number of lost steps.
//!
//! A servo is at its setpoint, and moves evenly between setpoints. A servo that takes pulses counts them as a stepper's drive does, and
//! never slips. A servo whose crank was stuck continues from the position at which it stands.

use cophase_core::pulse::{Runs, StepsPerTurn};
use cophase_core::servo::Setpoint;
use cophase_core::settings::AxisSettings;
use cophase_core::units::Phase;
use cophase_scene::units::{nearest, nm, turns};

use super::at_crank::AtCrank;
use super::drive::AxisDrive;
use super::flag::{Extra, Flag, Met};
use super::index::Passed;
use super::played::Plan;
use super::pull_out::PullOut;
use super::pulse_counter::PulseCounter;

/// One motor with its crank.
#[derive(Clone, Debug)]
pub struct SimulatedAxis {
    drive: AxisDrive,
    reversed: bool,
    /// Steps per turn of the crank.
    steps_per_turn: StepsPerTurn,
    /// Steps with which the drive itself makes a turn of the crank; those of the settings, unless its switches differ.
    drive_steps_per_turn: f64,
    /// Turns of the motor per turn of the crank.
    motor_turns: f64,
    /// Inertia of the motor at the crank.
    rotor_inertia_kgm2: f64,
    friction_nm: f64,
    /// Torque that a stepper can give at each speed.
    pull_out: PullOut,
    ratio: f64,
    /// Commanded phase at step 0, turns.
    home_turns: f64,
    /// Crank phase at step 0, turns.
    origin_turns: f64,
    flag: Option<Flag>,
    pulses: PulseCounter,
    /// Last commanded position of a servo.
    commanded: Option<Phase>,
    overload: Overload,
    /// True while the crank is stuck, and its motor with it.
    stuck: bool,
    /// True from the loss of the field until the field holds the rotor again.
    is_out_of_step: bool,
    /// Largest fraction of the pull-out torque that was required, and the speed at that time, rev/s.
    torque_used: Option<(f64, f64)>,
    /// Commanded travel of the drive, turns.
    commanded_turns: f64,
    /// Part of this travel that the field has not made, turns: while the drive was off, or by a fault.
    cleared_turns: f64,
    /// Travel of the field that the rotor has not made, turns; negative if the load drove it further. 0 if torque moves the cranks.
    dropped_turns: f64,
    /// Slip of the crank on its motor's shaft, turns: positive behind.
    slipped_turns: f64,
    /// Whole electrical cycles slipped.
    lost_cycles: i64,
    injected_cycles: i64,
    travelled_turns: f64,
}

/// Travel of a drive and its crank in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Travel {
    /// Travel of the command, turns.
    pub commanded_turns: f64,
    /// Travel of the field, turns. It differs from that of the command under a disturbance.
    pub field_turns: f64,
    /// Slip of the crank on its motor's shaft, turns: positive backward.
    pub slip_turns: f64,
    /// Torque that a servo is commanded to add, N·m.
    pub torque_nm: f64,
}

impl Travel {
    /// Returns the travel of a drive that follows its command.
    const fn commanded(turns: f64, torque_nm: f64) -> Self {
        Self {
            commanded_turns: turns,
            field_turns: turns,
            slip_turns: 0.0,
            torque_nm,
        }
    }
}

/// Motion of a crank within a tick.
#[derive(Clone, Copy)]
enum Turning<'a> {
    /// Evenly, over this number of cycles.
    Evenly(u32),
    /// By the runs of the tick, which command these turns: edge by edge if the crank follows pulses, or else evenly.
    By(&'a Runs, f64),
}

/// Difference, in steps, up to which the travel of a crank is that of its pulses.
const ROUNDING_STEPS: f64 = 1e-6;

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
        motor: &AtCrank,
        start_turns: f64,
        friction_nm: f64,
    ) -> Self {
        Self {
            drive,
            reversed: settings.reversed,
            steps_per_turn: settings.steps_per_crank_turn(),
            drive_steps_per_turn: settings.steps_per_crank_turn().to_f64(),
            motor_turns: motor.motor_turns,
            rotor_inertia_kgm2: motor.rotor_inertia_kgm2,
            friction_nm,
            pull_out: motor.pull_out.clone(),
            ratio,
            home_turns,
            origin_turns: home_turns + start_turns,
            flag: None,
            pulses: PulseCounter::new(),
            commanded: None,
            overload: Overload::None,
            stuck: false,
            is_out_of_step: false,
            torque_used: None,
            commanded_turns: 0.0,
            cleared_turns: 0.0,
            dropped_turns: 0.0,
            slipped_turns: 0.0,
            lost_cycles: 0,
            injected_cycles: 0,
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
        let takes_pulses = self.drive.kind().takes_pulses();
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

    /// Torque of the motor's own shaft, N·m, from that at the crank.
    pub fn torque_at_motor_nm(&self, at_crank_nm: f64) -> f64 {
        at_crank_nm / self.motor_turns
    }

    /// Torque that a motion requires of the motor, N·m at the crank: its share of the load, its friction, and the inertia of its rotor.
    pub fn required_nm(&self, share_nm: f64, acceleration_rad_s2: f64, speed_hz: f64) -> f64 {
        // A machine at rest does not work against friction.
        let friction_nm = if speed_hz == 0.0 {
            0.0
        } else {
            self.friction_nm
        };
        share_nm + friction_nm + self.rotor_inertia_kgm2 * acceleration_rad_s2 * self.ratio
    }

    /// Compares the torque that the motion of this tick needs with the torque that the motor has. Returns the needed torque, N·m at the
    /// crank.
    pub fn load(&mut self, share_nm: f64, acceleration_rad_s2: f64, speed_hz: f64) -> f64 {
        let needed = self.required_nm(share_nm, acceleration_rad_s2, speed_hz);
        if !self.drive.kind().is_open_loop() {
            return needed;
        }
        let max = self.pull_out.torque_nm(speed_hz * self.ratio);
        let used = needed.abs() / max;
        if self.torque_used.is_none_or(|(worst, _)| used > worst) {
            self.torque_used = Some((used, speed_hz * self.ratio));
        }
        self.overload = if needed > max {
            Overload::Driving
        } else if needed < -max {
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
    ) -> Travel {
        let before = self.commanded_turns;
        let torque_nm = if self.drive.kind().takes_pulses() {
            self.pulses.count(plan.runs, &mut plan.tally);
            let counted = self.pulses.counted() as f64;
            let commanded = (command_turns - self.home_turns) * self.steps_per_turn();
            let commanded = commanded.clamp(counted - 1.0, counted + 1.0);
            self.commanded_turns = self.steps_per_turn.turns_of(commanded);
            0.0
        } else {
            self.commanded_turns += self.follow(setpoint);
            nm(self.own(setpoint).torque) * self.motor_turns
        };
        Travel::commanded(self.commanded_turns - before, torque_nm)
    }

    /// Takes the command of the drive in a tick, for machines whose cranks are at the positions of their motors.
    #[inline]
    pub fn take(&mut self, plan: &mut Plan<'_>, setpoint: &Setpoint) -> Travel {
        let before = self.commanded_turns;
        if self.drive.kind().takes_pulses() {
            self.pulses.count(plan.runs, &mut plan.tally);
            let counted = self.pulses.counted() as f64;
            self.commanded_turns = self.steps_per_turn.turns_of(counted);
        } else {
            self.commanded_turns += self.follow(setpoint);
        }
        Travel::commanded(self.commanded_turns - before, 0.0)
    }

    /// Electrical cycles by which faults of the scene made field and rotor fall back.
    pub fn injected_cycles(&self) -> i64 {
        self.injected_cycles
    }

    /// Applies a disturbance to the field, beside its `travel` in the tick: the part of the commanded travel that it does not make, and
    /// the electrical cycles by which it and its rotor fall back at once.
    pub fn disturb(&mut self, travel: &Travel, lost_cycles: i64, stuck: bool) {
        let lost_turns = lost_cycles as f64 * self.cycle_turns().unwrap_or(0.0);
        self.injected_cycles += lost_cycles;
        self.cleared_turns += travel.commanded_turns - travel.field_turns + lost_turns;
        if lost_turns > 0.0 {
            // The sensor does not detect this motion.
            self.travelled_turns -= lost_turns;
        }
        self.stuck = stuck;
    }

    /// Slips the crank on its motor's shaft, for machines whose cranks are moved by torque.
    pub fn slip(&mut self, turns: f64) {
        self.slipped_turns += turns;
    }

    /// Position at which the field would hold the crank, turns since power-up.
    pub fn field_turns(&self) -> f64 {
        self.origin_turns + self.field_travel_turns()
    }

    fn field_travel_turns(&self) -> f64 {
        self.commanded_turns - self.cleared_turns - self.slipped_turns
    }

    /// Takes over the position that the crank has reached in a tick of `cycles`. Returns the events at its index sensor, if there are
    /// any. Their times are those of a crank that turns evenly.
    pub fn moved(&mut self, turns: f64, cycles: u32, energised: bool) -> Option<Passed> {
        let before = self.turns();
        self.travelled_turns = turns - self.origin_turns;
        let behind_turns = self.field_travel_turns() - self.travelled_turns;
        self.count_lost_cycles(behind_turns);
        self.drive.monitor(behind_turns, energised);
        if self.drive.follows_rotor(energised) {
            self.cleared_turns = self.commanded_turns - (self.travelled_turns + self.slipped_turns);
        }
        self.pass(before, Turning::Evenly(cycles))
    }

    /// Counts the electrical cycles of a stepper in the travel by which its rotor is behind the field.
    fn count_lost_cycles(&mut self, behind_turns: f64) {
        if let Some(cycle_turns) = self.cycle_turns() {
            self.lost_cycles = nearest(-behind_turns / cycle_turns);
        }
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

    /// Turns of the crank that its motor's encoder counts. Slip of the crank on its shaft does not move the motor.
    pub fn counted_turns(&self) -> f64 {
        self.travelled_turns + self.slipped_turns
    }

    /// Steps with which the drive itself makes a turn of the crank.
    pub fn drive_steps_per_turn(&self) -> f64 {
        self.drive_steps_per_turn
    }

    /// Sets the flag that the axis has for its index sensor.
    #[must_use]
    pub fn with_flag(mut self, flag: Option<Flag>) -> Self {
        self.flag = flag;
        self
    }

    /// Sets the steps with which the drive makes a turn of its motor.
    #[must_use]
    pub fn with_drive_steps(mut self, steps_per_turn: Option<u32>) -> Self {
        if let Some(steps) = steps_per_turn {
            self.drive_steps_per_turn = f64::from(steps) * self.motor_turns;
        }
        self
    }

    /// Steps, or encoder counts, per turn of the crank.
    pub fn steps_per_turn(&self) -> f64 {
        self.steps_per_turn.to_f64()
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
        Some(self.steps_per_turn.turns_of(f64::from(cycle_steps)))
    }

    /// Returns the travel of a servo's setpoint, turns. The first setpoint gives the position at which the loop assumes the crank.
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

    /// Moves the crank in a tick with its motor. Returns the events at the index sensor in it, if there are any.
    #[inline(always)] // Inlined, because axes are independent of each other and the division is slow.
    pub fn play(&mut self, travel: &Travel, runs: &Runs, energised: bool) -> Option<Passed> {
        let before = self.turns();
        if !energised {
            // A drive that is off has no field: its crank stands, and its command is discarded.
            self.cleared_turns += travel.field_turns;
            self.slipped_turns += travel.slip_turns;
            self.travelled_turns -= travel.slip_turns;
        } else {
            if self.overload != Overload::None || self.stuck || self.is_out_of_step {
                self.drop_travel(travel.field_turns);
            }
            self.slipped_turns += travel.slip_turns;
            self.travelled_turns = self.field_travel_turns() - self.dropped_turns;
        }
        self.drive.monitor(self.dropped_turns, energised);
        self.pass(before, Turning::By(runs, travel.commanded_turns))
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
            Turning::By(runs, turns) => {
                let cycles = runs.iter().map(|run| run.cycles()).sum();
                let off_steps = (after - before - turns) * self.steps_per_turn();
                let by_pulses =
                    self.drive.kind().takes_pulses() && off_steps.abs() < ROUNDING_STEPS;
                (cycles, by_pulses.then_some(runs))
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

    /// Moves a field that does not hold its rotor, or makes it hold the rotor again.
    #[cold]
    fn drop_travel(&mut self, field_turns: f64) {
        let overload = if self.stuck {
            Overload::Driving
        } else {
            self.overload
        };
        match (overload, self.cycle_turns()) {
            (Overload::Driving, _) => self.dropped_turns += field_turns,
            (Overload::Driven, _) => self.dropped_turns -= field_turns,
            // Equivalent positions of a stepper's field are whole cycles apart. It locks to the nearest one.
            (Overload::None, Some(cycle_turns)) => {
                self.dropped_turns = (self.dropped_turns / cycle_turns).round() * cycle_turns;
            }
            (Overload::None, None) => self.cleared_turns += std::mem::take(&mut self.dropped_turns),
        }
        self.is_out_of_step = overload != Overload::None;
        self.count_lost_cycles(self.dropped_turns);
    }

    /// Returns the cycle of the rising edge that took the crank to `place`, or beyond it.
    fn when(&self, runs: &Runs, place: f64) -> u32 {
        let beyond =
            ((self.turns() - place) * self.steps_per_turn() + ROUNDING_STEPS).floor() as i64;
        self.pulses.cycle_before(runs, beyond)
    }
}
