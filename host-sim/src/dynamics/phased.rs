//! Phased model: one rotor per crank, and rods that are rigid wherever geometry permits it.
//!
//! The platform lies in the plane closest to its corners. The height of each corner above its crank's axis depends on its
//! own crank only. So the plane moves relative to the frame with G(α) ω. Column i of G is the contribution of corner i to
//! heave and tilts, times dhᵢ/dα. Let y be the force of the cranks on the platform. The platform, of mass and inertias M_p,
//! obeys M_p p″ = y − weight. A frame of M_f obeys M_f f″ = pull + weight − y, because its springs carry the weight at
//! rest. Crank i, of inertia J, obeys J αᵢ″ = torque − columnᵢ·y − warp. The kinematics are p″ = f″ + G α″ + Ġ ω. Together:
//!
//! ```text
//! (M_p⁻¹ + M_f⁻¹ + G J⁻¹ Gᵀ) y = M_p⁻¹ weight + M_f⁻¹ (pull + weight) + G J⁻¹ (torques − warps) + Ġ ω
//! ```
//!
//! These are three equations for any number of cranks. A fixed frame has M_f⁻¹ = 0.
//!
//! Up to three corners always lie in a plane. A platform on four or more is *over-constrained*: unless all heights fit,
//! rods must deform. Rods are light and stiff, so they are modelled as quasi-static: the platform lies in the plane of the
//! least deformation, and corner i is loaded with k times its distance from that plane. The rods' own oscillation, at
//! √(k / m) and above, is not modelled ([`super::Elastic`] does so).

use super::corners::{Corners, FREEDOMS, MAX};
use super::{Body, Crank, Frame, PlaneMotion};
use crate::axes::{Axes, per_axis};
use crate::dynamics::Dynamics;
use crate::dynamics::modes::Bound;
use crate::pose::Pose;

/// A machine with N angles, and the frame's plane if it has a frame. Positions are in that order.
#[derive(Clone, Debug)]
pub struct Phased {
    body: Body,
    corners: Corners,
    frame: Option<Frame>,
    /// M_p⁻¹, M_p⁻¹ + M_f⁻¹ and J⁻¹.
    platform_mobility: [f64; FREEDOMS],
    mobility: [f64; FREEDOMS],
    rotor_mobility: [f64; MAX],
}

impl Phased {
    /// Creates a machine of a body, on a fixed frame.
    pub fn new(body: Body) -> Self {
        let platform_mobility = body.masses().map(f64::recip);
        let mut rotor_mobility = [0.0; MAX];
        for (mobility, rotor) in rotor_mobility.iter_mut().zip(&body.rotors_kgm2) {
            *mobility = rotor.recip();
        }
        Self {
            corners: Corners::new(body.axes(), body.mount_radius_m),
            body,
            frame: None,
            platform_mobility,
            mobility: platform_mobility,
            rotor_mobility,
        }
    }

    /// Puts the machine on a frame.
    #[must_use]
    pub fn on(mut self, frame: Frame) -> Self {
        let frame_mobility = frame.suspended.masses.map(f64::recip);
        self.mobility = std::array::from_fn(|f| self.platform_mobility[f] + frame_mobility[f]);
        self.frame = Some(frame);
        self
    }

    /// Height of each of N corners above the platform's plane, m. Zero for up to three corners.
    #[inline(always)]
    fn warps<const N: usize>(&self, heights: &[f64; N]) -> [f64; N] {
        if N <= FREEDOMS {
            return [0.0; N];
        }
        let plane = self.corners.plane(heights);
        std::array::from_fn(|i| heights[i] - self.corners.height(&plane, i))
    }

