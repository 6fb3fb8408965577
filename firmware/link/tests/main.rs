//! Tests of what is stored or sent, a module for each part.
#![allow(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

mod board;
mod codec;
mod golden_messages;
mod link;
mod link_bring_up;
mod link_conditions;
mod link_damage;
mod link_streams;
mod message_layout;
mod power_cuts;
mod store;
mod support;
