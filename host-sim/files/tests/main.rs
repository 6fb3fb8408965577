//! Tests of files, a module for each kind.

mod bands;
mod compare;
mod ended;
mod operating_range;
mod trace_files;
