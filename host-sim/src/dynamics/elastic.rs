//! Elastic model: one rotor per crank, rods as springs, and a platform that is free to heave and tilt on them.
//!
//! The force on corner i, upwards, is k (hᵢ + fᵢ − cᵢ) + c (h′ᵢ + f′ᵢ − c′ᵢ). Here hᵢ is the height above the frame that
//! the crank commands, fᵢ the height of the crank's axis on the frame, and cᵢ the height of the corner on the platform. The
//! crank is loaded with that force times −dhᵢ/dα, and the frame with the opposite force. The oscillation that
//! [`super::Phased`] neglects by quasi-static rods occurs here, at √(N k / m) in heave and √(N k ρ² / 2I) in tilt.

use super::corners::{Corners, FREEDOMS, MAX};
use super::{Body, Frame, PlaneMotion};
use crate::dynamics::Dynamics;
use crate::dynamics::modes::Bound;
use crate::pose::Pose;

/// A machine with N angles, the platform's plane, and the frame's plane if it has a frame. Positions are in that order.
#[derive(Clone, Debug)]
pub struct Elastic {
    body: Body,
    corners: Corners,
    frame: Option<Frame>,
    /// Damping of each rod, N·s/m.
    damper_ns_per_m: f64,
}

impl Elastic {
    /// Creates a machine of a body. The damping of the rods is a fraction of critical damping in heave.
    pub fn new(body: Body, damping_ratio: f64) -> Self {
        let corners = Corners::new(body.axes(), body.mount_radius_m);
        let rods_n_per_m = body.axes() as f64 * body.rod_n_per_m;
        let critical = 2.0 * (rods_n_per_m * body.load.mass_kg).sqrt();
        Self {
            damper_ns_per_m: damping_ratio * critical / body.axes() as f64,
            corners,
            body,
            frame: None,
        }
    }

    /// Puts the machine on a frame.
    #[must_use]
    pub fn on(mut self, frame: Frame) -> Self {
        self.frame = Some(frame);
        self
    }

    /// Angular frequency of the platform's heave on its rods with all cranks locked, rad/s.
    pub fn heave_rad_s(&self) -> f64 {
        (self.body.axes() as f64 * self.body.rod_n_per_m / self.body.load.mass_kg).sqrt()
    }

    /// Platform's plane relative to the frame's.
    fn over_frame(&self, q: &[f64]) -> [f64; FREEDOMS] {
        let n = self.body.axes();
        let under = |f: usize| {
            if self.frame.is_some() {
                q[n + FREEDOMS + f]
            } else {
                0.0
            }
        };
        std::array::from_fn(|f| q[n + f] - under(f))
    }

    /// Plane of the platform at rest on cranks that stand at these angles.
    fn plane_at_rest(&self, alpha: &[f64]) -> [f64; FREEDOMS] {
        let mut plane = [0.0; FREEDOMS];
        for (i, &alpha) in alpha.iter().enumerate() {
            let height = self.body.crank(alpha).height_m;
            for (plane, share) in plane.iter_mut().zip(self.corners.share(i)) {
                *plane += share * height;
            }
        }
        plane[0] -= self.body.weight_n() / (self.body.axes() as f64 * self.body.rod_n_per_m);
        plane
    }

    /// Position and motion of the platform at these positions and their rates.
    pub fn plane(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion {
        PlaneMotion {
            place: self.place_at(q),
            rate: self.place_at(v),
            acceleration: self.place_at(a),
        }
    }

    /// Position of the platform at these positions.
    fn place_at(&self, q: &[f64]) -> [f64; FREEDOMS] {
        let n = self.body.axes();
        std::array::from_fn(|f| q[n + f])
    }
}

impl Dynamics for Elastic {
    fn rotors_kgm2(&self) -> &[f64] {
        &self.body.rotors_kgm2
    }

    fn friction_nm(&self, angle: usize) -> f64 {
        self.body.friction_nm[angle]
    }

    fn body(&self) -> Option<&Body> {
        Some(&self.body)
    }

    fn positions(&self) -> usize {
        self.body.axes() + FREEDOMS + self.frame.as_ref().map_or(0, Frame::freedoms)
    }

    fn rest(&self, alpha_rad: &[f64], positions: &mut [f64]) {
        let n = self.body.axes();
        positions[n..n + FREEDOMS].copy_from_slice(&self.plane_at_rest(alpha_rad));
    }

    fn accelerations(
        &self,
        q: &[f64],
        v: &[f64],
        torque: &[f64],
        held: &[bool; MAX],
        out: &mut [f64],
    ) {
        let body = &self.body;
        let n = body.axes();
        let (place, rate) = (self.over_frame(q), self.over_frame(v));
        let mut forces = [0.0; FREEDOMS];
        for i in 0..n {
            let crank = body.crank(q[i]);
            let short = crank.height_m - self.corners.height(&place, i);
            let short_rate = crank.lever_m * v[i] - self.corners.height(&rate, i);
            let push_n = body.rod_n_per_m * short + self.damper_ns_per_m * short_rate;
            for (force, share) in forces.iter_mut().zip(self.corners.force(i)) {
                *force += share * push_n;
            }
            let net_nm = torque[i] - push_n * crank.lever_m;
            out[i] = if held[i] {
                0.0
            } else {
                net_nm / body.rotors_kgm2[i]
            };
        }
        for (f, mass) in body.masses().into_iter().enumerate() {
            out[n + f] = forces[f] / mass;
        }
        out[n] -= body.load.gravity_mps2;
        if let Some(frame) = &self.frame {
            let from = n + FREEDOMS;
            let pull = frame.pull(&q[from..], &v[from..]);
            // At rest the springs carry the platform's weight, so only the difference from it acts on the frame.
            let cranks = [body.weight_n() - forces[0], -forces[1], -forces[2]];
            frame.accelerations(&q[from..], &v[from..], &pull, &cranks, &mut out[from..]);
        }
    }

    fn fastest_mode(&self, rotors: Bound) -> Bound {
        let frame = self.frame.as_ref();
        let rods = Bound::of_elastic_rods(&self.body, frame, self.damper_ns_per_m);
        rods.and(rotors.or(frame.map_or_else(Bound::default, Bound::of_frame)))
    }

    fn is_geometric(&self) -> bool {
        false
    }

    fn frame(&self) -> Option<&Frame> {
        self.frame.as_ref()
    }

    fn pose(&self, q: &[f64], v: &[f64], a: &[f64]) -> Option<Pose> {
        Some(self.plane(q, v, a).tilted())
    }

    fn place(&self, q: &[f64]) -> Option<[f64; FREEDOMS]> {
        Some(self.place_at(q))
    }

    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64 {
        let body = &self.body;
        let n = body.axes();
        let rotors: f64 = (0..n).map(|i| body.rotors_kgm2[i] * v[i] * v[i]).sum();
        let masses = body.masses();
        let platform: f64 = (0..FREEDOMS).map(|f| masses[f] * v[n + f] * v[n + f]).sum();
        let place = self.over_frame(q);
        let rods: f64 = (0..n)
            .map(|i| body.crank(q[i]).height_m - self.corners.height(&place, i))
            .map(|short| short * short)
            .sum();
        let mut energy =
            0.5 * (rotors + platform + body.rod_n_per_m * rods) + body.weight_n() * q[n];
        if let Some(frame) = &self.frame {
            let from = n + FREEDOMS;
            // At rest the springs carry the platform's weight.
            energy += frame.energy_j(&q[from..], &v[from..]) - body.weight_n() * q[from];
        }
        energy
    }
}
