//! Operating range of a machine: torque, amplitude and step rate over the speed of its cranks, with their limits.
//!
//! *Required torque* is the peak over a turn of what the motion requires of a motor, as the quasi-static model level computes it.
//! *Available torque* is the greatest torque of a motor at a speed. It is a stepper's pull-out torque, a servo's limit, or the
//! breakdown torque of an induction motor.
//!
//! All numbers are those of the simulation.

use std::f64::consts::TAU;

use cophase_core::program::EntrySettings;
use cophase_core::pulse::PulseTiming;
use cophase_core::settings::Settings;
use cophase_link::board::{self, Board, Rp2040, Unfit};
use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;

use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::{AtCrank, Motor};
use crate::mechanism::turn_search::{max_of_samples, sample_angles};
use crate::mechanism::{LoadAtAngle, SquareLaw};
use crate::simulated_machine::SimulatedMachine;

/// Speed up to which the board's limit is searched, rev/s. A board that has no limit below it counts as one without a limit.
const FASTEST_HZ: f64 = 1e4;

/// Level of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Amplitude, m/s².
    pub amax_mps2: f64,
    /// Speed that it requires, rev/s.
    pub speed_hz: f64,
}

/// Operating range of a machine.
#[derive(Debug)]
pub struct OperatingRange {
    /// Name of the scene.
    pub name: String,
    machine: SimulatedMachine,
    law: SquareLaw,
    /// Offsets of the axes from the master, rad, in the order of the axes, with the number of consecutive axes that have each.
    offsets: Vec<(f64, u32)>,
    /// Load at each of the [`sample_angles`] of the master, for each of these offsets.
    sampled: Vec<LoadAtAngle>,
    /// Motors at their cranks; `None` for an axis whose torque is not known.
    motors: Vec<Option<Motor>>,
    settings: Settings,
    /// Greatest speed of the program, rev/s.
    pub top_hz: f64,
    /// Levels of the program, the lowest first, each once.
    pub levels: Vec<Level>,
}

/// Greatest ratio of required to available torque of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Axis.
    pub axis: usize,
    /// Speed, rev/s.
    pub speed_hz: f64,
    /// Required over available torque.
    pub ratio: f64,
}

impl OperatingRange {
    /// Operating range of a scene's machine. `None` if no model level of it compares torques, or if the torque of no motor is known.
    ///
    /// # Errors
    /// The machine cannot be created from the numbers of the scene.
    pub fn for_scene(checked: &Checked) -> Result<Option<Self>, SceneError> {
        let range = Self::new(checked)?;
        Ok(range.filter(|range| range.motors.iter().any(Option::is_some)))
    }

    /// Operating range of a scene's machine, also without motors whose torque is known. `None` if no model level of it compares
    /// torques.
    ///
    /// # Errors
    /// The machine cannot be created from the numbers of the scene.
    pub fn new(checked: &Checked) -> Result<Option<Self>, SceneError> {
        let compares = checked.machine.levels().contains(&Fidelity::QuasiStatic);
        compares.then(|| Self::of_any(checked)).transpose()
    }

    /// Greatest load of a motor while the master accelerates at its limit, on any machine: of its moved part only what a model level compares.
    /// `None` if the torque of no motor is known.
    ///
    /// # Errors
    /// The machine cannot be created from the numbers of the scene.
    pub fn steepest_load(checked: &Checked) -> Result<Option<Load>, SceneError> {
        let range = Self::of_any(checked)?;
        if range.motors.iter().all(Option::is_none) {
            return Ok(None);
        }
        Ok(range.max_load_at(range.acceleration_limit_hz_per_s()))
    }

