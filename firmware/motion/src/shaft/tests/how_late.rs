//! Delay of stops at a phase in realistic machines, printed: the quantity that [`super::at_phase`] bounds.

use super::at_phase::{Found, is_the_earliest, stop_at};
use super::earliest::{Coasting, Earliest};
use super::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Machines with 20 to 100 rev/s, 20 to 200 rev/s², 10 to 100 times that in rev/s³, at 2 kHz. A band is up to a seventh
/// of all speeds wide.
fn any_machine() -> impl Strategy<Value = ShaftLimits> {
    let band = (0.1..0.8_f64, 0.02..0.15_f64);
    (20.0..100.0_f64, 20.0..200.0_f64, 10.0..100.0_f64, band).prop_map(
        |(speed_hz, acceleration, per_s, (from, width))| {
            let bands = [(from * speed_hz, (from + width) * speed_hz)];
            limits(2000, speed_hz, acceleration, acceleration * per_s, &bands)
        },
    )
}

fn print(name: &str, late: impl Iterator<Item = f64>, turns_later: usize) {
    let mut late: Vec<_> = late.collect();
    late.sort_by(f64::total_cmp);
    let at = |part: f64| late[((late.len() - 1) as f64 * part) as usize];
    std::println!(
        "{name}: {} stops; ticks late: least {:.2}, half {:.2}, nine in ten {:.2}, most {:.2}; {turns_later} a turn later",
        late.len(),
        at(0.0),
        at(0.5),
        at(0.9),
        at(1.0),
    );
}

const CLASSES: [&str; 5] = ["falling", "steady", "rising", "below a band", "slow"];

/// Stops of shafts, classed by their motion at the demand, and the delay of those that leave a band against the earliest
/// stop that ignores the band.
fn stops(of: impl Strategy<Value = ShaftLimits>, each: usize) -> ([Vec<Found>; 5], Vec<f64>) {
    let cuts = prop::collection::vec((any::<prop::sample::Index>(), 0..ONE_TURN), 10);
    let cases = (of, any_speeds(), cuts);
    let mut all: [Vec<Found>; 5] = Default::default();
    let mut without_bands = std::vec![];
    let mut runner = TestRunner::deterministic();
    while all.iter().any(|found| found.len() < each) {
        let tree = cases.new_tree(&mut runner).expect("a case");
        let (limits, speeds, cuts) = tree.current();
        let targets = targets(&limits, &speeds);
        let mut watch = Watch::new(limits);
        for (tick, &target) in targets.iter().enumerate() {
            watch.advance(Demand::Follow(target));
            let requested = cuts
                .iter()
                .find(|(cut, _)| cut.index(targets.len()) == tick);
            let (Some(&(_, phase_bits)), 1..) = (requested, watch.speed) else {
                continue;
            };
            let Some(earliest) = Earliest::of(&watch) else {
                continue;
            };
            let class = match (earliest.kind, watch.acceleration) {
                (Coasting::BelowBand, _) => 3,
                (Coasting::Slow, _) => 4,
                (Coasting::LetGo, ..0) => 0,
                (Coasting::LetGo, 0) => 1,
                (Coasting::LetGo, 1..) => 2,
            };
            if all[class].len() == each {
                continue;
            }
            let phase = Turns::from_bits(phase_bits);
            if earliest.kind == Coasting::BelowBand {
                let free = Earliest::letting_go(&watch);
                without_bands.push(stop_at(&mut watch.clone(), phase, &free).over);
            }
            all[class].push(stop_at(&mut watch.clone(), phase, &earliest));
        }
    }
    (all, without_bands)
}

fn turns_later(found: &[Found]) -> usize {
    found.iter().filter(|found| found.turns_later > 0).count()
}

/// If this fails, machines stop later than documented. Their jerk has so many units that planning in whole ones costs
/// almost nothing. A shaft that leaves a band cannot coast inside it for up to a turn, as a stop without bands may. It
/// coasts at the lower edge.
#[test]
fn stops_of_machines_are_no_later_than_two_ticks() {
    let (all, without_bands) = stops(any_machine(), 2000);
    for (name, found) in CLASSES.into_iter().zip(all) {
        print(
            name,
            found.iter().map(|found| found.over),
            turns_later(&found),
        );
        assert!(found.iter().all(|found| found.over <= 2.0), "{name}");
        assert!(found.iter().all(Found::is_at_first_passage), "{name}");
    }
    print(
        "below a band, over stops without bands",
        without_bands.into_iter(),
        0,
    );
}

/// The same over all settings that are accepted, down to jerks of 64 units, of which planning subtracts four. There
/// planning in whole units costs time.
#[test]
fn planning_in_whole_units_delays_stops_within_bounds() {
    let (all, _) = stops(any_limits(), 500);
    for (name, found) in CLASSES.into_iter().zip(all) {
        print(
            name,
            found.iter().map(|found| found.over),
            turns_later(&found),
        );
        assert!(found.iter().all(is_the_earliest), "{name}");
    }
}
