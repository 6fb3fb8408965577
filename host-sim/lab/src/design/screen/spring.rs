//! Coil spring under a screen, in the units of its source: kgf and cm.

use core::f64::consts::PI;

/// Coil spring of round wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Diameter of the wire, cm.
    pub wire_cm: f64,
    /// Mean diameter of the coil, cm.
    pub coil_cm: f64,
    /// Shear modulus, kgf/cm².
    pub shear_modulus: f64,
}

impl Spring {
    /// Load at which the wire reaches a shear stress of `stress` kgf/cm², kgf: π d³ τ / (8 K_w D), with K_w Wahl's factor for the
    /// curvature of the wire.
    #[must_use]
    pub fn load_kgf(&self, stress: f64, wahl: f64) -> f64 {
        PI * self.wire_cm.powi(3) * stress / (8.0 * wahl * self.coil_cm)
    }

    /// Active turns with which a load in kgf compresses it by a travel in cm: G d⁴ f / (8 P D³).
    #[must_use]
    pub fn turns(&self, load_kgf: f64, travel_cm: f64) -> f64 {
        self.shear_modulus * self.wire_cm.powi(4) * travel_cm
            / (8.0 * load_kgf * self.coil_cm.powi(3))
    }

    /// Stiffness, kgf/cm: G d⁴ / (8 D³ n).
    #[must_use]
    pub fn stiffness_kgf_per_cm(&self, turns: f64) -> f64 {
        self.shear_modulus * self.wire_cm.powi(4) / (8.0 * self.coil_cm.powi(3) * turns)
    }

    /// Free height with ground ends, cm: active turns times their pitch, and 1.5 end turns of which half a wire is ground off.
    #[must_use]
    pub fn height_cm(&self, turns: f64, pitch_cm: f64) -> f64 {
        turns * pitch_cm + self.wire_cm
    }
}
