//! `steps.vcd`: the edges on the wires, as a logic analyser would have caught them.
//!
//! *Window*: the stretch of time the file covers. Times are nanoseconds since power-up, not since the window's
//! start, so that an edge can be found again in `trace.csv`; the first timestamp is the window's start, with
//! every wire's level there, and the last is its end, so that viewers show all of it even if nothing moves.
//!
//! The file carries no date: the same run gives the same bytes.

use std::io::{self, Write};

use ::vcd::{IdCode, SimulationCommand, TimescaleUnit};
use thiserror::Error;

/// A wire of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// `step_i`: rises at each step's crossing, falls half a step later.
    Step(usize),
    /// `dir_i`: the level at the drive's pin, after the axis's inversion.
    Dir(usize),
    /// `index_i`: the index sensor, once a turn.
    Index(usize),
    /// `enable`: the drives' common enable.
    Enable,
    /// `sync`: the controller's mark for a scope's trigger.
    Sync,
}

/// Every wire's level at the window's start. A vector shorter than the number of axes means low for the rest.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    /// `step_i`.
    pub step: Vec<bool>,
    /// `dir_i`.
    pub dir: Vec<bool>,
    /// `index_i`.
    pub index: Vec<bool>,
    /// `enable`.
    pub enable: bool,
    /// `sync`.
    pub sync: bool,
}

/// Why a change was not written.
#[derive(Debug, Error)]
pub enum VcdError {
    /// The change is earlier than what is already written (a file's times cannot go back).
    #[error("a change at {time_ns} ns comes after one at {last_ns} ns")]
    Order {
        /// The time refused.
        time_ns: u64,
        /// The latest time in the file.
        last_ns: u64,
    },
    /// There is no such axis.
    #[error("{signal:?} is not a wire of a file with {axes} axes")]
    Wire {
        /// The requested wire.
        signal: Signal,
        /// The file's axes.
        axes: usize,
    },
    /// There are more edges than any viewer likes.
    #[error(
        "from {:.3} to {:.3} s there are more than 60 million edges, about a gigabyte; show less with --window",
        *from_ns as f64 * 1e-9,
        *at_ns as f64 * 1e-9
    )]
    TooLong {
        /// Where the window begins.
        from_ns: u64,
        /// Where it became too much.
        at_ns: u64,
    },
    /// The writer refused.
    #[error("steps not written: {0}")]
    Io(#[from] io::Error),
}

/// Writes changes of the wires `step_i`, `dir_i`, `index_i`, `enable` and `sync` of module `cophase`.
///
/// ```
/// use host_sim::trace::{Levels, Signal, StepsVcd};
///
/// let mut steps = StepsVcd::new(Vec::new(), 2, 5_000, &Levels::default())?;
/// steps.change(5_250, Signal::Step(1), true)?;
/// steps.change(5_500, Signal::Step(1), false)?;
/// let text = String::from_utf8(steps.finish(6_000)?).unwrap();
/// assert!(text.contains("$timescale 1 ns $end"));
/// assert!(text.ends_with("#5250\n1\"\n#5500\n0\"\n#6000\n"));
/// # Ok::<(), host_sim::trace::VcdError>(())
/// ```
pub struct StepsVcd<W: Write> {
    // The `vcd` writer does not give its own writer back, so it is borrowed through this one.
    file: ::vcd::Writer<Held<W>>,
    axes: usize,
    ids: Vec<IdCode>,
    levels: Vec<bool>,
    now_ns: u64,
}

