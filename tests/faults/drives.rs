//! Faults between the loop and the drives, and on the cranks.

use super::{AT_TICK, TICK_S, began, kinematic, observe, phased, unread, with};

/// A cycle of 256 of 12800 steps, turns.
const CYCLE: f64 = 0.02;

/// Largest distance of a crank from its field at homing speed on the phased model level. It slips at a quarter of a cycle.
const SWING: f64 = CYCLE / 4.0;

/// Largest difference between a command in whole microsteps and its phase.
const STEP: f64 = 1.0 / 12800.0;

/// If this fails, a wrong number of steps is lost, or lost steps come back by themselves.
#[test]
fn lost_steps_are_whole_cycles_and_permanent() {
    for (cycles, machine, off) in [
        (3, kinematic(), STEP),
        (-2, kinematic(), STEP),
        (3, phased(), SWING),
        (1, kinematic().set("fidelity", "quasi-static"), STEP),
    ] {
        let fault = format!("kind = \"lost-steps\"\naxis = 2\ncycles = {cycles}\n");
        let samples = with(&machine, &fault);
        assert_eq!(began(&samples), AT_TICK);
        let lost = f64::from(cycles) * CYCLE;
        assert!(samples.ahead(2, AT_TICK - 1).abs() < off);
        for tick in [AT_TICK, AT_TICK + 1, AT_TICK + 50] {
            let ahead = samples.ahead(2, tick);
            assert!((ahead + lost).abs() < off, "{cycles}: {ahead} at {tick}");
            assert!(samples.ahead(0, tick).abs() < off);
        }
        // The motor's encoder measures the lost steps.
        let counts = samples.at(AT_TICK + 50).encoder[2];
        let turns = f64::from(counts) / 12800.0;
        assert!((turns - samples.at(AT_TICK + 50).actual[2]).abs() <= STEP);
    }
}

/// If this fails, a slip has a wrong rate, or an encoder on the motor detects it, which is not possible.
#[test]
fn slip_grows_steadily_and_motor_encoders_miss_it() {
    for (machine, off) in [(kinematic(), STEP), (phased(), SWING)] {
        let samples = with(
            &machine,
            "kind = \"slip\"\naxis = 1\nrate_deg_per_s = 360\nfor_s = 0.02\n",
        );
        for (after, slipped) in [(10, 10.0), (39, 39.0), (80, 40.0)] {
            // A turn a second, from the tick in which the slip begins.
            let expected = -slipped * TICK_S;
            let found = samples.ahead(1, AT_TICK + after - 1);
            assert!((found - expected).abs() < off, "{found}, not {expected}");
            let sample = samples.at(AT_TICK + after - 1);
            let motor = f64::from(sample.encoder[1]) / 12800.0;
            assert!((motor - sample.command[1]).abs() < off, "{motor}");
        }
    }
}

/// If this fails, the other cranks move a stuck crank through the platform, or it never moves again after its release.
#[test]
fn stuck_stepper_stands_and_resumes_whole_cycles_off() {
    for (machine, off) in [(kinematic(), STEP), (phased(), SWING)] {
        let samples = with(&machine, "kind = \"stuck\"\naxis = 0\nfor_s = 0.03\n");
        let before = samples.at(AT_TICK - 1).actual[0];
        for tick in AT_TICK..AT_TICK + 60 {
            let moved = samples.at(tick).actual[0] - before;
            assert!(moved.abs() < 1e-12, "{moved} at {tick}");
            assert!(samples.distance(1, tick) > 0.0);
        }
        // Meanwhile it was commanded to make 0.15 turns: seven and a half cycles.
        let cycles = samples.ahead(0, AT_TICK + 100) / CYCLE;
        assert!((cycles - cycles.round()).abs() * CYCLE < off, "{cycles}");
        assert!((-8.6..=-6.4).contains(&cycles), "{cycles}");
    }
    let for_good = with(&kinematic(), "kind = \"stuck\"\naxis = 0\n");
    let last = for_good.ticks.last().unwrap();
    assert_eq!(last.actual[0], for_good.at(AT_TICK).actual[0]);
}

/// If this fails, a runaway drive still obeys the loop, or runs on when it is switched off.
#[test]
fn runaway_turns_at_its_own_speed() {
    for speed_hz in [9.0, -4.0] {
        let fault = format!("kind = \"runaway\"\naxis = 2\nspeed_hz = {speed_hz}\n");
        let samples = with(&kinematic(), &fault);
        for tick in [AT_TICK, AT_TICK + 20] {
            let distance = samples.distance(2, tick);
            assert!((distance - speed_hz * TICK_S).abs() < 1e-9, "{distance}");
        }
        let off = samples.ticks.iter().rev().find(|sample| !sample.enabled);
        if let Some(sample) = off {
            assert!(samples.distance(2, sample.tick).abs() < 1e-12);
        }
        let phased = with(&phased(), &fault);
        let distance = phased.at(AT_TICK + 60).actual[2] - phased.at(AT_TICK + 20).actual[2];
        // Its rotor reaches that speed within twenty ticks, or has swung by a quarter of a cycle at either end.
        assert!(
            (distance - speed_hz * 40.0 * TICK_S).abs() < 2.0 * SWING,
            "{distance}"
        );
    }
}

