//! Which methods keep the energy of a machine that nothing drives or brakes, over 10,000 turns.
//!
//! Its inertia depends on where the cranks are, so that forces depend on speeds, and (q, v) are not what mechanics calls
//! canonical: no method here is symplectic for it. What remains is symmetry: run backwards, a symmetric method takes its own
//! steps back, and a machine whose cranks look the same turning either way can then neither gain nor lose, as long as its motion
//! repeats itself. Implicit midpoint is symmetric. Velocity Verlet, with its predictor for speeds, is not.
//!
//! As in the methods' own tests the energy is averaged at the start and at the end, under a Hann window, over 100 turns.
//! `cargo test --release -p host-sim --lib energy::table -- --ignored --nocapture` prints the table of docs/methods.md.

use std::f64::consts::TAU;

use cophase_methods::Scheme;
use cophase_methods::drift::Ends;

use super::body;
use crate::dynamics::{Driven, Freedom, Motor, Phased, Rigid, Servo};
use crate::mechanism::slider_crank::Platform;

const TURNS: f64 = 10_000.0;
const WINDOW_TURNS: f64 = 100.0;
const OMEGA_RAD_S: f64 = 100.0;

/// Not a whole number, so that a turn's ripple is met at all its phases.
const STEPS_A_TURN: f64 = 24.3;

/// What counts as kept.
const KEPT: f64 = 1e-6;

/// A machine that coasts.
#[derive(Clone, Copy, Debug)]
enum Coasting {
    /// On one shaft.
    Rigid,
    /// Three cranks, each by itself.
    Three,
    /// Four, on rods that bend without changing much of how they turn.
    Four,
    /// Four, on rods a hundred times as stiff, still far softer than steel. As levers come and go, twice a turn, rods that bend
    /// pull on their cranks as a child does that swings itself up: cranks that begin nearly in phase end up tumbling, and
    /// nothing of their motion repeats.
    Tumbling,
}

const REGULAR: [Coasting; 3] = [Coasting::Rigid, Coasting::Three, Coasting::Four];

/// The machine and its state: cranks of different rotors, almost in phase, at 100 rad/s.
fn machine(coasting: Coasting) -> (Driven, Vec<f64>) {
    let (axes, rod_n_per_m) = match coasting {
        Coasting::Three => (3, 1e3),
        Coasting::Rigid | Coasting::Four => (4, 1e3),
        Coasting::Tumbling => (4, 1e5),
    };
    let mut body = body(axes, Platform::Above);
    body.rod_n_per_m = rod_n_per_m;
    let freedom = if matches!(coasting, Coasting::Rigid) {
        Freedom::Rigid(Rigid::new(body))
    } else {
        Freedom::Phased(Box::new(Phased::new(body)))
    };
    let off = Motor::Servo(Servo {
        position_gain_per_s: 1.0,
        velocity_gain_nms: 1.0,
        integral_s: None,
        limit_nm: 1.0,
        velocity_feed_forward: 1.0,
    });
    let machine = Driven::new(freedom, vec![off; axes]);
    let angles: Vec<f64> = (0..axes).map(|i| 0.3 + 0.02 * (i * i) as f64).collect();
    let mut state = machine.at_rest(&angles);
    let half = state.len() / 2;
    state[half..].fill(OMEGA_RAD_S);
    (machine, state)
}

/// Relative change of the mean energy; infinite if a step failed.
fn drift(scheme: Scheme, steps_a_turn: f64, coasting: Coasting) -> f64 {
    let (machine, mut state) = machine(coasting);
    let mut method = scheme
        .prepare(&machine, TAU / OMEGA_RAD_S / steps_a_turn)
        .unwrap();
    let steps = (TURNS * steps_a_turn) as u32;
    let window = (WINDOW_TURNS * steps_a_turn) as u32;
    // Energy has no zero of its own: it is judged against that of motion, at the lowest place.
    let zero_j = -machine.body().weight_n() * 0.052;
    let mut ends = Ends::new(steps, window);
    for i in 0..steps {
        ends.add(i, machine.energy_j(&state) - zero_j);
        if method.step(&machine, 0.0, &mut state).is_err() {
            return f64::INFINITY;
        }
    }
    let (first, last) = ends.means();
    (last / first - 1.0).abs()
}

/// Were it wrong, a machine that coasts would run down or up by itself, and what friction and motors do to it could not be
/// distinguished from that.
#[test]
fn implicit_midpoint_keeps_it() {
    for coasting in REGULAR {
        let drift = drift(Scheme::ImplicitMidpoint, STEPS_A_TURN, coasting);
        println!("implicit midpoint, {coasting:?}: {drift:.1e}");
        assert!(drift < KEPT, "{coasting:?}: {drift:e}");
    }
}

/// Were it wrong, methods that are cheaper at this step would be passed over for nothing.
#[test]
fn rk4_and_explicit_euler_lose_it_at_that_step() {
    for coasting in REGULAR {
        for scheme in [Scheme::Rk4, Scheme::ExplicitEuler] {
            let drift = drift(scheme, STEPS_A_TURN, coasting);
            println!("{scheme}, {coasting:?}: {drift:.1e}");
            assert!(drift > 100.0 * KEPT, "{scheme}, {coasting:?}: {drift:e}");
        }
    }
}

/// The table of docs/methods.md, and the steps at which RK4 keeps energy by being accurate.
#[test]
#[ignore = "a table for the docs, of some minutes"]
fn table() {
    let all = [
        Coasting::Rigid,
        Coasting::Three,
        Coasting::Four,
        Coasting::Tumbling,
    ];
    let row = |scheme: Scheme, steps: f64| {
        print!("{:18} {steps:5}", scheme.facts().name);
        for coasting in all {
            print!(" {:8.1e}", drift(scheme, steps, coasting));
        }
        println!();
    };
    for scheme in [
        Scheme::ExplicitEuler,
        Scheme::SymplecticEuler,
        Scheme::VelocityVerlet,
        Scheme::Rk4,
        Scheme::ImplicitMidpoint,
        Scheme::Sdirk4,
    ] {
        row(scheme, STEPS_A_TURN);
    }
    for steps in [50.3, 100.3, 200.3, 400.3] {
        row(Scheme::Rk4, steps);
    }
}