impl<W: Write> StepsVcd<W> {
    /// Writes the header and every wire's level at `start_ns` (since power-up), the window's start.
    ///
    /// `w` should be buffered: each change is a small write.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(w: W, axes: usize, start_ns: u64, initial: &Levels) -> Result<Self, VcdError> {
        let mut file = ::vcd::Writer::new(Held(Some(w)));
        file.version("cophase")?;
        file.comment("times count from power-up")?;
        file.timescale(1, TimescaleUnit::NS)?;
        file.add_module("cophase")?;
        let mut ids = Vec::with_capacity(3 * axes + 2);
        let mut levels = Vec::with_capacity(3 * axes + 2);
        for (name, initial) in [
            ("step", &initial.step),
            ("dir", &initial.dir),
            ("index", &initial.index),
        ] {
            for i in 0..axes {
                ids.push(file.add_wire(1, &format!("{name}_{i}"))?);
                levels.push(initial.get(i).copied().unwrap_or(false));
            }
        }
        for (name, level) in [("enable", initial.enable), ("sync", initial.sync)] {
            ids.push(file.add_wire(1, name)?);
            levels.push(level);
        }
        file.upscope()?;
        file.enddefinitions()?;
        file.timestamp(start_ns)?;
        file.begin(SimulationCommand::Dumpvars)?;
        for (&id, &level) in ids.iter().zip(&levels) {
            file.change_scalar(id, level)?;
        }
        file.end()?;
        Ok(Self {
            file,
            axes,
            ids,
            levels,
            now_ns: start_ns,
        })
    }

    /// `signal` is at `level` from `time_ns` on. A level it already has is not written.
    ///
    /// # Errors
    /// [`VcdError::Order`] for a time before the last one written or before the window,
    /// [`VcdError::Wire`] for an axis the file has not; neither leaves a trace in the file.
    pub fn change(&mut self, time_ns: u64, signal: Signal, level: bool) -> Result<(), VcdError> {
        let wire = self.wire(signal)?;
        self.check(time_ns)?;
        if self.levels[wire] == level {
            return Ok(());
        }
        self.advance(time_ns)?;
        self.file.change_scalar(self.ids[wire], level)?;
        self.levels[wire] = level;
        Ok(())
    }

    /// Writes the window's end, flushes, and gives the writer back.
    ///
    /// # Errors
    /// [`VcdError::Order`] for an end before the last change, or what the writer says.
    pub fn finish(mut self, end_time_ns: u64) -> Result<W, VcdError> {
        self.check(end_time_ns)?;
        self.advance(end_time_ns)?;
        self.file.flush()?;
        let writer = self.file.writer().0.take();
        Ok(writer.ok_or_else(|| io::Error::other("writer already taken"))?)
    }

    /// Position of a wire in `ids` and `levels`.
    fn wire(&self, signal: Signal) -> Result<usize, VcdError> {
        let axes = self.axes;
        match signal {
            Signal::Step(i) if i < axes => Ok(i),
            Signal::Dir(i) if i < axes => Ok(axes + i),
            Signal::Index(i) if i < axes => Ok(2 * axes + i),
            Signal::Enable => Ok(3 * axes),
            Signal::Sync => Ok(3 * axes + 1),
            Signal::Step(_) | Signal::Dir(_) | Signal::Index(_) => {
                Err(VcdError::Wire { signal, axes })
            }
        }
    }

    fn check(&self, time_ns: u64) -> Result<(), VcdError> {
        if time_ns < self.now_ns {
            return Err(VcdError::Order {
                time_ns,
                last_ns: self.now_ns,
            });
        }
        Ok(())
    }

    /// Writes a timestamp, unless the file is already there.
    fn advance(&mut self, time_ns: u64) -> io::Result<()> {
        if time_ns > self.now_ns {
            self.file.timestamp(time_ns)?;
            self.now_ns = time_ns;
        }
        Ok(())
    }
}

/// A writer that can be taken out again.
struct Held<W>(Option<W>);

impl<W: Write> Write for Held<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Some(w) => w.write(bytes),
            None => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.as_mut().map_or(Ok(()), Write::flush)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_already_there_is_not_written() {
        let mut steps = StepsVcd::new(Vec::new(), 1, 0, &Levels::default()).unwrap();
        steps.change(10, Signal::Enable, false).unwrap();
        steps.change(20, Signal::Enable, true).unwrap();
        steps.change(30, Signal::Enable, true).unwrap();
        let text = String::from_utf8(steps.finish(40).unwrap()).unwrap();
        let body = text.split("$end\n").last().unwrap();
        assert_eq!(body, "#20\n1$\n#40\n");
    }

    #[test]
    fn changes_at_one_time_share_its_timestamp() {
        let mut steps = StepsVcd::new(Vec::new(), 2, 7, &Levels::default()).unwrap();
        steps.change(7, Signal::Step(0), true).unwrap();
        steps.change(7, Signal::Step(1), true).unwrap();
        let text = String::from_utf8(steps.finish(7).unwrap()).unwrap();
        let stamps: Vec<&str> = text.lines().filter(|line| line.starts_with('#')).collect();
        assert_eq!(stamps, ["#7"]);
    }

    #[test]
    fn going_back_in_time_is_refused_and_leaves_nothing() {
        let mut steps = StepsVcd::new(Vec::new(), 1, 100, &Levels::default()).unwrap();
        assert!(matches!(
            steps.change(99, Signal::Sync, true),
            Err(VcdError::Order {
                time_ns: 99,
                last_ns: 100
            })
        ));
        steps.change(150, Signal::Sync, true).unwrap();
        // Refused even where there would be nothing to write.
        assert!(steps.change(149, Signal::Sync, true).is_err());
        assert!(matches!(steps.finish(149), Err(VcdError::Order { .. })));
    }

    #[test]
    fn an_axis_the_file_has_not_is_refused() {
        let mut steps = StepsVcd::new(Vec::new(), 2, 0, &Levels::default()).unwrap();
        for signal in [Signal::Step(2), Signal::Dir(2), Signal::Index(9)] {
            assert!(matches!(
                steps.change(1, signal, true),
                Err(VcdError::Wire { axes: 2, .. })
            ));
        }
    }
}
