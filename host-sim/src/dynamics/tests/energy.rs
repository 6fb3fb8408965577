//! Conservation of energy by each method, for a machine without drive and brake, over 10,000 turns.
//!
//! The inertia depends on the crank angles, so forces depend on speeds, and (q, v) are not canonical coordinates. No method
//! here is symplectic for this system. Symmetry remains: run backwards, a symmetric method retraces its own steps. If the
//! machine is the same in both directions of rotation and its motion is periodic, such a method can neither gain nor lose
//! energy. Implicit midpoint is symmetric. Velocity Verlet, with its predictor for speeds, is not.
//!
//! As in the methods' own tests, the energy is averaged at the start and at the end, under a Hann window, over 100 turns.
//! `cargo test --release -p host-sim --lib energy::table -- --ignored --nocapture` prints the table of docs/methods.md.

use std::f64::consts::TAU;

use cophase_methods::Scheme;
use cophase_methods::drift::Ends;

use super::body;
use crate::drives::{Motor, Servo};
use crate::dynamics::{Driven, Dynamics, Phased, Rigid};
use crate::mechanism::Platform;

const TURNS: f64 = 10_000.0;
const WINDOW_TURNS: f64 = 100.0;
const OMEGA_RAD_S: f64 = 100.0;

/// Not an integer, so that the steps sample the ripple of a turn at all phases.
const STEPS_A_TURN: f64 = 24.3;

/// Relative change up to which energy counts as conserved.
const KEPT: f64 = 1e-6;

/// A machine that coasts.
#[derive(Clone, Copy, Debug)]
enum Coasting {
    /// Cranks on one shaft.
    Rigid,
    /// Three independent cranks.
    Three,
    /// Four cranks, on rods that bend without much effect on the rotation.
    Four,
    /// Four cranks, on rods a hundred times as stiff, still far softer than steel. Levers grow and shrink twice a turn, so
    /// bent rods excite their cranks parametrically. Cranks that start nearly in phase end up tumbling, and their motion is
    /// not periodic.
    Tumbling,
}

const REGULAR: [Coasting; 3] = [Coasting::Rigid, Coasting::Three, Coasting::Four];

/// Returns the machine and its state: cranks of different rotors, almost in phase, at 100 rad/s.
fn machine(coasting: Coasting) -> (Driven, Vec<f64>) {
    let (axes, rod_n_per_m) = match coasting {
        Coasting::Three => (3, 1e3),
        Coasting::Rigid | Coasting::Four => (4, 1e3),
        Coasting::Tumbling => (4, 1e5),
    };
    let mut body = body(axes, Platform::Above);
    body.rod_n_per_m = rod_n_per_m;
    let machine: Box<dyn Dynamics> = if matches!(coasting, Coasting::Rigid) {
        Box::new(Rigid::new(body))
    } else {
        Box::new(Phased::new(body))
    };
    let off = Motor::Servo(Servo {
        position_gain_per_s: 1.0,
        velocity_gain_nms: 1.0,
        integral_s: None,
        limit_nm: 1.0,
        velocity_feed_forward: 1.0,
    });
    let machine = Driven::new(machine, vec![off; axes]);
    let angles: Vec<f64> = (0..axes).map(|i| 0.3 + 0.02 * (i * i) as f64).collect();
    let mut state = machine.at_rest(&angles);
    let half = state.len() / 2;
    state[half..].fill(OMEGA_RAD_S);
    (machine, state)
}

/// Relative change of the mean energy. Infinite if a step failed.
fn drift(scheme: Scheme, steps_a_turn: f64, coasting: Coasting) -> f64 {
    let (machine, mut state) = machine(coasting);
    let mut method = scheme
        .prepare(&machine, TAU / OMEGA_RAD_S / steps_a_turn)
        .unwrap();
    let steps = (TURNS * steps_a_turn) as u32;
    let window = (WINDOW_TURNS * steps_a_turn) as u32;
    // The zero of potential energy is arbitrary. The change is relative to the energy above the lowest position.
    let zero_j = -machine.body().unwrap().weight_n() * 0.052;
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

/// If this fails, a coasting machine slows down or speeds up by itself. The effect of friction and motors could then not be
/// distinguished from that.
#[test]
fn implicit_midpoint_conserves_energy() {
    for coasting in REGULAR {
        let drift = drift(Scheme::ImplicitMidpoint, STEPS_A_TURN, coasting);
        println!("implicit midpoint, {coasting:?}: {drift:.1e}");
        assert!(drift < KEPT, "{coasting:?}: {drift:e}");
    }
}

/// If this fails, cheaper methods conserve energy at this step as well, and the choice of implicit midpoint is unjustified.
#[test]
fn rk4_and_explicit_euler_do_not_conserve_energy() {
    for coasting in REGULAR {
        for scheme in [Scheme::Rk4, Scheme::ExplicitEuler] {
            let drift = drift(scheme, STEPS_A_TURN, coasting);
            println!("{scheme}, {coasting:?}: {drift:.1e}");
            assert!(drift > 100.0 * KEPT, "{scheme}, {coasting:?}: {drift:e}");
        }
    }
}

/// Prints the table of docs/methods.md, and the step counts at which RK4 conserves energy by accuracy.
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
