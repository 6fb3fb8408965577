//! Speed of the core alone and of whole runs, in control ticks per second and per calibration load (see `measure`).
//!
//!     cargo bench -p host-sim --bench speed                 # all figures
//!     cargo bench -p host-sim --bench speed -- core-4 rigid # those with these words in their names
//!
//! - `core-N`: [`Controller::tick`] on `N` stepper axes in the middle of a program, all index sensors at one crank angle. The
//!   index pulses were recorded before, by playing the commanded phases to ideal sensors.
//! - `run-LEVEL`: a scene at a model level, without output and without an observer.
//!
//! `tests/baseline/bench` puts these figures beside those of commit 66e71d7.

mod measure;

use std::hint::black_box;

use cophase_core::controller::Controller;
use cophase_core::monitor::IndexPulse;
use cophase_core::signals::Feedback;
use cophase_core::supervisor::{Command, State};
use cophase_core::units::{MAX_AXES, PerAxis, Phase};
use cophase_scene::{Scene, load};
use host_sim::checked::Checked;
use host_sim::sim::simulate;

use measure::{Figure, Work};

/// Figures with their least ticks per load: a third of those of 66e71d7 on a shared x86-64 host. They detect a slowdown by several
/// times. `tests/baseline/bench` shows smaller ones.
const FIGURES: [Figure; 6] = [
    figure("core-2", 1700.0, || core(2)),
    figure("core-4", 1300.0, || core(4)),
    figure("core-6", 1100.0, || core(6)),
    figure("run-kinematic", 400.0, || run(default_scene())),
    figure("run-rigid", 140.0, || run(four_motors("rigid"))),
    figure("run-phased", 30.0, || run(four_motors("phased"))),
];

const fn figure(name: &'static str, min_per_load: f64, set_up: fn() -> Work) -> Figure {
    Figure {
        name,
        unit: "ticks",
        min_per_load,
        set_up,
    }
}

fn main() {
    measure::run(&FIGURES);
}

/// Number of ticks before the measured ticks, and number of measured ticks: ten simulated seconds each. The second ten have a
/// ramp, a level inside a band, and the crossing of that band.
const TICKS: usize = 20_000;

/// Crank angle of all index sensors.
const INDEX_DEG: f64 = 15.0;

/// Returns the scene that is run.
fn scene() -> Scene {
    load::parse(include_str!("speed.toml")).unwrap()
}

/// Returns the work of the core alone, with recorded feedback.
fn core(count: usize) -> Work {
    let mut scene = scene();
    scene.axes.count = count;
    scene.axis.retain(|axis| axis.number < count);
    scene.axes.index_deg = INDEX_DEG;
    let checked = Checked::new(scene).unwrap();
    let mut controller = checked.controller().unwrap();
    let mut sensors = Sensors::new(count, checked.settings.tick_cycles());

    let mut record = |controller: &mut Controller, command| {
        let feedback = Feedback {
            index: sensors.index.into(),
            ..Feedback::with_command(command)
        };
        let telemetry = &controller.tick(&feedback).telemetry;
        sensors.follow(std::array::from_fn(|axis| telemetry.axis_phase(axis)));
        feedback
    };
    record(&mut controller, Some(Command::Start));
    for _ in 1..TICKS {
        record(&mut controller, None);
    }
    let begun = controller.clone();
    let recorded: Vec<_> = (0..TICKS).map(|_| record(&mut controller, None)).collect();
    let pulses = recorded
        .iter()
        .filter(|one| one.index.of(count - 1).is_some());
    assert!(pulses.count() > 200, "the sensors are passed once per turn");
    // If pulses are read in a wrong tick, the phase errors are some degrees. Rounding to whole cycles gives only some millidegrees.
    let errors = controller
        .tick(&Feedback::with_command(None))
        .telemetry
        .phase_error;
    let furthest = errors.iter().map(|error| error.abs()).max().unwrap();
    assert!(furthest != 0 && furthest.to_num::<f64>() < 0.01 / 360.0);

    Box::new(move || {
        let mut controller = begun.clone();
        for feedback in &recorded {
            black_box(controller.tick(feedback));
        }
        let telemetry = &controller.tick(&Feedback::with_command(None)).telemetry;
        assert_eq!((telemetry.state, telemetry.fault), (State::Run, None));
        TICKS as u64 + 1
    })
}

/// Ideal index sensors of cranks at their commanded phases.
struct Sensors {
    count: usize,
    cycles: f64,
    /// Pulses that the next call of the tick reads. They are from the tick that played the output of two calls before it.
    index: PerAxis<Option<IndexPulse>>,
    /// Commanded phases at the ends of the last two ticks that were planned.
    phases: Option<[PerAxis<Phase>; 2]>,
}

impl Sensors {
    fn new(count: usize, tick_cycles: u32) -> Self {
        Self {
            count,
            cycles: f64::from(tick_cycles),
            index: [None; MAX_AXES],
            phases: None,
        }
    }

    /// Takes the phases at the end of a planned tick, while the tick planned before it plays.
    fn follow(&mut self, planned: PerAxis<Phase>) {
        if let Some([from, to]) = self.phases {
            self.index = std::array::from_fn(|axis| {
                let exists = axis < self.count;
                exists.then(|| self.pulse(from[axis], to[axis])).flatten()
            });
        }
        let playing = self.phases.map_or(planned, |[_, playing]| playing);
        self.phases = Some([playing, planned]);
    }

    /// Returns the pulse of a crank that moves forwards at constant speed, if its flag comes within a tick.
    fn pulse(&self, from: Phase, to: Phase) -> Option<IndexPulse> {
        let turns = to.since(from).to_num::<f64>();
        let beyond_index = (from.within_turn().to_num::<f64>() - INDEX_DEG / 360.0).rem_euclid(1.0);
        let part = (1.0 - beyond_index) / turns;
        (turns > 0.0 && part <= 1.0).then_some(IndexPulse {
            cycle: (part * self.cycles) as i32,
        })
    }
}

/// Returns the work of a whole run.
fn run(checked: Checked) -> Work {
    let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
    assert!(outcome.diverged.is_none() && outcome.fault.is_none());
    if let Some((scheme, steps)) = outcome.method {
        println!("# {:?}: {scheme}, {steps} steps a tick", checked.fidelity);
    }
    Box::new(move || {
        let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
        outcome.record.control_ticks
    })
}

/// Returns the default scene, in which the step pulses alone determine the crank angles.
fn default_scene() -> Checked {
    Checked::new(scene()).unwrap()
}

/// Returns a scene with four steppers of NEMA 34 size and a platform of 8 kg. The motors have 200 full steps, and 8 N·m that
/// fall to 2 at 30 rev/s.
fn four_motors(level: &str) -> Checked {
    let text = format!(
        r#"
        name = "speed"
        fidelity = "{level}"
        [machine]
        crank_radius_mm = 10
        lambda = 0.25
        load_kg = 8
        mount_radius_mm = 200
        [limits]
        speed_hz = 25
        acceleration_hz_per_s = 30
        jerk_hz_per_s2 = 300
        [axes]
        count = 4
        drive = "stepper"
        steps_per_turn = 12800
        rotor_inertia_kgm2 = 1e-3
        friction_nm = 0.05
        damping_nms = 0.1
        pull_out = [[0, 8.0], [5, 7.5], [15, 5.0], [30, 2.0]]
        [[program]]
        amax_g = 15
        ramp_s = 2
        hold_s = 3
        "#
    );
    Checked::new(load::parse(&text).unwrap()).unwrap()
}
