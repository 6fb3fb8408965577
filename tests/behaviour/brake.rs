//! Machines with a brake: the drives are switched off once all axes stand.

use super::stop_category::{DRIVES, behind, each_phase, run};

fn braked(axes: &str) -> String {
    format!("{axes}brake = true\n")
}

/// If this fails, the brake setting is not obeyed. The drives then hold against a brake, or a machine without one falls. The simulated
/// machine has no brake, so the test shows how far a platform falls that nothing holds.
#[test]
fn brake_setting_disables_drives_after_the_stop() {
    for axes in DRIVES {
        let mut worst_mrad = (0.0_f64, 0.0_f64);
        for axes in each_phase(axes) {
            let held = run(&axes, &behind(&axes));
            let cut = run(&braked(&axes), &behind(&axes));
            assert_eq!(held.kind(), cut.kind());
            assert_eq!(held.stopped(), cut.stopped(), "the stop is the same");
            assert!(held.last().drives && !cut.last().drives);
            let (held_mrad, cut_mrad) = (held.after_mrad(), cut.after_mrad());
            println!("{axes}held {held_mrad:.3} mrad, cut {cut_mrad:.3} mrad");
            worst_mrad = (worst_mrad.0.max(held_mrad), worst_mrad.1.max(cut_mrad));
        }
        let (held_mrad, cut_mrad) = worst_mrad;
        println!("{axes}worst: held {held_mrad:.3} mrad, cut {cut_mrad:.3} mrad");
        assert!(cut_mrad > 2.0 * held_mrad, "{axes}{held_mrad} {cut_mrad}");
    }
}
