//! The frame that the crank axes stand on, on its suspension; and, if there is one, the foundation block under that, on
//! the ground.
//!
//! Both heave and tilt as planes do. A suspension is a ring of springs and dampers at a radius ρ, of which half the
//! stiffness acts in each tilt: k ρ²/2 for k in heave. Heights are counted from rest: where frame and foundation have
//! sagged under all that they carry. There the springs hold the weight, and nothing of it is left in the equations but
//! what the platform's own weight is to its cranks.
//!
//! The cranks push the platform with y, heave and moments, so they push the frame with −y.

use super::corners::FREEDOMS;

/// A mass in heave and tilts, and what it stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// kg and kg·m².
    pub masses: [f64; FREEDOMS],
    /// N/m and N·m/rad.
    pub stiffness: [f64; FREEDOMS],
    /// N·s/m and N·m·s/rad.
    pub damping: [f64; FREEDOMS],
}

impl Layer {
    /// A mass on a ring of springs of `radius_m` that have `n_per_m` in all, damped by `zeta` of what is critical for all
    /// that they carry, which is this mass and `above`.
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

    /// What its springs and dampers push it back with where it is displaced against what it stands on.
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
/// Its state is its plane, and its foundation's after that.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The frame with all that is bolted to it, on its suspension.
    pub suspended: Layer,
    /// The block under the suspension, on the ground; without it the suspension stands on the ground itself.
    pub foundation: Option<Layer>,
}

/// What a frame does, and hands on to the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameMotion {
    /// Heave (m) and tilts (rad) of the frame, from rest.
    pub place: [f64; FREEDOMS],
    /// Force on the ground, N, downwards, beyond the weight at rest.
    pub ground_n: f64,
}

impl Frame {
    /// How many positions it has.
    pub const fn freedoms(&self) -> usize {
        match self.foundation {
            None => FREEDOMS,
            Some(_) => 2 * FREEDOMS,
        }
    }

    /// What the suspension pushes the frame with.
    pub fn pull(&self, place: &[f64], rate: &[f64]) -> [f64; FREEDOMS] {
        if self.foundation.is_none() {
            return self.suspended.pull(place, rate);
        }
        let against = |values: &[f64]| -> [f64; FREEDOMS] {
            std::array::from_fn(|f| values[f] - values[FREEDOMS + f])
        };
        self.suspended.pull(&against(place), &against(rate))
    }

    /// Accelerations of the frame, which the suspension pushes with `pull` and the cranks with `cranks`, and of its
    /// foundation.
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

    /// What it does, and hands on to the ground.
    pub fn motion(&self, place: &[f64], rate: &[f64]) -> FrameMotion {
        let ground = match &self.foundation {
            None => self.suspended.pull(place, rate),
            Some(foundation) => foundation.pull(&place[FREEDOMS..], &rate[FREEDOMS..]),
        };
        FrameMotion {
            place: [place[0], place[1], place[2]],
            // What holds it up beyond its weight, it pushes down with.
            ground_n: ground[0],
        }
    }

    /// How far the frame sags under all that stands on it, with its own mass and `load_kg`, m.
    pub fn sag_m(&self, load_kg: f64, gravity_mps2: f64) -> f64 {
        let on_it = load_kg + self.suspended.masses[0];
        let under = self.foundation.map_or(0.0, |foundation| {
            (on_it + foundation.masses[0]) / foundation.stiffness[0]
        });
        gravity_mps2 * (on_it / self.suspended.stiffness[0] + under)
    }

    /// Kinetic energy, and that of the springs from rest, J.
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
