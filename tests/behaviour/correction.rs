//! Correction of phase errors by slow trims of all axes.
//!
//! Unit tests: `firmware/core/src/phase_offset/tests.rs`. How close it keeps the cranks: `spread.rs`. Corrections of homing: `homing.rs`.

use cophase_core::supervisor::{FaultKind, State};

use super::homing::{CORRECTED, STEPPERS, machine, run, starts};

/// If this fails, a correction that reads two cranks' sensors the wrong way round drives the cranks apart, up to its limit, faster and
/// faster. Or a correct correction is taken for such a one.
#[test]
fn correction_that_drives_cranks_apart_is_swapped_wiring() {
    for count in 2..=6 {
        let apart = starts(count, |i| [0.3, -0.2, 0.4, -0.3, 0.2, -0.4][i]);
        let long = |more: &str| {
            machine(count, STEPPERS, &apart, CORRECTED)
                .program([(8.0, 0.5, 0.2), (8.0, 0.5, 6.0)])
                .with(more)
        };
        let (_, right) = run(&long(""));
        assert_eq!((right.state, right.fault), (State::Parked, None), "{count}");
        for (a, b) in (0..count).flat_map(|b| (0..b).map(move |a| (a, b))) {
            let swapped = format!(
                "[[fault]]\nat_s = 0\nkind = \"swapped-wiring\"\naxis = {a}\nwith = {b}\nlines = \"sensors\"\n"
            );
            let (recorded, outcome) = run(&long(&swapped));
            let Some(fault) = outcome.fault else {
                panic!("{count}: {a}, {b}: not stopped");
            };
            assert_eq!(fault.kind, FaultKind::SwappedWiring, "{count}: {a}, {b}");
            assert!(
                [Some(a), Some(b)].contains(&fault.axis),
                "{fault:?}, not {a} or {b}"
            );
            // The trims' limit is 5°.
            assert!(recorded.max_deg < 4.0, "{}° of trim", recorded.max_deg);
        }
    }
}
