//! The window of step edges that `steps.vcd` and `steps.fst` show.
//!
//! Levels outside the window are tracked but not written. So a window that begins in the middle of a run begins with the levels that
//! the wires have there.

use std::io::{Seek, Write};

use cophase_core::program::EntrySettings;
use cophase_core::pulse::Run;
use cophase_scene::Scene;
use host_sim::checked::Checked;
use host_sim::faults::Planned;

use super::edges::{EdgeFile, EdgeOutputs};
use super::{EdgeError, Levels, Row, Signal, TickEdges};

/// Part of the run that `steps.vcd` shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// Between two times, ns.
    Between(u64, u64),
    /// The whole run.
    All,
    /// The first 200 ms of motion.
    FirstMotion,
}

/// Length of the default window, ns.
const SHOWN_NS: u64 = 200_000_000;

/// Part of that window before a fault or a slip, ns.
const BEFORE_FAULT_NS: u64 = 50_000_000;

impl Window {
    /// Returns the window of a scene. The default is around the first injected fault, else the first motion. Wrong wiring exists from
    /// power-up on, and shows when the machine first moves.
    pub fn for_scene(scene: &Scene) -> Self {
        if let Some(scope) = scene.scope {
            return Self::seconds(scope.from_s, scope.to_s);
        }
        let begins = scene.fault.iter().map(|fault| Planned::new(fault).from_us);
        match begins.filter(|&from_us| from_us > 0).min() {
            Some(from_us) => Self::around(from_us as f64 * 1e-6),
            None => Self::FirstMotion,
        }
    }

    /// Window around a fault or a slip at a time, s.
    pub fn around(at_s: f64) -> Self {
        let from_ns = ((at_s * 1e9).round() as u64).saturating_sub(BEFORE_FAULT_NS);
        Self::Between(from_ns, from_ns + SHOWN_NS)
    }

    /// Window between two times, s.
    pub fn seconds(from_s: f64, to_s: f64) -> Self {
        Self::Between((from_s * 1e9).round() as u64, (to_s * 1e9).round() as u64)
    }

    /// Refuses a window that would have too many edges, as far as the program shows that before the run. `run_s` is the expected duration
    /// of the run. Only holds are counted. A scene with events at stated times is not judged, as these may end its program.
    ///
    /// # Errors
    /// The holds of the program have too many edges.
    pub fn check_length(self, checked: &Checked, run_s: f64) -> Result<(), EdgeError> {
        let (from_ns, to_ns) = match self {
            Self::All => (0, (run_s * 1e9) as u64),
            Self::Between(from_ns, to_ns) => (from_ns, to_ns),
            Self::FirstMotion => return Ok(()),
        };
        let scene = &checked.scene;
        if !(scene.fault.is_empty() && scene.command.is_empty() && scene.input.is_empty()) {
            return Ok(());
        }
        let (mut turns, mut max_hz) = (0.0, 0.0_f64);
        let mut until = Vec::new();
        for entry in &checked.settings.program {
            match entry {
                EntrySettings::Segment(segment) => {
                    let hz = checked.speed_hz(segment.amax_mps2);
                    max_hz = max_hz.max(hz);
                    until.push(turns);
                    turns += hz * segment.hold_s;
                }
                EntrySettings::Repeat { first, times } => {
                    let before = until.get(usize::from(*first)).copied().unwrap_or(turns);
                    until.push(turns);
                    turns += (turns - before) * f64::from(times.saturating_sub(1));
                }
            }
        }
        let axes = checked.settings.axes.iter();
        let pulsed = axes.filter(|axis| axis.drive.takes_pulses());
        let edges_a_turn = pulsed.map(|axis| {
            let ratio = axis.follower.constant_ratio().unwrap_or(1.0).abs();
            2.0 * ratio * axis.steps_per_crank_turn().to_f64()
        });
        // At most so many turns are outside the window.
        let outside_s = (run_s - (to_ns.saturating_sub(from_ns)) as f64 * 1e-9).max(0.0);
        let shown = edges_a_turn.sum::<f64>() * (turns - max_hz * outside_s);
        if shown > MAX_EDGES as f64 {
            return Err(EdgeError::TooLong {
                from_ns,
                at_ns: to_ns.min((run_s * 1e9) as u64),
            });
        }
        Ok(())
    }
}

/// Greatest number of edges in a file. A file of this size has about a gigabyte, and viewers cannot handle more.
const MAX_EDGES: u64 = 60_000_000;

/// Edges of the window.
pub(super) struct StepWindow<W: Write + Seek> {
    window: Window,
    /// Files, not yet begun or being written. Files that are still not begun at the end of the run are begun then, so that they are
    /// complete.
    files: Begun<W>,
    levels: Levels,
    edges: Vec<(u64, Signal, bool)>,
    ended: Option<(u64, u64)>,
    last_ns: u64,
    /// Edges shown so far.
    shown: u64,
}

