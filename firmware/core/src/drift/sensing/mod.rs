//! Sensing: what the sensors of one axis show of its crank.
//!
//! - [`index_filter`] makes pulses of a noisy line, and `index_watch` decides which of them are those of the flag.
//! - `encoder_watch` reads an encoder in every tick.
//! - `history` has the turns that were commanded, and `tick_phase` the phase that belongs to a pulse.

pub(super) mod encoder_watch;
pub(super) mod history;
pub mod index_filter;
pub(super) mod index_watch;
pub(super) mod tick_phase;
