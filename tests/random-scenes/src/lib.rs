//! Random valid scenes over all documented keys and ranges, including the ends of the ranges.
//!
//! [`scene`] draws one from a seed alone: the same seed gives the same text on every host. Each file here draws a table or two of
//! the scene (`docs/scenes.md`). A scene is made as a [`Scene`] and then written out. A key that is added to the file format
//! therefore does not compile here until it is drawn.
//!
//! Most numbers are drawn evenly over the logarithm of their range, and some exactly at one of its ends. Keys that depend on each
//! other are mostly drawn so that they fit: steps that the pulses allow, levels that the speed limit reaches, motors that can
//! move their load. Some scenes are refused all the same. The test counts them.
//!
//! Times are not drawn over their whole ranges, because a scene of 10⁶ s would run for days: a program lasts some seconds.

mod axes;
mod cam;
mod control;
mod events;
mod faults;
mod fidelity;
mod machine;
mod motors;
mod program;
mod source;
mod steady;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use cophase_scene::file::{Drive, Fidelity, Scene};
use cophase_scene::{SceneError, load};
use host_sim::checked::Checked;
use host_sim::mechanism::{AnyMechanism, Mechanism};

use source::Source;
pub use steady::steady;

/// Kinds of the scenes that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Some scenes have faults, noise of loads, and events from outside.
    pub disturbed: bool,
    /// All scenes have `[questions]` and leave `fidelity` to be chosen. They have cranks that torque moves, or cams with masses.
    pub has_questions: bool,
}

impl Kinds {
    /// All scenes.
    pub const ALL: Self = Self {
        disturbed: true,
        has_questions: false,
    };
    /// Scenes with questions, without faults or events.
    pub const QUESTIONS: Self = Self {
        disturbed: false,
        has_questions: true,
    };
}

/// A scene that was drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// TOML text.
    pub text: String,
    /// CSV text of the cam table that the scene names as [`TABLE_FILE`], if it does.
    pub table: Option<String>,
}

/// File of a cam table, beside the scene.
pub const TABLE_FILE: &str = "table.csv";

impl Drawn {
    /// Writes the scene into a folder, with its table, and returns the scene's path.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<PathBuf> {
        let path = folder.join("scene.toml");
        fs::write(&path, &self.text)?;
        if let Some(table) = &self.table {
            fs::write(folder.join(TABLE_FILE), table)?;
        }
        Ok(path)
    }
}

/// Draws a scene of any kind.
pub fn scene(seed: u64) -> Drawn {
    draw(seed, Kinds::ALL)
}

/// Draws a scene of these kinds.
///
/// # Panics
/// Never: every scene can be written as TOML.
pub fn draw(seed: u64, kinds: Kinds) -> Drawn {
    let (scene, table) = Basis::draw(&mut Source::new(seed), kinds, seed);
    Drawn {
        text: toml::to_string(&scene).expect("a scene can be written as TOML"),
        table,
    }
}

/// Draws a scene of these kinds and checks it, as the command does with a file. Scenes with a table in a file of its own are not
/// drawn with [`Kinds::has_questions`].
///
/// # Errors
/// The scene is refused.
pub fn checked(seed: u64, kinds: Kinds) -> Result<Checked, SceneError> {
    Checked::new(load::parse(&draw(seed, kinds).text)?)
}

/// Motors and drives of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Cranks under a platform.
    Cranks,
    /// Cam shafts with followers.
    Shafts,
    /// Pushers on screws that follow cam tables.
    Screws,
}

/// Drawn values that several tables depend on.
struct Basis {
    kinds: Kinds,
    kind: Kind,
    fidelity: Fidelity,
    count: usize,
    /// Drive of most axes, and of those that have one of their own.
    drive: Drive,
    other_drive: Option<Drive>,
    has_encoder: bool,
    /// Motors have torque: pull-out torque, gains and rotor inertia are given.
    has_torque: bool,
    tick_hz: u32,
    /// The mechanism that gives amax. For a cam, it is one of the same greatest acceleration.
    mechanism: AnyMechanism,
    load_kg: f64,
    /// Greatest speed of the master, rev/s.
    speed_hz: f64,
    homing_hz: f64,
    /// Time from rest to the greatest speed, s.
    ramp_s: f64,
    /// Crank turns per master turn.
    ratio: (u32, u32),
    /// Motor turns and crank turns that belong together.
    gear: (u32, u32),
    /// Times of the program, s, and its start.
    program_s: f64,
    begins_s: f64,
}

