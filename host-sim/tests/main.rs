//! Tests of the simulation, a module for each subject.

mod design;
mod extreme_values;
mod live;
mod machines;
mod peaks;
mod published;
