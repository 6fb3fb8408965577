//! Sensing: measurement of one crank by the sensors of its axis.
//!
//! - [`index_filter`] extracts pulses from a noisy line, and `index_watch` decides which of them are those of the flag.
//! - `encoder_watch` reads an encoder in every tick.
//! - `history` holds the turns that were commanded, and `tick_phase` computes the phase that belongs to a pulse.

pub(super) mod encoder_watch;
pub(super) mod history;
pub mod index_filter;
pub(super) mod index_watch;
pub(super) mod tick_phase;
