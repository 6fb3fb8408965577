//! Every crank a rotor of its own, rods rigid as far as that can be.
//!
//! The platform lies in the plane closest to its corners. Each corner's height depends on its own crank alone, so
//! that the plane moves with G(α) ω, where column i of G is what corner i adds to heave and tilts, times dhᵢ/dα. With
//! the platform's mass and inertias in M_p, Lagrange gives
//!
//! ```text
//! (diag J + Gᵀ M_p G) α″ = torques − Gᵀ (M_p Ġ ω + weight) − warp
//! ```
//!
//! Up to three corners always lie in a plane. A platform on four and more is *over-constrained*: unless all heights
//! fit, rods must give. They are light and stiff, so they are taken to have settled: the platform lies in the plane
//! that asks least of them, and corner i feels k times its distance from it. Of the rods' own oscillation, at
//! √(k / m) and above, nothing is left ([`super::Sprung`] has it).

use super::Body;
use super::corners::{Corners, FREEDOMS, MOST};

/// A machine of N angles. The state is N angles, then N speeds.
#[derive(Clone, Debug)]
pub struct Phased {
    body: Body,
    corners: Corners,
}

/// Where the platform is and how fast it moves: heave in m, tilts in rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneMotion {
    /// Heave, tilts.
    pub place: [f64; FREEDOMS],
    /// Their rates.
    pub rate: [f64; FREEDOMS],
}

impl Phased {
    /// Of a body.
    pub fn new(body: Body) -> Self {
        let corners = Corners::new(body.axes(), body.mount_radius_m);
        Self { body, corners }
    }

    /// The body.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The corners.
    pub fn corners(&self) -> &Corners {
        &self.corners
    }

    fn masses(&self) -> [f64; FREEDOMS] {
        let tilt = self.body.tilt_inertia_kgm2;
        [self.body.load.mass_kg, tilt, tilt]
    }

    /// α″ of each crank, rad/s², under each motor's torque, N·m. All slices have one entry an axis.
    pub fn accelerations(&self, alpha: &[f64], omega: &[f64], torque: &[f64], out: &mut [f64]) {
        let body = &self.body;
        let n = body.axes();
        let masses = self.masses();
        let mut columns = [[0.0; FREEDOMS]; MOST];
        let mut forces = [body.weight_n(), 0.0, 0.0];
        let mut levers = [0.0; MOST];
        for i in 0..n {
            let share = self.corners.share(i);
            levers[i] = body.lever_m(alpha[i]);
            let swing = body.lever_rate_m(alpha[i]) * omega[i] * omega[i];
            for f in 0..FREEDOMS {
                columns[i][f] = share[f] * levers[i];
                forces[f] += masses[f] * share[f] * swing;
            }
        }
        let warps = self.warps_m(alpha);
        let mut right = [0.0; MOST];
        for i in 0..n {
            let push: f64 = (0..FREEDOMS).map(|f| columns[i][f] * forces[f]).sum();
            let bend = body.rod_n_per_m * warps[i] * levers[i];
            right[i] = torque[i] + body.drag_nm(i, omega[i]) - push - bend;
        }
        self.solve(&columns, &masses, &right, out);
    }

    /// Solves (diag J + Gᵀ M_p G) x = b by way of the three freedoms of the platform: with y = M_p G x,
    /// x = J⁻¹ (b − Gᵀ y), and (M_p⁻¹ + G J⁻¹ Gᵀ) y = G J⁻¹ b.
    fn solve(
        &self,
        columns: &[[f64; FREEDOMS]; MOST],
        masses: &[f64; FREEDOMS],
        b: &[f64; MOST],
        x: &mut [f64],
    ) {
        let mut left = nalgebra::Matrix3::<f64>::zeros();
        let mut right = nalgebra::Vector3::<f64>::zeros();
        let rotors = &self.body.rotors_kgm2;
        for f in 0..FREEDOMS {
            left[(f, f)] = 1.0 / masses[f];
        }
        for (i, &rotor) in rotors.iter().enumerate() {
            let column = nalgebra::Vector3::from(columns[i]);
            left += column * column.transpose() / rotor;
            right += column * (b[i] / rotor);
        }
        // Symmetric and positive definite, as masses and rotors are above zero.
        let y = left
            .cholesky()
            .map_or(right, |factors| factors.solve(&right));
        for (i, &rotor) in rotors.iter().enumerate() {
            let held = nalgebra::Vector3::from(columns[i]).dot(&y);
            x[i] = (b[i] - held) / rotor;
        }
    }

    /// How far each corner is above the platform's plane, m; zero for up to three corners.
    pub fn warps_m(&self, alpha: &[f64]) -> [f64; MOST] {
        let mut warps = [0.0; MOST];
        let n = self.body.axes();
        if n <= FREEDOMS {
            return warps;
        }
        let mut heights = [0.0; MOST];
        for (height, &alpha) in heights.iter_mut().zip(alpha) {
            *height = self.body.height_m(alpha);
        }
        let plane = self.corners.plane(&heights[..n]);
        for (i, warp) in warps.iter_mut().enumerate().take(n) {
            *warp = heights[i] - self.corners.height(&plane, i);
        }
        warps
    }

    /// Where the platform is.
    pub fn plane(&self, alpha: &[f64], omega: &[f64]) -> PlaneMotion {
        let mut motion = PlaneMotion::default();
        for (i, (&alpha, &omega)) in alpha.iter().zip(omega).enumerate() {
            let (height, rate) = (self.body.height_m(alpha), self.body.lever_m(alpha) * omega);
            for (f, share) in self.corners.share(i).into_iter().enumerate() {
                motion.place[f] += share * height;
                motion.rate[f] += share * rate;
            }
        }
        motion
    }

    /// Kinetic and potential energy, rods' included, J; without friction and motors it stays.
    pub fn energy_j(&self, alpha: &[f64], omega: &[f64]) -> f64 {
        let body = &self.body;
        let motion = self.plane(alpha, omega);
        let rotors = body.rotors_kgm2.iter().zip(omega);
        let rotors: f64 = rotors.map(|(rotor, omega)| rotor * omega * omega).sum();
        let masses = self.masses();
        let platform: f64 = (0..FREEDOMS)
            .map(|f| masses[f] * motion.rate[f] * motion.rate[f])
            .sum();
        let rods: f64 = self.warps_m(alpha).iter().map(|warp| warp * warp).sum();
        0.5 * (rotors + platform + body.rod_n_per_m * rods) + body.weight_n() * motion.place[0]
    }
}
