//! A run that can be paused, copied and continued.

use cophase_core::control_loop;
use cophase_core::controller::Controller;
use cophase_scene::SceneError;
use embassy_time::Instant;

use super::io::{Observed, SimulatedIo};
use super::schedule::{Lateness, Schedule};
use super::{Observer, Outcome, tick_us};
use crate::checked::Checked;
use crate::faults::Faults;
use crate::virtual_time;

/// Controller and simulated machine, between two ticks of the loop.
#[derive(Clone)]
pub struct Simulation {
    controller: Controller,
    io: SimulatedIo,
    lateness: Lateness,
    max_ticks: u64,
}

impl Simulation {
    /// Creates the simulation of a scene at power-up, for at most `max_ticks` ticks.
    ///
    /// # Errors
    /// Fails like [`super::simulate`].
    pub fn new(max_ticks: u64, checked: &Checked) -> Result<Self, SceneError> {
        let controller = checked.controller()?;
        let schedule = schedule_of(checked, &controller, max_ticks);
        Ok(Self {
            lateness: schedule.lateness(),
            io: SimulatedIo::new(checked, schedule)?,
            controller,
            max_ticks,
        })
    }

    /// Makes the simulation record the torques of the motors and their effects, which have to be computed for it.
    pub fn record_forces(&mut self) {
        self.io.record_forces();
    }

    /// Runs the scene to its end.
    pub fn run(&mut self, observer: &mut dyn Observer) {
        self.run_to(u64::MAX, observer, &mut |_, _| {});
    }

    /// Runs the scene to its end. `progress` is called as in [`super::simulate`].
    pub fn run_with(&mut self, observer: &mut dyn Observer, progress: &mut dyn FnMut(u64, u64)) {
        self.run_to(u64::MAX, observer, progress);
    }

    /// Runs the scene up to a time, µs: no input is read at or after it. The scene may end before that time.
    pub fn run_until(&mut self, until_us: u64, observer: &mut dyn Observer) {
        // The loop may read the input of a deadline late by up to this time.
        let late_us = self.lateness.longest_us();
        self.run_to(until_us.saturating_sub(late_us), observer, &mut |_, _| {});
    }

    /// Runs the scene up to the first deadline that is not before a time, µs.
    fn run_to(
        &mut self,
        pause_us: u64,
        observer: &mut dyn Observer,
        progress: &mut dyn FnMut(u64, u64),
    ) {
        let Some(next_us) = self.io.pause_at(pause_us) else {
            return;
        };
        let next = Instant::from_micros(next_us);
        let io = &mut self.io;
        let mut observed = Observed {
            io,
            observer,
            progress,
        };
        let run = control_loop::run_from(next, &mut self.controller, &mut observed);
        virtual_time::run(run, |at| self.lateness.overshoot(at));
    }

    /// Continues in a scene that differs from the present one only in its faults. None of its faults may begin before the time up to which
    /// the simulation has run. A scene that has ended also continues, unless its machine diverged.
    pub fn go_on_in(&mut self, checked: &Checked) {
        let schedule = schedule_of(checked, &self.controller, self.max_ticks);
        self.lateness = schedule.lateness().after(&self.lateness);
        self.io.go_on_with(schedule, Faults::new(checked));
    }

    /// Ends the run, and returns its outcome.
    pub fn finish(self) -> Outcome {
        self.io.finish()
    }
}

