//! Figures of the slider-crank platform.

use std::f64::consts::TAU;

use crate::design::platform::{Design, Requirement, design};
use host_sim::mechanism::Mechanism;
use host_sim::mechanism::slider_crank::SliderCrank;

use super::Tolerance::{Absolute, Relative};
use super::{Figure, ReproducedError, Section};

const DESIGN: &str = "host-sim/tests/design.rs";

/// The source's examples: load kg, amax g, frequency Hz, λ, motors.
const EXAMPLES: [(f64, f64, f64, f64, u32); 4] = [
    (50.0, 200.0, 100.0, 0.1, 6),
    (50.0, 200.0, 200.0, 0.1, 2),
    (10.0, 100.0, 20.0, 0.6, 4),
    (10.0, 10.0, 5.0, 0.3, 3),
];

fn examples(gravity_mps2: f64) -> Result<Vec<Design>, ReproducedError> {
    let all = EXAMPLES
        .iter()
        .map(|&(load_kg, amax_g, freq_hz, lambda, motors)| {
            design(&Requirement {
                load_kg,
                amax_g,
                freq_hz,
                lambda,
                motors,
                safety: Requirement::DEFAULT_SAFETY,
                gravity_mps2,
            })
        });
    all.collect::<Result<_, _>>()
        .map_err(ReproducedError::from_error)
}

fn each(designs: &[Design], of: impl Fn(&Design) -> f64) -> [f64; 4] {
    std::array::from_fn(|i| of(&designs[i]))
}

fn of_lambda(lambda: f64) -> Result<SliderCrank, ReproducedError> {
    SliderCrank::new(lambda, 1.0).map_err(ReproducedError::from_error)
}

/// Returns the lowest exact and two-term acceleration for λ, relative to R ω², each with its angle, degrees.
fn lowest(lambda: f64) -> Result<[f64; 4], ReproducedError> {
    let mechanism = of_lambda(lambda)?;
    let two_term = mechanism.extrema_two_term(1.0).lowest();
    let exact = mechanism.extrema_exact(1.0).lowest();
    Ok([
        two_term.a_mps2 / lambda,
        two_term.alpha_rad.to_degrees(),
        exact.a_mps2 / lambda,
        exact.alpha_rad.to_degrees(),
    ])
}

pub(super) fn section() -> Result<Section, ReproducedError> {
    let ten = examples(10.0)?;
    let standard = examples(9.806_65)?;
    let radius_mm = |design: &Design| 1e3 * design.mechanism.crank_radius_m();
    let rod_mm = |design: &Design| 1e3 * design.mechanism.rod_length_m();
    let errors = [0.1, 0.3, 0.5, 0.6]
        .map(|lambda| of_lambda(lambda).map(|mechanism| 100.0 * mechanism.two_term_error().value));
    let [a, b, c, d] = errors;
    let step = 1.8_f64.to_radians();
    let printed = SliderCrank::new(0.040, 0.040 / 0.6).map_err(ReproducedError::from_error)?;
    let ramp_ms = |freq_hz: f64| 1e3 * (2.0 * TAU * freq_hz).powf(-2.0 / 3.0);
    Ok(Section {
        title: "Slider-crank platform",
        source: "Chinese patent on a mixing platform. Its four examples take gravity as 10 m/s².",
        command: "cargo test -p host-sim --test integration -- design published --nocapture",
        figures: vec![
            Figure::new(
                1,
                "crank radius of the examples, g = 10 m/s², mm",
                [4.6055, 1.1514, 39.579, 77.939],
                each(&ten, radius_mm),
                Absolute(5e-4),
                (DESIGN, "lengths_of_the_examples_with_gravity_10"),
            ),
            Figure::new(
                1,
                "rod length of the examples, mm",
                [46.055, 11.514, 65.964, 259.80],
                each(&ten, rod_mm),
                Absolute(5e-3),
                (DESIGN, "lengths_of_the_examples_with_gravity_10"),
            ),
            Figure::new(
                2,
                "crank radius, g = 9.80665 m/s², mm",
                [4.5165, 1.1291, 38.813, 76.432],
                each(&standard, radius_mm),
                Absolute(5e-4),
                (DESIGN, "lengths_of_the_examples_with_standard_gravity"),
            ),
            Figure::new(
                3,
                "largest torque, two-term, N·m",
                [228.725, 57.181, 227.035, 45.380],
                each(&ten, |design| design.torque_two_term.value),
                Absolute(0.01),
                (DESIGN, "two_term_torque_maxima"),
            ),
            Figure::new(
                4,
                "largest torque, exact, platform below, N·m",
                [228.81, 57.20, 240.85, 45.74],
                each(&ten, |design| design.torque_exact_below.value),
                Absolute(0.05),
                (DESIGN, "exact_torque_maxima_on_both_sides"),
            ),
            Figure::new(
                4,
                "largest torque, exact, platform above, N·m",
                [225.57, 56.39, 234.19, 35.65],
                each(&ten, |design| design.torque_exact_above.value),
                Absolute(0.05),
                (DESIGN, "exact_torque_maxima_on_both_sides"),
            ),
            Figure::new(
                6,
                "lowest acceleration at λ = 0.3, two-term and exact, of R ω², each with its angle, °",
                [-0.71667, 146.44, -0.70918, 148.23],
                lowest(0.3)?,
                Absolute(0.01),
                (DESIGN, "lowest_accelerations"),
            ),
            Figure::new(
                6,
                "… at λ = 0.6",
                [-0.80833, 114.62, -0.87155, 104.65],
                lowest(0.6)?,
                Absolute(0.01),
                (DESIGN, "lowest_accelerations"),
            ),
            Figure::new(
                6,
                "λ at which the exact curve splits",
                [0.263_763],
                [SliderCrank::LAMBDA_SPLIT_EXACT],
                Absolute(5e-7),
                (DESIGN, "lowest_accelerations"),
            ),
            Figure::new(
                7,
                "worst two-term error at λ = 0.1, 0.3, 0.5, 0.6, %",
                [0.046, 1.11, 5.16, 9.375],
                [a?, b?, c?, d?],
                Absolute(5e-3),
                (DESIGN, "two_term_error"),
            ),
            Figure::new(
                9,
                "peak power, platform above, kW",
                [141.7, 70.9, 29.4, 1.12],
                each(&ten, |design| 1e-3 * design.peak_power_w()),
                Absolute(0.05),
                (DESIGN, "peak_powers"),
            ),
            Figure::new(
                10,
                "time at which R α″ = R ω² on a ramp of 1 s, examples 1 and 4, ms",
                [8.59, 63.27],
                [ramp_ms(100.0), ramp_ms(5.0)],
                Absolute(5e-3),
                (
                    "host-sim/tests/published.rs",
                    "tangential_acceleration_exceeds_centripetal_at_ramp_start",
                ),
            ),
            Figure::new(
                11,
                "height difference by 1.8°, example 1, and 3 with its printed radius, mm",
                [0.145, 1.483],
                [
                    1e3 * ten[0].mechanism.worst_height_mismatch(step).value,
                    1e3 * printed.worst_height_mismatch(step).value,
                ],
                Relative(4e-3),
                (DESIGN, "a_full_step_gives_the_published_height_difference"),
            ),
        ],
    })
}
