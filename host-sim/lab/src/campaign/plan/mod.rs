//! Drawing of cases: the machine, its program, its noise, and its fault.
//!
//! A *case* has a number. All of it is drawn from a random stream of its own ([`stream`]), and [`VERSION`] identifies the method. A case is
//! run twice: with its fault (the *faulty* run), and without it, with noise alone (the *clean* run).

pub mod faults;
pub mod machines;
pub mod strata;
pub mod stream;

use cophase_scene::file::{FaultAt, FaultName, Noise};
use cophase_scene::{Scene, SceneError};
use host_sim::checked::Checked;
use host_sim::mechanism::Mechanism;

use super::geometry::Geometry;
use faults::Window;
use machines::Driven;
use strata::{Share, Stratum};
use stream::Stream;

/// Version of the plan. A seed draws the same cases as long as this is the same.
pub const VERSION: u32 = 4;

/// Machines on the phased model level, where torque moves the cranks, percent.
const ON_ROTORS_PERCENT: u32 = 10;

/// Case of a campaign.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the case, and the seed of its campaign.
    pub number: u64,
    seed: u64,
    /// Name of the machine.
    pub machine: String,
    /// Scene of the machine, with its fault.
    pub scene: Scene,
}

impl Case {
    /// Fault of the case.
    pub fn fault(&self) -> &FaultAt {
        &self.scene.fault[0]
    }

    /// Returns the scene of the faulty or of the clean run.
    pub fn scene_of(&self, clean: bool) -> Scene {
        let mut scene = self.scene.clone();
        if clean {
            scene.name.push_str("-clean");
            scene.description = title(self.number, self.seed, "no fault", &self.machine);
            scene.fault.clear();
        }
        scene
    }
}

/// Seed, kinds of faults and machines from which cases are drawn.
#[derive(Clone, Debug)]
pub struct Plan {
    seed: u64,
    /// Scene of the user. Without it, machines are drawn.
    scene: Option<Checked>,
    kinds: Vec<FaultName>,
}

impl Plan {
    /// Plan for a seed, with a given scene or with the machines of [`machines`].
    ///
    /// # Errors
    /// The scene has faults already, or no fault is possible in it.
    pub fn new(seed: u64, scene: Option<Checked>) -> Result<Self, SceneError> {
        let Some(checked) = &scene else {
            let kinds = faults::KINDS.to_vec();
            return Ok(Self { seed, scene, kinds });
        };
        if !checked.scene.fault.is_empty() {
            return Err(SceneError::for_key(
                "fault",
                "has faults of its own, and a campaign draws them; leave them out",
            ));
        }
        let kinds = kinds_of(checked);
        if kinds.is_empty() {
            return Err(SceneError::for_key(
                "",
                "has nothing that could go wrong on its model level; give axes with index sensors or encoders",
            ));
        }
        Ok(Self { seed, scene, kinds })
    }

    /// The seed.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The user's scene.
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref().map(|checked| &checked.scene)
    }

    /// Returns the strata of the cases, and the share of each, in the order of the kinds.
    pub fn strata(&self) -> Vec<(Stratum, Share)> {
        let mut strata = Vec::new();
        for &kind in &self.kinds {
            let encoders: Vec<bool> = match &self.scene {
                Some(checked) => vec![checked.scene.axes.encoder],
                None => fit(kind).into_iter().map(Driven::has_encoder).collect(),
            };
            for encoder in [false, true] {
                let of = encoders.iter().filter(|&&with| with == encoder).count();
                if of > 0 {
                    let share = Share {
                        of: of as u64,
                        among: (encoders.len() * self.kinds.len()) as u64,
                    };
                    strata.push((Stratum { kind, encoder }, share));
                }
            }
        }
        strata
    }

    /// Returns the stratum of a case. It is that of [`Plan::case`], at a small part of the cost.
    pub fn stratum(&self, number: u64) -> Stratum {
        let (kind, source) = self.begin(&mut Stream::new(self.seed, number));
        let encoder = match source {
            Source::Given(checked) => checked.scene.axes.encoder,
            Source::Drawn(driven) => driven.has_encoder(),
        };
        Stratum { kind, encoder }
    }

    /// Draws the kind of a case and, unless a scene is given, the drives of its machine.
    fn begin(&self, stream: &mut Stream) -> (FaultName, Source<'_>) {
        let kind = stream.one_of(&self.kinds);
        let source = match &self.scene {
            Some(checked) => Source::Given(checked),
            None => Source::Drawn(stream.one_of(&fit(kind))),
        };
        (kind, source)
    }

    /// Draws the case with a number.
    pub fn case(&self, number: u64) -> Case {
        let mut stream = Stream::new(self.seed, number);
        let (kind, source) = self.begin(&mut stream);
        let (machine, mut scene) = match source {
            Source::Given(checked) => given(&mut stream, checked),
            Source::Drawn(driven) => drawn(&mut stream, kind, driven),
        };
        let geometry = Geometry::new(&scene);
        let window = match source {
            Source::Given(checked) => window_of_given(checked),
            Source::Drawn(_) => window(&scene, geometry.as_ref()),
        };
        scene.name = format!("case-{number}");
        scene.description = title(number, self.seed, kind.name(), &machine);
        scene.fault = vec![faults::draw(
            &mut stream,
            &scene,
            geometry.as_ref(),
            &window,
            kind,
        )];
        Case {
            number,
            seed: self.seed,
            machine,
            scene,
        }
    }
}

/// Description of a case's scene.
fn title(number: u64, seed: u64, what: &str, machine: &str) -> String {
    format!("case {number} of seed {seed}: {what} on the machine {machine}")
}

/// Source of the machine of a case.
#[derive(Clone, Copy)]
enum Source<'a> {
    /// The user's scene.
    Given(&'a Checked),
    /// A drawn machine, with these drives.
    Drawn(Driven),
}

