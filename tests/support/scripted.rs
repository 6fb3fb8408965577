//! One machine with scripted events, for tests of the supervisor's reactions.

use cophase_core::supervisor::State;
use cophase_core::units::Amax;

use crate::{SceneBuilder, Tick, Watched, bench_scene, watch};

/// Four mixed axes. They cross a band on the way up and on the way down.
pub fn machine() -> SceneBuilder {
    bench_scene()
        .with(
            r#"
control = { park_deg = 33.3, settle_s = 0.02 }
limits = { homing_speed_hz = 4, band = [{ from_hz = 9, to_hz = 11 }] }
axes = { count = 4 }
axis = [{ number = 1, reversed = true }, { number = 3, drive = "servo", reversed = true }]
"#,
        )
        .program([(13.0, 1.5, 0.5), (1.8, 1.0, 0.3)])
}

/// Its control ticks a second.
pub const HZ: f64 = 2000.0;
/// A turn in the units of [`Tick::speed`].
pub const ONE_TURN: f64 = (1_u64 << 48) as f64;

/// A moment in the middle of the program, and between two readings.
pub const AMID_S: f64 = 1.5 + 0.2 / HZ;

/// Plays the scene with the events in `happens`, and checks every tick against the limits.
///
/// # Panics
/// If the axes are apart, or a limit is broken while the drives are on.
pub fn scripted(happens: &str) -> Watched {
    let watched = watch(&machine().with(happens).checked());
    let max_acceleration = (40.0 / HZ.powi(2) * ONE_TURN) as u64;
    let max_jerk = (800.0 / HZ.powi(3) * ONE_TURN) as u64;
    let mut last = (0, 0);
    for tick in &watched.ticks {
        let acceleration = tick.speed - last.0;
        // Without drives nothing moves, and the limits do not apply.
        if tick.drives_enabled {
            let at = tick.start_ns;
            assert!(
                acceleration.unsigned_abs() <= max_acceleration,
                "acceleration at {at} ns"
            );
            assert!(
                (acceleration - last.1).unsigned_abs() <= max_jerk,
                "jerk at {at} ns"
            );
            assert!(tick.speed >= 0, "the shaft turns back at {at} ns");
            last = (tick.speed, acceleration);
        } else {
            last = (0, 0);
        }
    }
    watched
}

/// A command at a time, for [`scripted`]. Without a start among them the scene starts at once.
pub fn command(at_s: f64, what: &str) -> String {
    format!("[[command]]\nat_s = {at_s}\ndo = \"{what}\"\n")
}

/// A change of a safety input.
pub fn input(at_s: f64, line: &str, active: bool) -> String {
    format!("[[input]]\nat_s = {at_s}\nline = \"{line}\"\nactive = {active}\n")
}

/// A fault at a time, with its other keys.
pub fn fault(kind: &str, at_s: f64, more: &str) -> String {
    format!("[[fault]]\nkind = \"{kind}\"\nat_s = {at_s}\n{more}\n")
}

/// The phase at which the scene parks: 33.3°, to the nearest unit.
fn park_bits() -> i64 {
    (33.3 / 360.0 * ONE_TURN).round() as i64
}

/// Asserts that the machine is parked exactly where the scene says.
///
/// # Panics
/// If it is not.
pub fn stands_at_park_phase(tick: &Tick) {
    assert_eq!((tick.state, tick.speed), (State::Parked, 0));
    assert_eq!(
        tick.phase.within_turn().to_bits(),
        park_bits(),
        "not at the phase to park at"
    );
}

/// Amplitude that the program requested, tick by tick, while its time advanced.
pub fn program(watched: &Watched) -> Vec<Amax> {
    let playing = watched
        .ticks
        .iter()
        .filter(|tick| tick.state == State::Run && !tick.holding);
    playing.map(|tick| tick.program).collect()
}
