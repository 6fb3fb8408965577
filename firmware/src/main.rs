//! Cophase firmware: the control loop of `cophase_core` on an RP2040.
//!
//! Two tasks run on the one core: the *control loop*, and the log in the time that the loop leaves. Neither makes step
//! edges: hardware does (`board::steps`). Neither switches off the drives when the enable input opens: hardware does
//! (`board::guard`).
//!
//! | module | contents |
//! | --- | --- |
//! | `board` | hardware: pins, step output, index capture, guard, safety lines, watchdog, witnesses, code in RAM, log |
//! | `start` | from power-up to a running loop, and the tasks |
//! | `settings` | choice and storage of the settings |
//! | `machine` | loop and board, set up for the axes of the settings |
//! | `link` | host link over USB and UART |
//! | `control` | input and output of the loop on this board |
//! | `report` | events, reported over the debug probe |
//!
//! Every member of this workspace builds for a host. There this binary has no hardware to drive and prints a message.
//! The loop itself runs on a host through `host-sim`.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "hardware access")]
mod board;
#[cfg(target_os = "none")]
mod control;
#[cfg(target_os = "none")]
mod link;
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