    fn of_any(checked: &Checked) -> Result<Self, SceneError> {
        let settings = &checked.settings;
        let motors: Vec<_> = (0..settings.axes.len())
            .map(|i| {
                AtCrank::motor(&checked.scene, i).filter(|motor| motor.max_nm(0.0).is_finite())
            })
            .collect();
        // Motors are not sized for faults and noise of the load, and some of these cannot occur on this model level.
        let mut undisturbed = checked.clone();
        undisturbed.scene.fault.clear();
        undisturbed.scene.noise.load_nm = 0.0;
        let machine = SimulatedMachine::new(&undisturbed.on(Fidelity::Kinematic)?)?;
        let mut offsets: Vec<(f64, u32)> = Vec::new();
        for offset_rad in settings.axes.iter().map(|axis| axis.offset_turns * TAU) {
            match offsets.last_mut() {
                Some((last_rad, count)) if *last_rad == offset_rad => *count += 1,
                _ => offsets.push((offset_rad, 1)),
            }
        }
        Ok(Self {
            name: checked.scene.name.clone(),
            sampled: sample_angles()
                .flat_map(|alpha_rad| loads_at(&machine, &offsets, alpha_rad))
                .collect(),
            machine,
            law: checked.law(),
            offsets,
            motors,
            levels: levels(checked),
            top_hz: checked.top_speed_hz(),
            settings: settings.clone(),
        })
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.motors.len()
    }

    /// Limit of the master's speed, rev/s.
    pub fn speed_limit_hz(&self) -> f64 {
        self.settings.limits.speed_hz
    }

    /// Limit of the master's acceleration, rev/s².
    pub fn acceleration_limit_hz_per_s(&self) -> f64 {
        self.settings.limits.acceleration_hz_per_s
    }

    /// Bands of speed in which the master never dwells, rev/s.
    pub fn bands_hz(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let bands = self.settings.limits.bands.iter();
        bands.map(|band| (band.from_hz, band.to_hz))
    }

    /// Peak over a turn of the torque that is required of a motor, N·m at the motor, without sign, at a speed and an acceleration of the master.
    pub fn required_nm(&self, axis: usize, speed_hz: f64, acceleration_hz_per_s: f64) -> f64 {
        let (omega, acceleration) = (speed_hz * TAU, acceleration_hz_per_s * TAU);
        let (motor, gear) = (
            &self.machine.axes[axis],
            self.settings.axes[axis].gear.ratio(),
        );
        let required = |loads: &[LoadAtAngle]| {
            let torques_nm = loads
                .iter()
                .zip(&self.offsets)
                .flat_map(|(load, (_, count))| {
                    let nm = load.torque_nm(omega, acceleration);
                    (0..*count).map(move |_| nm)
                });
            let share_nm = self.machine.share_nm(torques_nm);
            motor.required_nm(share_nm, acceleration, speed_hz).abs() / gear
        };
        let count = self.offsets.len();
        let sample = |i: u32| required(&self.sampled[i as usize * count..][..count]);
        let curve = |alpha_rad| required(&loads_at(&self.machine, &self.offsets, alpha_rad));
        max_of_samples(sample, curve).value
    }

    /// Greatest torque of a motor at a speed of its crank, N·m at the motor; `None` if it is not known.
    pub fn available_nm(&self, axis: usize, speed_hz: f64) -> Option<f64> {
        let motor = self.motors[axis].as_ref()?;
        let at_crank_nm = motor.max_nm(speed_hz * TAU);
        Some(at_crank_nm / self.settings.axes[axis].gear.ratio())
    }

    /// Amplitude at a steady speed, m/s².
    pub fn amax_mps2(&self, speed_hz: f64) -> f64 {
        self.law.amax_mps2(speed_hz * TAU)
    }

    /// Returns true if STEP and DIR command an axis.
    pub fn takes_pulses(&self, axis: usize) -> bool {
        self.settings.axes[axis].drive.takes_pulses()
    }

    /// Step rate of an axis at a speed, steps/s.
    pub fn step_hz(&self, axis: usize, speed_hz: f64) -> f64 {
        speed_hz * self.settings.axes[axis].steps_per_crank_turn().to_f64()
    }

    /// Greatest step rate that the step planner makes with the pulse width of the settings, steps/s.
    pub fn planner_step_hz(&self) -> Option<f64> {
        let Settings {
            pulse,
            clock_hz,
            tick_hz,
            ..
        } = &self.settings;
        let timing = PulseTiming::new(pulse, *clock_hz, *tick_hz).ok()?;
        Some(timing.max_step_hz(*tick_hz))
    }

