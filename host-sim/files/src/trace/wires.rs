//! The wires whose edges are written, and the order of their changes, for every file of edges.

use std::io;

use thiserror::Error;

/// A wire.
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

/// Levels of all wires at the window's start. A vector shorter than the number of axes means low for the
/// rest.
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
    /// True if `index_i` and `sync` are not known: they are `x` from beginning to end.
    pub is_sensed_unknown: bool,
}

/// Reason why a change was not written.
#[derive(Debug, Error)]
pub enum EdgeError {
    /// The change is earlier than the last one written. Times in a file cannot go back.
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
    /// There are more edges than viewers can handle.
    #[error(
        "from {:.3} to {:.3} s there are more than 60 million edges, about a gigabyte; show less with --window",
        *from_ns as f64 * 1e-9,
        *at_ns as f64 * 1e-9
    )]
    TooLong {
        /// Start of the window.
        from_ns: u64,
        /// Time at which the limit was exceeded.
        at_ns: u64,
    },
    /// The writer refused.
    #[error("steps not written: {0}")]
    Io(#[from] io::Error),
    /// The writer of FST refused.
    #[error("steps not written: {0}")]
    Fst(#[from] fst_writer::FstWriteError),
}

/// Levels of all wires of a file while it is written, up to a time.
pub(super) struct Wires {
    axes: usize,
    levels: Vec<bool>,
    is_sensed_unknown: bool,
    now_ns: u64,
}

impl Wires {
    /// The wires of `axes` axes at `start_ns`.
    pub fn new(axes: usize, start_ns: u64, initial: &Levels) -> Self {
        let each = [&initial.step, &initial.dir, &initial.index];
        let level = |wires: &[bool], i: usize| wires.get(i).copied().unwrap_or(false);
        let mut levels: Vec<bool> = each
            .into_iter()
            .flat_map(|wires| (0..axes).map(move |i| level(wires, i)))
            .collect();
        levels.extend([initial.enable, initial.sync]);
        Self {
            axes,
            levels,
            is_sensed_unknown: initial.is_sensed_unknown,
            now_ns: start_ns,
        }
    }

    /// Names of the wires, in the order of their levels.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let axes = self.axes;
        let each = ["step", "dir", "index"].into_iter();
        each.flat_map(move |name| (0..axes).map(move |i| format!("{name}_{i}")))
            .chain(["enable", "sync"].map(str::to_owned))
    }

    /// Levels of the wires. `None` for a level that is not known.
    pub fn levels(&self) -> impl Iterator<Item = Option<bool>> {
        let (axes, is_sensed_unknown) = (self.axes, self.is_sensed_unknown);
        let levels = self.levels.iter().enumerate();
        levels.map(move |(wire, &level)| {
            let is_sensed = (2 * axes..3 * axes).contains(&wire) || wire == 3 * axes + 1;
            (!(is_sensed && is_sensed_unknown)).then_some(level)
        })
    }

    /// Takes a change, and returns the wire's position. Returns `None` if the wire already has this level.
    ///
    /// # Errors
    /// [`EdgeError::Wire`] and [`EdgeError::Order`].
    pub fn change(
        &mut self,
        time_ns: u64,
        signal: Signal,
        level: bool,
    ) -> Result<Option<usize>, EdgeError> {
        let wire = self.position(signal)?;
        self.check(time_ns)?;
        if self.levels[wire] == level {
            return Ok(None);
        }
        self.levels[wire] = level;
        Ok(Some(wire))
    }

    /// Moves on to a time that is not before the present one, and returns whether it is a later one.
    ///
    /// # Errors
    /// [`EdgeError::Order`].
    pub fn advance(&mut self, time_ns: u64) -> Result<bool, EdgeError> {
        self.check(time_ns)?;
        let is_later = time_ns > self.now_ns;
        self.now_ns = time_ns;
        Ok(is_later)
    }

    fn check(&self, time_ns: u64) -> Result<(), EdgeError> {
        if time_ns < self.now_ns {
            return Err(EdgeError::Order {
                time_ns,
                last_ns: self.now_ns,
            });
        }
        Ok(())
    }

    fn position(&self, signal: Signal) -> Result<usize, EdgeError> {
        let axes = self.axes;
        match signal {
            Signal::Step(i) if i < axes => Ok(i),
            Signal::Dir(i) if i < axes => Ok(axes + i),
            Signal::Index(i) if i < axes => Ok(2 * axes + i),
            Signal::Enable => Ok(3 * axes),
            Signal::Sync => Ok(3 * axes + 1),
            Signal::Step(_) | Signal::Dir(_) | Signal::Index(_) => {
                Err(EdgeError::Wire { signal, axes })
            }
        }
    }
}