enum Begun<W: Write + Seek> {
    Not(EdgeOutputs<W>),
    At(u64, Vec<EdgeFile<W>>),
    Over,
}

impl<W: Write + Seek> StepWindow<W> {
    pub fn new(outputs: EdgeOutputs<W>, window: Window) -> Self {
        Self {
            window,
            files: Begun::Not(outputs),
            levels: Levels::default(),
            edges: Vec::new(),
            ended: None,
            last_ns: 0,
            shown: 0,
        }
    }

    /// Takes the edges of a tick, and its row for formats that contain numbers.
    pub fn tick(&mut self, tick: &TickEdges<'_>, row: Option<&Row>) -> Result<(), EdgeError> {
        let (start_ns, end_ns) = (tick.start_ns, tick.end_ns);
        let axes = tick.runs.len();
        self.last_ns = end_ns;
        if self.levels.step.is_empty() {
            self.levels.step = vec![false; axes];
            // A line that changes in the first tick had the other level before.
            let before = |axis| tick.index_changes(axis).next().map(|(_, level)| !level);
            let before = |axis| before(axis).unwrap_or(tick.is_index_high(axis));
            self.levels.index = (0..axes).map(before).collect();
            self.levels.dir = tick.reversed.iter().map(|reversed| !reversed).collect();
            self.levels.is_sensed_unknown = tick.sensed.is_none();
        }
        if self.window == Window::FirstMotion && tick.moves {
            self.window = Window::Between(start_ns, start_ns + SHOWN_NS);
        }
        let (from_ns, to_ns) = match self.window {
            Window::All => (0, u64::MAX),
            Window::Between(from_ns, to_ns) => (from_ns, to_ns),
            Window::FirstMotion => (u64::MAX, u64::MAX),
        };
        self.edges.retain(|(at, ..)| *at >= start_ns); // keeps edges at the end of the previous tick
        if end_ns <= from_ns || start_ns > to_ns {
            self.pass(tick);
            return self.close_after(end_ns, to_ns);
        }
        self.gather(tick);
        self.edges.sort_by_key(|(at, ..)| *at);
        for i in 0..self.edges.len() {
            let (at, signal, level) = self.edges[i];
            if at >= end_ns {
                break;
            }
            if at > to_ns {
                self.close(to_ns)?;
            }
            if at >= from_ns {
                self.begin(from_ns, axes)?;
                if let Begun::At(_, files) = &mut self.files {
                    files
                        .iter_mut()
                        .try_for_each(|file| file.change(at, signal, level))?;
                    self.shown += u64::from(matches!(signal, Signal::Step(_)));
                }
            }
            self.set(signal, level);
        }
        self.begin(from_ns, axes)?;
        if let Begun::At(_, files) = &mut self.files
            && let Some(row) = row
            && end_ns <= to_ns
        {
            files
                .iter_mut()
                .try_for_each(|file| file.sample(end_ns, row))?;
        }
        if self.shown > MAX_EDGES {
            return Err(EdgeError::TooLong {
                from_ns,
                at_ns: end_ns,
            });
        }
        self.close_after(end_ns, to_ns)
    }

    /// Tracks the levels over a tick that is not shown, without a loop over its edges.
    fn pass(&mut self, tick: &TickEdges<'_>) {
        self.levels.enable = tick.enable;
        self.levels.sync = tick.sensed.as_ref().is_some_and(|sensed| sensed.sync);
        for (i, (&reversed, &runs)) in tick.reversed.iter().zip(&tick.runs).enumerate() {
            for run in runs {
                self.levels.step[i] ^= run.edges() % 2 == 1;
                if run.is_pause() {
                    self.levels.dir[i] = run.forward() != reversed;
                }
            }
            self.levels.index[i] = tick.is_index_high(i);
        }
    }

    fn close_after(&mut self, end_ns: u64, to_ns: u64) -> Result<(), EdgeError> {
        if end_ns > to_ns {
            self.close(to_ns)
        } else {
            Ok(())
        }
    }

    /// Collects the edges of one tick, unsorted.
    fn gather(&mut self, tick: &TickEdges<'_>) {
        let start_ns = tick.start_ns;
        self.edges.push((start_ns, Signal::Enable, tick.enable));
        if let Some(sensed) = &tick.sensed {
            self.edges.push((start_ns, Signal::Sync, sensed.sync));
        }
        for (i, (&reversed, &runs)) in tick.reversed.iter().zip(&tick.runs).enumerate() {
            let mut cycle = 0_u64;
            let mut high = self.levels.step[i];
            for run in runs {
                if run.is_pause() {
                    let turn = cycle + u64::from(Run::DIR_DELAY);
                    self.edges.push((
                        start_ns + tick.ns(turn),
                        Signal::Dir(i),
                        run.forward() != reversed,
                    ));
                    cycle += u64::from(run.period());
                }
                for _ in 0..run.edges() {
                    cycle += u64::from(run.period());
                    high = !high;
                    self.edges
                        .push((start_ns + tick.ns(cycle), Signal::Step(i), high));
                }
            }
            let changes = tick.index_changes(i);
            self.edges
                .extend(changes.map(|(at, level)| (at, Signal::Index(i), level)));
        }
    }

