//! Longest stable steps of explicit methods on this project's machines, each linearised in one state.

use std::fmt::Write;

use cophase_methods::problems::{Cam, Chain, Law, Screen, Shaft};
use cophase_methods::{Differences, Equations, Scheme};
use host_sim::machines::crusher::mains::OnMains;
use host_sim::machines::five_bar::arm::FiveBarArm;
use host_sim::machines::five_bar::arm::Surface;
use nalgebra::DMatrix;

use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{Line, Panel};

/// Range in which the longest stable step is searched, s.
pub(super) const STEPS_S: (f64, f64) = (1e-7, 10.0);

/// Height of a machine's name, relative to the longest of its steps.
const NAME_ABOVE: f64 = 2.0;

/// Linearised machine: y′ = A y.
pub struct Linearised {
    /// Name in the picture and the data.
    pub name: &'static str,
    matrix: DMatrix<f64>,
    is_second_order: bool,
}

impl Equations for Linearised {
    fn dimension(&self) -> usize {
        self.matrix.nrows()
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        for (rate, row) in rates.iter_mut().zip(self.matrix.row_iter()) {
            *rate = row.iter().zip(y).map(|(entry, y)| entry * y).sum();
        }
    }

    fn is_second_order(&self) -> bool {
        self.is_second_order
    }
}

impl Linearised {
    /// Linearises the components `kept` of a machine at a state; the others do not change.
    pub(super) fn new(
        name: &'static str,
        equations: &dyn Equations,
        state: &[f64],
        kept: &[usize],
    ) -> Self {
        let n = equations.dimension();
        let mut all = DMatrix::zeros(n, n);
        let mut differences = Differences::new(n);
        equations.jacobian(0.0, state, &mut differences, &mut all);
        Self {
            name,
            matrix: DMatrix::from_fn(kept.len(), kept.len(), |i, j| all[(kept[i], kept[j])]),
            is_second_order: equations.is_second_order(),
        }
    }

    /// Largest magnitude of an eigenvalue, 1/s.
    pub fn fastest_per_s(&self) -> f64 {
        let eigenvalues = self.matrix.complex_eigenvalues();
        let sizes = eigenvalues.iter().map(|value| value.norm());
        sizes.fold(0.0, f64::max)
    }
}

/// Returns all machines, the slowest first.
pub fn all() -> [Linearised; 4] {
    let mut arm = FiveBarArm::assumed(9.81);
    // The links hang, so that gravity acts on the direction that the surface leaves free.
    let q = [-2.5, -0.64];
    arm.surface = Some(Surface {
        normal: [0.0, -1.0],
        distance_m: -arm.hand_m(q)[1] - 2e-4,
        stiffness_n_per_m: 2e4,
        damping_ns_per_m: 0.0,
    });
    let chain = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToCam);
    let screen = Screen {
        torque_over_rated: 0.0,
    };
    [
        Linearised::new("jaw crusher", &OnMains::SOURCE, &[0.0, 27.6], &[0, 1]),
        Linearised::new("screen's box", &screen, &[0.0; 6], &[0, 1, 3, 4]),
        Linearised::new("five-bar arm", &arm, &[q[0], q[1], 0.0, 0.0], &[0, 1, 2, 3]),
        Linearised::new("elastic chain", &chain, &[0.0; 6], &[0, 1, 2, 3, 4, 5]),
    ]
}

/// Makes the panel of the longest stable steps, and the data.
pub(super) fn panel(csv: &mut String) -> Result<Panel, ChartError> {
    let machines = all();
    let (mut lines, mut names) = (Vec::new(), Vec::new());
    for scheme in [
        Scheme::ExplicitEuler,
        Scheme::SymplecticEuler,
        Scheme::VelocityVerlet,
        Scheme::Rk4,
    ] {
        let mut points = Vec::new();
        for machine in &machines {
            let limit = scheme.longest_stable_step_s(machine, STEPS_S.0, STEPS_S.1)?;
            let Some(limit_s) = limit else {
                continue;
            };
            let fastest = machine.fastest_per_s();
            // Writing to a string cannot fail.
            let _ = writeln!(
                csv,
                "{} on {},,,{:.5},,,",
                scheme.facts().name,
                machine.name,
                limit_s * fastest
            );
            if limit_s > 0.0 {
                points.push((fastest, limit_s));
                if scheme == Scheme::Rk4 {
                    names.push((fastest, NAME_ABOVE * limit_s));
                }
            }
        }
        lines.push(Line {
            stroke: Stroke::None,
            ..Line::of_scheme(scheme, points)
        });
    }
    lines.push(Line {
        stroke: Stroke::None,
        marked: false,
        names: machines.iter().map(|one| one.name.to_owned()).collect(),
        ..Line::new("", Ink::Black, names)
    });
    Ok(Panel {
        title: "machines: longest stable step".to_owned(),
        x: Axis::log("fastest eigenvalue of the machine, 1/s", 5.0, 2e5),
        y: Axis::log("longest stable step, s", 1e-5, 10.0),
        lines,
        levels: Vec::new(),
    })
}
