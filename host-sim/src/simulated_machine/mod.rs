//! Simulated machines: motion of the drives, the cranks and the platform that the loop's output causes.
//!
//! On the *kinematic* model level every crank is where commanded. The *quasi-static* model level compares the torque that the motion
//! needs with the torque that each motor has. A stepper slips if more is required of it. On the *rigid*, *phased* and *elastic* model
//! levels ([`Rotors`]) torque moves the cranks. The machine's [`Follower`] moves with the phases of the cranks, by geometry or by equations
//! of its own, except where the equations of motion determine its pose.
//!
//! The two lowest levels neglect the effect of inertia on the motion: a crank lags by whole slips or not at all. They also neglect how
//! the torque of the other axes changes after one axis has slipped.

mod broken;
mod faulted_drive;
mod instant;
mod level;
mod required;
mod rotors;
mod sensors;
mod torque;

pub use broken::{Broken, Cause};
pub use instant::{Forces, Instant};
pub use rotors::{DriveCommand, Rotors};

use std::sync::Arc;

use cophase_methods::Scheme;
use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;

use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::{
    AtCrank, AxisDrive, Disturbance, DriveModel, Flag, Passages, Played, SimulatedAxis,
};
use crate::dynamics::plant::{Record, Tick};
use crate::dynamics::{Corners, FrameMotion};
use crate::machines::follower::{Follower, RunStart, ShaftTick};
use crate::pose::Pose;
use faulted_drive::{disturb, disturb_rotors};

/// Time for which an index line stays high, s: a typical flag width. A machine whose index filter needs longer levels gets wider
/// flags.
const FLAG_S: f64 = 20e-6;

/// Simulated machine of a scene.
#[derive(Clone, Debug)]
pub struct SimulatedMachine {
    /// Motors and their cranks.
    pub axes: Axes<SimulatedAxis>,
    /// Part that the axes move where they stand as commanded, and its geometry.
    follower: Box<dyn Follower>,
    /// Places of the axes.
    corners: Corners,
    mount_radius_m: f64,
    /// Time for which an index line stays high, cycles.
    pub index_cycles: u32,
    tick_s: f64,
    tick_cycles: u32,
    torques: bool,
    ticks: u64,
    /// Commanded speed of the master in the last tick, rad/s.
    omega_before: f64,
    /// Required torque of each motor, N·m, on the model level that compares torques.
    required_nm: Option<Axes<f64>>,
    /// Equations of motion, if torque moves the cranks.
    rotors: Option<Rotors>,
    /// Figures of the machine's own.
    record: Option<Box<dyn Record>>,
    /// Motors whose encoders are read, one bit each.
    has_encoder: u8,
}

