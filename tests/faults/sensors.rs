//! Faults of sensors, inputs and the loop itself.

use cophase_core::supervisor::FaultKind;
use cophase_files::trace::{Every, Window};
use cophase_tests::{SceneBuilder, record};
use host_sim::checked::Checked;
use host_sim::faults::Faults;

use super::samples::readings;
use super::{
    AT_S, AT_TICK, began, faulty, kinematic, latched, latched_in, observe, phased, unread, with,
};

fn at(fault: &str) -> Checked {
    faulty(&kinematic(), AT_S, fault)
}

/// If this fails, pulses are missing on another axis, or come back too early or never.
#[test]
fn missing_pulses_are_as_many_as_requested() {
    for machine in [kinematic(), phased()] {
        let all = observe(&machine.checked());
        let first = with(&machine, "kind = \"index-missing\"\naxis = 1\ncount = 1\n");
        let never = with(&machine, "kind = \"index-missing\"\naxis = 1\n");
        // Both runs are equal until the loop reacts: for a turn and a half.
        let until =
            |rises: Vec<f64>| -> Vec<f64> { rises.into_iter().filter(|&us| us < 0.3e6).collect() };
        assert_eq!(until(all.rises_us(1)).len(), 1);
        assert!(until(first.rises_us(1)).is_empty());
        assert!(never.rises_us(1).is_empty());
        assert_eq!(until(first.rises_us(0)), until(all.rises_us(0)));
    }
    // The loop's reaction to the next pulse is tested elsewhere. The fault layer suppresses this many pulses, and no more.
    let mut faults = Faults::new(&at("kind = \"index-missing\"\naxis = 1\ncount = 2\n"));
    let passes = |faults: &mut Faults| std::array::from_fn(|_| faults.misses(1));
    faults.extra((AT_TICK - 1) * 500);
    assert_eq!(passes(&mut faults), [false; 4]);
    faults.extra(AT_TICK * 500);
    assert!(!faults.misses(0));
    assert_eq!(passes(&mut faults), [true, true, false, false]);
}

/// If this fails, extra pulses come at a wrong time, or not at the same phase of the next turn.
#[test]
fn extra_pulses_occur_on_time_and_repeat_each_turn() {
    for machine in [kinematic(), phased()] {
        let samples = with(&machine, "kind = \"index-extra\"\naxis = 0\ncount = 2\n");
        let rises = samples.rises_us(0);
        assert!((rises[0] - AT_S * 1e6).abs() < 0.1, "{rises:?}");
        assert_eq!(began(&samples), AT_TICK);
        let place = |us: f64| {
            let (tick, part) = ((us / 500.0) as u64, us / 500.0 % 1.0);
            let (from, to) = (samples.at(tick - 1).actual[0], samples.at(tick).actual[0]);
            from + part * (to - from)
        };
        let again = rises
            .iter()
            .find(|&&us| (place(us) - place(rises[0]) - 1.0).abs() < 1e-4);
        assert!(again.is_some(), "{rises:?}");
    }
}

/// If this fails, the fault swaps wires of the drives, or of one kind of sensor alone.
#[test]
fn swapped_sensors_report_the_other_axis() {
    let apart = kinematic().axis(0, "index_deg", 90);
    let fault = "kind = \"swapped-wiring\"\naxis = 0\nwith = 2\nlines = \"sensors\"\n";
    let plain = observe(&apart.checked());
    let swapped = with(&apart, fault);
    // The first pulse of each axis, before the loop reacts to it.
    assert_eq!(swapped.rises_us(0)[0], plain.rises_us(2)[0]);
    assert_eq!(swapped.rises_us(2)[0], plain.rises_us(0)[0]);
    assert_eq!(swapped.rises_us(1)[0], plain.rises_us(1)[0]);
}

/// If this fails, a glitch affects another encoder, or lasts for a wrong time.
#[test]
fn encoder_glitch_shifts_counts_only_while_it_lasts() {
    let glitch = at("kind = \"encoder-glitch\"\naxis = 1\ncounts = -700\nfor_s = 0.01\n");
    let said = readings(&glitch, AT_TICK - 2..AT_TICK + 22);
    let counts: Vec<i32> = said.iter().map(|feedback| feedback.encoder[1]).collect();
    let mut expected = [-700; 24];
    expected[..2].fill(0);
    expected[22..].fill(0);
    assert_eq!(counts, expected);
    assert!(said.iter().all(|feedback| feedback.encoder[0] == 0));
    let for_good = at("kind = \"encoder-glitch\"\naxis = 1\ncounts = 9\n");
    assert_eq!(readings(&for_good, 10_000..10_001)[0].encoder[1], 9);
}

