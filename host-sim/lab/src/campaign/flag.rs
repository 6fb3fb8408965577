//! Place of an index flag, and the extra pulses beside it that are harmless.
//!
//! An extra pulse is *harmless* if a loop that takes it for the flag's own does no harm. Such a loop corrects the crank by no more than the
//! distance between the two. So the crank stays within its limit as long as that distance is at most half of the error that one crank may
//! have. The other half is left for the error that it has already. While the flag is before its sensor, the line is high, and an extra
//! pulse changes nothing.

use host_sim::checked::Checked;

use super::geometry::Geometry;

/// Fraction of one crank's limit within which an extra pulse is harmless.
const HARMLESS: f64 = 0.5;

/// Place of an axis's flag, turns of the crank.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    at_turns: f64,
    length_turns: f64,
    /// Distance from it within which an extra pulse is harmless, turns.
    harmless_turns: f64,
}

impl Flag {
    /// Flag of an axis. None if the axis has no index sensor.
    pub fn new(checked: &Checked, geometry: Option<&Geometry>, axis: usize) -> Option<Self> {
        let settings = checked.settings.axes.get(axis)?;
        let limit_turns = geometry.map_or(checked.scene.drift.warp_limit_deg / 360.0, |geometry| {
            geometry.single_limit_turns()
        });
        Some(Self {
            at_turns: settings.index_turns?,
            length_turns: settings.index_width_turns,
            harmless_turns: HARMLESS * limit_turns,
        })
    }

    /// Returns an extra pulse that comes while the crank is at `turns`, going forward.
    pub fn extra_at(&self, turns: f64) -> Extra {
        let off = turns - self.at_turns;
        let off_turns = off - off.round();
        let ends = self.harmless_turns.max(self.length_turns);
        Extra {
            off_turns,
            is_harmless: (-self.harmless_turns..=ends).contains(&off_turns),
        }
    }
}

/// Extra pulse, which no flag makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extra {
    /// Distance of the pulse after the place of the flag, turns of the crank; negative before it.
    pub off_turns: f64,
    /// True if a loop that takes it for the flag's own does no harm, or if the line is high already.
    pub is_harmless: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::library;

    /// If this fails, the distance is too wide, and pulses that the loop must report are ignored. Or it is too narrow, and the loop has to
    /// report pulses that do no harm. A limit that allows one crank 4° allows a pulse 2° in either direction, and the flag's length after
    /// it.
    #[test]
    fn an_extra_pulse_near_the_flag_is_harmless() {
        let is_harmless = |width_deg: f64, deg: f64| {
            let mut scene = library::find("default").unwrap().scene();
            scene.axes.index_width_deg = width_deg;
            let (tilt_mrad, warp_deg) = Geometry::new(&scene).unwrap().of_one(4.0 / 360.0);
            scene.drift.tilt_limit_mrad = tilt_mrad;
            scene.drift.warp_limit_deg = 2.0 * warp_deg.max(1.0);
            let geometry = Geometry::new(&scene);
            let flag = Flag::new(&Checked::new(scene).unwrap(), geometry.as_ref(), 0).unwrap();
            flag.extra_at(flag.at_turns + 3.0 + deg / 360.0).is_harmless
        };
        for (deg, expected) in [(-2.05, false), (-1.95, true), (1.95, true), (2.05, false)] {
            assert_eq!(is_harmless(0.0, deg), expected, "{deg}");
        }
        for (deg, expected) in [(-2.05, false), (5.9, true), (6.1, false)] {
            assert_eq!(is_harmless(6.0, deg), expected, "{deg}");
        }
    }
}
