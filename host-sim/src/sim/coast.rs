//! Cranks that no drive holds any more: the tilt of the platform that they cause, and the time until they stand.
//!
//! Drives that are off hold nothing. If torque moves the cranks, their speed and the weight of the platform keep them turning.
//! On the other model levels a crank without its drive stands.

use super::Moment;
use super::places::Places;
use super::record::RunRecord;
use super::recorder::raise;
use crate::checked::Checked;

/// Time after which a crank that stays at one position ([`Places`]) counts as standing, s.
pub(super) const STANDS_S: f64 = 0.05;

/// Monitor of cranks whose drives are switched off.
#[derive(Clone, Debug, Default)]
pub struct Coast {
    tick_s: f64,
    were_on: bool,
    places: Places,
    off_ticks: u64,
    /// Last of these ticks in which a crank moved.
    moved: Option<u64>,
}

impl Coast {
    /// Creates the monitor of a machine at power-up.
    pub fn new(checked: &Checked) -> Self {
        Self {
            tick_s: 1.0 / f64::from(checked.scene.control.tick_hz),
            ..Self::default()
        }
    }

    /// Takes in one tick.
    pub fn tick(&mut self, moment: &Moment<'_>, record: &mut RunRecord) {
        if moment.drives_enabled {
            self.were_on = true;
            self.off_ticks = 0;
            self.moved = None;
            return;
        }
        if self.were_on {
            self.off(moment, record);
        }
    }

    #[cold]
    fn off(&mut self, moment: &Moment<'_>, record: &mut RunRecord) {
        let figures = &mut record.figures;
        if let Some(tilt_mrad) = moment.tilt_mrad() {
            raise(figures.tilt_worst_off_mrad.get_or_insert(0.0), tilt_mrad);
        }
        if moment.machine.rotors().is_none() {
            return;
        }
        if self.off_ticks == 0 {
            self.places = Places::new(moment.actual_turns);
        }
        self.off_ticks += 1;
        if self.places.take(moment.actual_turns) {
            self.moved = Some(self.off_ticks);
            record.moved_until_s = Some(moment.end_ns as f64 * 1e-9);
            let coasted_s = figures.coasted_s.get_or_insert(0.0);
            raise(coasted_s, self.off_ticks as f64 * self.tick_s);
            return;
        }
        // A crank without friction may turn more slowly than counts as motion. Over a long time that is no motion either.
        let stands_ticks = (STANDS_S / self.tick_s).ceil() as u64;
        let still_ticks = self.off_ticks - self.moved.unwrap_or(0);
        if still_ticks.is_multiple_of(stands_ticks) {
            self.places = Places::new(moment.actual_turns);
        }
    }

    /// True if cranks still coast after their drives were switched off.
    pub fn is_on(&self) -> bool {
        let since = self.moved.map(|moved| self.off_ticks - moved);
        self.off_ticks > 0 && since.is_some_and(|ticks| ticks as f64 * self.tick_s < STANDS_S)
    }
}
