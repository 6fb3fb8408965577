//! Figures of the cam with its elastic follower.

use cophase_methods::problems::{Cam, Chain, Law, Shaft};
use cophase_methods::{Equations, Scheme, advance};

use super::Tolerance::{Absolute, Relative};
use super::{Figure, ReproducedError, Section};

const FILE: &str = "host-sim/methods/references/tests/references/chain.rs";

/// Returns results in the periodic regime: largest accelerations of the first and the third mass, m/s², largest deviation of the third
/// from the law, mm, and mean power of a damper between the first mass and the ground, kW.
fn periodic(law: Law, shaft: Shaft) -> Result<[f64; 4], ReproducedError> {
    const STEPS: u32 = 1 << 15;
    const SETTLING: u32 = 6;
    let cam = Cam::wrapper(law);
    let chain = Chain::wrapper(cam, shaft);
    let step_s = cam.cycle_s() / f64::from(STEPS);
    let mut method = Scheme::Exact
        .prepare(&chain, step_s)
        .map_err(ReproducedError::from_error)?;
    let (mut y, mut rates) = ([0.0; 6], [0.0; 6]);
    advance(method.as_mut(), &chain, 0.0, SETTLING * STEPS, &mut y)
        .map_err(ReproducedError::from_error)?;
    let mut found = [0.0_f64; 4];
    for i in SETTLING * STEPS..(SETTLING + 1) * STEPS {
        let t_s = f64::from(i) * step_s;
        chain.rates(t_s, &y, &mut rates);
        let off_mm = 1e3 * (y[2] - cam.at(t_s).displacement);
        for (max, value) in found.iter_mut().zip([rates[3], rates[5], off_mm]) {
            *max = max.max(value.abs());
        }
        let power_kw = 1e-3 * Chain::DAMPING_N_S_M[0] * y[3] * y[3];
        found[3] += power_kw / f64::from(STEPS);
        method
            .step(&chain, t_s, &mut y)
            .map_err(ReproducedError::from_error)?;
    }
    Ok(found)
}

pub(super) fn section() -> Result<Section, ReproducedError> {
    let cam = Cam::wrapper(Law::Cycloid);
    let chain = Chain::wrapper(cam, Shaft::DampedToGround);
    let modes = chain.modes();
    let mut figures = vec![
        Figure::new(
            1,
            "speed, rad/s; rise, dwell, return, cycle, s",
            [47.1239, 0.0444444, 0.05, 0.0388889, 0.1333333],
            [
                cam.speed_rad_s,
                cam.rise_s(),
                cam.dwell_s(),
                cam.return_s(),
                cam.cycle_s(),
            ],
            Relative(2e-6),
            (FILE, "cycle_times_match_the_printed_digits"),
        ),
        Figure::new(
            2,
            "modes, rad/s",
            [1718.3, 5610.0, 34190.8],
            chain.undamped_rad_s(),
            Relative(1e-4),
            (FILE, "modes_match_published_frequencies_and_damping"),
        ),
        Figure::new(
            2,
            "damping ratios",
            [0.03470, 0.09842, 0.34371],
            std::array::from_fn(|i| modes[i].zeta),
            Relative(1e-4),
            (FILE, "modes_match_published_frequencies_and_damping"),
        ),
    ];
    let peaks = [
        (
            "design peaks, rise and return, m/s²: cycloid",
            [267.19, 348.99],
        ),
        ("… skewed cycloid", [250.40, 327.05]),
        ("… modified sine", [235.08, 307.04]),
        ("… modified trapezoid", [207.87, 271.50]),
    ];
    for (law, (what, published)) in Law::ALL.into_iter().zip(peaks) {
        let (rise, return_) = Cam::wrapper(law).peaks_mps2();
        figures.push(Figure::new(
            3,
            what,
            published,
            [rise, return_],
            Relative(1e-4),
            (FILE, "design_peaks_match_the_published_ones"),
        ));
    }
    let printed = [
        (
            "largest acceleration, equations as printed, first and third mass, m/s²: cycloid",
            [361.01, 371.61],
        ),
        ("… skewed cycloid", [350.21, 369.92]),
        ("… modified sine", [323.36, 340.43]),
        ("… modified trapezoid", [288.07, 302.36]),
    ];
    for (law, (what, published)) in Law::ALL.into_iter().zip(printed) {
        let [first, third, ..] = periodic(law, Shaft::DampedToGround)?;
        figures.push(Figure::new(
            4,
            what,
            published,
            [first, third],
            Relative(1e-3),
            (FILE, "peak_accelerations_match_the_printed_ones"),
        ));
    }
    let [first, third, off_mm, _] = periodic(Law::ModifiedSine, Shaft::DampedToCam)?;
    let [_, _, off_ground_mm, power_kw] = periodic(Law::ModifiedSine, Shaft::DampedToGround)?;
    figures.push(Figure::new(
        5,
        "damper at the cam, modified sine, first and third mass, m/s²",
        [323.45, 340.58],
        [first, third],
        Relative(1e-3),
        (FILE, "figures_with_damper_at_the_cam_match_published_ones"),
    ));
    figures.push(Figure::new(
        5,
        "deviation of the third mass from the law, damper at the cam and at the ground, mm",
        [0.125, 0.246],
        [off_mm, off_ground_mm],
        Absolute(5e-4),
        (FILE, "figures_with_damper_at_the_cam_match_published_ones"),
    ));
    let cam = Cam::wrapper(Law::ModifiedSine);
    let fastest_mps = (0..10_000)
        .map(|i| cam.at(cam.cycle_s() * f64::from(i) / 1e4).velocity.abs())
        .fold(0.0, f64::max);
    figures.push(Figure::new(
        5,
        "damper at the ground: lag of the first mass, mm; its power, kW",
        [0.199, 1.40],
        [
            1e3 * Chain::DAMPING_N_S_M[0] * fastest_mps / Chain::STIFFNESS_N_M[0],
            power_kw,
        ],
        Relative(3.5e-3),
        (FILE, "figures_with_damper_at_the_cam_match_published_ones"),
    ));
    Ok(Section {
        title: "Cam and elastic follower",
        source: "Chinese article on a chocolate wrapper at 450 rpm. It prints no result; these were calculated from its equations.",
        command: "cargo test -p cophase-references chain -- --nocapture",
        figures,
    })
}
