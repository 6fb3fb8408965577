//! What the outputs of a controller do about a fault: the drives go off, a stop begins, or a correction begins.
//!
//! The judge does not ask the controller what it did. It compares the outputs of the faulty run with those of the case's clean run,
//! its [`Twin`], tick by tick. The two differ in the fault alone. So what one run does and the other does not is because of the fault,
//! and no threshold separates a reaction from chance.

use super::watch::Place;

/// Reaction that the outputs show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// The enable line of the drives goes off, and that of the twin does not.
    Off,
    /// The commanded acceleration falls, and from then on the commanded speed does not recover until it is zero. Where the twin moved
    /// alike until a later tick, the stop begins in that tick. The stop at the end of the program is none.
    Stop,
    /// The commanded phase of the faulted axis, relative to the master and to the twin, moves by more than two steps against the true
    /// error of the crank.
    Correction,
}

/// Response, and when the outputs began with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Responded {
    /// Kind of the response.
    pub response: Response,
    /// Beginning of the tick in which the first output of it was played.
    pub place: Place,
    /// Turns of the master N + 5 ticks before that: as many ticks as detection may take.
    pub turns: f64,
    /// Cranks were beyond a limit then.
    pub is_beyond_limit: bool,
}

/// Outputs of one tick, as the judge compares them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Commanded speed of the master, in units of 2⁻⁴⁸ turns a tick.
    pub speed: i64,
    /// Enable line of the drives.
    pub drives_enabled: bool,
    /// Commanded phase of the axis that the fault befalls, less the master's, turns.
    pub offset_turns: f64,
}

/// Outputs of a case's clean run, tick by tick since power-up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Twin {
    /// Outputs of each tick.
    pub ticks: Vec<Outputs>,
}