impl SimulatedMachine {
    /// Creates the machine of a scene, at power-up.
    ///
    /// # Errors
    /// Fails if no machine can be created from the numbers in the scene.
    pub fn new(checked: &Checked) -> Result<Self, SceneError> {
        let settings = &checked.settings;
        let in_common = &checked.scene.axes;
        let make = |i: usize| {
            let axis = checked.scene.resolved(i);
            let own = &settings.axes[i];
            let motor = AtCrank::new(&checked.scene, i);
            let window_deg = (DriveModel::for_drive(axis.drive).window_deg)(in_common);
            let window_turns = window_deg.map(|deg| deg / 360.0);
            let drive = AxisDrive::new(own.drive, own.cycle_steps, window_turns);
            let start_turns = axis.own.start_deg / 360.0;
            let home_turns = settings.home_turns(own);
            let ratio = own.follower.max_ratio(&settings.cams);
            SimulatedAxis::new(
                own,
                home_turns,
                ratio,
                drive,
                &motor,
                start_turns,
                axis.friction_nm,
            )
            .with_flag(Flag::new(
                own,
                &checked.scene.noise,
                i,
                checked.moves_by_torque(),
            ))
            .with_drive_steps(axis.own.drive_steps_per_turn)
        };
        let axes = per_axis(settings.axes.len(), make);
        let rotors = torque::rotors(checked, &axes)?;
        let turns: Axes<f64> = axes.iter().map(SimulatedAxis::turns).collect();
        let tick_s = 1.0 / f64::from(settings.tick_hz);
        let tick_cycles = settings.tick_cycles();
        let flag_cycles = (FLAG_S * f64::from(settings.clock_hz)).round() as u32;
        Ok(Self {
            has_encoder: (settings.axes.iter().rev())
                .fold(0, |bits, axis| bits << 1 | u8::from(axis.encoder)),
            follower: Arc::clone(&checked.machine).follower(&RunStart {
                level: checked.fidelity,
                tick_s,
                chosen: checked.chosen(),
                turns: &turns,
                shifts_turns: (settings.axes.iter())
                    .map(|axis| axis.follower.shift_turns())
                    .collect(),
            })?,
            record: Arc::clone(&checked.machine).record(),
            rotors,
            axes,
            corners: Corners::new(settings.axes.len(), checked.machine.mount_radius_m()),
            mount_radius_m: checked.machine.mount_radius_m(),
            index_cycles: flag_cycles.max(2 * settings.index_width_cycles()),
            tick_s,
            tick_cycles,
            torques: checked.fidelity == Fidelity::QuasiStatic,
            ticks: 0,
            omega_before: 0.0,
            required_nm: None,
        })
    }

    /// Cycles of the step clock per control tick.
    pub const fn tick_cycles(&self) -> u32 {
        self.tick_cycles
    }

    /// Mean speed and acceleration of the cranks, rad/s and rad/s², if torque moves them.
    pub fn motion(&self) -> Option<(f64, f64)> {
        self.rotors.as_ref().map(Rotors::motion)
    }

    /// Torque that motor `i` gives, or that is required of it, N·m; 0 with the drives off, and none on a model level without torque.
    pub fn motor_torque_nm(&self, i: usize) -> Option<f64> {
        let required = self.required_nm.as_ref().map(|required| required[i]);
        let at_crank_nm = required.or_else(|| self.torques_nm().map(|torques| torques[i]))?;
        Some(self.axes[i].torque_at_motor_nm(at_crank_nm))
    }

    /// Torque of each motor at its crank at the end of the tick, N·m, if torque moves the cranks.
    pub fn torques_nm(&self) -> Option<&[f64]> {
        self.rotors.as_ref().map(Rotors::torques_nm)
    }

    /// True if motor `i` is a servo whose torque is at its limit.
    pub fn is_at_limit(&self, i: usize) -> bool {
        let Some(rotors) = &self.rotors else {
            return false;
        };
        let limit_nm = rotors.driven().motors()[i].limit_nm();
        limit_nm.is_some_and(|limit_nm| rotors.torques_nm()[i].abs() >= limit_nm)
    }

    /// Motion of the frame, if it moves.
    pub fn frame(&self) -> Option<FrameMotion> {
        self.rotors.as_ref().and_then(Rotors::frame)
    }

    /// Static sag of the frame under its own weight and the load, µm; 0 if it does not move.
    pub fn sag_um(&self) -> f64 {
        self.rotors.as_ref().map_or(0.0, Rotors::sag_m) * 1e6
    }

    /// Largest displacement of a point on the mount circle from rest in this motion, µm.
    pub fn frame_um(&self, frame: &FrameMotion) -> f64 {
        let [heave, x, y] = frame.place;
        (heave.abs() + self.mount_radius_m * x.hypot(y)) * 1e6
    }

    /// Pose of the part that the axes move: from its equations of motion if it has any, else from the shafts. If torque does not move the
    /// shafts, `commanded` has their speed and acceleration.
    pub fn pose(&self, turns: &[f64], command_turns: &[f64], commanded: (f64, f64)) -> Pose {
        let pose = self.rotors.as_ref().and_then(Rotors::pose);
        let motion = self.motion().unwrap_or(commanded);
        self.posed(turns, command_turns, pose, motion)
    }

