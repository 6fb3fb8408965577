//! The Cophase firmware: `cophase_core`'s control loop on an RP2040.
//!
//! Two things run on the one core: the *control loop*, and in what time it leaves, the log. Step edges are made by
//! neither of them (`board::steps`), and neither cuts the drives when the enable input goes (`board::guard`).
//!
//! | module | is |
//! | --- | --- |
//! | `board` | pins, step output, index capture, guard, safety lines, watchdog: what is soldered |
//! | `start` | from power-up to a running loop, and the tasks |
//! | `settings` | which settings the firmware runs on, and where they are kept |
//! | `machine` | loop and world, set up for as many axes as the settings have |
//! | `from_ram` | code that is copied to RAM before all else |
//! | `control` | the loop's world, as this board has it |
//! | `report` | events, reported over the debug probe |
//!
//! Built for a host, as every member of this workspace can be, it has no hardware to drive and says so. The
//! loop itself runs on a host through `host-sim`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod control;
#[cfg(target_os = "none")]
mod from_ram;
#[cfg(target_os = "none")]
mod machine;
#[cfg(target_os = "none")]
mod report;
#[cfg(target_os = "none")]
mod settings;
#[cfg(target_os = "none")]
mod start;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "cophase-firmware drives motors from a microcontroller; this build is for a host and has none.\n\
         To build the firmware: cargo firmware. To run the control loop here, against a simulated machine: cargo sim run"
    );
    std::process::exit(2);
}
