//! Tests that cross crates, a module for each behaviour, machine or file: `cargo test -p cophase-tests homing` runs the tests of one.

/// Behaviours that a user sees of a machine, a noun for each.
///
/// Seek, jog, override and the immediate stop have their tests beside the code, in `firmware/core/src/controller/tests/`, and with a host
/// in `host-sim/command/tests/link.rs`.
mod behaviour {
    /// Alarms of drives that are shorter than a tick.
    mod alarm;
    /// Amplitude that a program requests, measured by the travel of the platform.
    mod amplitude;
    /// Forbidden bands: crossings, stops in them, and their events.
    mod bands;
    /// Machines with a brake: drives off after the stop.
    mod brake;
    /// Offsets and trims that tilt the platform or bend its rods.
    mod commanded_phases;
    /// Correction of phase errors by slow trims.
    mod correction;
    /// Cross-coupling of servos.
    mod coupling;
    /// Set-up and hold times of direction lines.
    mod direction;
    /// The enable input, and pulses without drives.
    mod enable;
    /// The shortest stop, after a fault.
    mod fault_stop;
    /// Elastic followers on cams.
    mod followers;
    /// Frames that move, and elastic rods.
    mod frame;
    /// Dry friction of the cranks.
    mod friction;
    /// Gears between motors and cranks, and ratios to the master.
    mod gears;
    /// The commands `hold` and `resume`.
    mod hold;
    /// Homing.
    mod homing;
    /// Late wake-ups of the loop, and missed deadlines.
    mod late;
    /// Loads on cranks that are all on one shaft.
    mod loads;
    /// Model levels on which torque moves the cranks, and their methods.
    mod model_levels;
    /// Parking at the parking phase, by the command `stop` and at the end of a program.
    mod park;
    /// Exact phases of all axes, for random scenes.
    mod phase;
    /// Limits on tilt and warp, for random platforms.
    mod platform_limits;
    /// The command `reset`.
    mod reset;
    /// Setpoints of servos: position, speed and torque.
    mod setpoints;
    /// Phase differences of cranks at a steady speed.
    mod spread;
    /// The command `start`.
    mod start;
    /// State of the drives after a stop: they hold, or are cut.
    mod stop_category;
    /// The stop input.
    mod stop_input;
    /// Underruns of the step hardware.
    mod underrun;
    /// Shafts away from their commands that no fault names.
    mod unnoticed_loss;
}

/// Machines other than a platform on slider-cranks, and their published values.
mod machines {
    /// Crank-rockers with a screw.
    mod crank_rocker;
    /// Cam tables in place of a cam shaft.
    mod electronic_cam;
    /// The suspended five-bar arm.
    mod five_bar;
    /// The jaw crusher.
    mod jaw_crusher;
    /// Servos on STEP and DIR.
    mod pulse_servo;
    /// Scotch yokes.
    mod scotch_yoke;
    /// The vibrating screen.
    mod screen;
}

/// Files of a run and of a board, and pages of the manual that the code decides.
mod files {
    /// The same bytes from the same scene.
    mod bytes;
    /// Functions that `docs/code-walk.md` names.
    mod code_walk;
    /// End of a run, in report and summary.
    mod ending;
    /// Pictures of the operating range.
    mod operating_range;
    /// Reactions to faults as `docs/faults.md` states them.
    mod reactions;
    /// Traces in the hands of other programs.
    mod readers;
    /// Causes, corrections, loads and curves of a report.
    mod report;
    /// Scenes as these tests build them.
    mod scenes;
    /// Settings files of boards.
    mod settings;
    /// Agreement of trace, step edges and report.
    mod trace;
    /// Pins that `docs/wiring.md` shows.
    mod wiring;
    /// Words of each machine in its report.
    mod words;
}

/// Effect of each `[[fault]]` and of `[noise]` on drives, cranks and sensors.
mod faults;
