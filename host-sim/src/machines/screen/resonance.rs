//! Steady motion of a screen, its resonances, and the speeds that they forbid.
//!
//! In steady rotation every motion is a complex amplitude: the real part of x e^{iωt} is the motion along the box, the imaginary
//! parts of z e^{iωt} and θ e^{iωt} are the motion across it and the pitch. With S = Σ G p and J = I + Σ G p²:
//!
//! ```text
//! (K − M ω² + iωC) x = ω² G R Σ e^{iφ}
//! [K − M ω² + iωC      −S ω²              ] [z]          [Σ e^{iφ}  ]
//! [−S ω²               Kθ − J ω² + iωCθ   ] [θ] = ω² G R [Σ p e^{iφ}]
//! ```
//!
//! *Pitch is excited* by shafts whose blocks have a moment about the centre. Two shafts that stand symmetrically and turn in phase
//! have none.

use std::f64::consts::TAU;

use num_complex::Complex;

use super::Screen;

/// Amplification above which a speed is too close to a resonance for continuous running.
pub const AMPLIFICATION: f64 = 2.0;

/// Relative distance of two bands below which the speeds between them are forbidden too: a shaft would not keep so small a gap.
const GAP: f64 = 0.02;

/// Ratio of neighbouring speeds at which the motion of the ends is sampled.
const SPEED_RATIO: f64 = 1.004;

/// Complex amplitudes of a steady motion.
#[derive(Clone, Copy, Debug)]
pub struct Steady {
    /// Along the box, m.
    pub along: Complex<f64>,
    /// Across the box, of its centre, m.
    pub across: Complex<f64>,
    /// Pitch, rad.
    pub pitch: Complex<f64>,
}

impl Steady {
    /// Largest distance from rest over a turn, m, of the point at `place_m` from the centre of the box.
    fn distance_m(&self, place_m: f64) -> f64 {
        let (x, z) = (self.along, self.across + self.pitch * place_m);
        (0.5 * (x.norm_sqr() + z.norm_sqr()) + 0.5 * (x * x - z * z).norm()).sqrt()
    }
}

/// Resonance that the shafts excite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Speed of the shafts, rad/s.
    pub omega_rad_s: f64,
    /// Torque of each motor that is enough to turn steadily there, N·m: the mean dissipation of the damping, plus the peak torque
    /// of a block's weight. It is an upper bound, because the weight does no net work over a turn.
    pub enough_nm: f64,
}

impl Screen {
    /// Sum of the blocks' static moments, kg·m, and its moment about the centre, kg·m².
    fn excitation(&self, turns: &[f64]) -> [Complex<f64>; 2] {
        let block = |turns: &f64| Complex::from_polar(self.moment_kgm(), turns * TAU);
        let blocks = turns.iter().map(block);
        let moments = blocks
            .clone()
            .zip(&self.places_m)
            .map(|(block, p)| block * *p);
        [blocks.sum(), moments.sum()]
    }

    /// Static moment of the blocks about the centre S, kg·m, and pitch inertia with them J, kg·m².
    fn coupling(&self) -> (f64, f64) {
        let sum = |power: i32| self.places_m.iter().map(|p| p.powi(power)).sum::<f64>();
        (
            self.block_kg * sum(1),
            self.pitch_kgm2 + self.block_kg * sum(2),
        )
    }

    /// Steady motion with the blocks at `turns`.
    pub fn steady(&self, turns: &[f64], omega_rad_s: f64) -> Steady {
        let square = omega_rad_s * omega_rad_s;
        let [force, moment] = self.excitation(turns).map(|sum| sum * square);
        let (coupling, inertia) = self.coupling();
        let damping = omega_rad_s * self.damping_ns_per_m();
        let arm = self.springs_m * self.springs_m;
        let moved = Complex::new(self.stiffness_n_per_m - self.mass_kg() * square, damping);
        let turned = Complex::new(
            arm * self.stiffness_n_per_m - inertia * square,
            arm * damping,
        );
        let off = Complex::from(-coupling * square);
        let along = force / moved;
        let pitch = (moment - off * along) / (turned - off * off / moved);
        Steady {
            along,
            across: (force - off * pitch) / moved,
            pitch,
        }
    }

    /// Largest distance of the box's centre and ends from rest, over a turn in steady rotation, m.
    fn distances_m(&self, omega_rad_s: f64) -> [f64; 3] {
        let steady = self.steady(&self.phases_turns, omega_rad_s);
        [0.0, self.springs_m, -self.springs_m].map(|place_m| steady.distance_m(place_m))
    }

    /// Speeds of the two modes in which the box moves across and pitches, without damping, rad/s.
    fn modes_rad_s(&self) -> [f64; 2] {
        let (coupling, inertia) = self.coupling();
        let (mass, stiffness) = (self.mass_kg(), self.stiffness_n_per_m);
        let turning = self.springs_m * self.springs_m * stiffness;
        // (K − M s)(Kθ − J s) = S² s²
        let a = mass * inertia - coupling * coupling;
        let half_b = 0.5 * (stiffness * inertia + turning * mass);
        let root = (half_b * half_b - a * stiffness * turning).max(0.0).sqrt();
        [half_b - root, half_b + root].map(|numerator| (numerator / a).sqrt())
    }

