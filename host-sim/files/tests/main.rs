//! Tests of files, a module for each kind.

mod compare;
mod trace_files;
