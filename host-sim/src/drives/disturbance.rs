//! Disturbance of a drive and its crank in one tick.

/// Disturbance of a drive and its crank: an input of the machine in addition to the loop's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Number of the axis whose command lines reach the drive.
    pub from: usize,
    /// True if the motor turns in the reversed sense.
    pub reversed: bool,
    /// Speed at which the motor turns regardless of its command, rev/s.
    pub runaway_hz: Option<f64>,
    /// Fraction of the commanded travel that the drive makes: below 1 after a step FIFO underrun.
    pub travel_share: f64,
    /// Electrical cycles by which field and rotor fall back at the beginning of the tick.
    pub lost_cycles: i64,
    /// Slip of the crank on its motor's shaft in this tick, turns: positive backward.
    pub slip_turns: f64,
    /// True if the crank is stuck, and its motor with it.
    pub stuck: bool,
    /// Additional load on the crank, N·m.
    pub load_nm: f64,
}

impl Disturbance {
    /// Returns no disturbance, for axis `number`.
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
