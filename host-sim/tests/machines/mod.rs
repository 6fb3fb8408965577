//! Design of the other machines, against the figures of their sources and independently computed figures.

mod crank_rocker;
mod crusher_on_mains;
mod five_bar;
mod five_bar_arm;
mod flywheel;
mod screen;

/// Compares a figure with a published one. `cargo test -p host-sim --test integration machines:: -- --nocapture` prints both.
#[track_caller]
fn assert_near(what: &str, ours: f64, theirs: f64, tolerance: f64) {
    println!("{what}: {ours}, published {theirs}");
    assert!(
        (ours - theirs).abs() <= tolerance,
        "{what}: {ours}, expected {theirs} ± {tolerance}"
    );
}
