//! Files of a run: traces ([`trace`]), recordings of a controller ([`record`]), reports ([`report`]), and their comparison ([`compare`]).
#![forbid(unsafe_code)]

pub mod compare;
pub mod record;
pub mod report;
pub mod trace;
pub mod version;