    /// Pose at an instant within the tick, under the forces at that instant.
    pub fn pose_within(&self, turns: &[f64], command_turns: &[f64], forces: &Forces) -> Pose {
        self.posed(turns, command_turns, forces.pose, forces.cranks)
    }

    fn posed(
        &self,
        turns: &[f64],
        command_turns: &[f64],
        pose: Option<Pose>,
        (omega_rad_s, acceleration_rad_s2): (f64, f64),
    ) -> Pose {
        let by_shafts = || (self.follower).pose(turns, omega_rad_s, acceleration_rad_s2);
        Pose {
            warp_deg: self.warp_deg(turns, command_turns),
            ..pose.unwrap_or_else(by_shafts)
        }
    }

    /// Largest deviation of an axis's phase error from the plane of all errors, degrees.
    pub fn warp_deg(&self, turns: &[f64], command_turns: &[f64]) -> f64 {
        if turns.len() <= 3 {
            return 0.0;
        }
        let errors = per_axis(turns.len(), |i| turns[i] - command_turns[i]);
        self.corners.warp(&errors) * 360.0
    }

    /// Tilt of the part that the axes move, mrad: the magnitude over both directions. `None` if it does not tilt.
    pub fn tilt_mrad(&self, turns: &[f64]) -> Option<f64> {
        match self.rotors.as_ref().and_then(Rotors::place) {
            Some([_, x, y]) => Some(x.hypot(y) * 1e3),
            None => self.follower.tilt_mrad(turns),
        }
    }

    /// Returns false if [`Self::tilt_mrad`] is certainly not above `mrad`. This check is faster than the tilt itself.
    pub fn may_tilt_beyond(&self, mrad: f64, turns: &[f64]) -> bool {
        let is_geometric = self.rotors.as_ref().is_none_or(Rotors::is_geometric);
        !is_geometric || self.follower.may_tilt_beyond(mrad, turns)
    }

    /// Equations of motion of the cranks, if torque moves them.
    pub fn rotors(&self) -> Option<&Rotors> {
        self.rotors.as_ref()
    }

    /// Figures of the machine's own, if it has any.
    pub fn record(&self) -> Option<&dyn Record> {
        self.record.as_deref()
    }

    /// Part that the axes move where they stand as commanded.
    pub fn follower(&self) -> &dyn Follower {
        &*self.follower
    }

    /// Integration method and its steps per tick, if anything is integrated.
    pub fn method(&self) -> Option<(Scheme, u32)> {
        let rotors = self.rotors.as_ref().map(Rotors::method);
        rotors.or_else(|| self.follower.method())
    }

    /// Reason why the equations could not be advanced further, if there is one.
    pub fn broken(&self) -> Option<Broken> {
        let rotors = self.rotors.as_ref().and_then(Rotors::broken);
        rotors.or_else(|| Some(self.follower.broken()?.into()))
    }

    /// Plays one tick, and sets `passages` to the events at the index sensors in it. `master_turns` is the travel of the master in the
    /// tick. `command_turns` are the commanded positions at its end. `disturbance` holds the disturbance of each drive, in a scene
    /// that has any.
    ///
    /// Drives that are off do not follow: their cranks stand, or coast if torque moves them.
    pub fn play(
        &mut self,
        played: &Played,
        drives_enabled: bool,
        master_turns: f64,
        command_turns: &[f64],
        disturbance: Option<&[Disturbance]>,
        passages: &mut Passages,
    ) {
        self.ticks += 1;
        let omega_rad_s = master_turns * std::f64::consts::TAU / self.tick_s;
        let acceleration_rad_s2 = (omega_rad_s - self.omega_before) / self.tick_s;
        self.omega_before = omega_rad_s;
        let master = (omega_rad_s, acceleration_rad_s2);
        if self.rotors.is_some() {
            self.turn_by_torque(played, drives_enabled, command_turns, disturbance, passages);
        } else {
            self.turn(played, drives_enabled, master, disturbance, passages);
            self.follower.play(&ShaftTick {
                axes: &self.axes,
                drives_enabled,
                omega_rad_s,
                acceleration_rad_s2,
                master_turns,
                command_turns,
            });
        }
        self.record_tick(drives_enabled, master, command_turns);
    }

