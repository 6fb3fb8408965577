//! A design as a page of text: steps A to J in order, the kinematics side by side, then the warnings.

use std::io::{self, Write};

use cophase_scene::digits::{degrees, four, percent, plain};

use super::motor::MotorChoice;
use super::steps::Design;
use host_sim::mechanism::Mechanism;
use host_sim::mechanism::slider_crank::Extrema;

/// Width of the text, columns.
const WIDTH: usize = 90;

/// One full step of the common 200-step motor. Behind its gear, it is the phase error of a crank that is off by one step.
const FULL_STEP_DEG: f64 = 1.8;

/// The source's least acceleration, in gravities: the lower end of what a program may request.
const MIN_AMAX_G: f64 = 10.0;

/// Writes the page.
///
/// # Errors
/// `out` cannot be written to.
pub(super) fn write_page(
    design: &Design,
    motor: &MotorChoice,
    out: &mut dyn Write,
) -> io::Result<()> {
    let motors = design.requirement.motors;
    writeln!(out, "Vibration platform on {motors} slider-cranks")?;
    writeln!(out)?;
    write_sizes(design, out)?;
    writeln!(out)?;
    write_comparison(design, out)?;
    writeln!(out)?;
    write_control(design, motor, out)?;
    writeln!(out)?;
    write_motor(design, motor, out)?;
    writeln!(out)?;
    for warning in design.warnings(motor) {
        write_wrapped(&warning.to_string(), "!  ", out)?;
    }
    Ok(())
}

