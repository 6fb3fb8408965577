//! Recording of a controller's stream: the files of a run, without a scene.
//!
//! A controller sends [samples](Sample) of its loop, tick by tick. Here they become the rows, edges and report that a simulated
//! run has, from the same code. *Unknown*: a column or wire to which no controller has access, such as the true phase of a crank.
//! It is left empty. *Gap*: samples that were lost on the line. A gap is counted and has no rows, because no rows are invented.
//!
//! Edges are not sent. They follow from the commanded phases of consecutive ticks, by the core's own planner
//! (`derived_edges`), as long as every tick since power-up at rest is known.

mod derived_edges;
mod events;
mod gaps;
mod stream;

pub use derived_edges::NoEdges;
pub use gaps::{Gap, Gaps};
pub use host_sim::sim::TAIL_S;
pub use stream::Stream;

use std::io::{Seek, Write};

use cophase_core::mechanism::{AnyMechanism, Mechanism};
use cophase_core::settings::Settings;
use cophase_core::supervisor::State;
use cophase_core::units::{Phase, Turns};
use cophase_link::message::{Counters, EventRecord};
use cophase_link::sample::{Channel, Sample, flags};
use host_sim::sim::{RunRecord, RunRecorder, Unwrapped};

use crate::trace::TraceInfo;
use crate::trace::{
    ControllerRows, Every, Format, RecordError, Row, ScopeData, ScopeFrame, TraceSetup, Traces,
    Window,
};
use derived_edges::Derivation;

/// Recording in progress.
pub struct Recording<W: Write + Seek> {
    traces: Traces<'static, W>,
    rows: ControllerRows,
    row: Row,
    stream: Stream,
    tick_ns: u64,
    master: Option<Unwrapped>,
    axes: Vec<Unwrapped>,
    command_turns: Vec<f64>,
    last: Option<Sample>,
    gaps: Gaps,
    edges: Result<Derivation, NoEdges>,
    recorder: RunRecorder,
    mechanism: AnyMechanism,
    /// For each start of the program, the tick of the sample and the number of program ticks that had elapsed.
    starts: Vec<(u32, u32)>,
}

/// Complete recording.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Format of the written files.
    pub written: TraceInfo,
    /// Reason why there are no edges; `None` if there are.
    pub no_edges: Option<NoEdges>,
    /// Data for `scope.svg`.
    pub scope: ScopeData,
    /// Samples that were lost.
    pub gaps: Gaps,
    /// Record of the run.
    pub record: RunRecord,
    last: Option<Sample>,
}

impl Recorded {
    /// Last state. `None` without samples.
    pub fn state(&self) -> Option<State> {
        let number = usize::from(self.last?.state);
        State::ALL.get(number).copied()
    }

    /// True if a fault was latched at the end.
    pub fn has_fault(&self) -> bool {
        self.last.is_some_and(|last| last.flags & flags::FAULT != 0)
    }
}

