//! From the numbers of a scene to the settings of the core, and what is wrong with them.

use cophase_core::controller::Controller;
use cophase_core::profile::{Profile, SliderCrank};
use cophase_core::program::{Program, ProgramBuilder, SegmentSettings, Shape as ProgramShape};
use cophase_core::settings::{
    AxisSettings, BandSettings, DriftSettings, DriveKind, LimitSettings, MAX_BANDS,
    MachineSettings, Platform as CorePlatform, Problem, PulseSettings, Settings, SettingsError,
};

use super::SceneError;
use super::file::{self, AxisApart, Drive, Fidelity, Scene, Segment};
use crate::design::STANDARD_GRAVITY_MPS2;
use crate::machine::PullOut;

/// A scene whose numbers have been checked, each by itself and against the others.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// Crank radius over rod length, however it was given.
    pub lambda: f64,
    /// The rung of the ladder, `auto` resolved.
    pub fidelity: Fidelity,
    /// Why that rung, in a sentence.
    pub why: String,
}

/// More than any motor that a platform of 50 kg needs has to give.
const MOST_FRICTION_NM: f64 = 1000.0;

/// Blocks within blocks within blocks: what a person can still read.
const MOST_NESTING: usize = 8;

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// The first thing that is wrong, by key, with what would be right. The error has no origin yet.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let lambda = lambda(&scene.machine)?;
        if !(2..=6).contains(&scene.axes.count) {
            return Err(SceneError::at(
                "axes.count",
                format!(
                    "{} is outside 2 to 6, the motors that one platform has",
                    scene.axes.count
                ),
            ));
        }
        for (entry, apart) in scene.axis.iter().enumerate() {
            check_apart(&scene, entry, apart)?;
        }
        PullOut::new(&scene.axes.pull_out)?;
        check_times(&scene)?;
        check_bands(&scene.limits)?;
        let (fidelity, why) = rung(&scene)?;
        let checked = Self {
            scene,
            lambda,
            fidelity,
            why,
        };
        match checked.scene.axes.count {
            2 => checked.controller::<2>().map(|_| ()),
            3 => checked.controller::<3>().map(|_| ()),
            4 => checked.controller::<4>().map(|_| ()),
            5 => checked.controller::<5>().map(|_| ()),
            _ => checked.controller::<6>().map(|_| ()),
        }?;
        Ok(checked)
    }

    /// The loop that this scene asks for; `N` is the scene's number of axes.
    ///
    /// # Errors
    /// Settings or a program that the core refuses.
    pub fn controller<const N: usize>(&self) -> Result<Controller<N>, SceneError> {
        let settings = self.settings::<N>();
        let placed = |error| self.placed(error);
        settings.check().map_err(placed)?;
        let program = self.program(settings.program_builder())?;
        let mut controller = Controller::new(&settings, program).map_err(placed)?;
        for (entry, apart) in self.scene.axis.iter().enumerate() {
            let turns = fixed::types::I16F48::saturating_from_num(apart.trim_deg / 360.0);
            if !controller.set_trim(apart.number, turns) {
                let limit = self.scene.axes.trim_limit_deg;
                return Err(SceneError::at(
                    format!("axis[{entry}].trim_deg"),
                    format!(
                        "{}° is outside -{limit} to {limit}°; trim less, or raise axes.trim_limit_deg",
                        apart.trim_deg
                    ),
                ));
            }
        }
        Ok(controller)
    }

    /// The core's error at the key that stands in the file: an axis may have apart what most have in common.
    fn placed(&self, error: SettingsError) -> SceneError {
        let SceneError { key, problem, .. } = error.into();
        let Some((axis, name)) = error.entry.zip(key.strip_prefix("axes.")) else {
            return SceneError::at(key, problem);
        };
        let entry = self.scene.axis.iter().position(|a| a.number == axis);
        match entry.map(|entry| (entry, &self.scene.axis[entry])) {
            Some((entry, apart)) if apart.has(name) => {
                SceneError::at(format!("axis[{entry}].{name}"), problem)
            }
            _ => SceneError::at(key, problem),
        }
    }

    /// The core's settings.
    pub fn settings<const N: usize>(&self) -> Settings<N> {
        let scene = &self.scene;
        let (machine, limits, drift) = (&scene.machine, &scene.limits, &scene.drift);
        let bands: heapless::Vec<_, MAX_BANDS> = limits
            .band
            .iter()
            .take(MAX_BANDS)
            .map(|band| BandSettings {
                from_hz: band.from_hz,
                to_hz: band.to_hz,
            })
            .collect();
        Settings {
            tick_hz: scene.control.tick_hz,
            machine: MachineSettings {
                crank_radius_m: machine.crank_radius_mm / 1e3,
                lambda: self.lambda,
                load_kg: machine.load_kg,
                platform: match machine.platform {
                    file::Platform::Above => CorePlatform::Above,
                    file::Platform::Below => CorePlatform::Below,
                },
                gravity_mps2: machine.gravity_mps2,
                mount_radius_m: machine.mount_radius_mm / 1e3,
            },
            limits: LimitSettings {
                speed_hz: limits.speed_hz,
                acceleration_hz_per_s: limits.acceleration_hz_per_s,
                jerk_hz_per_s2: limits.jerk_hz_per_s2,
                creep_hz: limits.creep_hz,
                bands,
            },
            pulse: PulseSettings {
                width_ns: scene.pulse.width_ns,
                dir_setup_ns: scene.pulse.dir_setup_ns,
                dir_hold_ns: scene.pulse.dir_hold_ns,
            },
            axes: std::array::from_fn(|i| self.axis(i)),
            drift: DriftSettings {
                tilt_limit_mrad: drift.tilt_limit_mrad,
                warp_limit_deg: drift.warp_limit_deg,
                common_limit_deg: drift.common_limit_deg,
            },
            park_turns: scene.control.park_deg / 360.0,
            settle_s: scene.control.settle_s,
        }
    }

    /// One axis: what all have in common, with what it has apart.
    fn axis(&self, number: usize) -> AxisSettings {
        let axes = &self.scene.axes;
        let apart = self.apart(number);
        let own = |pick: fn(&AxisApart) -> Option<f64>| apart.and_then(pick);
        let index_deg = own(|a| a.index_deg).unwrap_or(axes.index_deg);
        AxisSettings {
            drive: match apart.and_then(|a| a.drive).unwrap_or(axes.drive) {
                Drive::Stepper => DriveKind::Stepper,
                Drive::Servo => DriveKind::Servo,
            },
            steps_per_turn: apart
                .and_then(|a| a.steps_per_turn)
                .unwrap_or(axes.steps_per_turn),
            reversed: apart.is_some_and(|a| a.reversed),
            ratio: apart.and_then(|a| a.ratio).unwrap_or(axes.ratio),
            offset_turns: own(|a| a.offset_deg).unwrap_or(axes.offset_deg) / 360.0,
            index_turns: apart
                .and_then(|a| a.index)
                .unwrap_or(axes.index)
                .then_some(index_deg / 360.0),
            trim_limit_turns: axes.trim_limit_deg / 360.0,
            trim_rate_hz: axes.trim_rate_deg_per_s / 360.0,
            rotor_inertia_kgm2: axes.rotor_inertia_kgm2,
        }
    }

    /// The profile of this scene's machine.
    pub fn profile(&self) -> Profile {
        let machine = &self.scene.machine;
        let crank = SliderCrank::new(
            machine.crank_radius_mm / 1e3,
            self.lambda,
            self.scene.control.tick_hz,
        );
        Profile::SliderCrank(crank)
    }

    /// What axis `number` has apart from the others.
    pub fn apart(&self, number: usize) -> Option<&AxisApart> {
        self.scene.axis.iter().find(|apart| apart.number == number)
    }

    fn program(&self, mut builder: ProgramBuilder) -> Result<Program, SceneError> {
        append(&mut builder, &self.scene.program, "program", 0)?;
        builder.build().map_err(|error| self.placed(error))
    }
}

