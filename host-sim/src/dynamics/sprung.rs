//! Every crank a rotor of its own, rods as springs, the platform free to heave and tilt on them.
//!
//! Corner i is pushed up with k (hᵢ − cᵢ) + c (h′ᵢ − c′ᵢ), where hᵢ is where its crank would have it and cᵢ where the
//! platform has it; its crank feels that times −dhᵢ/dα. What [`super::Phased`] takes as settled oscillates here, at
//! √(N k / m) in heave.

use super::corners::{Corners, FREEDOMS};
use super::{Body, PlaneMotion};

/// A machine of N angles and a free platform. The state is N angles, heave and two tilts, then their speeds.
#[derive(Clone, Debug)]
pub struct Sprung {
    body: Body,
    corners: Corners,
    /// Damping of each rod, N·s/m.
    damper_ns_per_m: f64,
}

impl Sprung {
    /// Of a body, and of rods that are damped so much, as a part of critical damping in heave.
    pub fn new(body: Body, damping_ratio: f64) -> Self {
        let corners = Corners::new(body.axes(), body.mount_radius_m);
        let rods_n_per_m = body.axes() as f64 * body.rod_n_per_m;
        let critical = 2.0 * (rods_n_per_m * body.load.mass_kg).sqrt();
        Self {
            damper_ns_per_m: damping_ratio * critical / body.axes() as f64,
            corners,
            body,
        }
    }

    /// The body.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Frequency of the platform's heave on its rods with all cranks held, rad/s.
    pub fn heave_rad_s(&self) -> f64 {
        (self.body.axes() as f64 * self.body.rod_n_per_m / self.body.load.mass_kg).sqrt()
    }

    /// α″ of each crank and the platform's accelerations, under each motor's torque, N·m.
    pub fn accelerations(
        &self,
        alpha: &[f64],
        omega: &[f64],
        plane: &PlaneMotion,
        torque: &[f64],
        out: &mut [f64],
    ) -> [f64; FREEDOMS] {
        let body = &self.body;
        let mut forces = [-body.weight_n(), 0.0, 0.0];
        for i in 0..body.axes() {
            let lever = body.lever_m(alpha[i]);
            let short = body.height_m(alpha[i]) - self.corners.height(&plane.place, i);
            let short_rate = lever * omega[i] - self.corners.height(&plane.rate, i);
            let push_n = body.rod_n_per_m * short + self.damper_ns_per_m * short_rate;
            for (force, share) in forces.iter_mut().zip(self.corners.force(i)) {
                *force += share * push_n;
            }
            let net_nm = torque[i] + body.drag_nm(i, omega[i]) - push_n * lever;
            out[i] = net_nm / body.rotors_kgm2[i];
        }
        let tilt = body.tilt_inertia_kgm2;
        [
            forces[0] / body.load.mass_kg,
            forces[1] / tilt,
            forces[2] / tilt,
        ]
    }

    /// Kinetic and potential energy, J; without damping, friction and motors it stays.
    pub fn energy_j(&self, alpha: &[f64], omega: &[f64], plane: &PlaneMotion) -> f64 {
        let body = &self.body;
        let rotors: f64 = (0..body.axes())
            .map(|i| body.rotors_kgm2[i] * omega[i] * omega[i])
            .sum();
        let tilt = body.tilt_inertia_kgm2;
        let masses = [body.load.mass_kg, tilt, tilt];
        let platform: f64 = (0..FREEDOMS)
            .map(|f| masses[f] * plane.rate[f] * plane.rate[f])
            .sum();
        let rods: f64 = (0..body.axes())
            .map(|i| body.height_m(alpha[i]) - self.corners.height(&plane.place, i))
            .map(|short| short * short)
            .sum();
        0.5 * (rotors + platform + body.rod_n_per_m * rods) + body.weight_n() * plane.place[0]
    }
}