    /// Computes [`Dynamics::accelerations`] with N cranks. A known number lets the compiler unroll all loops over them.
    fn accelerations_of<const N: usize>(
        &self,
        q: &[f64],
        v: &[f64],
        torque: &[f64],
        held: &[bool; MAX],
        out: &mut [f64],
    ) {
        const ONE_EACH: &str = "an angle for each crank";
        let body = &self.body;
        let (alpha, place) = q.split_first_chunk::<N>().expect(ONE_EACH);
        let (omega, rate) = v.split_first_chunk::<N>().expect(ONE_EACH);
        let (cranks_out, frame_out) = out.split_first_chunk_mut::<N>().expect(ONE_EACH);
        let torque = torque.first_chunk::<N>().expect(ONE_EACH);
        let cranks = body.cranks(alpha);
        let warps = self.warps(&cranks.map(|crank| crank.height_m));

        let [a, d, f] = self.mobility;
        let mut left = Symmetric {
            a,
            d,
            f,
            ..Symmetric::default()
        };
        let mut right = [body.load.gravity_mps2, 0.0, 0.0];
        // Weight that the springs carry at rest, and their force in excess of it.
        let weight = [body.weight_n(), 0.0, 0.0];
        let mut pull = [0.0; FREEDOMS];
        if let Some(frame) = &self.frame {
            pull = frame.pull(place, rate);
            for f in 0..FREEDOMS {
                right[f] += (pull[f] + weight[f]) / frame.suspended.masses[f];
            }
        }
        let mut columns = [[0.0; FREEDOMS]; N];
        let mut net = [0.0; N];
        let mut mobilities = [0.0; N];
        for i in 0..N {
            let share = self.corners.share(i);
            let lever = cranks[i].lever_m;
            columns[i] = share.map(|share| share * lever);
            let bend_nm = body.rod_n_per_m * warps[i] * lever;
            net[i] = torque[i] - bend_nm;
            if !held[i] {
                mobilities[i] = self.rotor_mobility[i];
            }
            let mobility = mobilities[i];
            left.add(&columns[i], mobility);
            let swing = cranks[i].lever_rate_m * omega[i] * omega[i];
            for f in 0..FREEDOMS {
                right[f] += columns[i][f] * mobility * net[i] + share[f] * swing;
            }
        }
        let y = left.solve(&right);
        for i in 0..N {
            let load: f64 = (0..FREEDOMS).map(|f| columns[i][f] * y[f]).sum();
            cranks_out[i] = (net[i] - load) * mobilities[i];
        }
        if let Some(frame) = &self.frame {
            let cranks = std::array::from_fn(|f| weight[f] - y[f]);
            frame.accelerations(place, rate, &pull, &cranks, frame_out);
        }
    }

    /// Position and motion of the platform at these positions and their rates.
    pub fn plane(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion {
        let n = self.body.axes();
        let cranks = self.cranks(&q[..n]);
        let mut motion = PlaneMotion {
            place: self.place_of(&cranks, q),
            ..PlaneMotion::default()
        };
        for (i, crank) in cranks.iter().enumerate() {
            let rate = crank.lever_m * v[i];
            let acceleration = crank.lever_m * a[i] + crank.lever_rate_m * v[i] * v[i];
            for (f, share) in self.corners.share(i).into_iter().enumerate() {
                motion.rate[f] += share * rate;
                motion.acceleration[f] += share * acceleration;
            }
        }
        if self.frame.is_some() {
            for f in 0..FREEDOMS {
                motion.rate[f] += v[n + f];
                motion.acceleration[f] += a[n + f];
            }
        }
        motion
    }

    fn cranks(&self, alpha: &[f64]) -> Axes<Crank> {
        per_axis(alpha.len(), |i| self.body.crank(alpha[i]))
    }

    /// Position of the platform on these cranks.
    fn place_of(&self, cranks: &[Crank], q: &[f64]) -> [f64; FREEDOMS] {
        let heights = per_axis(cranks.len(), |i| cranks[i].height_m);
        let mut place = self.corners.plane(&heights);
        if self.frame.is_some() {
            for (place, frame) in place.iter_mut().zip(&q[cranks.len()..]) {
                *place += frame;
            }
        }
        place
    }
}

impl Dynamics for Phased {
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
        self.body.axes() + self.frame.as_ref().map_or(0, Frame::freedoms)
    }