    /// True if the shafts, turning at their phases, excite the pitch.
    pub fn excites_pitch(&self) -> bool {
        let [_, moment] = self.excitation(&self.phases_turns);
        let (coupling, _) = self.coupling();
        let min_kgm = 1e-9 * self.springs_m * self.block_kg;
        moment.norm() > min_kgm * self.eccentricity_m || coupling.abs() > min_kgm
    }

    /// Speeds that the springs' resonance forbids, rev/s: the box would move by more than [`AMPLIFICATION`] throws in steady
    /// state. Without damping, r² / |1 − r²| equals the amplification a at r² = a / (a ± 1), where r is the speed over the natural
    /// one. Damping narrows that band.
    fn springs_band_hz(&self) -> (f64, f64) {
        let natural_hz = self.natural_rad_s() / TAU;
        let edge = |sign: f64| natural_hz * (AMPLIFICATION / (AMPLIFICATION + sign)).sqrt();
        (edge(1.0), edge(-1.0))
    }

    /// Speeds at which an end of the box moves by more than [`AMPLIFICATION`] times what any point of it moves far above the
    /// resonances, rev/s.
    fn pitch_bands_hz(&self) -> Vec<(f64, f64)> {
        if !self.excites_pitch() {
            return Vec::new();
        }
        let modes = self.modes_rad_s();
        let far = self.distances_m(1e6 * modes[1]);
        let max_m = AMPLIFICATION * far.into_iter().fold(self.throw_m(), f64::max);
        let exceeds = |omega: f64| {
            let [_, one, other] = self.distances_m(omega);
            one.max(other) > max_m
        };
        let edge = |inside: f64, outside: f64| {
            let (mut inside, mut outside) = (inside, outside);
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if exceeds(middle) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside / TAU
        };
        let (low, high) = (0.2 * modes[0], 5.0 * modes[1]);
        let count = ((high / low).ln() / SPEED_RATIO.ln()).ceil() as i32;
        let mut speeds: Vec<f64> = (0..=count).map(|i| low * SPEED_RATIO.powi(i)).collect();
        // A narrow peak lies at a mode.
        speeds.extend(modes);
        speeds.sort_by(f64::total_cmp);
        let mut bands = Vec::new();
        let mut from_hz = None;
        for pair in speeds.windows(2) {
            match (exceeds(pair[0]), exceeds(pair[1])) {
                (false, true) => from_hz = Some(edge(pair[1], pair[0])),
                (true, false) => bands.extend(from_hz.take().zip(Some(edge(pair[0], pair[1])))),
                _ => {}
            }
        }
        bands
    }

    /// Speeds that the resonances forbid, rev/s, in order and apart. In steady state the centre of the box would move by more than
    /// [`AMPLIFICATION`] throws there, or an end of it by more than as many times what the box moves far above the resonances.
    /// Bands of the pitch that begin above `top_hz`, the largest speed of the shafts, are left out.
    #[must_use]
    pub fn bands_hz(&self) -> Vec<(f64, f64)> {
        let pitch = self.pitch_bands_hz();
        let mut bands = vec![self.springs_band_hz()];
        bands.extend(
            pitch
                .into_iter()
                .filter(|&(from_hz, _)| from_hz < self.top_hz),
        );
        bands.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut joined: Vec<(f64, f64)> = Vec::new();
        for band in bands {
            match joined.last_mut() {
                Some(last) if band.0 < (1.0 + GAP) * last.1 => last.1 = last.1.max(band.1),
                _ => joined.push(band),
            }
        }
        joined
    }

    /// Resonances that the shafts excite and reach, the one of the springs first.
    #[must_use]
    pub fn resonances(&self) -> Vec<Resonance> {
        let count = self.places_m.len() as f64;
        let weight_nm = self.moment_kgm() * self.gravity_mps2;
        let natural = self.natural_rad_s();
        let amplitude_m = self.throw_m() / (2.0 * self.zeta);
        // Dissipated power along and across the box: C ω² A² / 2 each, or a torque of C ω A² / 2.
        let dissipated = self.damping_ns_per_m() * natural * amplitude_m * amplitude_m / count;
        let mut resonances = vec![Resonance {
            omega_rad_s: natural,
            enough_nm: dissipated + weight_nm,
        }];
        if self.excites_pitch() {
            let [_, pitch] = self.modes_rad_s();
            let steady = self.steady(&self.phases_turns, pitch);
            let arm = self.springs_m * self.springs_m;
            let moved = steady.along.norm_sqr() + steady.across.norm_sqr();
            let squares = moved + arm * steady.pitch.norm_sqr();
            let dissipated = 0.5 * self.damping_ns_per_m() * pitch * squares / count;
            resonances.push(Resonance {
                omega_rad_s: pitch,
                enough_nm: dissipated + weight_nm,
            });
        }
        resonances.retain(|resonance| {
            resonance.omega_rad_s == natural || resonance.omega_rad_s < TAU * self.top_hz
        });
        resonances
    }
}
