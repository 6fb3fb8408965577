//! Sums and extremes of a recording.

use cophase_core::mechanism::{AnyMechanism, Mechanism};
use cophase_core::settings::Settings;
use cophase_core::supervisor::State;
use cophase_core::units::{Amax, Turns};
use cophase_link::sample::{Sample, flags};
use cophase_scene::units::{degrees, speed_hz};

use crate::trace::Row;

/// Sums and extremes of all samples that were recorded.
#[derive(Clone, Debug)]
pub struct Totals {
    /// Ticks of the first and the last sample. `None` without samples.
    pub ticks: Option<(u32, u32)>,
    /// Last state. `None` without samples.
    pub state: Option<State>,
    /// True if a fault was latched at the end.
    pub has_fault: bool,
    /// Time in each state, s: idle, homing, run, stop, parked, fault. Gaps are not counted.
    pub time_in_state_s: [f64; 6],
    /// Each axis at the end.
    pub axes: Vec<AxisTotals>,
    /// Greatest commanded speed, rev/s.
    pub top_speed_hz: f64,
    /// Amplitude of that speed, m/s².
    pub top_amax_mps2: f64,
    runs: Vec<(u32, u32)>,
}

/// One axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct AxisTotals {
    /// Commanded steps at the end.
    pub steps: i64,
    /// Commanded phase at the end, turns.
    pub command_turns: f64,
    /// Largest phase error in the recording, degrees, without sign.
    pub phase_error_peak_deg: f64,
    /// Correction at the end, degrees.
    pub correction_deg: f64,
}

impl Totals {
    /// For each start of the program, the tick of the sample and the number of program ticks that
    /// had elapsed.
    pub(super) fn runs_from(&self) -> &[(u32, u32)] {
        &self.runs
    }
}

/// Running sums.
pub(super) struct Totalling {
    totals: Totals,
    mechanism: AnyMechanism,
    tick_hz: u32,
    last_state: Option<State>,
}

impl Totalling {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            totals: Totals {
                ticks: None,
                state: None,
                has_fault: false,
                time_in_state_s: [0.0; 6],
                axes: vec![AxisTotals::default(); settings.axes.len()],
                top_speed_hz: 0.0,
                top_amax_mps2: 0.0,
                runs: Vec::new(),
            },
            mechanism: settings.mechanism(),
            tick_hz: settings.tick_hz,
            last_state: None,
        }
    }

    pub(super) fn push(&mut self, sample: &Sample, row: &Row, every: u16) {
        let totals = &mut self.totals;
        let first = totals.ticks.map_or(sample.tick, |(first, _)| first);
        totals.ticks = Some((first, sample.tick));
        let state = State::ALL.get(usize::from(sample.state)).copied();
        if let Some(time_s) = totals.time_in_state_s.get_mut(usize::from(sample.state)) {
            *time_s += f64::from(every) / f64::from(self.tick_hz);
        }
        if state == Some(State::Run) && self.last_state != state {
            totals.runs.push((sample.tick, sample.program_ticks));
        }
        self.last_state = state;
        totals.state = state;
        totals.has_fault = sample.flags & flags::FAULT != 0;
        let speed = Turns::from_bits(sample.speed);
        let hz = speed_hz(speed, self.tick_hz);
        if hz > totals.top_speed_hz {
            totals.top_speed_hz = hz;
            let amax: Amax = self.mechanism.amax(speed);
            totals.top_amax_mps2 = amax.to_num();
        }
        for (axis, row) in totals.axes.iter_mut().zip(&row.axes) {
            axis.phase_error_peak_deg = axis.phase_error_peak_deg.max(row.phase_error_deg.abs());
        }
    }

    pub(super) fn finish(mut self, last: Option<&Sample>, command_turns: &[f64]) -> Totals {
        if let Some(last) = last {
            for (i, axis) in self.totals.axes.iter_mut().enumerate() {
                axis.steps = last.steps[i];
                axis.command_turns = command_turns[i];
                axis.correction_deg = degrees(Turns::from_bits(last.correction[i]));
            }
        }
        self.totals
    }
}
