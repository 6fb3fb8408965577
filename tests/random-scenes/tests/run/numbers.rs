//! Numbers of random scenes.

use cophase_random_scenes::Source;

/// If this fails, the ends of ranges are not drawn, and errors that only they show are never found.
#[test]
fn numbers_cover_a_range_and_reach_its_ends() {
    let mut source = Source::new(1);
    assert_eq!(source.number(-0.0, 0.0), 0.0);
    for (low, high) in [(0.0, 5.0), (1e-3, 50.0), (-180.0, 180.0)] {
        let drawn: Vec<f64> = (0..2000).map(|_| source.number(low, high)).collect();
        assert!(drawn.iter().all(|value| (low..=high).contains(value)));
        assert!(drawn.contains(&low) && drawn.contains(&high));
        let below = |part: f64| drawn.iter().filter(|value| value.abs() < part).count();
        assert!((100..1900).contains(&below(0.03 * high)));
    }
}