/// Writes steps A to H, one per line.
fn write_sizes(design: &Design, out: &mut dyn Write) -> io::Result<()> {
    let requested = &design.requirement;
    let radius_mm = 1e3 * design.mechanism.crank_radius_m();
    let rod_mm = 1e3 * design.mechanism.rod_length_m();
    let stroke_mm = 1e3 * design.mechanism.stroke_m();
    let gravity = plain(requested.gravity_mps2);
    let amax = four(requested.amax_mps2());
    let rpm = four(design.speed_rpm());
    let apart = 360 / requested.motors;
    let rows = [
        (
            "A  load",
            "m",
            plain(requested.load_kg),
            "kg",
            "without platform and rods".into(),
        ),
        (
            "B  acceleration",
            "amax",
            plain(requested.amax_g),
            "g",
            format!("{amax} m/s² with g = {gravity} m/s²"),
        ),
        (
            "C  frequency",
            "f",
            plain(requested.freq_hz),
            "Hz",
            String::new(),
        ),
        (
            "D  crank speed",
            "ω",
            four(design.speed_rad_s()),
            "rad/s",
            format!("2 π f, {rpm} rpm"),
        ),
        (
            "E  crank/rod ratio",
            "λ",
            plain(requested.lambda),
            "",
            String::new(),
        ),
        (
            "F  crank radius",
            "R",
            four(radius_mm),
            "mm",
            format!("amax / (ω² (1 + λ)), stroke {} mm", four(stroke_mm)),
        ),
        ("G  rod length", "L", four(rod_mm), "mm", "R / λ".into()),
        (
            "H  motors",
            "N",
            requested.motors.to_string(),
            "",
            format!("{apart} deg apart around the platform"),
        ),
    ];
    for (step, symbol, value, unit, note) in rows {
        let line = format!("{step:<20} {symbol:<5}{value:>9} {unit:<6} {note}");
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
}

/// Writes step I: the results of the two-term formula, and the exact ones with the platform on either
/// side.
fn write_comparison(design: &Design, out: &mut dyn Write) -> io::Result<()> {
    let omega = design.speed_rad_s();
    let two_term = design.mechanism.extrema_two_term(omega);
    let exact = design.mechanism.extrema_exact(omega);
    let motions: [Extrema; 3] = [two_term, exact, exact];
    let torques = [
        design.torque_two_term,
        design.torque_exact_below,
        design.torque_exact_above,
    ];
    let safety = design.requirement.safety;
    let with_safety = format!("   … times safety {}, N·m", plain(safety));
    let per_motor = |torque_nm: f64| four(design.per_motor(torque_nm));
    let rows = [
        (
            "I  kinematics",
            ["two-term", "exact", "exact"].map(String::from),
        ),
        ("   platform", ["below", "below", "above"].map(String::from)),
        (
            "   largest acceleration, m/s²",
            motions.map(|m| four(m.stretched.a_mps2)),
        ),
        (
            "   lowest acceleration, m/s²",
            motions.map(|m| four(m.lowest().a_mps2)),
        ),
        (
            "   … at crank angle, deg",
            motions.map(|m| degrees(m.lowest().alpha_rad)),
        ),
        ("   torque maximum, N·m", torques.map(|t| four(t.value))),
        (
            "   … at crank angle, deg",
            torques.map(|t| degrees(t.alpha_rad)),
        ),
        ("   … per motor, N·m", torques.map(|t| per_motor(t.value))),
        (&with_safety, torques.map(|t| per_motor(safety * t.value))),
        (
            "   peak power, kW",
            torques.map(|t| four(1e-3 * omega * t.value)),
        ),
    ];
    for (name, [a, b, c]) in rows {
        writeln!(out, "{name:<32}{a:>12}{b:>12}{c:>12}")?;
    }
    let error = design.mechanism.two_term_error();
    writeln!(
        out,
        "   Two-term acceleration is off by at most {} of amax, at {} deg.",
        percent(error.value),
        degrees(error.alpha_rad)
    )
}

/// Writes step J: the task of the controller of this mechanism.
fn write_control(design: &Design, motor: &MotorChoice, out: &mut dyn Write) -> io::Result<()> {
    let rpm = |amax_g: f64| {
        let amax_mps2 = amax_g * design.requirement.gravity_mps2;
        let speed_rad_s = design.mechanism.speed_for_amax_rad_s(amax_mps2);
        four(speed_rad_s * 60.0 / core::f64::consts::TAU)
    };
    let amax_g = design.requirement.amax_g;
    let from = if amax_g > MIN_AMAX_G {
        format!("{MIN_AMAX_G} g at {} rpm, ", rpm(MIN_AMAX_G))
    } else {
        String::new()
    };
    let full_step_deg = FULL_STEP_DEG / motor.gear.ratio();
    let mismatch = design
        .mechanism
        .worst_height_mismatch(full_step_deg.to_radians());
    writeln!(
        out,
        "J  control: a drive for each motor, all on one motion controller following amax(t)"
    )?;
    writeln!(
        out,
        "   ω = √(amax / (R (1 + λ))): {from}{} g at {} rpm",
        plain(amax_g),
        rpm(amax_g)
    )?;
    writeln!(
        out,
        "   {} deg (one full step) between two cranks: one side up to {} mm higher",
        plain(full_step_deg),
        four(1e3 * mismatch.value)
    )
}

/// Writes the figures of the motor behind its gear, which are no step of the source.
fn write_motor(design: &Design, motor: &MotorChoice, out: &mut dyn Write) -> io::Result<()> {
    let gear = motor.gear;
    writeln!(
        out,
        "   motor: {} turn{} to {} of the crank, {} steps per turn",
        gear.motor_turns,
        if gear.motor_turns == 1 { "" } else { "s" },
        gear.crank_turns,
        motor.steps_per_turn
    )?;
    let rows = [
        ("   step rate, steps/s", four(motor.step_rate_hz(design))),
        (
            "   electrical cycle at the crank, deg",
            four(motor.electrical_cycle_deg()),
        ),
        (
            "   required torque with safety, N·m",
            four(motor.torque_nm(design)),
        ),
        (
            "   inertia ratio, load over motor",
            motor
                .inertia_ratio(design)
                .map_or_else(|| "give --rotor-inertia-kgm2".to_owned(), four),
        ),
    ];
    for (name, value) in rows {
        writeln!(out, "{name:<40}{value}")?;
    }
    Ok(())
}

/// Writes `text` in lines of at most [`WIDTH`] columns. The first begins with `lead`, and the others
/// are indented.
fn write_wrapped(text: &str, lead: &str, out: &mut dyn Write) -> io::Result<()> {
    let mut line = String::from(lead);
    let indent = lead.chars().count();
    for word in text.split_whitespace() {
        let length = line.chars().count();
        if length > indent && length + word.chars().count() + 1 > WIDTH {
            writeln!(out, "{line}")?;
            line = " ".repeat(indent);
        } else if length > indent {
            line.push(' ');
        }
        line.push_str(word);
    }
    writeln!(out, "{line}")
}