    /// Greatest speed at which the [RP2040](Rp2040) makes the steps of all axes within a tick, rev/s. `None` if it does so at every
    /// speed.
    ///
    /// # Errors
    /// The board cannot run this machine at any speed.
    pub fn board_speed_hz(&self) -> Result<Option<f64>, Unfit> {
        let mut settings = self.settings.clone();
        settings.clock_hz = Rp2040::CLOCK_HZ;
        let mut fits = |speed_hz: f64| {
            settings.limits.speed_hz = speed_hz;
            board::check::<Rp2040>(&settings)
        };
        fits(0.0)?;
        if fits(FASTEST_HZ).is_ok() {
            return Ok(None);
        }
        let (mut low, mut high) = (0.0, FASTEST_HZ);
        // 1e4 rev/s halved this number of times is less than one turn per day.
        for _ in 0..32 {
            let middle = f64::midpoint(low, high);
            if fits(middle).is_ok() {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Some(low))
    }

    /// Groups of axes with the same values of a curve at some speeds up to `top_hz`, in the order of the first axis of each group.
    pub fn kinds<T: PartialEq>(
        &self,
        top_hz: f64,
        curve: impl Fn(usize, f64) -> T,
    ) -> Vec<Vec<usize>> {
        let key = |axis: usize| [0.0, 0.3, 0.6, 1.0].map(|part| curve(axis, part * top_hz));
        let mut kinds: Vec<Vec<usize>> = Vec::new();
        for axis in 0..self.axes() {
            match kinds.iter_mut().find(|kind| key(kind[0]) == key(axis)) {
                Some(kind) => kind.push(axis),
                None => kinds.push(vec![axis]),
            }
        }
        kinds
    }

    /// Groups of axes with the same load, in the order of the first axis of each group.
    pub fn load_kinds(&self) -> Vec<Vec<usize>> {
        let torques = |axis, hz| (self.required_nm(axis, hz, 0.0), self.available_nm(axis, hz));
        self.kinds(self.top_hz, torques)
    }

    /// Motor with the greatest ratio of required to available torque at a steady speed up to the program's greatest. `None` if the
    /// torque of no motor is known.
    pub fn max_load(&self) -> Option<Load> {
        self.max_load_at(0.0)
    }

    fn max_load_at(&self, acceleration_hz_per_s: f64) -> Option<Load> {
        const SPEEDS: u32 = 64;
        let kinds: Vec<usize> = self.load_kinds().iter().map(|axes| axes[0]).collect();
        let speeds = (1..=SPEEDS).map(|i| self.top_hz * f64::from(i) / f64::from(SPEEDS));
        let loads = speeds.flat_map(|speed_hz| {
            kinds.iter().filter_map(move |&axis| {
                let required_nm = self.required_nm(axis, speed_hz, acceleration_hz_per_s);
                let ratio = required_nm / self.available_nm(axis, speed_hz)?;
                Some(Load {
                    axis,
                    speed_hz,
                    ratio,
                })
            })
        });
        loads.reduce(|max, load| if load.ratio > max.ratio { load } else { max })
    }
}

/// Load with the master at one angle, rad, for each of the offsets.
fn loads_at(
    machine: &SimulatedMachine,
    offsets: &[(f64, u32)],
    alpha_rad: f64,
) -> Axes<LoadAtAngle> {
    let load = |i: usize| machine.follower().load_at(alpha_rad + offsets[i].0);
    per_axis(offsets.len(), load)
}

/// Levels of a program, the lowest first, each once.
fn levels(checked: &Checked) -> Vec<Level> {
    let entries = checked.settings.program.iter();
    let mut levels: Vec<f64> = entries
        .filter_map(|entry| match entry {
            EntrySettings::Segment(segment) => Some(segment.amax_mps2),
            EntrySettings::Repeat { .. } => None,
        })
        .filter(|amax_mps2| *amax_mps2 > 0.0)
        .collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
        .into_iter()
        .map(|amax_mps2| Level {
            amax_mps2,
            speed_hz: checked.law().speed_for_amax_rad_s(amax_mps2) / TAU,
        })
        .collect()
}
