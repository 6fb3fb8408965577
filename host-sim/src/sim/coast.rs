//! What cranks do that no drive holds any more: how far they tilt the platform, and when they stand.
//!
//! Drives that are off hold nothing. Where torque moves the cranks, what they had of speed, and the weight of the platform, turn
//! them on; on the other model levels a crank without its drive stands.

use super::Moment;
use super::places::Places;
use crate::scene::Checked;

/// Time after which a crank stands that stays at one place ([`Places`]), s.
pub(super) const STANDS_S: f64 = 0.05;

/// Cranks that are let go, watched.
#[derive(Clone, Debug, Default)]
pub struct Coast {
    /// Largest tilt of the platform with the drives off, after they had been on, mrad; none where they stayed on.
    pub worst_tilt_mrad: Option<f64>,
    /// For how long cranks that were let go turned on, s: the longest time.
    pub turned_s: f64,
    tick_s: f64,
    were_on: bool,
    places: Places,
    off_ticks: u64,
    /// The last of these in which a crank moved.
    moved: Option<u64>,
}

impl Coast {
    /// Of a machine at power-up.
    pub fn new(checked: &Checked) -> Self {
        Self {
            tick_s: 1.0 / f64::from(checked.scene.control.tick_hz),
            ..Self::default()
        }
    }

    /// Looks at one tick.
    pub fn tick(&mut self, moment: &Moment<'_>) {
        if moment.drives_enabled {
            self.were_on = true;
            self.off_ticks = 0;
            self.moved = None;
            return;
        }
        if self.were_on {
            self.off(moment);
        }
    }

    #[cold]
    fn off(&mut self, moment: &Moment<'_>) {
        let worst_mrad = self.worst_tilt_mrad.unwrap_or(0.0);
        self.worst_tilt_mrad = Some(worst_mrad.max(moment.tilt_mrad()));
        if moment.machine.rotors().is_none() {
            return;
        }
        if self.off_ticks == 0 {
            self.places = Places::at(moment.actual_turns);
        }
        self.off_ticks += 1;
        if self.places.take(moment.actual_turns) {
            self.moved = Some(self.off_ticks);
            self.turned_s = self.turned_s.max(self.off_ticks as f64 * self.tick_s);
        }
    }

    /// Whether cranks turn on that were let go.
    pub fn is_on(&self) -> bool {
        let since = self.moved.map(|moved| self.off_ticks - moved);
        self.off_ticks > 0 && since.is_some_and(|ticks| ticks as f64 * self.tick_s < STANDS_S)
    }
}