    /// Records the tick that was played in the figures of the machine's own.
    fn record_tick(&mut self, drives_enabled: bool, master: (f64, f64), command_turns: &[f64]) {
        let Some(mut record) = self.record.take() else {
            return;
        };
        let turns: Axes<f64> = self.axes.iter().map(SimulatedAxis::turns).collect();
        record.tick(&Tick {
            // The first tick is played a tick after power-up.
            t_s: (self.ticks + 1) as f64 * self.tick_s,
            tick_s: self.tick_s,
            drives_enabled,
            omega_rad_s: master.0,
            acceleration_rad_s2: master.1,
            turns: &turns,
            command_turns,
            pose: self.pose(&turns, command_turns, master),
            state: self.rotors.as_ref().map(Rotors::state),
        });
        self.record = Some(record);
    }

    /// Turns the cranks by torque.
    fn turn_by_torque(
        &mut self,
        played: &Played,
        drives_enabled: bool,
        command_turns: &[f64],
        disturbance: Option<&[Disturbance]>,
        passages: &mut Passages,
    ) {
        let Some(rotors) = &mut self.rotors else {
            return;
        };
        let mut plans = played.plans();
        let (tick_s, count) = (self.tick_s, self.axes.len());
        let axes = &mut self.axes;
        let mut travel = per_axis(count, |i| {
            axes[i].command(plans.of(i), &played.setpoints[i], command_turns[i])
        });
        if let Some(disturbance) = disturbance {
            disturb(axes, &mut travel, disturbance, tick_s, drives_enabled);
            disturb_rotors(rotors, axes, disturbance, drives_enabled);
        }
        let commands = per_axis(count, |i| {
            axes[i].slip(travel[i].slip_turns);
            DriveCommand {
                turns: axes[i].field_turns(),
                torque_nm: travel[i].torque_nm,
            }
        });
        rotors.play(&commands, drives_enabled);
        for (i, axis) in axes.iter_mut().enumerate() {
            let passed = axis.moved(rotors.turns(i), self.tick_cycles, drives_enabled);
            passages.put(i, passed);
            if axis.drive().follows_rotor(drives_enabled) {
                rotors.clear(i);
            }
        }
    }

    /// Turns the shafts as commanded. `master` has the master's speed, rad/s, and acceleration, rad/s².
    fn turn(
        &mut self,
        played: &Played,
        drives_enabled: bool,
        master: (f64, f64),
        disturbance: Option<&[Disturbance]>,
        passages: &mut Passages,
    ) {
        if self.torques {
            self.compare_torques(master.0, master.1, drives_enabled);
        }
        let mut plans = played.plans();
        let (tick_s, count) = (self.tick_s, self.axes.len());
        let axes = &mut self.axes;
        let Some(disturbance) = disturbance else {
            for (i, (axis, setpoint)) in axes.iter_mut().zip(&played.setpoints).enumerate() {
                let plan = plans.of(i);
                let travel = axis.take(plan, setpoint);
                passages.put(i, axis.play(&travel, plan.runs, drives_enabled));
            }
            return;
        };
        let mut travel = per_axis(count, |i| axes[i].take(plans.of(i), &played.setpoints[i]));
        disturb(axes, &mut travel, disturbance, tick_s, drives_enabled);
        for (i, (axis, travel)) in axes.iter_mut().zip(&travel).enumerate() {
            passages.put(i, axis.play(travel, played.runs(i), drives_enabled));
        }
    }
}
