//! A run that can be paused, copied and continued.

use cophase_core::control_loop;
use cophase_core::controller::Controller;
use embassy_time::Instant;

use super::io::{Observed, SimulatedIo};
use super::schedule::{Lateness, Schedule};
use super::{Observer, Outcome, tick_us};
use crate::faults::Faults;
use crate::scene::{Checked, SceneError};
use crate::virtual_time;

/// Controller and simulated machine, between two ticks of the loop.
#[derive(Clone)]
pub struct Simulation<P> {
    controller: Controller,
    io: SimulatedIo<P>,
    lateness: Lateness,
    most_ticks: u64,
}

impl<P: FnMut(u64, u64)> Simulation<P> {
    /// Creates the simulation of a scene at power-up, for at most `most_ticks` ticks. `progress` is called as in [`super::simulate`].
    ///
    /// # Errors
    /// Fails like [`super::simulate`].
    pub fn new(most_ticks: u64, checked: &Checked, progress: P) -> Result<Self, SceneError> {
        let controller = checked.controller()?;
        let schedule = schedule_of(checked, &controller, most_ticks);
        Ok(Self {
            lateness: schedule.lateness(),
            io: SimulatedIo::new(checked, schedule, progress)?,
            controller,
            most_ticks,
        })
    }

    /// Runs the scene to its end.
    pub fn run(&mut self, observer: &mut impl Observer) {
        self.run_to(u64::MAX, observer);
    }

    /// Runs the scene up to a time, µs: no input is read at or after it. The scene may end before that time.
    pub fn run_until(&mut self, until_us: u64, observer: &mut impl Observer) {
        // The loop may read the input of a deadline late by up to this time.
        let late_us = self.lateness.longest_us();
        self.run_to(until_us.saturating_sub(late_us), observer);
    }

    /// Runs the scene up to the first deadline that is not before a time, µs.
    fn run_to(&mut self, pause_us: u64, observer: &mut impl Observer) {
        let Some(next_us) = self.io.pause_at(pause_us) else {
            return;
        };
        let next = Instant::from_micros(next_us);
        let io = &mut self.io;
        let mut observed = Observed { io, observer };
        let run = control_loop::run_from(next, &mut self.controller, &mut observed);
        virtual_time::run(run, |at| self.lateness.overshoot(at));
    }

    /// Continues in a scene that differs from the present one only in its faults. None of its faults may begin before the time up to which
    /// the simulation has run. Either both scenes touch drives or neither does ([`crate::scene::Scene::touches_drives`]). A scene that has
    /// ended also continues, unless its machine diverged.
    pub fn go_on_in(&mut self, checked: &Checked) {
        let schedule = schedule_of(checked, &self.controller, self.most_ticks);
        self.lateness = schedule.lateness().after(&self.lateness);
        self.io.go_on_with(schedule, Faults::new(checked));
    }

    /// Ends the run, and returns its outcome.
    pub fn finish(self) -> Outcome {
        self.io.finish()
    }
}

/// Returns the commands, inputs and late deadlines of a scene.
fn schedule_of(checked: &Checked, controller: &Controller, most_ticks: u64) -> Schedule {
    let end_us = most_ticks.saturating_mul(tick_us(checked));
    Schedule::new(checked, controller.program().0.duration()).ending_by(end_us)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::{FaultAt, FaultName, LateAt, Noise};
    use crate::scene::library;
    use crate::sim::{Moment, simulate};

    /// Records the ticks that are played.
    #[derive(Default)]
    struct Ticks(Vec<String>);

    impl Observer for Ticks {
        fn tick(&mut self, moment: &Moment<'_>) {
            let telemetry = moment.telemetry;
            self.0.push(format!(
                "{} {:?} {:?} {:?} {:?}",
                moment.start_ns,
                telemetry.state,
                telemetry.fault,
                telemetry.phase,
                moment.actual_turns
            ));
        }
    }

    /// If this fails, a pause loses or repeats a tick or an event, and runs of a campaign that share their beginning differ from runs that
    /// do not.
    /// The deadline before the fault is late, so that its input is read after the fault has begun.
    #[test]
    fn a_copied_simulation_continues_as_an_uninterrupted_run() {
        let mut scene = library::find("default").expect("built in").scene();
        scene.noise = Noise {
            index_deg: 0.05,
            ..scene.noise
        };
        let tick_us = 1_000_000.0 / f64::from(scene.control.tick_hz);
        let at_s = 2.0;
        scene.late = vec![LateAt {
            at_s: at_s - 2e-6 * tick_us,
            by_us: (2.5 * tick_us).round(),
        }];
        let clean = Checked::new(scene.clone()).expect("a scene that is built in");
        for kind in [
            FaultName::Overrun,
            FaultName::StopInput,
            FaultName::IndexMissing,
            FaultName::IndexExtra,
        ] {
            let has_axis = matches!(kind, FaultName::IndexMissing | FaultName::IndexExtra);
            let mut fault = FaultAt::new(at_s, kind);
            fault.axis = has_axis.then_some(1);
            fault.count = (kind != FaultName::StopInput).then_some(3);
            scene.fault = vec![fault];
            let faulty = Checked::new(scene.clone()).expect("a fault that the scene may have");

            let [mut alone, mut shared, mut copied] = [const { Ticks(Vec::new()) }; 3];
            let outcome = simulate(&faulty, &mut alone, |_, _| {}).expect("runs");
            let mut simulation = Simulation::new(u64::MAX, &clean, |_, _| {}).expect("runs");
            simulation.run_until((at_s * 1e6) as u64, &mut shared);
            let mut copy = simulation.clone();
            copy.go_on_in(&faulty);
            copy.run(&mut copied);
            let before = shared.0.len();
            assert_eq!(alone.0[..before], shared.0, "{kind:?}");
            assert_eq!(alone.0[before..], copied.0, "{kind:?}");
            let copied = copy.finish();
            assert_eq!(outcome.statistics.events, copied.statistics.events);
            assert_eq!(outcome.ticks, copied.ticks);

            let mut alone = Ticks::default();
            simulate(&clean, &mut alone, |_, _| {}).expect("runs");
            simulation.run(&mut shared);
            assert_eq!(alone.0, shared.0, "{kind:?}");
        }
    }
}
