//! Singular configuration: errors grow towards the edge of the reach. A path within the margin is refused.

use cophase_lab::chart::breakdown::runs::refusal;
use cophase_lab::chart::breakdown::singular::{MARGIN, REACH_MM, margin_mm, measure, scene};

/// If this fails, the picture shows a failure where there is none.
#[test]
fn errors_grow_towards_the_edge_of_the_reach() {
    let (far, near) = (measure(400.0).unwrap(), measure(499.5).unwrap());
    assert!(near.table_mm > 30.0 * far.table_mm, "{near:?}, {far:?}");
    assert!(near.place_mm.is_finite() && far.place_mm.is_finite());
}

/// If this fails, a path within the margin is accepted, or a path outside it is refused.
#[test]
fn a_path_within_the_margin_is_refused() {
    let at_margin = margin_mm(MARGIN);
    assert!(at_margin < REACH_MM);
    let refused = refusal(&scene(at_margin + 0.2, MARGIN).unwrap());
    let refused = refused.expect("it is within the margin");
    assert!(
        refused.contains("five_bar.path_mm") && refused.contains("nearly singular"),
        "{refused}"
    );
    assert_eq!(refusal(&scene(at_margin - 0.2, MARGIN).unwrap()), None);
}
