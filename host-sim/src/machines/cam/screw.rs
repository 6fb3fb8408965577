//! Pushers on screws: the electronic cam.
//!
//! Each axis turns a screw whose nut carries the pusher, and follows a cam table. The machine compares the pusher with that of a mechanical
//! cam shaft that turns with the master. Both have the same law, and the lobe is shifted by the same angle as the axis's table.
//!
//! The position of a pusher is that of its motor. Its acceleration is the second difference of the commanded position over two ticks,
//! because that of whole steps has no meaning. It applies to the instant between the two ticks, and is compared with the acceleration of
//! the lobe at this instant.

use std::f64::consts::TAU;

use cophase_core::units::{MAX_AXES, PerAxis};
use cophase_methods::problems::Cam;

use super::pushers::PusherPeaks;
use crate::machines::follower::{PartMotion, Peaks, ShaftTick};

/// Screws of all axes.
#[derive(Clone, Debug)]
pub(super) struct Screws {
    lead_m: f64,
    /// Phase of each axis's table at the master's phase 0, turns.
    shifts: PerAxis<f64>,
    /// Commanded positions at the ends of the last two ticks, m.
    commanded: Option<[PerAxis<f64>; 2]>,
    /// Turns of the master since power-up.
    master_turns: f64,
    /// Travel of the master in the last tick, turns.
    last_turns: f64,
}

impl Screws {
    /// Creates screws of a lead, m per turn, with the shifts of the axes' tables, turns.
    pub fn new(lead_m: f64, shifts: impl IntoIterator<Item = f64>) -> Self {
        let mut all = [0.0; MAX_AXES];
        for (one, shift) in all.iter_mut().zip(shifts) {
            *one = shift;
        }
        Self {
            lead_m,
            shifts: all,
            commanded: None,
            master_turns: 0.0,
            last_turns: 0.0,
        }
    }

    /// Returns the position of a pusher whose axis is at `turns`, m.
    fn place_m(&self, turns: f64) -> f64 {
        self.lead_m * turns
    }

    /// Plays a tick of `tick_s`.
    pub fn play(
        &mut self,
        cam: &Cam,
        tick_s: f64,
        tick: &ShaftTick<'_>,
        (pushers, peaks): (&mut [PartMotion], &mut [Peaks]),
    ) {
        let master_turns = tick.master_turns;
        let between = self.master_turns;
        self.master_turns += master_turns;
        // Speed and acceleration of the master at the instant between this tick and the last.
        let omega = TAU * (master_turns + self.last_turns) / 2.0 / tick_s;
        let alpha = TAU * (master_turns - self.last_turns) / (tick_s * tick_s);
        self.last_turns = master_turns;
        let mut now = [0.0; MAX_AXES];
        for (now, turns) in now.iter_mut().zip(tick.command_turns) {
            *now = self.place_m(*turns);
        }
        let [before, last] = self.commanded.unwrap_or([now; 2]);
        let axes = pushers.iter_mut().zip(peaks).zip(tick.axes).enumerate();
        for (axis, ((pusher, peaks), screw)) in axes {
            let shift = self.shifts[axis];
            let lobe = cam.at_angle(TAU * (between + shift));
            let by_law = lobe.acceleration * omega * omega + lobe.velocity * alpha;
            let accel_mps2 = (now[axis] - 2.0 * last[axis] + before[axis]) / (tick_s * tick_s);
            let place_m = self.place_m(screw.turns());
            *pusher = PartMotion {
                place_m,
                accel_mps2,
            };
            let lift_m = cam.at_angle(TAU * (self.master_turns + shift)).displacement;
            *peaks = PusherPeaks {
                off_law_worst_mm: (place_m - lift_m).abs() * 1e3,
                pusher_accel_worst_mps2: accel_mps2.abs(),
                cam_side_accel_worst_mps2: by_law.abs(),
                off_law_accel_worst_mps2: (accel_mps2 - by_law).abs(),
            }
            .into();
        }
        self.commanded = Some([last, now]);
    }
}
