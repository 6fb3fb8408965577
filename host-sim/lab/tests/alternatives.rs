//! The controller states which faults look alike to the sensors of an axis. The judge of a campaign has its own table of accepted names.
//! Neither table is derived from the other, so they can contradict each other.

use cophase_core::monitor::alternatives;
use cophase_core::supervisor::{Fault, FaultKind};
use cophase_core::units::Turns;
use cophase_lab::campaign::names::{Circumstances, accepted};
use cophase_lab::campaign::plan::Plan;
use cophase_scene::file::{FaultAt, FaultName};
use host_sim::checked::Checked;

/// Returns the name of a fault that the controller would report with perfect sensors.
fn cause(fault: &FaultAt) -> Option<FaultKind> {
    let turns_back = fault.speed_hz.is_some_and(|speed_hz| speed_hz <= 0.0);
    if fault.kind == FaultName::Runaway && turns_back {
        return Some(FaultKind::Reversed);
    }
    let name = fault.kind.name();
    FaultKind::ALL.into_iter().find(|kind| kind.name() == name)
}

/// If this fails, a user is given a name for another cause, and no message states that the sensors cannot distinguish the two.
#[test]
fn the_alternatives_of_an_accepted_name_include_the_cause() {
    let plan = Plan::new(20, None).expect("a plan of drawn machines");
    let mut compared = 0;
    for number in 0..2000 {
        let case = plan.case(number);
        let fault = case.fault();
        let (Some(cause), Some(axis)) = (cause(fault), fault.axis) else {
            continue; // a load is not a kind of fault
        };
        let checked = Checked::new(case.scene_of(false)).expect("a case that can be run");
        let axis_settings = &checked.settings.axes[axis];
        let has_encoder = checked.scene.axes.encoder;
        let is_stepper = checked.scene.resolved(axis).drive.kind().is_open_loop();
        for bits in 0..64_u8 {
            let bit = |place: u8| bits >> place & 1 != 0;
            let names = accepted(
                fault,
                Circumstances {
                    has_encoder,
                    is_stepper,
                    watches_following_error: !is_stepper && bit(0),
                    in_homing: bit(1),
                    is_beyond_limit: bit(2),
                    opposed: bit(3),
                    flags_apart: bit(4),
                    stood_first: bit(5),
                },
            );
            for name in names.into_iter().filter(|&name| name != cause) {
                compared += 1;
                // The phase error may be ahead or behind.
                let has_cause = [-1, 1].into_iter().any(|sign| {
                    let named = Fault::new(name).with_size(Turns::from_bits(sign));
                    alternatives(&named, axis_settings).any(|other| other == cause)
                });
                assert!(
                    has_cause,
                    "{} is accepted for {} (encoder: {has_encoder}), which is none of its alternatives",
                    name.name(),
                    cause.name(),
                );
            }
        }
    }
    assert!(compared > 10_000, "{compared} is hardly anything");
}
