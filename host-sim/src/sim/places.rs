//! Places of cranks, by which one that moves differs from one that stands.

/// A crank stands that stays within this of one place, degrees, for [`super::coast::STANDS_S`]: 7.2° a second, twice what friction in
/// this model lets a crank turn at that it holds. So a rod that rings does not count, and a crank that swings does.
const STANDS_DEG: f64 = 0.36;

/// Place of each crank when it moved last, turns.
#[derive(Clone, Debug, Default)]
pub(super) struct Places(Vec<f64>);

impl Places {
    /// Places of cranks as they are now.
    pub fn at(turns: &[f64]) -> Self {
        Self(turns.to_vec())
    }

    /// Takes in where the cranks are now. Returns true if one of them has moved.
    pub fn take(&mut self, turns: &[f64]) -> bool {
        let mut has_moved = false;
        for (place, &turns) in self.0.iter_mut().zip(turns) {
            if (turns - *place).abs() * 360.0 > STANDS_DEG {
                *place = turns;
                has_moved = true;
            }
        }
        has_moved
    }
}
