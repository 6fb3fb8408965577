//! Running a scene: the control loop in virtual time, against the scene's machine.
//!
//! [`simulate`] sets up the two sides, a simulated `Io` stands between them, and an [`Observer`] looks on. What
//! an observer does, or whether there is one, never changes what happens.

pub mod coast;
pub mod event_watch;
pub mod events;
mod io;
mod moment;
mod outcome;
mod schedule;
pub mod statistics;
mod unwrapped;

pub use moment::{Moment, Observer};
pub use outcome::Outcome;
pub use statistics::Statistics;

use cophase_core::control_loop;

use crate::faults::Faults;
use crate::machine::Machine;
use crate::scene::{Checked, SceneError};
use crate::virtual_time;
use io::{SimulatedIo, World};
use schedule::Schedule;

/// Runs a scene to its end.
///
/// `progress` is called now and then with the ticks done and about how many there will be.
///
/// # Errors
/// A scene whose machine cannot be made; [`Checked`] has refused those that the core refuses.
///
/// ```
/// use host_sim::scene::{Checked, library};
/// use host_sim::sim::simulate;
///
/// let checked = Checked::new(library::find("patent-4").unwrap().scene()).unwrap();
/// let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
/// assert!(outcome.fault.is_none());
/// ```
pub fn simulate(
    checked: &Checked,
    observer: &mut impl Observer,
    progress: impl FnMut(u64, u64),
) -> Result<Outcome, SceneError> {
    let mut controller = checked.controller()?;
    let schedule = Schedule::new(checked, controller.program().0.duration());
    let mut lateness = schedule.lateness();
    let machine = Machine::new(checked)?;
    let sensors = machine.sensors(checked);
    let statistics = Statistics::new(checked, machine.platform.mechanism());
    let world = World {
        machine,
        sensors,
        schedule,
        faults: Faults::new(checked),
    };
    let mut io = SimulatedIo::new(controller.tick_hz(), world, statistics, observer, progress);
    virtual_time::run(control_loop::run(&mut controller, &mut io), |at| {
        lateness.overshoot(at)
    });
    Ok(io.finish())
}
