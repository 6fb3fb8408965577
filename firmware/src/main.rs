//! The Cophase image: `cophase_core`'s control loop on a board.
//!
//! Built for a host, as every member of this workspace can be, it has no hardware to drive and says so.
//! The loop itself runs on a host through `host-sim`.
#![forbid(unsafe_code)]

fn main() {
    eprintln!(
        "cophase-firmware drives motors from a microcontroller; this build is for a host and has none.\n\
         To run the control loop here, against a simulated machine: cargo sim run"
    );
    std::process::exit(2);
}