    fn accelerations(
        &self,
        q: &[f64],
        v: &[f64],
        torque: &[f64],
        held: &[bool; MAX],
        out: &mut [f64],
    ) {
        match self.body.axes() {
            1 => self.accelerations_of::<1>(q, v, torque, held, out),
            2 => self.accelerations_of::<2>(q, v, torque, held, out),
            3 => self.accelerations_of::<3>(q, v, torque, held, out),
            4 => self.accelerations_of::<4>(q, v, torque, held, out),
            5 => self.accelerations_of::<5>(q, v, torque, held, out),
            _ => self.accelerations_of::<MAX>(q, v, torque, held, out),
        }
    }

    fn fastest_mode(&self, rotors: Bound) -> Bound {
        let frame = self
            .frame
            .as_ref()
            .map_or_else(Bound::default, Bound::of_frame);
        if self.body.axes() > 3 {
            rotors.and(Bound::of_bent_rods(&self.body)).or(frame)
        } else {
            rotors.or(frame)
        }
    }

    fn is_geometric(&self) -> bool {
        self.frame.is_none()
    }

    fn frame(&self) -> Option<&Frame> {
        self.frame.as_ref()
    }

    fn pose(&self, q: &[f64], v: &[f64], a: &[f64]) -> Option<Pose> {
        Some(self.plane(q, v, a).tilted())
    }

    fn place(&self, q: &[f64]) -> Option<[f64; FREEDOMS]> {
        Some(self.place_of(&self.cranks(&q[..self.body.axes()]), q))
    }

    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64 {
        let body = &self.body;
        let n = body.axes();
        let motion = self.plane(q, v, &[0.0; MAX + 2 * FREEDOMS]);
        let rotors = body.rotors_kgm2.iter().zip(v);
        let rotors: f64 = rotors.map(|(rotor, omega)| rotor * omega * omega).sum();
        let masses = body.masses();
        let platform: f64 = (0..FREEDOMS)
            .map(|f| masses[f] * motion.rate[f] * motion.rate[f])
            .sum();
        // Up to three corners always lie in a plane.
        let heights = self
            .cranks(&q[..n])
            .iter()
            .map(|crank| crank.height_m)
            .collect::<Axes<_>>();
        let plane = self.corners.plane(&heights);
        let warps = heights
            .iter()
            .enumerate()
            .map(|(i, height)| height - self.corners.height(&plane, i));
        let rods: f64 = if n > FREEDOMS {
            warps.map(|warp| warp * warp).sum()
        } else {
            0.0
        };
        let mut energy =
            0.5 * (rotors + platform + body.rod_n_per_m * rods) + body.weight_n() * motion.place[0];
        if let Some(frame) = &self.frame {
            // At rest the springs carry the platform's weight.
            energy += frame.energy_j(&q[n..], &v[n..]) - body.weight_n() * q[n];
        }
        energy
    }
}

/// A symmetric 3 × 3 matrix with the rows `[a b c]`, `[b d e]`, `[c e f]`.
#[derive(Clone, Copy, Debug, Default)]
struct Symmetric {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
}

impl Symmetric {
    /// Adds `by` times the outer product of a column with itself.
    fn add(&mut self, column: &[f64; 3], by: f64) {
        let [x, y, z] = *column;
        let (bx, by_y) = (by * x, by * y);
        self.a += bx * x;
        self.b += bx * y;
        self.c += bx * z;
        self.d += by_y * y;
        self.e += by_y * z;
        self.f += by * z * z;
    }

    /// Returns the vector whose product with this matrix is `right`, by L D Lᵀ. Positive masses and inertias make the
    /// matrix positive definite.
    fn solve(&self, right: &[f64; 3]) -> [f64; 3] {
        let (b, c) = (self.b / self.a, self.c / self.a);
        let d = self.d - b * self.b;
        let e_d = self.e - b * self.c;
        let e = e_d / d;
        let f = self.f - c * self.c - e * e_d;
        let y = right[1] - b * right[0];
        let z = (right[2] - c * right[0] - e * y) / f;
        let y = y / d - e * z;
        [right[0] / self.a - b * y - c * z, y, z]
    }
}
