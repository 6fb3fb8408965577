//! The scenes of these tests: a change keeps all else, and a key that no scene has is named.

use cophase_tests::bench_scene;

/// If this fails, a test runs on another machine than it states.
#[test]
fn changes_of_a_scene_keep_all_else() {
    let before = bench_scene().axis(2, "start_deg", 3).checked().scene;
    let changed = bench_scene()
        .with("axis = [{ number = 2, start_deg = 3 }]\nfault = [{ at_s = 1, kind = \"stuck\", axis = 0 }]")
        .with("axis = [{ number = 2, drive = \"servo\" }]\nfault = [{ at_s = 2, kind = \"stuck\", axis = 1 }]")
        .set("limits.speed_hz", 22)
        .program([(1.0, 0.5, 0.5), (2.0, 0.5, 0.5)])
        .program([(8.0, 0.5, 0.5)]);
    let mut after = changed.checked().scene;
    assert_eq!((after.fault.len(), after.limits.speed_hz), (2, 22.0));
    assert!(after.axis.len() == 1 && after.axis[0].drive != before.axis[0].drive);
    after.fault.clear();
    after.limits.speed_hz = before.limits.speed_hz;
    after.axis[0].drive = before.axis[0].drive;
    assert_eq!(after, before);
    let without = changed.without("fault").without("axis").checked().scene;
    assert!(without.fault.is_empty() && without.axis.is_empty());
}

/// If this fails, a test whose key is misspelt runs on the machine without it.
#[test]
#[should_panic(expected = "no scene has a key `limits.speed_rpm`")]
fn keys_that_no_scene_has_are_named() {
    let _ = bench_scene().set("limits.speed_rpm", 12);
}

/// See [`keys_that_no_scene_has_are_named`].
#[test]
#[should_panic(expected = "no scene has a key `axis.star_deg`")]
fn keys_in_a_list_that_no_scene_has_are_named() {
    let _ = bench_scene().with("axis = [{ number = 1, star_deg = 3 }]");
}

/// If this fails, a test removes a key that its scene has not, and goes on.
#[test]
#[should_panic(expected = "the scene has no `axes.encoder` to remove")]
fn keys_to_remove_must_be_there() {
    let _ = bench_scene().without("axes.encoder");
}
