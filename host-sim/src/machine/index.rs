//! An index sensor between the crank and the loop: the line rises as its flag comes and falls as it goes,
//! and the loop hears what the core's filter makes of that.

use cophase_core::drift::{IndexFilter, IndexPulse};

/// One index line with its filter.
#[derive(Clone, Debug)]
pub struct IndexSensor {
    filter: IndexFilter,
    high_cycles: u32,
    /// The line is high and falls so many cycles after the present tick's beginning.
    falls: Option<u32>,
}

impl IndexSensor {
    /// Of a flag that passes in `high_cycles`, through a filter of `width` cycles.
    pub fn new(width: u32, high_cycles: u32) -> Self {
        Self {
            filter: IndexFilter::new(width, false),
            high_cycles,
            falls: None,
        }
    }

    /// One tick of `cycles`, in which the flag came at the cycle `rises` or did not come.
    pub fn tick(&mut self, rises: Option<u32>, cycles: u32) -> Option<IndexPulse> {
        if let Some(rise) = rises {
            self.fall_before(rise);
            self.filter.change(rise as i32, true);
            self.falls = Some(rise + self.high_cycles);
        }
        self.fall_before(cycles);
        self.falls = self.falls.map(|falls| falls - cycles);
        self.filter.end_tick(cycles)
    }

    fn fall_before(&mut self, cycle: u32) {
        if let Some(falls) = self.falls.take_if(|falls| *falls < cycle) {
            self.filter.change(falls as i32, false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Were a passage told twice, or not at its edge, drift would be wrong where a tick ends.
    #[test]
    fn a_passage_is_told_once_wherever_the_tick_ends() {
        for rise in 0..=1000 {
            let mut sensor = IndexSensor::new(50, 120);
            let told = [sensor.tick(Some(rise), 1000), sensor.tick(None, 1000)];
            let edge = |cycle| Some(IndexPulse { cycle });
            let expected = if rise <= 950 {
                [edge(rise as i32), None]
            } else {
                [None, edge(rise as i32 - 1000)]
            };
            assert_eq!(told, expected, "a rise at {rise}");
            // And the next passage is heard.
            assert_eq!(sensor.tick(Some(500), 1000), edge(500));
        }
    }
}
