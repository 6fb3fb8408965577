//! Simulation of a scene: the control loop in virtual time, with the machine of the scene.
//!
//! [`simulate`] sets up the loop and the machine. A simulated `Io` connects them, and an [`Observer`] receives each
//! tick. An observer never changes the run.

mod coast;
mod corrections;
pub mod event_watch;
pub mod events;
mod forces;
mod hold;
mod io;
mod moment;
mod off_command;
mod outcome;
mod places;
pub mod record;
mod recorder;
pub(crate) mod schedule;
mod simulation;
mod truth;
pub(crate) mod unwrapped;

pub use moment::{Moment, Observer};
pub use outcome::Outcome;
pub use record::RunRecord;
pub use recorder::RunRecorder;
pub use simulation::Simulation;

use crate::checked::Checked;
use crate::virtual_time;
use cophase_scene::SceneError;
pub(crate) use io::SimulatedIo;
pub use io::TAIL_S;
use schedule::Schedule;
pub use unwrapped::Unwrapped;

/// Runs a scene to its end.
///
/// `progress` is called from time to time with the number of ticks done and the approximate total.
///
/// # Errors
/// Fails if the machine of the scene cannot be created. [`Checked`] has refused the scenes that the core refuses.
///
/// ```
/// use cophase_scene::library;
/// use host_sim::checked::Checked;
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
    simulate_first(u64::MAX, checked, observer, progress)
}

/// Runs a scene for at most `ticks` ticks: to see its beginning, or to measure the time that a tick takes.
///
/// # Errors
/// Fails like [`simulate`].
pub fn simulate_first(
    ticks: u64,
    checked: &Checked,
    observer: &mut impl Observer,
    mut progress: impl FnMut(u64, u64),
) -> Result<Outcome, SceneError> {
    let mut simulation = Simulation::new(ticks, checked)?;
    simulation.record_forces();
    simulation.run_with(observer, &mut progress);
    Ok(simulation.finish())
}

/// Control ticks that a run of a scene is expected to take: its program, homing, parking, and external events.
///
/// # Errors
/// Fails like [`simulate`].
pub fn expected_ticks(checked: &Checked) -> Result<u64, SceneError> {
    let program_ticks = checked.controller()?.program().0.duration();
    Ok(Schedule::new(checked, program_ticks).expected_us() / tick_us(checked))
}

/// Refuses a scene whose events cannot have the effect that they are for.
///
/// # Errors
/// A fault comes when the machine has long been standing.
pub fn check_times(checked: &Checked) -> Result<(), SceneError> {
    let program_ticks = checked.controller()?.program().0.duration();
    Schedule::new(checked, program_ticks).check(&checked.scene)
}

fn tick_us(checked: &Checked) -> u64 {
    virtual_time::TICKS_PER_S / u64::from(checked.settings.tick_hz)
}