impl<W: Write + Seek + 'static> Recording<W> {
    /// Begins a recording of a controller with these settings, whose clock is set.
    ///
    /// # Errors
    /// The header of the trace cannot be written.
    pub fn new(
        settings: &Settings,
        stream: Stream,
        csv: W,
        vcd: W,
        window: Window,
    ) -> Result<Self, RecordError> {
        let axes = settings.axes.len();
        let unknown = stream.unknown_columns();
        let setup = TraceSetup {
            shape: axes.into(),
            // Every received row is written.
            every: Every::Ticks(1),
            window,
            unknown: &unknown,
        };
        let frame = ScopeFrame {
            title: settings.name.to_string(),
            subtitle: "recorded from a controller".to_owned(),
            bands_hz: settings
                .limits
                .bands
                .iter()
                .map(|band| (band.from_hz, band.to_hz))
                .collect(),
            gravity_mps2: cophase_scene::units::STANDARD_GRAVITY_MPS2,
            ..ScopeFrame::default()
        };
        let edges = if stream.every != 1 {
            Err(NoEdges::NotEveryTick)
        } else if !stream.has_edges() {
            Err(NoEdges::Channels)
        } else {
            Derivation::new(settings)
        };
        Ok(Self {
            traces: Traces::new(
                &setup,
                [(Format::Csv, csv), (Format::Vcd, vcd)],
                None,
                ScopeData::new(axes, frame),
            )?,
            rows: ControllerRows::new(settings),
            row: Row::of_axes(axes),
            stream,
            tick_ns: 1_000_000_000 / u64::from(settings.tick_hz),
            master: None,
            axes: Vec::new(),
            command_turns: vec![0.0; axes],
            last: None,
            gaps: Gaps::new(stream.every),
            edges,
            recorder: RunRecorder::new(axes, settings.tick_hz, stream.every),
            mechanism: settings.mechanism(),
            starts: Vec::new(),
        })
    }

    /// The sample that was recorded last.
    pub const fn last(&self) -> Option<&Sample> {
        self.last.as_ref()
    }

    /// Samples that were recorded and lost so far.
    pub const fn gaps(&self) -> &Gaps {
        &self.gaps
    }

    /// Takes the next sample. A sample that is not later than the last one is already recorded, so it is left out.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn push(&mut self, sample: &Sample) -> Result<(), RecordError> {
        if self.last.is_some_and(|last| sample.tick <= last.tick) {
            return Ok(());
        }
        if self.gaps.push(sample.tick) > 0 {
            self.edges = Err(NoEdges::Lost);
        }
        self.fill(sample);
        self.traces.push_row(&self.row)?;
        self.recorder.sample(sample);
        let is_running = |sample: &Sample| sample.state == State::Run as u8;
        if is_running(sample) && !self.last.as_ref().is_some_and(is_running) {
            self.starts.push((sample.tick, sample.program_ticks));
        }
        let reason = {
            let derived = match &mut self.edges {
                Ok(derivation) => derivation.push(sample),
                Err(reason) => Err(*reason),
            };
            match derived {
                Ok(edges) => {
                    if let Some(edges) = edges {
                        self.traces.push_edges(&edges, None)?;
                    }
                    None
                }
                Err(reason) => Some(reason),
            }
        };
        if let Some(reason) = reason {
            self.edges = Err(reason);
        }
        self.last = Some(*sample);
        Ok(())
    }

    /// Fills the row of a sample. The row is that of the tick that plays the loop's commands of the sample's tick.
    fn fill(&mut self, sample: &Sample) {
        let phase = |turns: i64| Phase::ZERO.advanced(Turns::from_bits(turns));
        let master = phase(sample.phase);
        let axis = |i: usize| master.advanced(Turns::from_bits(sample.lead[i]));
        let master_turns = self
            .master
            .get_or_insert_with(Unwrapped::default)
            .follow(master);
        if self.axes.is_empty() {
            let count = self.command_turns.len();
            self.axes = (0..count)
                .map(|i| Unwrapped::starting_at(axis(i)))
                .collect();
        }
        for (i, (axis_turns, turns)) in self
            .axes
            .iter_mut()
            .zip(&mut self.command_turns)
            .enumerate()
        {
            *turns = axis_turns.follow(axis(i));
        }
        let end_ns = played_ns(sample.tick, self.tick_ns) + self.tick_ns;
        self.rows.fill(
            &mut self.row,
            end_ns,
            sample,
            master_turns,
            &self.command_turns,
        );
        self.row.forget_truth();
        if !self.stream.has(Channel::Amax) {
            self.row.amax_requested_mps2 = f64::NAN;
        }
        if !self.stream.has(Channel::Speed) {
            self.row.amax_commanded_mps2 = f64::NAN;
            self.row.omega_rad_s = f64::NAN;
        }
    }

    /// Ends the recording, with the events that the controller reported during it, and the counters of its loop.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(
        mut self,
        events: &[EventRecord],
        counters: &Counters,
    ) -> Result<Recorded, RecordError> {
        if let Ok(derivation) = &mut self.edges
            && let Some(edges) = derivation.last()
        {
            self.traces.push_edges(&edges, None)?;
        }
        let missed = events
            .iter()
            .any(|record| matches!(record.event, cophase_link::message::Event::Missed(_)));
        let no_edges = self
            .edges
            .err()
            .or(missed.then_some(NoEdges::Missed))
            .or(self.last.is_none().then_some(NoEdges::Nothing));
        let mut record = self
            .recorder
            .finish(self.last.as_ref(), &self.command_turns, |top| {
                self.mechanism.amax(top).to_num()
            });
        record.control_ticks = self.gaps.ticks.map_or(0, |(first, last)| {
            u64::from(last - first) + u64::from(self.stream.every)
        });
        record.figures.late_deadlines = counters.late_deadlines;
        record.figures.missed_deadlines = counters.missed_deadlines;
        record.events = events::events(events, &self.starts, self.tick_ns);
        let (mut written, scope) = self.traces.finish()?;
        written.every = self.stream.every.into();
        if no_edges.is_some() {
            written.window_from_s = None;
            written.window_to_s = None;
        }
        Ok(Recorded {
            written,
            no_edges,
            scope,
            gaps: self.gaps,
            record,
            last: self.last,
        })
    }
}

/// Returns the start of the tick that plays the commands of a tick, ns since power-up.
pub(crate) const fn played_ns(tick: u32, tick_ns: u64) -> u64 {
    (tick as u64 + 1) * tick_ns
}