impl AxisApart {
    /// Whether a key of [`file::Axes`] is given for this axis apart.
    fn has(&self, name: &str) -> bool {
        match name {
            "drive" => self.drive.is_some(),
            "steps_per_turn" => self.steps_per_turn.is_some(),
            "ratio" => self.ratio.is_some(),
            "offset_deg" => self.offset_deg.is_some(),
            "index_deg" => self.index_deg.is_some(),
            _ => false,
        }
    }
}

fn lambda(machine: &file::Machine) -> Result<f64, SceneError> {
    match (machine.lambda, machine.rod_length_mm) {
        (Some(lambda), None) => Ok(lambda),
        (None, Some(length_mm)) => {
            let lambda = machine.crank_radius_mm / length_mm;
            // A crank that cannot be is refused for itself, by the core.
            if (0.1..=0.6).contains(&lambda) || !(0.1..=500.0).contains(&machine.crank_radius_mm) {
                return Ok(lambda);
            }
            // Rounded inwards, so that what is advised is accepted.
            let low = (machine.crank_radius_mm / 0.6 * 100.0).ceil() / 100.0;
            let high = (machine.crank_radius_mm / 0.1 * 100.0).floor() / 100.0;
            Err(SceneError::of(
                "machine.rod_length_mm",
                Problem::OutOfRange {
                    value: length_mm,
                    low,
                    high,
                },
            )
            .because("1.67 to 10 crank radii"))
        }
        (Some(_), Some(_)) => Err(SceneError::at(
            "machine.rod_length_mm",
            "given together with machine.lambda, which says the same; leave one out",
        )),
        (None, None) => Err(SceneError::at(
            "machine.lambda",
            "missing; give the ratio of crank radius to rod length, or machine.rod_length_mm",
        )),
    }
}

