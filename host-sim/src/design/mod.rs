//! The patent's design method, steps A to J.
