//! Reference thresholds by a library's solvers, and checks of the chart against them.
//!
//! The two methods, DOP853 (Hairer) and RKV 9(8) (Verner), share only their library. They give the threshold to 1e-13. Their
//! difference is the error of the reference.

use cophase_methods::problems::Screen;
use cophase_methods::{Equations, Scheme, advance};
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};

use super::{Decision, LiftOff, PullsOut, Resonance, lift_off, pull_out, resonance, threshold};

struct Adapter<'a>(&'a dyn Equations);

impl<const N: usize> ODE<f64, [f64; N]> for Adapter<'_> {
    fn diff(&self, t_s: f64, y: &[f64; N], rates: &mut [f64; N]) {
        self.0.rates(t_s, y, rates);
    }
}

#[derive(Clone, Copy, Debug)]
enum Library {
    Dop853,
    Rkv98,
}

const LIBRARY: [Library; 2] = [Library::Dop853, Library::Rkv98];
const RELATIVE: f64 = 1e-13;
const ABSOLUTE: f64 = 1e-15;
/// Absolute tolerance of the chain. The stiffest link causes rounding errors of 1e-13 m/s per step in its velocities. The errors of
/// positions are smaller by its frequencies: 2e-15 m, or 1e-8 N at the cam.
const ABSOLUTE_OF_CHAIN: f64 = 1e-11;
const MAX_STEPS: usize = 10_000_000;

/// Returns the states at evenly spaced times, or at the end only.
macro_rules! solved {
    ($ivp:expr, $library:expr, $absolute:expr, $max_s:expr) => {
        match $library {
            Library::Dop853 => {
                $ivp.method(
                    ExplicitRungeKutta::dop853()
                        .rtol(RELATIVE)
                        .atol($absolute)
                        .h_max($max_s)
                        .max_steps(MAX_STEPS),
                )
                .solve()
                .expect("DOP853")
                .y
            }
            Library::Rkv98 => {
                $ivp.method(
                    ExplicitRungeKutta::rkv989e()
                        .rtol(RELATIVE)
                        .atol($absolute)
                        .h_max($max_s)
                        .max_steps(MAX_STEPS),
                )
                .solve()
                .expect("RKV 9(8)")
                .y
            }
        }
    };
}

fn end<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    library: Library,
    absolute: f64,
) -> [f64; N] {
    let adapter = Adapter(equations);
    let states = solved!(
        IVP::ode(&adapter, 0.0, end_s, start),
        library,
        absolute,
        end_s
    );
    *states.last().expect("an end")
}

fn passes(drive: f64, library: Library) -> bool {
    let screen = Screen {
        torque_over_rated: drive,
    };
    end(&screen, [0.0; 6], resonance::END_S, library, ABSOLUTE)[5] > resonance::PASSED_RAD_S
}

fn is_out(machine: &PullsOut, drive: f64, library: Library) -> bool {
    let led = machine.led_to(drive);
    let state = end(
        &led,
        pull_out::Led::START,
        pull_out::END_S,
        library,
        ABSOLUTE,
    );
    led.is_out(pull_out::END_S, &state)
}

/// Returns the least contact force in the last turn. Steps are at most a 4096th of the turn, with 16 samples in each. Between
/// samples, the error of a parabola is less than 1e-12 of the contribution of the fastest mode that takes part, 5610 rad/s.
fn min_contact_n(drive: f64, library: Library) -> f64 {
    const SAMPLES: u32 = 65_536;
    let chain = lift_off::chain(drive);
    let cycle_s = chain.cam.cycle_s();
    let start_s = f64::from(lift_off::SETTLING) * cycle_s;
    let start = end(&chain, [0.0; 6], start_s, library, ABSOLUTE_OF_CHAIN);
    let sample_s = cycle_s / f64::from(SAMPLES);
    let times: Vec<f64> = (0..=SAMPLES + 1)
        .map(|i| start_s + f64::from(i) * sample_s)
        .collect();
    let adapter = Adapter(&chain);
    let until_s = start_s + cycle_s + 2.0 * sample_s;
    let states = solved!(
        IVP::ode(&adapter, start_s, until_s, start).t_eval(&times),
        library,
        ABSOLUTE_OF_CHAIN,
        16.0 * sample_s
    );
    assert_eq!(states.len(), times.len());
    let contact = times
        .iter()
        .zip(&states)
        .map(|(t_s, state)| lift_off::contact_n(&chain, *t_s, state));
    lift_off::min(contact)
}

