//! `steps.vcd`: the edges on the wires, as a logic analyser would record them.
//!
//! *Window*: the part of the run that the file covers. Times are nanoseconds since power-up, and not since the
//! window's start, so that an edge can be found again in `trace.csv`. The first timestamp is the window's
//! start, with every wire's level there. The last one is its end, so that viewers show the whole window even
//! if nothing moves.
//!
//! The file carries no date: the same run gives the same bytes.

use std::io::{self, Write};

use super::wires::{EdgeError, Levels, Signal, Wires};
use ::vcd::{IdCode, SimulationCommand, TimescaleUnit, Value};

/// Writes changes of the wires `step_i`, `dir_i`, `index_i`, `enable` and `sync` of module `cophase`.
///
/// ```
/// use cophase_files::trace::{Levels, Signal, StepsVcd};
///
/// let mut steps = StepsVcd::new(Vec::new(), 2, 5_000, &Levels::default())?;
/// steps.change(5_250, Signal::Step(1), true)?;
/// steps.change(5_500, Signal::Step(1), false)?;
/// let text = String::from_utf8(steps.finish(6_000)?).unwrap();
/// assert!(text.contains("$timescale 1 ns $end"));
/// assert!(text.ends_with("#5250\n1\"\n#5500\n0\"\n#6000\n"));
/// # Ok::<(), cophase_files::trace::EdgeError>(())
/// ```
pub struct StepsVcd<W: Write> {
    // The `vcd` writer does not return its own writer, so it is borrowed through this one.
    file: ::vcd::Writer<Held<W>>,
    ids: Vec<IdCode>,
    wires: Wires,
}

impl<W: Write> StepsVcd<W> {
    /// Writes the header and every wire's level at `start_ns` (since power-up), the window's start.
    ///
    /// `w` should be buffered: each change is a small write.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(w: W, axes: usize, start_ns: u64, initial: &Levels) -> Result<Self, EdgeError> {
        let wires = Wires::new(axes, start_ns, initial);
        let mut file = ::vcd::Writer::new(Held(Some(w)));
        file.version("cophase")?;
        file.comment("times count from power-up")?;
        file.timescale(1, TimescaleUnit::NS)?;
        file.add_module("cophase")?;
        let ids = wires
            .names()
            .map(|name| file.add_wire(1, &name))
            .collect::<Result<Vec<_>, _>>()?;
        file.upscope()?;
        file.enddefinitions()?;
        file.timestamp(start_ns)?;
        file.begin(SimulationCommand::Dumpvars)?;
        for (&id, level) in ids.iter().zip(wires.levels()) {
            file.change_scalar(id, level.map_or(Value::X, Value::from))?;
        }
        file.end()?;
        Ok(Self { file, ids, wires })
    }

    /// Sets `signal` to `level` from `time_ns` on. A level that the signal already has is not written.
    ///
    /// # Errors
    /// [`EdgeError::Order`] for a time before the last one written or before the window. [`EdgeError::Wire`]
    /// for an axis that the file does not have. Neither error changes the file.
    pub fn change(&mut self, time_ns: u64, signal: Signal, level: bool) -> Result<(), EdgeError> {
        if let Some(wire) = self.wires.change(time_ns, signal, level)? {
            self.advance(time_ns)?;
            self.file.change_scalar(self.ids[wire], level)?;
        }
        Ok(())
    }

    /// Writes the window's end, flushes, and returns the writer.
    ///
    /// # Errors
    /// [`EdgeError::Order`] for an end before the last change, or an error of the writer.
    pub fn finish(mut self, end_time_ns: u64) -> Result<W, EdgeError> {
        self.advance(end_time_ns)?;
        self.file.flush()?;
        let writer = self.file.writer().0.take();
        Ok(writer.ok_or_else(|| io::Error::other("writer already taken"))?)
    }

    /// Writes a timestamp, unless the file is already at that time.
    fn advance(&mut self, time_ns: u64) -> Result<(), EdgeError> {
        if self.wires.advance(time_ns)? {
            self.file.timestamp(time_ns)?;
        }
        Ok(())
    }
}

/// A writer that can be taken out.
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
    fn a_change_before_the_last_time_is_refused() {
        let mut steps = StepsVcd::new(Vec::new(), 1, 100, &Levels::default()).unwrap();
        assert!(matches!(
            steps.change(99, Signal::Sync, true),
            Err(EdgeError::Order {
                time_ns: 99,
                last_ns: 100
            })
        ));
        steps.change(150, Signal::Sync, true).unwrap();
        // A time in the past is refused even if the change would write nothing.
        assert!(steps.change(149, Signal::Sync, true).is_err());
        assert!(matches!(steps.finish(149), Err(EdgeError::Order { .. })));
    }

    #[test]
    fn an_axis_not_in_the_file_is_refused() {
        let mut steps = StepsVcd::new(Vec::new(), 2, 0, &Levels::default()).unwrap();
        for signal in [Signal::Step(2), Signal::Dir(2), Signal::Index(9)] {
            assert!(matches!(
                steps.change(1, signal, true),
                Err(EdgeError::Wire { axes: 2, .. })
            ));
        }
    }
}
