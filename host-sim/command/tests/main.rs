//! Tests of the command, a module for each subject: `cargo test -p cophase --test integration udp::` runs the tests of one.

mod arguments;
mod bad_input;
mod campaign;
mod compare;
mod design;
mod design_scene;
mod drawings;
mod examples;
mod flood;
mod hostile;
mod interrupted;
mod link;
mod record;
mod replay;
mod same_files;
mod scope;
mod settings;
mod shell;
mod support;
mod trace_formats;
mod udp;
