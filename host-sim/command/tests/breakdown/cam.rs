//! Flexible cam shaft: its pusher accelerates more than the law requires. That of an electronic cam hardly does.

use cophase_lab::chart::breakdown::cam::{measure, peak};

/// If this fails, the overshoot in the picture differs from the published one, or the electronic cam has one as well. Published: 302.36 to
/// 371.61 of 271.50 to 348.99 m/s², 6 to 13 % at the pusher.
#[test]
fn the_shaft_overshoots_and_the_table_does_not() {
    let facts = measure().unwrap();
    // 307.04 m/s² on the return by the published law.
    assert!((peak(&facts.law) / 307.04 - 1.0).abs() < 1e-3);
    let over = |turn| peak(turn) / 307.04 - 1.0;
    assert!(
        (0.06..0.13).contains(&over(&facts.shaft)),
        "{}",
        over(&facts.shaft)
    );
    // A spline's second derivative is off by up to 1.9 % (tests/machines/electronic_cam.rs).
    assert!(over(&facts.screw).abs() < 0.02, "{}", over(&facts.screw));
}
