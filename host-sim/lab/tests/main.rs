//! Tests of charts, references and campaigns.

mod alternatives;
mod judge_is_independent;
mod references;
mod reproduced;
