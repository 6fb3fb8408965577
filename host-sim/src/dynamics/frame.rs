//! The frame that carries the crank axes, on its suspension. A foundation block under the suspension, on the ground, is optional.
//!
//! Both heave and tilt as planes. A suspension is a ring of springs and dampers of radius ρ. In each tilt half of the
//! stiffness acts: k ρ²/2 for k in heave. Heights are relative to rest, where frame and foundation have sagged under
//! everything that they carry. At rest the springs carry the weight. So the only weight in the equations is the platform's
//! own, as it loads the cranks.
//!
//! The cranks push the platform with y, in heave and moments, so they push the frame with −y.

use super::corners::FREEDOMS;

/// A mass that heaves and tilts on springs and dampers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Mass and tilt inertias, kg and kg·m².
    pub masses: [f64; FREEDOMS],
    /// Stiffness in heave and tilts, N/m and N·m/rad.
    pub stiffness: [f64; FREEDOMS],
    /// Damping in heave and tilts, N·s/m and N·m·s/rad.
    pub damping: [f64; FREEDOMS],
}

impl Layer {
    /// Creates a mass on a ring of springs of `radius_m` with a total stiffness of `n_per_m`. Damping is `zeta` times
    /// critical damping for the carried mass, which is this mass and `above`.
    pub fn new(
        masses: [f64; FREEDOMS],
        above: [f64; FREEDOMS],
        n_per_m: f64,
        radius_m: f64,
        zeta: f64,
    ) -> Self {
        let tilt = n_per_m * radius_m * radius_m / 2.0;
        let stiffness = [n_per_m, tilt, tilt];
        let critical = |f: usize| 2.0 * (stiffness[f] * (masses[f] + above[f])).sqrt();
        Self {
            masses,
            stiffness,
            damping: std::array::from_fn(|f| zeta * critical(f)),
        }
    }

    /// Force and moments of its springs and dampers, for a displacement relative to the layer below.
    fn pull(&self, place: &[f64], rate: &[f64]) -> [f64; FREEDOMS] {
        std::array::from_fn(|f| -self.stiffness[f] * place[f] - self.damping[f] * rate[f])
    }

    fn energy_j(&self, place: &[f64], rate: &[f64], under: &[f64]) -> f64 {
        let twice = (0..FREEDOMS).map(|f| {
            let stretch = place[f] - under[f];
            self.masses[f] * rate[f] * rate[f] + self.stiffness[f] * stretch * stretch
        });
        0.5 * twice.sum::<f64>()
    }
}

/// A frame on its suspension.
///
/// The state is the frame's plane, followed by the foundation's if there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Frame with everything that is bolted to it, on its suspension.
    pub suspended: Layer,
    /// Block between the suspension and the ground. Without it the suspension stands directly on the ground.
    pub foundation: Option<Layer>,
}

/// Motion of a frame, and the force that it transmits to the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameMotion {
    /// Heave (m) and tilts (rad) of the frame, relative to rest.
    pub place: [f64; FREEDOMS],
    /// Force on the ground, N, positive downwards, in excess of the weight at rest.
    pub ground_n: f64,
}

impl Frame {
    /// Number of positions.
    pub const fn freedoms(&self) -> usize {
        match self.foundation {
            None => FREEDOMS,
            Some(_) => 2 * FREEDOMS,
        }
    }

    /// Force and moments of the suspension on the frame.
    pub fn pull(&self, place: &[f64], rate: &[f64]) -> [f64; FREEDOMS] {
        if self.foundation.is_none() {
            return self.suspended.pull(place, rate);
        }
        let against = |values: &[f64]| -> [f64; FREEDOMS] {
            std::array::from_fn(|f| values[f] - values[FREEDOMS + f])
        };
        self.suspended.pull(&against(place), &against(rate))
    }

    /// Computes the accelerations of the frame and of its foundation. `pull` is the suspension's force on the frame,
    /// `cranks` that of the cranks.
    pub fn accelerations(
        &self,
        place: &[f64],
        rate: &[f64],
        pull: &[f64; FREEDOMS],
        cranks: &[f64; FREEDOMS],
        out: &mut [f64],
    ) {
        for f in 0..FREEDOMS {
            out[f] = (pull[f] + cranks[f]) / self.suspended.masses[f];
        }
        if let Some(foundation) = &self.foundation {
            let ground = foundation.pull(&place[FREEDOMS..], &rate[FREEDOMS..]);
            for f in 0..FREEDOMS {
                out[FREEDOMS + f] = (ground[f] - pull[f]) / foundation.masses[f];
            }
        }
    }

    /// Motion of the frame, and the force that it transmits to the ground.
    pub fn motion(&self, place: &[f64], rate: &[f64]) -> FrameMotion {
        let ground = match &self.foundation {
            None => self.suspended.pull(place, rate),
            Some(foundation) => foundation.pull(&place[FREEDOMS..], &rate[FREEDOMS..]),
        };
        FrameMotion {
            place: [place[0], place[1], place[2]],
            // The upward force in excess of the weight has an equal reaction on the ground.
            ground_n: ground[0],
        }
    }

    /// Static sag of the frame with its own mass and `load_kg` on it, m.
    pub fn sag_m(&self, load_kg: f64, gravity_mps2: f64) -> f64 {
        let on_it = load_kg + self.suspended.masses[0];
        let under = self.foundation.map_or(0.0, |foundation| {
            (on_it + foundation.masses[0]) / foundation.stiffness[0]
        });
        gravity_mps2 * (on_it / self.suspended.stiffness[0] + under)
    }

    /// Kinetic energy, and energy of the springs relative to rest, J.
    pub fn energy_j(&self, place: &[f64], rate: &[f64]) -> f64 {
        let Some(foundation) = &self.foundation else {
            return self.suspended.energy_j(place, rate, &[0.0; FREEDOMS]);
        };
        let (frame, block) = place.split_at(FREEDOMS);
        let (frame_rate, block_rate) = rate.split_at(FREEDOMS);
        self.suspended.energy_j(frame, frame_rate, block)
            + foundation.energy_j(block, block_rate, &[0.0; FREEDOMS])
    }
}
