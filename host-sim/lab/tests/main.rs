//! Tests of charts, references and campaigns.

mod alternatives;
mod references;
mod reproduced;
