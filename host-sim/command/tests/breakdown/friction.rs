//! Dry friction: smoothed it has an error of its own and limits the step; by contacts it has neither.

use cophase_lab::chart::Size;
use cophase_lab::chart::breakdown::friction::{SPEEDS_MPS, Treatment, limit_s, measure};
use cophase_methods::Scheme;
use cophase_methods::problems::DenHartog;

/// If this fails, the picture shows a failure where there is none, or contacts have an error that a shorter step does not remove.
#[test]
fn smoothed_friction_keeps_an_error_and_contacts_do_not() {
    let tried = measure(Size::Small).unwrap();
    let errors = |scheme: Scheme, treatment: Treatment| {
        let found = tried
            .iter()
            .find(|tried| (tried.scheme, tried.treatment) == (scheme, treatment));
        found.expect("it is tried").errors.clone()
    };
    for speed_mps in SPEEDS_MPS {
        let smoothed = errors(Scheme::Rk4, Treatment::Smoothed(speed_mps));
        let [.., (_, before), (_, last)] = smoothed[..] else {
            panic!("{} steps", smoothed.len());
        };
        // An error of the step would fall to a sixteenth. That of the smoothing stays, to within a hundredth.
        assert!((last / before - 1.0).abs() < 1e-2, "{last}, {before}");
        assert!(last > 1e-2, "{last}");
        // Beyond the limit the mass shakes, and the error is far larger.
        let beyond = smoothed
            .iter()
            .filter(|(step_s, _)| *step_s > 10.0 * limit_s(speed_mps));
        assert!(
            beyond.clone().all(|(_, error)| *error > 3.0 * last),
            "{smoothed:?}"
        );
    }
    for scheme in [Scheme::Rk4, Scheme::Sdirk4] {
        let exact = errors(scheme, Treatment::Contacts);
        // Order 4, from half a radian a step on: a sixteenth by each half.
        let resolved = exact
            .iter()
            .filter(|(step_s, _)| step_s * DenHartog::STOPPING.omega_rad_s < 0.5);
        let resolved: Vec<f64> = resolved.map(|(_, error)| *error).collect();
        assert!(resolved.len() >= 3, "{}", resolved.len());
        for pair in resolved.windows(2) {
            assert!(pair[1] < pair[0] / 10.0, "{scheme}: {resolved:?}");
        }
    }
}