/// Returns the variants of drives that are drawn for a kind of fault.
fn fit(kind: FaultName) -> Vec<Driven> {
    let befalls = |driven: &Driven| faults::befalls(kind, *driven);
    Driven::ALL.into_iter().filter(befalls).collect()
}

/// Draws a machine for a kind of fault.
fn drawn(stream: &mut Stream, kind: FaultName, driven: Driven) -> (String, Scene) {
    let on_rotors = stream.percent(ON_ROTORS_PERCENT) || faults::needs_torque(kind);
    let prove = stream.percent(50) || faults::needs_proof(kind);
    // A pattern that proves the wiring needs room within the limits, and a board has to keep the tick rate. A few machines are refused for
    // that, and the next one is drawn instead.
    let mut machine = machines::draw(stream, driven, on_rotors, prove);
    for _ in 0..MAX_DRAWN {
        if is_accepted(&machine) {
            break;
        }
        machine = machines::draw(stream, driven, on_rotors, prove);
    }
    (machine.name.clone(), machine)
}

/// Largest number of further draws. At least one machine in two is accepted.
const MAX_DRAWN: usize = 50;

/// True if a run accepts the scene of a machine from a file.
fn is_accepted(machine: &Scene) -> bool {
    Checked::new(machine.clone()).is_ok_and(|checked| checked.check_rate().is_ok())
}

/// Returns the user's machine. It gets noise at the stated level unless it has its own. The seed of the noise is drawn for the case.
fn given(stream: &mut Stream, checked: &Checked) -> (String, Scene) {
    let mut scene = checked.scene.clone();
    if scene.noise.is_none() {
        scene.noise = Noise {
            encoder_counts: if scene.axes.encoder {
                machines::NOISE.encoder_counts
            } else {
                0.0
            },
            ..machines::NOISE
        };
    }
    scene.noise.seed = stream.seed();
    // A replay of the file must use the same model level. So the scene stores the chosen level, and not the questions that choose one.
    scene.fidelity = checked.fidelity;
    scene.questions = Default::default();
    (checked.scene.name.clone(), scene)
}

/// Returns the kinds of faults that suit the axes of a scene, can be detected, and pass its check.
fn kinds_of(checked: &Checked) -> Vec<FaultName> {
    let scene = &checked.scene;
    let geometry = Geometry::new(scene);
    let window = window_of_given(checked);
    let is_taken = |kind: FaultName| {
        let mut stream = Stream::new(0, 0);
        let (_, mut scene) = given(&mut stream, checked);
        scene.fault = vec![faults::draw(
            &mut stream,
            &scene,
            geometry.as_ref(),
            &window,
            kind,
        )];
        Checked::new(scene).is_ok()
    };
    let fits = |kind: &FaultName| {
        let needs_index = matches!(kind, FaultName::IndexMissing | FaultName::IndexExtra);
        !faults::axes_for(scene, *kind).is_empty()
            && (scene.correction.prove_wiring || !faults::needs_proof(*kind))
            && (checked.moves_by_torque() || !faults::needs_torque(*kind))
            && (scene.axes.index || !needs_index)
            && is_taken(*kind)
    };
    faults::KINDS.into_iter().filter(fits).collect()
}

/// Window of a drawn machine. Homing takes two turns and the time of the corrections, which is not known here. So `run_s` is about the
/// beginning of *run*, and the hold is long enough for the difference not to matter.
fn window(scene: &Scene, geometry: Option<&Geometry>) -> Window {
    let amax_mps2 =
        scene.program[0].amax_g.unwrap_or_default() * cophase_scene::units::STANDARD_GRAVITY_MPS2;
    let level_hz = geometry.map_or(scene.limits.homing_speed_hz, |geometry| {
        geometry.mechanism().speed_for_amax_rad_s(amax_mps2) / std::f64::consts::TAU
    });
    let proof_s = if scene.correction.prove_wiring {
        2.0 / scene.limits.homing_speed_hz
    } else {
        0.0
    };
    let run_s = scene.control.settle_s + 2.2 / scene.limits.homing_speed_hz + proof_s;
    let program_s = |part: f64| {
        let segment = &scene.program[0];
        segment.ramp_s.unwrap_or_default() + part * segment.hold_s.unwrap_or_default()
    };
    Window {
        homing_s: scene.control.settle_s + 0.05,
        run_s,
        end_s: run_s + program_s(0.5),
        level_hz,
    }
}

/// Window of the user's scene: all of its program but the last twentieth.
fn window_of_given(checked: &Checked) -> Window {
    let scene = &checked.scene;
    let controller = checked.controller();
    let ticks = controller.map_or(0, |controller| controller.program().0.duration());
    let program_s = ticks as f64 / f64::from(scene.control.tick_hz);
    let run_s = scene.control.settle_s + 2.5 / scene.limits.homing_speed_hz;
    Window {
        homing_s: scene.control.settle_s + 0.05,
        run_s,
        end_s: run_s + 0.95 * program_s,
        level_hz: checked.top_speed_hz(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a campaign runs machines that no board runs, and the scene of a replay is refused.
    #[test]
    fn a_run_accepts_every_drawn_machine() {
        let drawn = |seed: u64, number: u64| Plan::new(seed, None).unwrap().case(number).scene;
        let of_one_seed = (0..300).map(|number| (1, number));
        // Their first machines have four and five axes at 4 kHz.
        let too_fast = [
            (699_814_883, 5781),
            (310_044_136, 9513),
            (332_297_142, 2714),
        ];
        for (seed, number) in of_one_seed.chain(too_fast) {
            assert!(
                is_accepted(&drawn(seed, number)),
                "case {number} of seed {seed}"
            );
        }
    }
}