    fn set(&mut self, signal: Signal, level: bool) {
        match signal {
            Signal::Step(i) => self.levels.step[i] = level,
            Signal::Dir(i) => self.levels.dir[i] = level,
            Signal::Index(i) => self.levels.index[i] = level,
            Signal::Enable => self.levels.enable = level,
            Signal::Sync => self.levels.sync = level,
        }
    }

    fn begin(&mut self, from_ns: u64, axes: usize) -> Result<(), EdgeError> {
        if let Begun::Not(outputs) = &mut self.files {
            let files = std::mem::take(outputs).begin(axes, from_ns, &self.levels)?;
            self.files = Begun::At(from_ns, files);
        }
        Ok(())
    }

    fn close(&mut self, end_ns: u64) -> Result<(), EdgeError> {
        if let Begun::At(from_ns, files) = &mut self.files {
            self.ended = Some((*from_ns, end_ns));
            let files = std::mem::take(files);
            self.files = Begun::Over;
            files.into_iter().try_for_each(|file| file.finish(end_ns))?;
        }
        Ok(())
    }

    pub fn finish(mut self, axes: usize) -> Result<(u64, u64), EdgeError> {
        let last_ns = self.last_ns;
        self.begin(last_ns, axes)?;
        self.close(last_ns)?;
        Ok(self.ended.unwrap_or((last_ns, last_ns)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::load;

    /// If this fails, a run of minutes ends with the message that its file of edges is too large, or a window that fits is refused.
    #[test]
    fn a_window_with_too_many_edges_is_refused_before_the_run() {
        // 4.46 rev/s for 10 s, many times: 6.8 million edges each.
        let refused = |times: u32, more: &str, window: Window| {
            let text = format!(
                "name = \"window\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
                 [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
                 [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 25600\n{more}\
                 [[program]]\nrepeat = {times}\nsegments = [{{ amax_g = 1, ramp_s = 1, hold_s = 10 }}]"
            );
            let checked = Checked::new(load::parse(&text).unwrap()).unwrap();
            let run_s = 11.0 * f64::from(times) + 3.0;
            window.check_length(&checked, run_s).is_err()
        };
        assert!(!refused(8, "", Window::All));
        assert!(refused(10, "", Window::All));
        assert!(refused(100, "", Window::seconds(1.0, 1000.0)));
        assert!(!refused(100, "", Window::seconds(500.0, 501.0)));
        assert!(!refused(100, "", Window::FirstMotion));
        // It may end the run at once.
        let fault = "[[fault]]\nat_s = 5\nkind = \"stop-input\"\n";
        assert!(!refused(100, fault, Window::All));
    }

    /// If this fails, the window of a fault shows the machine's first steps, or leaves out the time just before the fault. Or a
    /// window that was requested is moved.
    #[test]
    fn the_default_window_shows_the_first_fault() {
        let of = |more: &str| {
            let text = format!(
                "name = \"window\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
                 [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
                 [axes]\ncount = 3\ndrive = \"servo\"\nsteps_per_turn = 4096\nencoder = true\n\
                 [[program]]\namax_g = 1\nhold_s = 1\n{more}"
            );
            Window::for_scene(&load::parse(&text).unwrap())
        };
        let fault =
            |at_s: f64, what: &str| format!("[[fault]]\nat_s = {at_s}\nkind = \"{what}\"\n");
        let (late, early) = (
            fault(1.5, "stop-input"),
            fault(0.9, "overrun\"\ncount = 3\n#\""),
        );
        let reversed = fault(0.0, "reversed\"\naxis = 0\n#\"");
        assert_eq!(of(""), Window::FirstMotion);
        assert_eq!(of(&reversed), Window::FirstMotion);
        assert_eq!(of(&late), Window::Between(1_450_000_000, 1_650_000_000));
        let first = Window::Between(850_000_000, 1_050_000_000);
        assert_eq!(of(&(late + &early + &reversed)), first);
        assert_eq!(
            of(&fault(0.02, "stop-input")),
            Window::Between(0, 200_000_000)
        );
        let scope = "[scope]\nfrom_s = 0.1\nto_s = 0.2\n";
        assert_eq!(
            of(&(early + scope)),
            Window::Between(100_000_000, 200_000_000)
        );
    }
}
