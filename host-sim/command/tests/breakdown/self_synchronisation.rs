//! Self-synchronisation: free exciters settle according to Blekhman's condition. The controller keeps them in phase in every case.

use cophase_lab::chart::breakdown::self_synchronisation::{FOUR_M, TWO_M, forced, free, screen};

/// Far above the resonance two exciters at ±p come in phase if M p²/I is above 2. Below 2 they come to opposite phases, because the box
/// then moves less. If this fails, the equations couple the shafts through the box incorrectly.
#[test]
fn free_motors_settle_where_the_box_moves_least() {
    for (place_m, in_phase) in [(0.6, false), (1.2, false), (1.9, true)] {
        let places = [-place_m, place_m];
        let screen = screen(&places).unwrap();
        let ratio = screen.mass_kg() * place_m * place_m / screen.pitch_kgm2;
        assert_eq!(ratio > 2.0, in_phase, "{ratio}");
        let settled = free(&places).unwrap().last().unwrap().1;
        println!("M p²/I = {ratio:.2}: resultant {settled:.3}");
        if in_phase {
            assert!(settled > 0.97, "{settled}");
        } else {
            assert!(settled < 0.1, "{settled}");
        }
    }
}

/// If this fails, the controller does not keep exciters in phase that separate when they are free.
#[test]
fn the_controller_keeps_them_in_phase() {
    for places in [TWO_M, FOUR_M] {
        assert!(free(places).unwrap().last().unwrap().1 < 0.2);
        let kept = forced(places).unwrap();
        assert!(kept.len() > 100);
        let min = kept.iter().map(|point| point.1).fold(f64::MAX, f64::min);
        // If one of two shafts is off by 1°, the resultant is 1 − (0.5°)²/2 = 0.99996.
        assert!(min > 0.999, "{min}");
    }
}
