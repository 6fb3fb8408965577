//! Tests of the simulation, a module for each subject.

mod assembly;
mod design;
mod extreme_values;
mod live;
mod machines;
mod peaks;
mod published;
mod rigid_loads;