fn check_apart(scene: &Scene, entry: usize, apart: &AxisApart) -> Result<(), SceneError> {
    let key = |name: &str| format!("axis[{entry}].{name}");
    if apart.number >= scene.axes.count {
        return Err(SceneError::at(
            key("number"),
            format!(
                "there is no axis {}; with axes.count = {} they are 0 to {}",
                apart.number,
                scene.axes.count,
                scene.axes.count - 1
            ),
        ));
    }
    if scene.axis[..entry]
        .iter()
        .any(|other| other.number == apart.number)
    {
        return Err(SceneError::at(
            key("number"),
            format!(
                "axis {} has an [[axis]] of its own already; put both into one",
                apart.number
            ),
        ));
    }
    if let Some(friction_nm) = apart.friction_nm {
        range(&key("friction_nm"), friction_nm, 0.0, MOST_FRICTION_NM)?;
    }
    range(&key("start_deg"), apart.start_deg, -180.0, 180.0)?;
    range(&key("trim_deg"), apart.trim_deg, -36.0, 36.0)?;
    range(&key("pull_out_scale"), apart.pull_out_scale, 0.0, 10.0)
}

fn check_times(scene: &Scene) -> Result<(), SceneError> {
    const MOST_S: f64 = 1e6;
    for (i, command) in scene.command.iter().enumerate() {
        range(&format!("command[{i}].at_s"), command.at_s, 0.0, MOST_S)?;
    }
    for (i, input) in scene.input.iter().enumerate() {
        range(&format!("input[{i}].at_s"), input.at_s, 0.0, MOST_S)?;
    }
    for (i, late) in scene.late.iter().enumerate() {
        range(&format!("late[{i}].at_s"), late.at_s, 0.0, MOST_S)?;
        range(&format!("late[{i}].by_us"), late.by_us, 0.0, 1e6)?;
    }
    let axes = &scene.axes;
    range("axes.friction_nm", axes.friction_nm, 0.0, MOST_FRICTION_NM)?;
    range(
        "axes.full_steps_per_turn",
        f64::from(axes.full_steps_per_turn),
        4.0,
        65_536.0,
    )?;
    if scene.limits.band.len() > MAX_BANDS {
        return Err(SceneError::at(
            "limits.band",
            format!(
                "{} bands are more than the {MAX_BANDS} that the shaft keeps; join neighbours",
                scene.limits.band.len()
            ),
        ));
    }
    if let Some(scope) = scene.scope {
        range("scope.from_s", scope.from_s, 0.0, MOST_S)?;
        range("scope.to_s", scope.to_s, 0.0, MOST_S)?;
        if scope.to_s <= scope.from_s {
            return Err(SceneError::at(
                "scope.to_s",
                format!(
                    "{} is not after scope.from_s = {}; swap or part them",
                    scope.to_s, scope.from_s
                ),
            ));
        }
    }
    Ok(())
}

/// What the core would find too, one edge at a time; said of the whole.
fn check_bands(limits: &file::Limits) -> Result<(), SceneError> {
    for (i, band) in limits.band.iter().enumerate() {
        if band.from_hz <= limits.creep_hz && band.to_hz >= limits.speed_hz {
            return Err(SceneError::at(
                format!("limits.band[{i}]"),
                format!(
                    "the band covers all speeds from limits.creep_hz = {} to limits.speed_hz = {} rev/s, so \
                     that none is left to run at; let it begin above the one and end below the other",
                    limits.creep_hz, limits.speed_hz
                ),
            ));
        }
    }
    Ok(())
}

fn range(key: &str, value: f64, low: f64, high: f64) -> Result<(), SceneError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(SceneError::of(
        key,
        Problem::OutOfRange { value, low, high },
    ))
}

