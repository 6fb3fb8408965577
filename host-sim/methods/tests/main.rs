//! Tests of the numerical methods, a module for each property.

mod allocation;
mod energy;
mod failures;
mod friction;
mod jacobians;
mod linear;
mod screen;
mod stability;
mod support;
