//! The driven damped oscillator q″ + 2ζω q′ + ω² q = F cos νt, and its solution in closed form.

use nalgebra::{DMatrix, Matrix2, Vector2};

use crate::equations::{Differences, Equations, Linear};

/// A driven damped oscillator; state (q, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// Natural frequency ω, rad/s, above 0.
    pub omega_rad_s: f64,
    /// Damping ratio ζ, 0 or more.
    pub zeta: f64,
    /// Amplitude F of the driving force per unit mass.
    pub force: f64,
    /// Frequency ν of the driving force, rad/s.
    pub drive_rad_s: f64,
}

impl Oscillator {
    /// Returns an oscillator without a driving force.
    pub fn free(omega_rad_s: f64, zeta: f64) -> Self {
        Self {
            omega_rad_s,
            zeta,
            force: 0.0,
            drive_rad_s: 0.0,
        }
    }

    /// Returns A of y′ = A y + b.
    fn matrix_2(&self) -> Matrix2<f64> {
        let omega = self.omega_rad_s;
        Matrix2::new(0.0, 1.0, -omega * omega, -2.0 * self.zeta * omega)
    }

    /// Returns the energy per unit mass, ½ v² + ½ ω² q².
    pub fn energy(&self, y: &[f64]) -> f64 {
        0.5 * (y[1] * y[1] + (self.omega_rad_s * y[0]).powi(2))
    }

    /// Returns the state at `t_s` of an underdamped (ζ < 1) oscillator that was at `y0` at time 0, to rounding. It is the steady
    /// motion under the force, and the free decay of the difference at the start. It does not hold for ν = ω without damping.
    pub fn exact(&self, t_s: f64, y0: [f64; 2]) -> [f64; 2] {
        let (omega, nu) = (self.omega_rad_s, self.drive_rad_s);
        let decay = self.zeta * omega;
        // q = Re(F e^iνt / (ω² − ν² + 2iζων)) = c cos νt + s sin νt
        let (real, imaginary) = (omega * omega - nu * nu, 2.0 * decay * nu);
        let scale = self.force / (real * real + imaginary * imaginary);
        let (c, s) = (scale * real, scale * imaginary);
        let steady = |t: f64| {
            let (sin, cos) = (nu * t).sin_cos();
            Vector2::new(c * cos + s * sin, nu * (s * cos - c * sin))
        };
        let start = Vector2::from(y0) - steady(0.0);
        let damped = omega * (1.0 - self.zeta * self.zeta).sqrt();
        let (sin, cos) = (damped * t_s).sin_cos();
        // exp(At) = e^−δt (cos ωt I + sin ωt / ω (A + δ I)), δ = ζω
        let turning = Matrix2::identity() * cos
            + (self.matrix_2() + Matrix2::identity() * decay) * (sin / damped);
        let at = steady(t_s) + turning * start * (-decay * t_s).exp();
        [at[0], at[1]]
    }
}

impl Equations for Oscillator {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        let omega = self.omega_rad_s;
        rates[0] = y[1];
        rates[1] = self.force * (self.drive_rad_s * t_s).cos()
            - omega * (omega * y[0] + 2.0 * self.zeta * y[1]);
    }

    fn is_second_order(&self) -> bool {
        true
    }

    fn jacobian(&self, _: f64, _: &[f64], _: &mut Differences, jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from(&self.matrix_2());
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }
}

impl Linear for Oscillator {
    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(2, 2, self.matrix_2().as_slice())
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        input[0] = 0.0;
        input[1] = self.force * (self.drive_rad_s * t_s).cos();
    }
}
