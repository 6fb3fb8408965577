//! Run that no guard refuses beforehand, and that diverges.
//!
//! Implicit midpoint has no stability limit. But rotors of 0.1 g cm² on motors of 1000 N·m/rad oscillate through 158 rad in a step, which
//! is a whole tick here. A motor's field then has many solutions of the step, and the method finds a distant one. The run ends there
//! with a message, and its files have the results up to then.

use super::runs::three_steppers;

/// Scene of the run.
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
