//! What is wrong with a drive and its crank in one tick.

/// Input of a machine beside the loop's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// The axis whose lines its drive detects.
    pub from: usize,
    /// Its motor turns the other way round.
    pub reversed: bool,
    /// It turns at this speed, whatever its command is, rev/s.
    pub runaway_hz: Option<f64>,
    /// Part of what it is commanded to do that it makes: less than 1 where its pulses underran.
    pub travel_share: f64,
    /// Electrical cycles by which field and rotor fall back as the tick begins.
    pub lost_cycles: i64,
    /// By how much the crank slips back on its motor's shaft in this tick, turns.
    pub slip_turns: f64,
    /// The crank, and its motor with it, stands.
    pub stuck: bool,
    /// Torque more that the crank is loaded with, N·m.
    pub load_nm: f64,
}

impl Disturbance {
    /// Nothing is, with axis `number`.
    pub const fn nothing(number: usize) -> Self {
        Self {
            from: number,
            reversed: false,
            runaway_hz: None,
            travel_share: 1.0,
            lost_cycles: 0,
            slip_turns: 0.0,
            stuck: false,
            load_nm: 0.0,
        }
    }
}
