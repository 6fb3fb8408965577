//! Scene table `[crusher]`: a jaw crusher.

use cophase_core::settings::key::{needed, or_value};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

const MAX_LENGTH_MM: f64 = 20_000.0;

keys! {
    /// Table of a jaw crusher.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct CrusherTable {
        /// Eccentricity of the shaft, mm.
        eccentric_mm: f64 = needed("10").from(0.1, MAX_LENGTH_MM),
        /// Length of the jaw from the eccentric to the toggle plate, mm.
        jaw_mm: f64 = needed("800").from(0.1, MAX_LENGTH_MM),
        /// Length of the toggle plate, mm.
        toggle_mm: f64 = needed("250").from(0.1, MAX_LENGTH_MM),
        /// Distance of the toggle's fixed pivot from the shaft, mm.
        ground_mm: f64 = needed("790").from(0.1, MAX_LENGTH_MM),
        /// Distance of the rock's force from the eccentric, along the jaw, mm.
        force_mm: f64 = needed("650").from(0.1, MAX_LENGTH_MM),
        /// Mass of the jaw, kg. Its inertia is that of a uniform rod.
        jaw_kg: f64 = needed("1470.2").from(0.0, 1e6),
        /// Distance of the jaw's centre of mass from the eccentric, mm.
        jaw_centre_mm: f64 = needed("463.4").from(0.0, MAX_LENGTH_MM).at_most(1.0, &[("crusher.jaw_mm", 1)]),
        /// Profile of the rock's force over the closing stroke.
        rock: Rock = or_value("linear-rise"),
        /// Peak force of the rock across the jaw, kN.
        rock_kn: f64 = needed("1310").from(0.0, 1e5),
        /// Turns of the shaft since power-up between which rock is fed.
        rock_turns: (f64, f64) = needed("[24, 54]").from(0.0, 1e7),
    }
}

words! {
    /// Profile of the rock's force over the closing stroke.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Rock {
        /// Rise in proportion to the shaft's angle, up to the peak at the end of the stroke.
        LinearRise = "linear-rise",
        /// Peak force over the second half of the stroke.
        SecondHalf = "second-half",
        /// Peak force over the whole stroke.
        Constant = "constant",
    }
}
