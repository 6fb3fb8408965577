//! The electronic cam against the mechanical cam shaft: the same law and the same program. One machine has four cams that turn with the
//! master, the other has four pushers on screws that follow a cam table.

use std::f64::consts::{PI, TAU};

use cophase_core::supervisor::State;
use cophase_scene::library;
use cophase_tests::scene;
use host_sim::checked::Checked;
use host_sim::setup;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

const AXES: usize = 4;

/// Place and acceleration of every pusher in every tick.
#[derive(Default)]
struct Pushers {
    ticks: Vec<[(f64, f64); AXES]>,
}

impl Observer for Pushers {
    fn tick(&mut self, moment: &Moment<'_>) {
        let pushers = moment.machine.follower().parts();
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

/// The scene with cams on shafts instead. Their drives are servos, so the cams stand where they are commanded, not at the step before.
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

/// If this fails, the table, its shift, or its position in a turn is wrong. The pushers of the electronic cam then move differently from
/// those of the shaft that it replaces.
///
/// *Lift.* A pusher on a screw stands at the whole step below its command, so up to a step of 20 mm / 1600 = 12.5 µm below. The table's
/// points are h = 3.75° apart. Its spline is off by h⁴ y⁗/384 between them. With y″ = 84 mm · 5.53 / β² and the law's fastest wave, 4π/β
/// for β = 105°, that is 0.31 µm.
///
/// *Acceleration.* The second derivative of a spline is off by (h 4π/β)²/12 = 1.7 % of the law's peak at its points, and less between them.
/// The table has a point wherever the law's jerk jumps, so the jump adds nothing. The second difference over two ticks of 0.5 ms measures
/// the mean around the tick. It is less by (ω 4π/β · 0.5 ms)²/12 = 4e-5. Mechanical pushers are measured at a tick's end, and the second
/// difference covers half a tick to either side of it. The speed-up moves it by another 1e-3.
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
            // The acceleration on a screw belongs to the end of the previous tick.
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
    assert!(off_m < 12.5e-6 + 0.31e-6, "{off_m:e} m below");
    assert!(lowest_m > -0.31e-6, "{lowest_m:e} m above");
    assert!(
        off_mps2 < 0.02 * peak_mps2,
        "{off_mps2} of {peak_mps2} m/s²"
    );
    // The report's own comparison, with the law at the master's phase, gives the same result.
    let peaks = outcome
        .record
        .axes
        .iter()
        .map(|axis| axis.follower.unwrap());
    for (peaks, shaft_mps2) in peaks.zip(peaks_mps2) {
        assert!(peaks.of("off_law_worst_mm").unwrap() < 12.8e-3, "{peaks:?}");
        assert!(
            peaks.of("off_law_accel_worst_mps2").unwrap() < 0.02 * peak_mps2,
            "{peaks:?}"
        );
        let cam_side_mps2 = peaks.of("cam_side_accel_worst_mps2").unwrap();
        assert!((cam_side_mps2 / shaft_mps2 - 1.0).abs() < 1e-3);
    }
}

/// If this fails, an error accumulates from tick to tick, or the machine parks at another phase. Axes must be where the table has them: at
/// 0°, and at the shifts of −90, −180 and −270° from there, that is 270°, 180° and 90°. The law rests at both ends, and is 4.2 turns up at
/// the dwell.
#[test]
fn axes_end_on_their_tables() {
    let (_, outcome) = run(library::find("electronic-cam").unwrap().text);
    let turns = |axis: usize| outcome.record.axes[axis].command_turns;
    assert!(turns(0).abs() < 1e-6, "{}", turns(0));
    // A seventh of the return.
    assert!((4.0..4.19).contains(&turns(1)), "{}", turns(1));
    assert!((turns(2) - 4.2).abs() < 1e-6, "{}", turns(2));
    // Three quarters of the rise.
    assert!((3.5..4.0).contains(&turns(3)), "{}", turns(3));
}

/// Distance of a nut in one turn of its screw, and travel that a step makes, m.
const LEAD_M: f64 = 0.020;
const STEP_M: f64 = LEAD_M / 1600.0;
/// Shifts of the four axes' tables, turns.
const SHIFTS: [f64; AXES] = [0.0, -0.25, -0.5, -0.75];

/// Lift of a unit stroke over a unit angle, in the closed form of the literature. Handbooks on cam design print the coefficients of the
/// last two laws with eight digits. A parameter gives the skewed cycloid.
fn closed_form(law: &str, u: f64) -> f64 {
    match law {
        "cycloid" => u - (TAU * u).sin() / TAU,
        "skewed-cycloid" => {
            // u = (φ − k sin φ)/2π grows with φ, so bisection finds it to the last bit.
            let k = 1.0 - 3.0_f64.sqrt() / 2.0;
            let (mut low, mut high) = (0.0, TAU);
            for _ in 0..60 {
                let phi: f64 = 0.5 * (low + high);
                if phi - k * phi.sin() < TAU * u {
                    low = phi;
                } else {
                    high = phi;
                }
            }
            (low - low.sin()) / TAU
        }
        "modified-sine" => match u {
            ..0.125 => 0.439_900_85 * u - 0.035_006_2 * (2.0 * TAU * u).sin(),
            ..0.875 => {
                0.280_049_57 + 0.439_900_85 * u
                    - 0.315_055_77 * (2.0 * TAU * u / 3.0 - PI / 6.0).cos()
            }
            _ => 0.560_099_15 + 0.439_900_85 * u - 0.035_006_2 * (TAU * (2.0 * u - 1.0)).sin(),
        },
        "modified-trapezoid" => match u {
            ..0.125 => 0.388_984_48 * u - 0.030_954_4 * (2.0 * TAU * u).sin(),
            ..0.375 => 2.444_061_84 * u * u - 0.222_030_94 * u + 0.007_234_06,
            ..0.625 => 1.611_015_4 * u - 0.030_954_4 * (2.0 * TAU * u - PI).sin() - 0.305_507_7,
            ..0.875 => -2.444_061_84 * u * u + 4.666_091_7 * u - 1.229_264_8,
            _ => 0.611_015_4 + 0.388_984_48 * u + 0.030_954_4 * (2.0 * TAU * u - 3.0 * PI).sin(),
        },
        _ => unreachable!("{law} is no law"),
    }
}

/// Commanded and true places of all pushers in every tick, with the turns of the master at its end.
#[derive(Default)]
struct Places {
    ticks: Vec<(f64, [(f64, f64); AXES])>,
}

impl Observer for Places {
    fn tick(&mut self, moment: &Moment<'_>) {
        let pushers = moment.machine.follower().parts();
        let of = |axis: usize| (LEAD_M * moment.command_turns[axis], pushers[axis].place_m);
        self.ticks
            .push((moment.master_turns, std::array::from_fn(of)));
    }
}

/// Runs a scene and compares its pushers with `lift_m`, a function of the table's turns from 0 to 1. `spline_m` bounds the spline's error.
#[track_caller]
fn follows(what: &str, checked: &Checked, lift_m: impl Fn(f64) -> f64, spline_m: f64) {
    let mut places = Places::default();
    let outcome = simulate(checked, &mut places, |_, _| {}).unwrap();
    assert!(outcome.fault.is_none(), "{what}: {:?}", outcome.fault);
    assert_eq!(outcome.state, State::Parked, "{what}");
    let (mut commanded_m, mut below_m, mut above_m) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (master_turns, axes) in &places.ticks {
        for ((command_m, place_m), shift) in axes.iter().zip(SHIFTS) {
            let lift_m = lift_m((master_turns + shift).rem_euclid(1.0));
            commanded_m = commanded_m.max((command_m - lift_m).abs());
            below_m = below_m.max(lift_m - place_m);
            above_m = above_m.max(place_m - lift_m);
        }
    }
    println!(
        "{what}: command off by {:.3} of {:.3} µm, pusher {:.3} µm below and {:.3} above",
        1e6 * commanded_m,
        1e6 * spline_m,
        1e6 * below_m,
        1e6 * above_m
    );
    let travel: f64 = places.ticks.last().map_or(0.0, |(turns, _)| *turns);
    assert!(travel > 3.0, "{what}: {travel} turns");
    assert!(commanded_m < spline_m, "{what}: {commanded_m:e} m");
    assert!(below_m < STEP_M + spline_m, "{what}: {below_m:e} m below");
    assert!(above_m < spline_m, "{what}: {above_m:e} m above");
}

/// If this fails, the core's table follower moves a pusher by another curve than the chosen law, and a user's product is not handled as
/// designed. Each law is compared with its closed form, written here a second time.
///
/// A cubic spline is off by at most 5/384 h⁴ max|y⁗| between its points (Hall and Meyer, 1976), where y‴ jumps at points only. The return
/// is the steepest: h/β = 3.75/105, and y⁗ = 84 mm · max|s⁗| / β⁴. The fourth derivative is Ca (2π)² for the cycloid. It is Ca (4π)² for
/// laws with quarter waves, of a period of half the angle, at the ends. That of the skewed cycloid is 476, found by differences. Four
/// coefficients of 5e-9 each, the most that eight digits leave, add 2 nm. A pusher on a screw stands at the whole step below its command.
#[test]
fn laws_move_the_pusher_by_their_closed_forms() {
    let text = library::find("electronic-cam").unwrap().text;
    for (law, fourth) in [
        ("cycloid", TAU.powi(3)),
        ("skewed-cycloid", 476.0),
        ("modified-sine", 5.528 * 16.0 * PI * PI),
        ("modified-trapezoid", 4.8882 * 16.0 * PI * PI),
    ] {
        let stroke_m = 0.084;
        let lift_m = |turns: f64| {
            let deg = 360.0 * turns;
            match deg {
                ..120.0 => stroke_m * closed_form(law, deg / 120.0),
                ..255.0 => stroke_m,
                _ => stroke_m * (1.0 - closed_form(law, (deg - 255.0) / 105.0)),
            }
        };
        let spline_m = 5.0 / 384.0 * (3.75_f64 / 105.0).powi(4) * fourth * stroke_m + 2e-9;
        let named = format!("law = \"{law}\"");
        assert_eq!(text.matches("law = \"modified-sine\"").count(), 2);
        let text = text.replace("law = \"modified-sine\"", &named);
        follows(law, &scene(&text), lift_m, spline_m);
    }
}

/// If this fails, a run prints another difference from the law than its pushers have, or the table of short segments is coarser than it
/// need be.
///
/// In three ticks of a turn at constant speed, the second differences of command and closed form are compared. The speed is about
/// 1 rev/s, so a tick is 0.18°. Coefficients of eight digits are off by 5e-9, and a second difference has four such errors, of 5.5 (0.18/60)² =
/// 5e-5 at least. The coefficients of the modified trapezoid have jumps of 7e-7, so it is left out.
#[test]
fn printed_difference_from_the_law_is_that_of_the_pushers() {
    for (segments, max) in [
        ([120.0, 135.0, 105.0], 0.016),
        ([60.0, 60.0, 60.0], 0.045),
        ([40.0, 60.0, 60.0], 0.09),
        ([100.0, 33.0, 77.0], 0.045),
    ] {
        for law in ["cycloid", "skewed-cycloid", "modified-sine"] {
            let [rise, dwell, back] = segments;
            let text = library::find("electronic-cam").unwrap().text;
            let (head, rest) = text.split_once("law = \"modified-sine\"\nsegment").unwrap();
            let (_, rest) = rest.split_once("[control]").unwrap();
            let text = format!(
                "{head}law = \"{law}\"\nsegment = [{{ deg = {rise}, turns = 1 }}, {{ deg = {dwell} }}, {{ deg = {back}, turns = -1 }}]\n\
                 max_acceleration_hz_per_s = 1e5\n[control]{rest}"
            );
            let checked = scene(&text);
            let (_, _, printed) = checked.cam_tables().next().unwrap();
            let printed = printed.expect("it has a law");
            let lift = |turns: f64| match 360.0 * turns.rem_euclid(1.0) {
                deg if deg < rise => closed_form(law, deg / rise),
                deg if deg < rise + dwell => 1.0,
                deg if deg < rise + dwell + back => {
                    1.0 - closed_form(law, (deg - rise - dwell) / back)
                }
                _ => 0.0,
            };
            let mut places = Places::default();
            simulate(&checked, &mut places, |_, _| {}).unwrap();
            let (mut off, mut peak) = (0.0_f64, 0.0_f64);
            for three in places.ticks.windows(3) {
                let step = [three[1].0 - three[0].0, three[2].0 - three[1].0];
                if step[0] < 0.0004 || (step[0] - step[1]).abs() > 1e-12 {
                    continue; // Not at the speed of the program.
                }
                let bend = |at: &dyn Fn(usize) -> f64| at(0) - 2.0 * at(1) + at(2);
                let law = bend(&|i| lift(three[i].0));
                let command = bend(&|i| three[i].1[0].0 / LEAD_M);
                off = off.max((command - law).abs());
                peak = peak.max(law.abs());
            }
            let off = off / peak;
            println!("{segments:?} {law}: {off:.4}, printed {printed:.4}");
            assert!(
                off < printed * 1.02 + 1e-3,
                "{segments:?} {law}: {off}, printed {printed}"
            );
            assert!(
                off > printed * 0.9 - 1e-3,
                "{segments:?} {law}: {off}, printed {printed}"
            );
            assert!(printed < max, "{segments:?} {law}: {printed}");
        }
    }
}

/// If this fails, the axis does not pass through the points of a user's file, or the curve between them is wrong. The curve is a harmonic
/// lift, y = 42 mm (1 − cos x), over the whole turn, in 48 points with nine decimals. The spline is off by at most 5/384 h⁴ · 42 mm with h
/// = 2π/48, and by rounding of 5e-10 turns, which no spline doubles.
#[test]
fn table_from_a_file_moves_the_pusher_through_its_points() {
    let lift_m = |turns: f64| 0.042 * (1.0 - (TAU * turns).cos());
    let rows: String = (0..48)
        .map(|i| f64::from(i) / 48.0)
        .map(|turns| format!("{turns:.9},{:.9}\n", lift_m(turns) / LEAD_M))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("lobe.csv"),
        format!("master_turns,axis_turns\n{rows}"),
    )
    .unwrap();
    let text = library::find("electronic-cam").unwrap().text;
    let (head, rest) = text.split_once("[[cam_table]]").unwrap();
    let (_, rest) = rest.split_once("[control]").unwrap();
    let text =
        format!("{head}[[cam_table]]\nname = \"lobe\"\nfile = \"lobe.csv\"\n[control]{rest}");
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text).unwrap();
    let checked = setup::checked_from_file(&file).unwrap();
    let spline_m = 5.0 / 384.0 * (TAU / 48.0).powi(4) * 0.042 + 2.0 * 5e-10 * LEAD_M;
    follows("file", &checked, lift_m, spline_m);
}

/// Greatest accelerations of the four laws, over stroke and squared duration, as published.
const LAWS: [(&str, f64); 4] = [
    ("modified-sine", 5.5280),
    ("cycloid", TAU),
    ("skewed-cycloid", 5.8883),
    ("modified-trapezoid", 4.8881),
];

/// If this fails, a law in a cam table differs from the law on a cam, or its table is too coarse. The pushers of the electronic cam then
/// accelerate differently from those of the shaft, or from the published values. The errors are those of
/// `pushers_move_as_on_the_cam_shaft`. The error of the spline's second derivative grows with the square of the law's fastest wave, so it
/// is printed for each law.
#[test]
fn laws_give_the_published_pusher_acceleration() {
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
        let speed_hz = outcome.record.figures.speed_top_hz;
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
