//! Upper bound of the frequency of a machine's fastest mode.
//!
//! It is a bound and not a spectrum, because cranks turn and levers change. Let D be the inertias of the individual
//! positions, and M the inertia of all of them together. M − D is the platform's inertia as the cranks carry it, and is
//! never negative: any mass attached to a position makes it slower. So the frequency of every mode is at most the square
//! root of the largest eigenvalue of D⁻¹ K. Its decay rate is at most that of D⁻¹ C. The largest
//! eigenvalue of a sum of stiffnesses is at most the sum of their largest eigenvalues.

use super::{Body, FREEDOMS, Frame, Layer};
use crate::drives::Motor;

/// An oscillation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Frequency without damping, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio.
    pub zeta: f64,
}

/// Largest eigenvalues of D⁻¹ K and of D⁻¹ C, 1/s² and 1/s: bounds of ω² and 2 ζ ω.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bound {
    stiff: f64,
    damped: f64,
}

impl Bound {
    /// Bound of motors on their rotors.
    pub(super) fn of_rotors(motors: &[Motor], rotors_kgm2: &[f64]) -> Self {
        let each = motors.iter().zip(rotors_kgm2);
        each.fold(Self::default(), |max, (motor, rotor)| {
            max.or(Self {
                stiff: motor.stiffest_nm() / rotor,
                damped: motor.damping_nms() / rotor,
            })
        })
    }

    /// Bound of rods that deform where the platform is over-constrained. They act on the cranks only.
    pub(super) fn of_bent_rods(body: &Body) -> Self {
        let lever_m = body.longest_lever_m();
        let lightest = body.rotors_kgm2.iter().copied().fold(f64::MAX, f64::min);
        Self {
            stiff: body.rod_n_per_m * lever_m * lever_m / lightest,
            damped: 0.0,
        }
    }

    /// Bound of rods as springs, between cranks, platform and frame.
    pub(super) fn of_elastic_rods(
        body: &Body,
        frame: Option<&Frame>,
        damper_ns_per_m: f64,
    ) -> Self {
        let cranks = Self::of_bent_rods(body).stiff / body.rod_n_per_m;
        let n = body.axes() as f64;
        let around = n / 2.0 * body.mount_radius_m * body.mount_radius_m;
        // Two corners lie on one tilt axis, each at the full radius.
        let around = if body.axes() == 2 {
            2.0 * around
        } else {
            around
        };
        let masses = body.masses();
        let planes = [n, around, around].into_iter().enumerate().map(|(f, sum)| {
            let frame = frame.map_or(0.0, |frame| 1.0 / frame.suspended.masses[f]);
            sum * (1.0 / masses[f] + frame)
        });
        let mobility = cranks + planes.fold(0.0, f64::max);
        Self {
            stiff: body.rod_n_per_m * mobility,
            damped: damper_ns_per_m * mobility,
        }
    }

    /// Bound of a frame and its foundation on their springs.
    pub(super) fn of_frame(frame: &Frame) -> Self {
        let of = |f: usize, pick: fn(&Layer) -> [f64; FREEDOMS]| {
            let upper = pick(&frame.suspended)[f];
            let Some(foundation) = &frame.foundation else {
                return upper / frame.suspended.masses[f];
            };
            let (above, below) = (frame.suspended.masses[f], foundation.masses[f]);
            let (a, d) = (upper / above, (upper + pick(foundation)[f]) / below);
            0.5 * (a + d + ((a - d) * (a - d) + 4.0 * upper * upper / (above * below)).sqrt())
        };
        (0..FREEDOMS).fold(Self::default(), |max, f| {
            max.or(Self {
                stiff: of(f, |layer| layer.stiffness),
                damped: of(f, |layer| layer.damping),
            })
        })
    }

    /// Modes of each layer of springs by itself.
    pub(super) fn layers(frame: &Frame) -> impl Iterator<Item = Mode> + '_ {
        let layers = std::iter::once(&frame.suspended).chain(&frame.foundation);
        layers.flat_map(|layer| {
            (0..FREEDOMS).map(|f| {
                let bound = Self {
                    stiff: layer.stiffness[f] / layer.masses[f],
                    damped: layer.damping[f] / layer.masses[f],
                };
                bound.mode()
            })
        })
    }

    /// Modes of each motor on its rotor by itself.
    pub(super) fn rotors(motors: &[Motor], rotors_kgm2: &[f64]) -> Vec<Mode> {
        let each = motors.iter().zip(rotors_kgm2);
        each.map(|(motor, rotor)| {
            Self::of_rotors(std::slice::from_ref(motor), std::slice::from_ref(rotor)).mode()
        })
        .collect()
    }

    /// Combined bound of two systems that share no position.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            stiff: self.stiff.max(other.stiff),
            damped: self.damped.max(other.damped),
        }
    }

    /// Combined bound of two systems that share positions.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            stiff: self.stiff + other.stiff,
            damped: self.damped + other.damped,
        }
    }

    /// Bound of a known mode.
    pub(super) fn of_mode(mode: Mode) -> Self {
        Self {
            stiff: mode.omega_rad_s * mode.omega_rad_s,
            damped: 2.0 * mode.zeta * mode.omega_rad_s,
        }
    }

    /// Mode with this bound as its frequency and damping.
    pub(super) fn mode(self) -> Mode {
        let omega_rad_s = self.stiff.sqrt();
        Mode {
            omega_rad_s,
            zeta: if self.stiff > 0.0 {
                self.damped / (2.0 * omega_rad_s)
            } else {
                0.0
            },
        }
    }
}
