//! The electronic cam against the mechanical cam shaft: the same law and the same program, once as four cams that turn with the master, and once as
//! four pushers on screws that follow a cam table.

use cophase_core::supervisor::State;
use cophase_tests::scene;
use host_sim::scene::{library, load};
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

/// Greatest accelerations of the four laws, over stroke and squared duration, as published.
const LAWS: [(&str, f64); 4] = [
    ("modified-sine", 5.5280),
    ("cycloid", std::f64::consts::TAU),
    ("skewed-cycloid", 5.8883),
    ("modified-trapezoid", 4.8881),
];

/// If one of the laws were another in a cam table than on a cam, or its table too coarse for it, the pushers of the electronic cam would move otherwise than those of the
/// shaft, or accelerate otherwise than published. The errors are those of `pushers_move_as_on_the_cam_shaft`; that of the spline's second derivative grows with the
/// square of the law's fastest wave, so that it is printed for each law.
#[test]
fn each_law_moves_the_pusher() {
    for (law, coefficient) in LAWS {
        let text = library::find("electronic-cam").unwrap().text;
        let text = text.replace("\"modified-sine\"", &format!("\"{law}\""));
        // The same speed for every law.
        let amax_g = 0.5567 * coefficient / LAWS[0].1;
        let text = text.replace("amax_g = 0.5567", &format!("amax_g = {amax_g:.6}"));
        let (electronic, outcome) = run(&text);
        let (shaft, _) = run(&mechanical(&text));
        let (mut below_m, mut above_m, mut off_mps2) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut peak_mps2 = 0.0_f64;
        for (i, (screws, cams)) in electronic
            .ticks
            .iter()
            .zip(&shaft.ticks)
            .enumerate()
            .skip(1)
        {
            for axis in 0..AXES {
                let below = cams[axis].0 - screws[axis].0;
                below_m = below_m.max(below);
                above_m = above_m.max(-below);
                let before = shaft.ticks[i - 1][axis].1;
                peak_mps2 = peak_mps2.max(before.abs());
                off_mps2 = off_mps2.max((screws[axis].1 - before).abs());
            }
        }
        let speed_hz = outcome.statistics.top_speed_hz;
        let duration_s = 105.0 / 360.0 / speed_hz;
        let measured = peak_mps2 * duration_s * duration_s / 0.084;
        println!(
            "{law}: {:.2} µm below, {:.2} above, acceleration off by {:.2} % of {peak_mps2:.3} m/s², coefficient {measured:.3}",
            1e6 * below_m,
            1e6 * above_m,
            100.0 * off_mps2 / peak_mps2
        );
        assert!(below_m < 12.5e-6 + 1e-6 && above_m < 1e-6, "{law}");
        assert!(off_mps2 < 0.05 * peak_mps2, "{law}");
        assert!(
            (measured / coefficient - 1.0).abs() < 5e-3,
            "{law}: {measured}"
        );
    }
}

/// If a user's points were read in another order or unit, or joined otherwise than by a smooth curve, the pusher would not be where the formula of the points has it.
/// Here that is a harmonic motion of 4.2 turns, at 72 points.
#[test]
fn a_table_from_a_file_moves_the_pusher() {
    const POINTS: usize = 72;
    let turns = |phase: f64| 2.1 * (1.0 - (phase * std::f64::consts::TAU).cos());
    let rows: Vec<String> = (0..POINTS)
        .map(|i| i as f64 / POINTS as f64)
        .map(|phase| format!("{phase:.9},{:.9}", turns(phase)))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let header = "master_turns,axis_turns\n";
    std::fs::write(
        folder.path().join("lobe.csv"),
        header.to_owned() + &rows.join("\n"),
    )
    .unwrap();
    let text = library::find("electronic-cam").unwrap().text;
    let from = text.find("law = \"modified-sine\"\nsegment").unwrap();
    let to = from + text[from..].find("]\n\n").unwrap() + 1;
    let text = format!("{}file = \"lobe.csv\"{}", &text[..from], &text[to..]);
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let checked = load::checked_from_file(&path).unwrap();
    let mut lifts = Lifts::default();
    let outcome = simulate(&checked, &mut lifts, |_, _| {}).unwrap();
    assert!(outcome.fault.is_none());
    let mut off_turns = 0.0_f64;
    for &(phase, axis_turns) in &lifts.ticks {
        off_turns = off_turns.max((axis_turns - turns(phase)).abs());
    }
    // A step is 1/1600 turn; the spline through 72 points of a sine is off by (2π/72)⁴/384 of its amplitude, 3e-7 turns.
    println!("{off_turns:e} turns off in {} ticks", lifts.ticks.len());
    assert!(off_turns < 1.0 / 1600.0 + 1e-6, "{off_turns}");
    assert!(lifts.ticks.iter().any(|(_, turns)| *turns > 4.19));
}

/// Turns of the master, and position of the first axis, turns, in every tick.
#[derive(Default)]
struct Lifts {
    ticks: Vec<(f64, f64)>,
}

impl Observer for Lifts {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.ticks
            .push((moment.master_turns, moment.actual_turns[0]));
    }
}
