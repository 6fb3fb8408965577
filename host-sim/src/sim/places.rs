//! Reference positions of cranks, which distinguish a crank that moves from one that stands.

/// Largest distance from one position, degrees, within which a crank stands, for [`super::coast::STANDS_S`]. That is 7.2° per second.
/// So an oscillating rod does not count as motion, and a swinging crank does.
const STANDS_DEG: f64 = 0.36;

/// Position of each crank when it last moved, turns.
#[derive(Clone, Debug, Default)]
pub(super) struct Places(Vec<f64>);

impl Places {
    /// Records the present positions of the cranks.
    pub fn new(turns: &[f64]) -> Self {
        Self(turns.to_vec())
    }

    /// Takes in the positions of the cranks. Returns true if one of them has moved.
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
