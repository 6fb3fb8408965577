//! The figures of `host-sim/benches/speed.rs`, through the interfaces of commit 66e71d7. `bench` beside this file puts it there.
//!
//! Work and names are the same as there: what is changed in one is changed in both.
//!
//! - `core-N`: [`Controller::tick`] on `N` stepper axes in the middle of a program, all index sensors at one crank angle. The
//!   index pulses were recorded before, by playing the commanded phases to ideal sensors.
//! - `run-LEVEL`: a scene at a model level, with nothing written and nobody looking on.

mod measure;

use std::hint::black_box;

use cophase_core::controller::Controller;
use cophase_core::drift::IndexPulse;
use cophase_core::settings::CLOCK_HZ;
use cophase_core::signals::Feedback;
use cophase_core::supervisor::{Command, State};
use cophase_core::units::Phase;
use host_sim::checked::Checked;
use cophase_scene::{library, load};
use host_sim::sim::simulate;
use measure::{Figure, Work};

/// Nothing is asserted here.
const FIGURES: [Figure; 6] = [
    figure("core-2", 0.0, core::<2>),
    figure("core-4", 0.0, core::<4>),
    figure("core-6", 0.0, core::<6>),
    figure("run-kinematic", 0.0, || run(default_scene())),
    figure("run-rigid", 0.0, || run(four_motors("rigid"))),
    figure("run-phased", 0.0, || run(four_motors("phased"))),
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

/// Ticks before those that are measured, and these: ten simulated seconds each. The second ten have a ramp, a level inside a
/// band, and the crossing of that band.
const TICKS: usize = 20_000;

/// Crank angle of all index sensors.
const INDEX_DEG: f64 = 15.0;

/// The core alone, with feedback that was recorded.
fn core<const N: usize>() -> Work {
    let mut scene = library::SCENES[0].scene();
    scene.axes.count = N;
    scene.axis.retain(|axis| axis.number < N);
    scene.axes.index_deg = INDEX_DEG;
    let mut controller: Controller<N> = Checked::new(scene).unwrap().controller().unwrap();
    let mut sensors = Sensors::new(&controller);

    let mut record = |controller: &mut Controller<N>, command| {
        let feedback = Feedback {
            index: sensors.index,
            ..Feedback::with_command(command)
        };
        sensors.follow(controller.tick(&feedback).telemetry.axis_phase);
        feedback
    };
    record(&mut controller, Some(Command::Start));
    for _ in 1..TICKS {
        record(&mut controller, None);
    }
    let begun = controller.clone();
    let recorded: Vec<_> = (0..TICKS).map(|_| record(&mut controller, None)).collect();
    let pulses = recorded.iter().filter(|one| one.index[N - 1].is_some());
    assert!(pulses.count() > 200, "the sensors are passed once per turn");
    // Were pulses read in a wrong tick, cranks would seem to be degrees behind. Cycles are whole: some millidegrees.
    let errors = controller.tick(&Feedback::with_command(None)).telemetry.drift;
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

/// Ideal index sensors of cranks that are where they are commanded to be.
struct Sensors<const N: usize> {
    cycles: f64,
    /// Pulses that the next call of the tick reads: those of the tick that played what was returned two calls before it.
    index: [Option<IndexPulse>; N],
    /// Commanded phases at the ends of the last two ticks that were planned.
    phases: Option<[[Phase; N]; 2]>,
}

impl<const N: usize> Sensors<N> {
    fn new(controller: &Controller<N>) -> Self {
        Self {
            cycles: f64::from(CLOCK_HZ / controller.tick_hz()),
            index: [None; N],
            phases: None,
        }
    }

    /// Takes the phases to which a tick was planned, while the tick planned before it plays.
    fn follow(&mut self, planned: [Phase; N]) {
        if let Some([from, to]) = self.phases {
            self.index = std::array::from_fn(|axis| self.pulse(from[axis], to[axis]));
        }
        let playing = self.phases.map_or(planned, |[_, playing]| playing);
        self.phases = Some([playing, planned]);
    }

    /// The pulse of a crank that moves forwards at constant speed, if its flag comes within a tick.
    fn pulse(&self, from: Phase, to: Phase) -> Option<IndexPulse> {
        let turns = to.since(from).to_num::<f64>();
        let beyond_index = (from.within_turn().to_num::<f64>() - INDEX_DEG / 360.0).rem_euclid(1.0);
        let part = (1.0 - beyond_index) / turns;
        (turns > 0.0 && part <= 1.0).then_some(IndexPulse {
            cycle: (part * self.cycles) as i32,
        })
    }
}

/// A whole run.
fn run(checked: Checked) -> Work {
    let outcome = simulate::<4>(&checked, &mut (), |_, _| {}).unwrap();
    assert!(outcome.diverged.is_none() && outcome.fault.is_none());
    if let Some((scheme, steps)) = outcome.method {
        println!("# {:?}: {scheme}, {steps} steps a tick", checked.fidelity);
    }
    Box::new(move || {
        let outcome = simulate::<4>(&checked, &mut (), |_, _| {}).unwrap();
        outcome.ticks
    })
}

/// The default scene, where cranks are where pulses put them.
fn default_scene() -> Checked {
    Checked::new(library::SCENES[0].scene()).unwrap()
}

/// Four steppers of NEMA 34 size: 200 full steps, 8 N·m that fall to 2 at 30 rev/s; a platform of 8 kg.
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