/// Returns the drive at which an outcome changes, between two drives, to 1e-13 of it.
fn bisected(low: f64, high: f64, beyond: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    assert!(!beyond(low) && beyond(high), "nothing turns over");
    while high - low > 1e-13 * high {
        let middle = f64::midpoint(low, high);
        if beyond(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    f64::midpoint(low, high)
}

/// Returns the drive at which the least force is 0, by secants. Unlike the other outcomes, this force is a smooth function.
fn lift_off_hz(low: f64, high: f64, library: Library) -> f64 {
    let mut points = [low, high].map(|hz| (hz, min_contact_n(hz, library)));
    for _ in 0..8 {
        let [(a, at_a), (b, at_b)] = points;
        let next = b - at_b * (b - a) / (at_b - at_a);
        if (next - b).abs() < 1e-13 * b {
            return next;
        }
        points = [points[1], (next, min_contact_n(next, library))];
    }
    points[1].0
}

/// Checks that both libraries put the threshold within the stated uncertainty: the outcome changes between its two ends.
fn assert_reference(decision: &dyn Decision, beyond: impl Fn(f64, Library) -> bool) {
    for library in LIBRARY {
        for (end, expected) in [(-1.0, false), (1.0, true)] {
            let drive = decision.reference() * (1.0 + end * decision.uncertainty());
            let name = decision.name();
            assert_eq!(
                beyond(drive, library),
                expected,
                "{name}, {library:?}: {drive}"
            );
        }
    }
}

/// If this fails, the chart gives errors against a wrong threshold.
#[test]
fn thresholds_match_the_library_solvers() {
    assert_reference(&Resonance, passes);
    let machine = PullsOut::new();
    assert_reference(&machine, |drive, library| is_out(&machine, drive, library));
    assert_reference(&LiftOff, |drive, library| {
        min_contact_n(drive, library) < 0.0
    });
}

/// If this fails, shorter steps do not converge to the reference. The error of RK4 falls at least in proportion to the step, over the
/// three finest steps each, down to the error of the reference.
#[test]
fn rk4_converges_to_the_reference() {
    for decision in super::decisions() {
        let steps_s = decision.steps_s();
        let errors: Vec<f64> = steps_s[steps_s.len() - 3..]
            .iter()
            .map(|&step_s| {
                let found = threshold(decision.as_ref(), Scheme::Rk4, step_s);
                found.unwrap().expect("a threshold").error
            })
            .collect();
        println!("{}: {errors:?}", decision.name());
        for pair in errors.windows(2) {
            let fell = pair[1] < 0.5 * pair[0] || pair[1] < 10.0 * decision.uncertainty();
            assert!(fell, "{}: {errors:?}", decision.name());
        }
    }
}

/// If this fails, the screen is not the published one. The published screen runs up to 5.00 mm at 837 turns per minute. At 1.05 of the
/// rated torque, it is captured near 187 with 28 mm. At 1.1, it runs up. All numbers agree to 2 %.
#[test]
fn the_screen_reproduces_published_run_up_and_capture() {
    let end = |torque_over_rated: f64| {
        let screen = Screen { torque_over_rated };
        let mut method = Scheme::Rk4.prepare(&screen, 1e-3).unwrap();
        let mut state = [0.0; 6];
        advance(method.as_mut(), &screen, 0.0, 30_000, &mut state).unwrap();
        let rpm = state[5] * 60.0 / std::f64::consts::TAU;
        (rpm, Screen::amplitude_m(&state) * 1e3)
    };
    let near = |found: f64, published: f64| (found / published - 1.0).abs() < 0.02;
    let unlimited = end(Screen::UNLIMITED);
    let caught = end(1.05);
    let through = end(1.1);
    println!("unlimited {unlimited:?}, at 1.05 {caught:?}, at 1.1 {through:?}");
    assert!(
        near(unlimited.0, 837.0) && near(unlimited.1, 5.0),
        "{unlimited:?}"
    );
    assert!(near(caught.0, 187.0) && near(caught.1, 28.0), "{caught:?}");
    assert!(
        near(through.0, 837.0) && near(through.1, 5.0),
        "{through:?}"
    );
}

/// Searches brackets of the thresholds in a wide range. Run it by hand after a change of a machine:
/// `cargo test -p cophase-lab --lib decisions -- --ignored --nocapture`.
#[test]
#[ignore = "shows the constants anew; asserts nothing"]
fn print_the_thresholds() {
    for library in LIBRARY {
        let speed = lift_off_hz(6.0, 8.0, library);
        println!("{library:?}: lift-off {speed:.14}");
        let resonance = bisected(0.8, 1.6, |drive| passes(drive, library));
        println!("{library:?}: resonance {resonance:.14}");
        let machine = PullsOut::new();
        let speeds: Vec<bool> = (10..90)
            .map(|hz| is_out(&machine, f64::from(hz), library))
            .collect();
        println!("out of step from 10 rev/s on: {speeds:?}");
        let first = 10.0 + speeds.iter().position(|out| *out).unwrap() as f64;
        let speed = bisected(first - 1.0, first, |drive| is_out(&machine, drive, library));
        println!("{library:?}: pull-out {speed:.14}");
    }
}