impl Basis {
    /// Draws a scene, and the file of its cam table if it has one.
    fn draw(source: &mut Source, kinds: Kinds, seed: u64) -> (Scene, Option<String>) {
        let kind = match source.below(if kinds.has_questions { 9 } else { 10 }) {
            0..8 => Kind::Cranks,
            8 => Kind::Shafts,
            _ => Kind::Screws,
        };
        let tick_hz = control::tick_hz(source);
        let (machine, shaft) = match kind {
            Kind::Cranks => (Some(machine::machine(source, tick_hz)), None),
            Kind::Shafts | Kind::Screws => (None, Some(cam::shaft(source, kind, kinds, tick_hz))),
        };
        let mechanism = machine
            .as_ref()
            .map_or_else(|| cam::mechanism(shaft.as_ref()), machine::mechanism);
        let has_links = shaft
            .as_ref()
            .is_some_and(|shaft| shaft.masses_kg.is_some());
        let (fidelity, has_torque) = fidelity::level(source, kind, kinds, has_links);
        let drive = axes::drive(source, kind, fidelity);
        let speed_hz = control::speed_hz(source, &mechanism, tick_hz);
        let ramp_s = control::ramp_s(source, tick_hz);
        let mut basis = Self {
            kinds,
            kind,
            fidelity,
            count: source.one_of(&[2, 3, 3, 3, 4, 4, 5, 6]),
            drive,
            other_drive: axes::other_drive(source, drive),
            has_encoder: source.percent(40),
            has_torque,
            tick_hz,
            load_kg: machine.as_ref().map_or(0.0, |machine| machine.load_kg),
            mechanism,
            speed_hz,
            homing_hz: control::homing_hz(source, speed_hz),
            ramp_s,
            ratio: axes::ratio(source, kind),
            gear: axes::gear(source),
            program_s: 0.0,
            begins_s: 0.0,
        };
        let control = control::control(source, tick_hz);
        let program = program::program(source, &basis);
        basis.program_s = program::length_s(&program);
        basis.begins_s = control.settle_s + 2.0 / basis.homing_hz;
        let (cam_table, table) = cam::tables(source, &basis, shaft.as_ref());
        let limits = control::limits(source, &basis);
        let pulse = control::pulse(source, tick_hz);
        let axes = axes::axes(source, &basis, &pulse, &limits, &cam_table, table.is_some());
        let axis = axes::apart(source, &basis, &axes, &cam_table);
        let frame = machine
            .as_ref()
            .and_then(|machine| machine::frame(source, machine, fidelity));
        let machine = machine.map(|machine| machine::rods(source, &basis, &axes, machine));
        let noise = faults::noise(source, &basis);
        let fault = faults::faults(source, &basis, &axes, &axis);
        let questions = fidelity::questions(source, &basis, has_links, frame.is_some());
        let method = fidelity::method(source, &basis, &axes);
        let events = events::events(source, &basis);
        let scene = Scene {
            name: format!("random-{seed}"),
            description: String::new(),
            fidelity,
            questions,
            method,
            frame,
            control,
            index: control::index(source, tick_hz),
            drift: control::drift(source, &basis, &axes),
            correction: control::correction(source, &basis, &axes),
            limits,
            pulse,
            cam: shaft,
            screen: None,
            crusher: None,
            five_bar: None,
            cam_table,
            machine,
            axes,
            axis,
            noise,
            wiring: control::wiring(source),
            link: control::link(source),
            program,
            command: events.commands,
            input: events.inputs,
            fault,
            late: events.late,
            scope: events.scope,
        };
        (scene, table)
    }

    /// True if all cranks must be at one angle, as on the rigid level.
    fn is_rigid(&self) -> bool {
        self.fidelity == Fidelity::Rigid
    }

    /// True if an axis has this drive.
    fn has_drive(&self, drive: Drive) -> bool {
        self.drive == drive || self.other_drive == Some(drive)
    }

    /// Greatest acceleration at the greatest speed, m/s².
    fn most_amax_mps2(&self) -> f64 {
        self.mechanism
            .amax_mps2(self.speed_hz * std::f64::consts::TAU)
    }

    /// Greatest speed of a crank, rev/s.
    fn crank_hz(&self) -> f64 {
        self.speed_hz * f64::from(self.ratio.0) / f64::from(self.ratio.1)
    }

    /// Motor turns per crank turn.
    fn motor_turns(&self) -> f64 {
        f64::from(self.gear.0) / f64::from(self.gear.1)
    }

    /// A time from power-up to somewhat after the program, s.
    fn time_s(&self, source: &mut Source) -> f64 {
        source.between(0.0, self.begins_s + 1.2 * self.program_s)
    }
}