/// Returns the commands, inputs and late deadlines of a scene.
fn schedule_of(checked: &Checked, controller: &Controller, max_ticks: u64) -> Schedule {
    let end_us = max_ticks.saturating_mul(tick_us(checked));
    Schedule::new(checked, controller.program().0.duration()).ending_by(end_us)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Moment;
    use cophase_scene::file::{FaultAt, FaultName, Fidelity, LateAt};
    use cophase_scene::library;

    /// Records the ticks that are played.
    #[derive(Default)]
    struct Ticks(Vec<String>);

    impl Observer for Ticks {
        fn tick(&mut self, moment: &Moment<'_>) {
            let telemetry = moment.telemetry;
            self.0.push(format!(
                "{} {:?} {:?} {:?} {:?} {:?}",
                moment.start_ns,
                telemetry.state,
                telemetry.fault,
                telemetry.phase,
                moment.actual_turns,
                moment.index
            ));
        }
    }

    /// Returns a fault of a kind, with the keys that it needs.
    fn fault(at_s: f64, kind: FaultName) -> FaultAt {
        use FaultName as Kind;
        let mut fault = FaultAt::new(at_s, kind);
        fault.axis = (!matches!(kind, Kind::Overrun | Kind::StopInput)).then_some(1);
        match kind {
            Kind::Overrun | Kind::IndexMissing | Kind::IndexExtra => fault.count = Some(3),
            Kind::Slip => fault.rate_deg_per_s = Some(90.0),
            Kind::Runaway => fault.speed_hz = Some(3.0),
            Kind::LoadStep => fault.torque_nm = Some(0.1),
            _ => {}
        }
        fault
    }

    /// If this fails, a pause loses or repeats a tick or an event, or the machine of a scene with a fault moves otherwise than one without it
    /// before the fault begins. Runs of a campaign that share their beginning then differ from runs that do not.
    /// The deadline before the fault is late, so that its input is read after the fault has begun.
    #[test]
    fn a_copied_simulation_continues_as_an_uninterrupted_run() {
        use FaultName as Kind;
        const ON_DRIVES: [FaultName; 5] = [
            Kind::LostSteps,
            Kind::Slip,
            Kind::Stuck,
            Kind::Runaway,
            Kind::StepFifoUnderrun,
        ];
        let others = [
            Kind::Overrun,
            Kind::StopInput,
            Kind::IndexMissing,
            Kind::IndexExtra,
        ];
        let steppers = [&others[..], &ON_DRIVES].concat();
        let with_torque = [&ON_DRIVES[..], &[Kind::LoadStep]].concat();
        assert_continues("default", Fidelity::Kinematic, &steppers);
        assert_continues("patent-1", Fidelity::Kinematic, &ON_DRIVES[1..4]);
        assert_continues("lost-steps", Fidelity::QuasiStatic, &ON_DRIVES);
        assert_continues("lost-steps", Fidelity::Phased, &with_torque);
        assert_continues("pulse-servo", Fidelity::Phased, &with_torque[1..]);
    }

    fn assert_continues(scene: &str, fidelity: Fidelity, kinds: &[FaultName]) {
        let mut scene = library::find(scene).expect("built in").scene();
        scene.fidelity = fidelity;
        scene.questions = Default::default();
        scene.noise.index_deg = 0.05;
        let tick_us = 1_000_000.0 / f64::from(scene.control.tick_hz);
        let at_s = 2.0;
        let max_ticks = 5 * u64::from(scene.control.tick_hz);
        let start = |checked: &Checked| Simulation::new(max_ticks, checked).expect("runs");
        scene.late = vec![LateAt {
            at_s: at_s - 2e-6 * tick_us,
            by_us: (2.5 * tick_us).round(),
        }];
        scene.fault.clear();
        let clean = Checked::new(scene.clone()).expect("a scene that is built in");
        for &kind in kinds {
            scene.fault = vec![fault(at_s, kind)];
            let faulty = Checked::new(scene.clone()).expect("a fault that the scene may have");

            let [mut alone, mut shared, mut copied] = [const { Ticks(Vec::new()) }; 3];
            let mut uninterrupted = start(&faulty);
            uninterrupted.run(&mut alone);
            let outcome = uninterrupted.finish();
            let mut simulation = start(&clean);
            simulation.run_until((at_s * 1e6) as u64, &mut shared);
            let mut copy = simulation.clone();
            copy.go_on_in(&faulty);
            copy.run(&mut copied);
            let before = shared.0.len();
            // Not by `assert_eq!`, which would print every tick.
            let differs = alone.0.iter().zip(shared.0.iter().chain(&copied.0));
            let first = differs.into_iter().find(|(alone, shared)| alone != shared);
            assert_eq!(first, None, "{} {fidelity:?} {kind:?}", scene.name);
            assert_eq!(alone.0.len(), before + copied.0.len());
            let copied = copy.finish();
            assert_eq!(outcome.record.events, copied.record.events);
            assert_eq!(outcome.record.control_ticks, copied.record.control_ticks);

            let mut alone = Ticks::default();
            start(&clean).run(&mut alone);
            simulation.run(&mut shared);
            assert!(alone.0 == shared.0, "{} {fidelity:?} {kind:?}", scene.name);
        }
    }
}