/// If this fails, a motor that is wired the other way round turns as commanded.
#[test]
fn reversed_motor_turns_backward_from_the_start() {
    for (machine, off) in [(kinematic(), STEP), (phased(), SWING)] {
        let samples = with(&unread(&machine), "kind = \"reversed\"\naxis = 1\n");
        assert_eq!(began(&samples), samples.ticks[0].tick);
        let sample = samples.at(AT_TICK);
        assert!((sample.actual[1] + sample.command[1]).abs() < off);
        assert!(sample.command[1] > 0.2);
        assert!((f64::from(sample.encoder[1]) / 12800.0 + sample.command[1]).abs() < off);
    }
}

/// If this fails, drives still follow their own lines. Two axes with different steps show it: one makes twice as many per turn.
#[test]
fn swapped_drive_lines_move_the_other_crank() {
    let apart =
        "[[axis]]\nnumber = 1\nsteps_per_turn = 25600\n[[axis]]\nnumber = 2\nreversed = true\n";
    for (machine, off) in [(unread(&kinematic()), STEP), (unread(&phased()), SWING)] {
        let samples = with(
            &machine.clone().with(apart),
            "kind = \"swapped-wiring\"\naxis = 0\nwith = 1\nlines = \"drive\"\n",
        );
        let sample = samples.at(AT_TICK);
        assert!((sample.actual[0] - 2.0 * sample.command[1]).abs() < off);
        assert!((sample.actual[1] - sample.command[0] / 2.0).abs() < off);
        // If one axis of the pair is mounted the other way round, each axis receives a reversed direction.
        let turned = with(
            &machine.clone().with(apart),
            "kind = \"swapped-wiring\"\naxis = 0\nwith = 2\nlines = \"drive\"\n",
        );
        let sample = turned.at(AT_TICK);
        assert!((sample.actual[0] + sample.command[2]).abs() < off);
        assert!((sample.actual[2] + sample.command[0]).abs() < off);
    }
}

/// If this fails, a load does not hold its crank back by the angle that the motor's spring gives: T sin(p δ).
#[test]
fn load_step_holds_its_crank_back() {
    let samples = with(&phased(), "kind = \"load-step\"\naxis = 0\ntorque_nm = 8\n");
    let without = observe(&phased().checked());
    let mean = |axis| {
        // Over a whole turn, the machine's own load has the same mean on all axes.
        let ticks = AT_TICK + 200..AT_TICK + 600;
        let off = ticks.map(|tick| samples.ahead(axis, tick) - without.ahead(axis, tick));
        off.sum::<f64>() / 400.0
    };
    let spring = -(8.0_f64 / 20.0).asin() / 50.0 / std::f64::consts::TAU;
    // Its oscillation about that angle, and that of the other cranks, has decayed to one part in a hundred.
    assert!(
        (mean(0) - spring).abs() < 0.05 * spring.abs(),
        "{}",
        mean(0)
    );
    assert!(mean(1).abs() < 0.05 * spring.abs(), "{}", mean(1));
}

/// If this fails, a scene whose fault has not begun yet runs differently from a scene without faults.
#[test]
fn fault_has_no_effect_before_it_begins() {
    for machine in [kinematic(), phased()] {
        let plain = observe(&machine.checked());
        let samples = with(&machine, "kind = \"lost-steps\"\naxis = 2\n");
        for tick in 2..AT_TICK {
            for axis in 0..3 {
                let off = samples.at(tick).actual[axis] - plain.at(tick).actual[axis];
                // Steps have their own times in the one run, and are read at ticks in the other.
                assert!(off.abs() <= STEP, "{off} at {tick}");
            }
        }
    }
}

/// If this fails, a scene can move one crank of a single shaft by itself, or give a torque on a level where torque moves
/// nothing.
#[test]
fn model_levels_that_cannot_show_a_fault_are_refused() {
    let slip = "fault = [{ at_s = 1, kind = \"slip\", axis = 0, rate_deg_per_s = 1 }]";
    let said = kinematic().set("fidelity", "rigid").with(slip).refused();
    assert!(
        said.contains("slip") && said.contains("\"phased\""),
        "{said}"
    );
    let said = kinematic().set("noise.load_nm", 1).refused();
    assert!(
        said.contains("noise.load_nm") && said.contains("\"phased\""),
        "{said}"
    );
    // The automatic choice of a model level does not choose that level.
    let auto = kinematic()
        .set("fidelity", "auto")
        .set("questions.torque_percent", 1);
    let chosen = |fault: &str| auto.clone().with(fault).checked().fidelity.name();
    let fault = "[[fault]]\nat_s = 1\nkind = \"stuck\"\naxis = 0\n";
    assert_ne!(chosen(fault), "rigid");
}
