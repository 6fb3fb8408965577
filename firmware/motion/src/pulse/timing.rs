//! Timing of a drive's STEP and DIR lines in cycles of the step clock, and the step rates that it allows.

use super::planner::GUARD;
use super::{MAX_EDGES, Run};
use crate::settings::{Problem, PulseSettings, SettingsError, tick_cycles};

/// Greatest number of counts of a servo axis in a tick: half of what 64 bits hold, as half-steps of 2⁻⁴⁸.
const MAX_COUNTS: f64 = 8192.0;

/// Timing of the STEP and DIR lines for one tick rate, in cycles of the step clock.
#[derive(Clone, Copy, Debug, Hash)]
pub struct PulseTiming {
    pub(super) tick: u32,
    pub(super) width: u32,
    /// Length of the pause before the one that changes the direction.
    pub(super) before_turn: u32,
    /// Length of the pause that changes the direction.
    pub(super) turn: u32,
}

impl PulseTiming {
    /// Converts checked settings for a step clock of `clock_hz` cycles per second and a tick rate in Hz. Times in
    /// nanoseconds are rounded up to whole cycles.
    ///
    /// # Errors
    /// A tick does not have a usable number of cycles ([`tick_cycles`]), or a direction change needs more than a quarter
    /// of a tick.
    #[cold]
    pub fn new(
        settings: &PulseSettings,
        clock_hz: u32,
        tick_hz: u32,
    ) -> Result<Self, SettingsError> {
        let tick = tick_cycles(clock_hz, tick_hz)?;
        let cycles = |ns: f64| libm::ceil(ns * f64::from(clock_hz) / 1e9) as u32;
        let width = cycles(settings.width_ns);
        // DIR holds its level for this pause and changes DIR_DELAY after it.
        let before_turn = cycles(settings.dir_hold_ns)
            .saturating_sub(Run::DIR_DELAY)
            .max(Run::MIN_CYCLES);
        // The next edge comes at least GUARD after the pause, which compensates DIR_DELAY. A change of direction follows
        // a falling edge, and STEP must also stay low for its width.
        const { assert!(GUARD >= Run::DIR_DELAY) };
        let turn = cycles(settings.dir_setup_ns)
            .max(width.saturating_sub(before_turn + GUARD))
            .max(Run::MIN_CYCLES);
        let timing = Self {
            tick,
            width,
            before_turn,
            turn,
        };
        let turn_round = width.max(GUARD) + before_turn + turn + 2 * GUARD;
        if turn_round > timing.tick / 4 {
            let us = |cycles: u32| f64::from(cycles) * 1e6 / f64::from(clock_hz);
            return Err(SettingsError::new(
                "pulse.dir_setup_ns",
                Problem::SetupTooLong {
                    need_us: us(turn_round),
                    max_us: us(timing.tick / 4),
                },
            ));
        }
        Ok(timing)
    }

    /// Greatest step rate at a tick rate in Hz, steps/s.
    ///
    /// The pulse width must remain when an edge has moved by the guard, also in the three quarters of a tick that a
    /// change of direction leaves.
    pub fn max_step_hz(&self, tick_hz: u32) -> f64 {
        let half_step = f64::from((self.width + GUARD + 2).max(2 * GUARD)) * 4.0 / 3.0;
        let clock_hz = f64::from(self.tick) * f64::from(tick_hz);
        let by_width = clock_hz / (2.0 * half_step);
        let by_edges = f64::from(MAX_EDGES - 2) * f64::from(tick_hz) / 2.0;
        by_width.min(by_edges)
    }

    /// Checks that the steps of a motor can be made at its greatest speed, `motor_speed_hz` in rev/s.
    ///
    /// # Errors
    /// The step rate exceeds the limit set by the pulse width or by the [`MAX_EDGES`] of a tick.
    #[cold]
    pub fn check_rate(
        &self,
        steps_per_turn: u32,
        motor_speed_hz: f64,
        tick_hz: u32,
    ) -> Result<(), SettingsError> {
        let rate_hz = motor_speed_hz * f64::from(steps_per_turn);
        let max_hz = self.max_step_hz(tick_hz);
        if rate_hz > max_hz {
            return Err(SettingsError::new(
                "axes.steps_per_turn",
                Problem::StepRate {
                    speed_hz: motor_speed_hz,
                    rate_hz,
                    max_hz,
                    edges: MAX_EDGES,
                },
            ));
        }
        Ok(())
    }

    /// Checks that 64 bits hold the counts of a tick, for the motor of a servo axis: it is counted and makes no pulses.
    ///
    /// # Errors
    /// `motor_speed_hz`, in rev/s, would give more than 8192 counts a tick.
    #[cold]
    pub fn check_counts(
        steps_per_turn: u32,
        motor_speed_hz: f64,
        tick_hz: u32,
    ) -> Result<(), SettingsError> {
        let rate_hz = motor_speed_hz * f64::from(steps_per_turn);
        let max_hz = MAX_COUNTS * f64::from(tick_hz);
        if rate_hz > max_hz {
            return Err(SettingsError::new(
                "axes.steps_per_turn",
                Problem::CountRate {
                    speed_hz: motor_speed_hz,
                    rate_hz,
                    max_hz,
                    max_steps: (max_hz / motor_speed_hz) as u32,
                },
            ));
        }
        Ok(())
    }

    /// Cycles in a tick.
    pub const fn tick(&self) -> u32 {
        self.tick
    }
}
