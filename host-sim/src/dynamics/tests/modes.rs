//! The bound on a machine's fastest mode, against its spectrum.

use cophase_methods::{Differences, Equations};
use nalgebra::DMatrix;
use proptest::prelude::*;

use super::{body, frame};
use crate::drives::{Motor, Servo};
use crate::dynamics::{Driven, Dynamics, Elastic, Phased};
use crate::mechanism::Platform;

/// Spring of 1000 N·m/rad, nearly undamped.
const SPRING: Servo = Servo {
    position_gain_per_s: 1e6,
    velocity_gain_nms: 1e-3,
    integral_s: None,
    limit_nm: f64::INFINITY,
    velocity_feed_forward: 1.0,
};

proptest! {
    /// If this fails because a mode is faster than the bound, an unstable step is accepted and the scene diverges. This
    /// covers quasi-static and elastic rods, with and without a frame and its foundation. If the bound is far too wide,
    /// scenes are slow without need.
    #[test]
    fn no_mode_is_faster_than_the_bound(
        alpha in (2_usize..=6).prop_flat_map(|n| prop::collection::vec(-3.0..3.0, n)),
        stiffer in 1.0..1000.0,
        elastic in any::<bool>(),
        framed in any::<bool>(),
        on_block in any::<bool>(),
    ) {
        let n = alpha.len();
        let body = body(n, Platform::Above);
        let mut frame = frame(0.0, on_block);
        frame.suspended.stiffness = frame.suspended.stiffness.map(|k| k * stiffer);
        let dynamics: Box<dyn Dynamics> = match (elastic, framed) {
            (false, false) => Box::new(Phased::new(body)),
            (false, true) => Box::new(Phased::new(body).on(frame)),
            (true, false) => Box::new(Elastic::new(body, 0.0)),
            (true, true) => Box::new(Elastic::new(body, 0.0).on(frame)),
        };
        let mut machine = Driven::new(dynamics, vec![Motor::Servo(SPRING); n]);
        machine.energised = true;
        for (field, alpha) in machine.fields.iter_mut().zip(&alpha) {
            field.alpha_rad = *alpha;
        }
        let state = machine.at_rest(&alpha);
        let dimension = state.len();
        let mut jacobian = DMatrix::zeros(dimension, dimension);
        machine.jacobian(0.0, &state, &mut Differences::new(dimension), &mut jacobian);
        let fastest = jacobian.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max);
        let bound = machine.fastest_mode().omega_rad_s;
        // The bound omits the effect of a force on a changing lever. Rods that bend by 0.1 rad of crank angle or more, as
        // these may, have that effect too.
        let lever_rate = 1.3 * 0.012;
        let bent = 2e6 * 24e-3 * lever_rate / 1e-3;
        let max = if n > 3 { (bound * bound + bent).sqrt() } else { bound * 1.001 };
        prop_assert!(fastest <= max, "{fastest} rad/s; the bound is {bound}, {max}");
        prop_assert!(fastest > 0.3 * bound, "{fastest} rad/s; the bound is {bound}");
    }
}
