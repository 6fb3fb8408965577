//! A run that no guard refuses beforehand, and that comes to an end on the way.
//!
//! Implicit midpoint has no limit, so none binds. But rotors of 0.1 g cm² on motors of 1000 N·m/rad go through 158 rad in the
//! one step that a tick is given here, and a motor's field then has many places at which the step could end: the method finds
//! one that lies far away, and cranks fly off. The run ends there and says so, and what was seen until then is written.

use super::runs::three_steppers;

/// The scene.
pub fn scene() -> String {
    let method = "[method]\nname = \"implicit-midpoint\"\nsteps_per_tick = 1\n[machine]";
    three_steppers(
        "phased",
        &[
            ("[machine]", method),
            ("rotor_inertia_kgm2 = 1e-3", "rotor_inertia_kgm2 = 1e-8"),
        ],
    )
}
