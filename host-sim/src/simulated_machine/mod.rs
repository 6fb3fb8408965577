//! Simulated machines: motion of the drives, the cranks and the platform that the loop's output causes.
//!
//! On the *kinematic* model level every crank is where commanded. The *quasi-static* model level compares the torque that the motion
//! needs with the torque that each motor has. A stepper slips if more is required of it. On the *rigid*, *phased* and *elastic* model
//! levels ([`Rotors`]) torque moves the cranks. The position of the platform follows from the phases of the cranks by geometry, except
//! on the last two levels, where the equations of motion determine it. A scene with cams has [`Followers`] instead, one per axis.
//!
//! The two lowest levels neglect the effect of inertia on the motion: a crank lags by whole slips or not at all. They also neglect how
//! the torque of the other axes changes after one axis has slipped.

mod assembly;
mod broken;
mod cam;
mod faulted_drive;
mod instant;
mod level;
mod required;
mod rotors;
mod sensors;
mod torque;

pub use broken::{Broken, Cause};
pub use cam::{Followers, Peaks, Pusher, Turned};
pub use instant::{Forces, Instant};
pub use rotors::{DriveCommand, Rotors};
pub use torque::motor_of;

use std::sync::Arc;

use cophase_methods::Scheme;
use cophase_scene::SceneError;
use cophase_scene::file::{Drive, Fidelity};

