//! Crank of bring-up, with nothing on it.

use cophase_core::settings::AxisSettings;
use cophase_scene::file::Fidelity;

use super::{Machine, Shown};
use crate::mechanism::SquareLaw;

/// Crank of one axis with its rod detached. It moves nothing.
#[derive(Clone, Copy, Debug)]
pub struct DetachedCrank {
    /// Law of the machine from which it is detached.
    pub law: SquareLaw,
}

impl Machine for DetachedCrank {
    fn name(&self) -> &'static str {
        "a detached crank"
    }

    fn axis_noun(&self) -> &'static str {
        "crank"
    }

    fn law(&self) -> SquareLaw {
        self.law
    }

    fn shown(&self) -> Shown {
        Shown::Displacement("crank")
    }

    fn draw(&self, _: &str, _: &[AxisSettings]) -> String {
        String::new()
    }

    fn levels(&self) -> &'static [Fidelity] {
        &[Fidelity::Kinematic]
    }

    fn motion(&self, _: Fidelity) -> &'static str {
        "the crank is where commanded"
    }

    fn left_out(&self, _: Fidelity) -> String {
        "torque and inertia".to_owned()
    }
}
