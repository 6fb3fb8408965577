//! The electronic cam against the mechanical cam shaft: the same law and the same program, once as four cams that turn with the master, and once as
//! four pushers on screws that follow a cam table.

use cophase_core::supervisor::State;
use cophase_tests::scene;
use host_sim::scene::library;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

const AXES: usize = 4;

/// Place and acceleration of every pusher in every tick.
#[derive(Default)]
struct Pushers {
    ticks: Vec<[(f64, f64); AXES]>,
}

impl Observer for Pushers {
    fn tick(&mut self, moment: &Moment<'_>) {
        let followers = moment.machine.followers().expect("a scene with pushers");
        let pushers = followers.pushers();
        let of = |axis: usize| (pushers[axis].place_m, pushers[axis].accel_mps2);
        self.ticks.push(std::array::from_fn(of));
    }
}

fn run(text: &str) -> (Pushers, Outcome) {
    let mut pushers = Pushers::default();
    let outcome = simulate(&scene(text), &mut pushers, |_, _| {}).unwrap();
    assert!(outcome.fault.is_none(), "{:?}", outcome.fault);
    assert_eq!(outcome.state, State::Parked);
    (pushers, outcome)
}

/// The scene with cams on shafts instead: servos, so that they stand where they are commanded, not at the step before.
fn mechanical(electronic: &str) -> String {
    let (head, rest) = electronic.split_once("[[cam_table]]").unwrap();
    let (_, rest) = rest.split_once("[control]").unwrap();
    let head = head
        .lines()
        .filter(|line| !line.starts_with("screw_lead_mm"));
    let mut text = format!("{}\n[control]{rest}", head.collect::<Vec<_>>().join("\n"));
    text = text
        .replace("\"stepper\"", "\"servo\"")
        .replace("cam = \"lobe\"\n", "");
    for (electronic, mechanical) in [
        ("cam_shift_deg = -90", "offset_deg = -90"),
        ("cam_shift_deg = -180", "offset_deg = 180"),
        ("cam_shift_deg = -270", "offset_deg = 90"),
    ] {
        assert!(text.contains(electronic), "the scene has no {electronic}");
        text = text.replace(electronic, mechanical);
    }
    text
}

/// If the table, its shift, or its position in a turn were wrong, the pushers of the electronic cam would move otherwise than those of the shaft
/// that it replaces.
///
/// *Lift.* A pusher on a screw stands at the whole step below its command, so up to a step of 20 mm / 1600 = 12.5 µm below. The table's points are h = 3°
/// apart. Its spline is off by h⁴ y⁗/384 between them: with y″ = 84 mm · 5.53 / β² and the law's fastest wave, 4π/β for β = 105°, that is
/// 0.13 µm.
///
/// *Acceleration.* The second derivative of a spline is off by (h 4π/β)²/12 = 1.9 % of the law's peak at its points, and less between them. Where the
/// law's jerk jumps there is a point, so that the jump adds nothing. The second difference over two ticks of 0.5 ms sees the mean around the tick: less
/// by (ω 4π/β · 0.5 ms)²/12 = 4e-5. Mechanical pushers are looked at at a tick's end, and the second difference half a tick to either
/// side of it; the speed-up moves it by another 1e-3.
#[test]
fn pushers_move_as_on_the_cam_shaft() {
    let text = library::find("electronic-cam").unwrap().text;
    let (electronic, outcome) = run(text);
    let (shaft, _) = run(&mechanical(text));
    assert_eq!(electronic.ticks.len(), shaft.ticks.len());
    let mut off_m: f64 = 0.0;
    let mut off_mps2: f64 = 0.0;
    let mut peaks_mps2 = [0.0_f64; AXES];
    let mut lowest_m = f64::INFINITY;
    for (i, (screws, cams)) in electronic.ticks.iter().zip(&shaft.ticks).enumerate() {
        for axis in 0..AXES {
            let below = cams[axis].0 - screws[axis].0;
            off_m = off_m.max(below);
            lowest_m = lowest_m.min(below);
            // The acceleration on a screw belongs to the end of the tick before.
            let Some(before) = i.checked_sub(1).map(|i| shaft.ticks[i][axis].1) else {
                continue;
            };
            peaks_mps2[axis] = peaks_mps2[axis].max(before.abs());
            off_mps2 = off_mps2.max((screws[axis].1 - before).abs());
        }
    }
    let peak_mps2 = peaks_mps2.into_iter().fold(0.0, f64::max);
    println!("lift {lowest_m:e} to {off_m:e} m below, acceleration {off_mps2} of {peak_mps2} m/s²");
    assert!((5.4..5.5).contains(&peak_mps2), "{peak_mps2} m/s²");
    assert!(off_m < 12.5e-6 + 0.3e-6, "{off_m:e} m below");
    assert!(lowest_m > -0.3e-6, "{lowest_m:e} m above");
    assert!(
        off_mps2 < 0.02 * peak_mps2,
        "{off_mps2} of {peak_mps2} m/s²"
    );
    // The report's own comparison, against the law at the master's phase, is the same.
    for (peaks, shaft_mps2) in outcome.statistics.followers.iter().zip(peaks_mps2) {
        assert!(peaks.off_m < 12.8e-6, "{:e} m", peaks.off_m);
        assert!(peaks.off_mps2 < 0.02 * peak_mps2, "{} m/s²", peaks.off_mps2);
        assert!((peaks.cam_side_mps2 / shaft_mps2 - 1.0).abs() < 1e-3);
    }
}

/// If an error accumulated from tick to tick, or the machine parked at another phase, axes would not be where the table has them: at 0°, and at the
/// shifts of −90, −180 and −270° from there, that is 270°, 180° and 90°. The law rests at both ends, and is 4.2 turns up at the dwell.
#[test]
fn after_the_run_every_axis_is_on_its_table() {
    let (_, outcome) = run(library::find("electronic-cam").unwrap().text);
    let turns = |axis: usize| outcome.statistics.turns[axis].0;
    assert!(turns(0).abs() < 1e-6, "{}", turns(0));
    // A seventh of the return.
    assert!((4.0..4.19).contains(&turns(1)), "{}", turns(1));
    assert!((turns(2) - 4.2).abs() < 1e-6, "{}", turns(2));
    // Three quarters of the rise.
    assert!((3.5..4.0).contains(&turns(3)), "{}", turns(3));
}
