//! Underruns of the step hardware.

use cophase_core::supervisor::FaultKind;

use crate::faults::{AT_TICK, kinematic, latched, observe, with};

/// A microstep, turns.
const STEP: f64 = 1.0 / 12800.0;

/// If this fails, an underrun of the step hardware costs no steps, or is not reported.
#[test]
fn fifo_underrun_costs_half_a_tick_of_steps() {
    let samples = with(&kinematic(), "kind = \"step-fifo-underrun\"\naxis = 1\n");
    let without = observe(&kinematic().checked());
    // Both runs are equal until the fault, and the crank moves by the whole pulses of the tick without it.
    let before = without.at(AT_TICK - 1).actual[1];
    let lost = without.distance(1, AT_TICK) / 2.0;
    assert!(lost > 10.0 * STEP, "{lost}");
    assert!((samples.distance(1, AT_TICK) - lost).abs() < 1e-9);
    for after in [0, 5] {
        let sample = samples.at(AT_TICK + after);
        let whole = sample.actual[1] + lost;
        let steps = (whole - before) / STEP;
        assert!((steps - steps.round()).abs() * STEP < 1e-9, "{steps}");
        assert!((whole - sample.command[1]).abs() < STEP, "{whole}");
    }
    assert!(latched(&samples, FaultKind::StepFifoUnderrun));
}
