//! The laboratory. It sizes machines ([`design`]), compares methods and model levels ([`chart`]), tests the loop's claims on thousands of machines
//! ([`campaign`]), and puts published figures beside ours ([`reproduced`]).
//!
//! Nothing here takes part in running a scene. [`host_sim`] runs scenes.
#![forbid(unsafe_code)]

pub mod campaign;
pub mod chart;
pub mod design;
pub mod numbers;
pub mod reproduced;