use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::{
    AtCrank, AxisDrive, Disturbance, Flag, FollowingError, Passages, Played, SimulatedAxis,
};
use crate::dynamics::plant::{Record, Recorder, Tick};
use crate::dynamics::{Corners, FrameMotion, PlaneMotion};
use crate::machines::platform::Platform;
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
    /// Platform that the cranks carry; `None` for a machine without one.
    pub platform: Option<Platform>,
    /// Places of the axes around the platform; without one, around a circle of 1 m.
    corners: Corners,
    /// Time for which an index line stays high, cycles.
    pub index_cycles: u32,
    tick_s: f64,
    tick_cycles: u32,
    torques: bool,
    omega_before: f64,
    /// Required torque of each motor, N·m, on the model level that compares torques.
    required_nm: Option<Axes<f64>>,
    /// Equations of motion, if torque moves the cranks.
    rotors: Option<Rotors>,
    /// Followers, if the axes are cam shafts.
    followers: Option<Followers>,
    /// Recorder of the figures, if the shafts move something other than a platform.
    recorder: Option<Recorder>,
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
        let following_error =
            |window_deg: Option<f64>| FollowingError::new(window_deg.map(|deg| deg / 360.0));
        let servo = following_error(in_common.servo.and_then(|servo| servo.following_error_deg));
        let converter = following_error(
            in_common
                .induction
                .and_then(|motor| motor.following_error_deg),
        );
        let make = |i: usize| {
            let overrides = checked.overrides(i);
            let own = &settings.axes[i];
            let motor = AtCrank::new(&checked.scene, i);
            let drive = match checked.scene.drive(i) {
                Drive::Stepper => AxisDrive::Stepper {
                    pull_out: motor.pull_out.clone(),
                    cycle_steps: own.cycle_steps,
                },
                Drive::Servo => AxisDrive::Servo(servo),
                Drive::PulseServo => AxisDrive::PulseServo(servo),
                Drive::Induction => AxisDrive::PulseServo(converter),
            };
            let start_turns = overrides.map_or(0.0, |own| own.start_deg / 360.0);
            let friction_nm = overrides
                .and_then(|own| own.friction_nm)
                .unwrap_or(in_common.friction_nm);
            let home_turns = settings.home_turns(own);
            let ratio = own.follower.most_ratio(&settings.cams);
            SimulatedAxis::new(
                own,
                home_turns,
                ratio,
                drive,
                &motor,
                start_turns,
                friction_nm,
            )
            .with_flag(Flag::new(own, &checked.scene.noise, i, checked.fidelity))
            .with_drive_steps(overrides.and_then(|own| own.drive_steps_per_turn))
        };
        let axes = per_axis(settings.axes.len(), make);
        let platform = checked.machine.platform().cloned();
        let rotors = torque::rotors(checked, &axes)?;
        let turns: Axes<f64> = axes.iter().map(SimulatedAxis::turns).collect();
        let tick_s = 1.0 / f64::from(settings.tick_hz);
        let tick_cycles = settings.tick_cycles();
        let flag_cycles = (FLAG_S * f64::from(settings.clock_hz)).round() as u32;
        Ok(Self {
            has_encoder: (settings.axes.iter().rev())
                .fold(0, |bits, axis| bits << 1 | u8::from(axis.encoder)),
            followers: Followers::new(checked, &turns)?,
            recorder: Arc::clone(&checked.machine).plant().map(Recorder::new),
            rotors,
            axes,
            corners: Corners::new(
                settings.axes.len(),
                platform.as_ref().map_or(1.0, Platform::mount_radius_m),
            ),
            platform,
            index_cycles: flag_cycles.max(2 * settings.index_width_cycles()),
            tick_s,
            tick_cycles,
            torques: checked.fidelity == Fidelity::QuasiStatic,
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
        let radius_m = self.platform.as_ref().map_or(0.0, Platform::mount_radius_m);
        (heave.abs() + radius_m * x.hypot(y)) * 1e6
    }

    /// Pose of the platform: from its equations of motion if it has any, else by geometry from the cranks. If torque does not move the
    /// cranks, the geometry uses the commanded speed and acceleration. For pushers, their mean, which does not tilt.
    pub fn pose(&self, turns: &[f64], command_turns: &[f64], commanded: (f64, f64)) -> Pose {
        if let Some(followers) = &self.followers {
            let mean = followers.mean();
            return Pose {
                z_m: mean.place_m,
                accel_mps2: mean.accel_mps2,
                warp_deg: self.warp_deg(turns, command_turns),
                ..Pose::default()
            };
        }
        let plane = self.rotors.as_ref().and_then(Rotors::platform);
        if let (Some(recorder), None) = (&self.recorder, plane) {
            return recorder.plant.pose(turns, commanded.0, commanded.1);
        }
        let motion = self.motion().unwrap_or(commanded);
        self.posed(turns, command_turns, plane, motion)
    }

    /// Pose of the platform at an instant within the tick, under the forces at that instant.
    pub fn pose_within(&self, turns: &[f64], command_turns: &[f64], forces: &Forces) -> Pose {
        self.posed(turns, command_turns, forces.platform, forces.cranks)
    }

    fn posed(
        &self,
        turns: &[f64],
        command_turns: &[f64],
        plane: Option<PlaneMotion>,
        (omega_rad_s, acceleration_rad_s2): (f64, f64),
    ) -> Pose {
        if let Some(plane) = plane {
            let [z_m, x, y] = plane.place;
            // The part that a plant moves has one slope, its pitch.
            let (tilt, pitch) = match self.recorder {
                Some(_) => ([0.0; 2], x),
                None => ([x, y], 0.0),
            };
            return Pose {
                z_m,
                accel_mps2: plane.acceleration[0],
                tilt_x_mrad: tilt[0] * 1e3,
                tilt_y_mrad: tilt[1] * 1e3,
                pitch_mrad: pitch * 1e3,
                warp_deg: self.warp_deg(turns, command_turns),
            };
        }
        let warp_deg = self.warp_deg(turns, command_turns);
        match &self.platform {
            Some(platform) => platform.pose(turns, warp_deg, omega_rad_s, acceleration_rad_s2),
            None => Pose {
                warp_deg,
                ..Pose::default()
            },
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

    /// Tilt of the platform, mrad: the magnitude over both directions. It is 0 on a machine without a platform.
    pub fn tilt_mrad(&self, turns: &[f64]) -> f64 {
        let Some(platform) = &self.platform else {
            return 0.0;
        };
        match self.rotors.as_ref().and_then(Rotors::place) {
            Some([_, x, y]) => x.hypot(y) * 1e3,
            None => platform.tilt_mrad(turns),
        }
    }

    /// Returns false if [`Self::tilt_mrad`] is certainly not above `mrad`. This check is faster than the tilt itself.
    pub fn may_tilt_beyond(&self, mrad: f64, turns: &[f64]) -> bool {
        match (&self.platform, &self.rotors) {
            (None, _) => false,
            (Some(platform), None) => platform.may_tilt_beyond(mrad, turns),
            (Some(platform), Some(rotors)) if rotors.is_geometric() => {
                platform.most_tilt_mrad(turns) > mrad
            }
            // The platform has equations of its own.
            (Some(_), Some(_)) => true,
        }
    }

    /// Equations of motion of the cranks, if torque moves them.
    pub fn rotors(&self) -> Option<&Rotors> {
        self.rotors.as_ref()
    }

    /// Figures of a machine with its own plant model, if it is one.
    pub fn record(&self) -> Option<&dyn Record> {
        self.recorder.as_ref().map(|recorder| &*recorder.record)
    }

    /// Followers of the cam shafts, if the axes are cam shafts.
    pub fn followers(&self) -> Option<&Followers> {
        self.followers.as_ref()
    }

    /// Integration method and its steps per tick, if anything is integrated.
    pub fn method(&self) -> Option<(Scheme, u32)> {
        let rotors = self.rotors.as_ref().map(Rotors::method);
        rotors.or_else(|| self.followers.as_ref()?.method())
    }

    /// Reason why the equations could not be advanced further, if there is one.
    pub fn broken(&self) -> Option<Broken> {
        let rotors = self.rotors.as_ref().and_then(Rotors::broken);
        rotors.or_else(|| Some(self.followers.as_ref()?.broken()?.into()))
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
        self.turn(
            played,
            drives_enabled,
            master_turns,
            command_turns,
            disturbance,
            passages,
        );
        if self.recorder.is_some() {
            self.record_tick(drives_enabled, master_turns, command_turns);
        }
    }

    /// Records the tick that was played in the figures of a machine with its own plant model.
    fn record_tick(&mut self, drives_enabled: bool, master_turns: f64, command_turns: &[f64]) {
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        let (omega_rad_s, acceleration_rad_s2) = recorder.master(master_turns, self.tick_s);
        let t_s = recorder.end_s(self.tick_s);
        let turns: Axes<f64> = self.axes.iter().map(SimulatedAxis::turns).collect();
        let commanded = (omega_rad_s, acceleration_rad_s2);
        let pose = self.pose(&turns, command_turns, commanded);
        let tick = Tick {
            t_s,
            tick_s: self.tick_s,
            drives_enabled,
            omega_rad_s,
            acceleration_rad_s2,
            turns: &turns,
            command_turns,
            pose,
            state: self.rotors.as_ref().map(Rotors::state),
        };
        if let Some(recorder) = &mut self.recorder {
            recorder.record.tick(&tick);
        }
    }

    fn turn(
        &mut self,
        played: &Played,
        drives_enabled: bool,
        master_turns: f64,
        command_turns: &[f64],
        disturbance: Option<&[Disturbance]>,
        passages: &mut Passages,
    ) {
        let mut plans = played.plans();
        let (tick_s, count) = (self.tick_s, self.axes.len());
        if let Some(rotors) = &mut self.rotors {
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
            return;
        }
        let (mut omega, mut acceleration) = (0.0, 0.0);
        // Nothing else depends on these two, and divisions are slow.
        if self.torques || self.followers.is_some() {
            omega = master_turns * std::f64::consts::TAU / self.tick_s;
            acceleration = (omega - self.omega_before) / self.tick_s;
            self.omega_before = omega;
        }
        if self.torques {
            self.compare_torques(omega, acceleration, drives_enabled);
        }
        if let Some(disturbance) = disturbance {
            let axes = &mut self.axes;
            let mut travel = per_axis(count, |i| axes[i].take(plans.of(i), &played.setpoints[i]));
            disturb(axes, &mut travel, disturbance, tick_s, drives_enabled);
            for (i, axis) in axes.iter_mut().enumerate() {
                let passed = axis.play(&travel[i], played.runs(i), drives_enabled);
                passages.put(i, passed);
            }
            return;
        }
        let Some(followers) = &mut self.followers else {
            for (i, (axis, setpoint)) in self.axes.iter_mut().zip(&played.setpoints).enumerate() {
                let plan = plans.of(i);
                let travel = axis.take(plan, setpoint);
                passages.put(i, axis.play(&travel, plan.runs, drives_enabled));
            }
            return;
        };
        // Cams stand while their drives are off.
        let on = f64::from(u8::from(drives_enabled));
        let turned = per_axis(self.axes.len(), |i| {
            let axis = &mut self.axes[i];
            let from = axis.turns();
            let plan = plans.of(i);
            let travel = axis.take(plan, &played.setpoints[i]);
            passages.put(i, axis.play(&travel, plan.runs, drives_enabled));
            Turned {
                from,
                to: axis.turns(),
                omega_rad_s: omega * axis.ratio() * on,
                acceleration_rad_s2: acceleration * axis.ratio() * on,
            }
        });
        followers.play(&turned, master_turns, command_turns);
    }
}