/// The lowest rung that answers what the scene asks.
fn rung(scene: &Scene) -> Result<(Fidelity, String), SceneError> {
    let has_torque = !scene.axes.pull_out.is_empty();
    match scene.fidelity {
        Fidelity::QuasiStatic if !has_torque => Err(SceneError::at(
            "axes.pull_out",
            "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
             as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
        )),
        Fidelity::Auto if has_torque => Ok((
            Fidelity::QuasiStatic,
            "the scene gives the motors' pull-out torque, so whether they keep in step is asked"
                .to_owned(),
        )),
        Fidelity::Auto => Ok((
            Fidelity::Kinematic,
            "the scene says nothing of torque, so only phases and what follows from them are asked"
                .to_owned(),
        )),
        chosen => Ok((chosen, "the scene asks for it".to_owned())),
    }
}

/// Appends entries to a program, blocks with all that is in them.
fn append(
    builder: &mut ProgramBuilder,
    entries: &[Segment],
    path: &str,
    depth: usize,
) -> Result<(), SceneError> {
    if depth > MOST_NESTING {
        return Err(SceneError::at(
            path,
            format!("blocks are nested more than {MOST_NESTING} deep; write some of them out"),
        ));
    }
    for (i, entry) in entries.iter().enumerate() {
        let here = format!("{path}[{i}]");
        // The core knows keys, but not which entry they are of.
        let placed = |error: SettingsError| {
            let key = error.key.strip_prefix("program").unwrap_or(error.key);
            in_g(format!("{here}{key}"), error.problem)
        };
        match block_or_level(entry, &here)? {
            Entry::Block { segments, times } => {
                let first = builder.here();
                append(builder, segments, &format!("{here}.segments"), depth + 1)?;
                builder.repeat(first, times).map_err(placed)?;
            }
            Entry::Level(amax_g) => {
                let settings = SegmentSettings {
                    amax_mps2: amax_g * STANDARD_GRAVITY_MPS2,
                    ramp_s: entry.ramp_s.unwrap_or(0.0),
                    hold_s: entry.hold_s.unwrap_or(0.0),
                    shape: match entry.shape.unwrap_or_default() {
                        file::Shape::Linear => ProgramShape::Linear,
                        file::Shape::Smooth => ProgramShape::Smooth,
                    },
                };
                builder.segment(settings).map_err(placed)?;
            }
        }
    }
    Ok(())
}

/// A problem with a level: the core reckons in m/s², the file in g.
fn in_g(key: String, problem: Problem) -> SceneError {
    let g = |mps2: f64| mps2 / STANDARD_GRAVITY_MPS2;
    match problem {
        Problem::OutOfRange { value, low, high } if key.ends_with(".amax_g") => {
            let (value, low, high) = (g(value), g(low), (g(high) * 10.0).floor() / 10.0);
            SceneError::of(key, Problem::OutOfRange { value, low, high })
        }
        Problem::LevelOutOfReach {
            asked_mps2,
            needed_hz,
            limit_hz,
            most_mps2,
        } => SceneError::at(
            key,
            format!(
                "{:.2} g ({asked_mps2:.2} m/s²) needs {needed_hz:.3} rev/s, over limits.speed_hz = {limit_hz}; \
                 give at most {} g, or raise limits.speed_hz",
                g(asked_mps2),
                // Rounded down, so that what is advised is accepted.
                (g(most_mps2) * 100.0).floor() / 100.0
            ),
        ),
        other => SceneError::of(key, other),
    }
}

enum Entry<'a> {
    Level(f64),
    Block { segments: &'a [Segment], times: u32 },
}

fn block_or_level<'a>(entry: &'a Segment, path: &str) -> Result<Entry<'a>, SceneError> {
    let key = |name: &str| format!("{path}.{name}");
    match (entry.amax_g, &entry.segments, entry.repeat) {
        (Some(amax_g), None, None) => Ok(Entry::Level(amax_g)),
        (None, Some(segments), Some(times)) => {
            for (name, given) in [
                ("ramp_s", entry.ramp_s.is_some()),
                ("hold_s", entry.hold_s.is_some()),
                ("shape", entry.shape.is_some()),
            ] {
                if given {
                    return Err(SceneError::at(
                        key(name),
                        "belongs to a level, not to a block that is repeated; put it into the block's segments",
                    ));
                }
            }
            Ok(Entry::Block { segments, times })
        }
        (None, None, None) => Err(SceneError::at(
            key("amax_g"),
            "missing; give the level to go to, or `repeat` and `segments`",
        )),
        (None, Some(_), None) => Err(SceneError::at(
            key("repeat"),
            "missing; say how often `segments` are to be played",
        )),
        (None, None, Some(_)) => Err(SceneError::at(
            key("segments"),
            "missing; give the block that is to be repeated",
        )),
        (Some(_), _, _) => Err(SceneError::at(
            key("amax_g"),
            "given together with a block; a program entry is either a level or a block: split it in two",
        )),
    }
}