/// If this fails, an alarm or an input acts on a wrong axis or line, or does not end.
#[test]
fn alarms_and_inputs_are_on_while_they_last() {
    // The reading at the end notes that the line was active before it, as the board does.
    let during = AT_TICK..=AT_TICK + 20;
    let on = |kind: &str, which: fn(&cophase_core::signals::Feedback) -> bool| {
        let said = readings(&at(&format!("kind = \"{kind}\"\nfor_s = 0.01\n")), 0..500);
        for (tick, feedback) in (0..).zip(&said) {
            assert_eq!(which(feedback), during.contains(&tick), "{kind} at {tick}");
        }
    };
    on("enable-loss", |feedback| !feedback.inputs.enable);
    on("stop-input", |feedback| feedback.inputs.stop);
    on("drive-alarm\"\naxis = 2\n#\"", |feedback| {
        feedback.alarms == 1 << 2
    });
    let samples = with(&kinematic(), "kind = \"drive-alarm\"\naxis = 2\n");
    assert!(latched(&samples, FaultKind::DriveAlarm));
    assert_eq!(latched_in(&samples), Some(AT_TICK));
}

/// If this fails, an overrun misses a wrong number of deadlines, which decides whether it is a fault.
#[test]
fn overrun_misses_its_deadlines() {
    for count in [1, 3] {
        let samples = with(
            &kinematic(),
            &format!("kind = \"overrun\"\ncount = {count}\n"),
        );
        assert_eq!(samples.outcome.record.figures.missed_deadlines, count);
        assert_eq!(latched(&samples, FaultKind::Overrun), count == 3);
    }
}

/// If this fails, an encoder does not count in the direction in which its motor turns.
#[test]
fn encoders_count_in_their_motors_sense() {
    for machine in [kinematic(), phased()] {
        let samples = observe(&machine.axis(2, "reversed", true).checked());
        for sample in &samples.ticks {
            for (axis, sense) in [(0, 1.0), (2, -1.0)] {
                let counts = sense * sample.actual[axis] * 12800.0;
                let off = counts - f64::from(sample.encoder[axis]);
                assert!((-1e-5..1.0).contains(&off), "axis {axis}: {off}");
            }
        }
    }
}

/// If this fails, a flag's length shifts the pulse of a crank that turns forward, or does not shift that of a crank that
/// turns backward.
#[test]
fn long_flag_is_detected_at_its_leading_end() {
    let short = kinematic().set("axes.index_deg", 40);
    let long = short.clone().set("axes.index_width_deg", 10);
    let first = |machine: &SceneBuilder| observe(&machine.checked()).rises_us(1)[0];
    assert_eq!(first(&long), first(&short));
    let backward = with(&unread(&long), "kind = \"reversed\"\naxis = 1\n");
    let us = backward.rises_us(1)[0];
    let tick = backward.at((us / 500.0) as u64);
    // From 0 downwards, the crank meets the end at 50° at -310°. A tick there is 0.9°.
    let place = tick.actual[1] * 360.0;
    assert!((-310.9..=-309.1).contains(&place), "{place}");
}

/// If this fails, a sensor with a delay answers in time, or loses edges that fall into the next tick.
#[test]
fn sensor_delay_shifts_the_index_edges() {
    let first = |machine: &SceneBuilder| observe(&machine.checked()).rises_us(1)[0];
    let late = kinematic().set("axes.index_delay_us", 700);
    let off = first(&late) - first(&kinematic());
    assert!((off - 700.0).abs() < 0.01, "{off}");
}

/// If this fails, the report does not show which faults were injected, or which were reported.
#[test]
fn report_lists_the_injected_faults() {
    let run = record(
        &at("kind = \"lost-steps\"\naxis = 2\ncycles = 3\n"),
        Every::Fitting,
        Window::FirstMotion,
    );
    let injected = &run.report["injected"];
    assert_eq!(injected.as_array().map(Vec::len), Some(1));
    assert_eq!(injected[0]["kind"], "lost-steps");
    assert_eq!(injected[0]["axis"], 2);
    assert_eq!(injected[0]["at_s"], AT_S);
    let events = run.report["events"].as_array().unwrap();
    let words = "injected: lost steps, axis 2, 3 cycles";
    assert!(events.iter().any(|event| event["what"] == words));
    assert!(run.report["reported_faults"].is_array());
}
