//! A run that no guard refuses beforehand, and that comes to an end on the way.
//!
//! Implicit midpoint has no limit, so none binds. But rotors of 0.1 g cm² on motors of 1000 N·m/rad go through 158 rad in the
//! one step that a tick is given here, and a motor's field then has many places at which the step could end: the method finds
//! none of them. It says so, the run ends there, and what was seen until then is written.

/// The scene.
pub const SCENE: &str = r#"
name = "diverging"
fidelity = "phased"
[method]
name = "implicit-midpoint"
steps_per_tick = 1
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 8
mount_radius_mm = 200
[limits]
speed_hz = 30
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 1200
creep_hz = 5
[axes]
count = 3
drive = "stepper"
steps_per_turn = 12800
rotor_inertia_kgm2 = 1e-8
damping_nms = 0.2
pull_out = [[0, 20.0], [60, 20.0]]
[[program]]
amax_g = 15
ramp_s = 0.5
hold_s = 0.5
"#;
