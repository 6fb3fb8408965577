//! Mechanisms: from crank angle to platform motion, in floating point.
