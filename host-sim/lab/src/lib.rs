//! The laboratory: methods and model levels compared ([`chart`]), the loop's claims tested on thousands of machines
//! ([`campaign`]), and published figures beside ours ([`reproduced`]).
//!
//! Nothing here takes part in running a scene; that is [`host_sim`].
#![forbid(unsafe_code)]

pub mod campaign;
pub mod chart;
pub mod reproduced;
