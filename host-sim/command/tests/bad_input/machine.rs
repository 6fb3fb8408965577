//! Errors in the mechanism and its load.

use cophase_scene::library;

use super::edit::{before, rename, set, without};
use super::{Case, assert_all_refused, case};

#[test]
fn wrong_units_name_the_key_with_the_right_one() {
    let unit = |path, to, key, right| case(to, rename(path, to), key, "unknown key", right);
    assert_all_refused(&[
        unit(
            "machine.load_kg",
            "load_g",
            "machine.load_g",
            "`load_kg`, in kg",
        ),
        unit(
            "machine.load_kg",
            "load_lb",
            "machine.load_lb",
            "`load_kg`, in kg",
        ),
        unit(
            "machine.crank_radius_mm",
            "crank_radius_m",
            "machine.crank_radius_m",
            "`crank_radius_mm`, in mm",
        ),
        unit(
            "machine.mount_radius_mm",
            "mount_radius_cm",
            "machine.mount_radius_cm",
            "`mount_radius_mm`, in mm",
        ),
        unit(
            "machine.gravity_mps2",
            "gravity_g",
            "machine.gravity_g",
            "`gravity_mps2`, in m/s²",
        ),
        unit(
            "program[0].amax_g",
            "amax_mps2",
            "program[0].amax_mps2",
            "`amax_g`, in g",
        ),
        unit(
            "program[1].ramp_s",
            "ramp_ms",
            "program[1].ramp_ms",
            "`ramp_s`, in s",
        ),
        unit(
            "program[1].hold_s",
            "hold_min",
            "program[1].hold_min",
            "`hold_s`, in s",
        ),
        unit(
            "limits.speed_hz",
            "speed_rpm",
            "limits.speed_rpm",
            "`speed_hz`, in rev/s",
        ),
        unit(
            "limits.acceleration_hz_per_s",
            "acceleration_hz",
            "limits.acceleration_hz",
            "`acceleration_hz_per_s`, in rev/s²",
        ),
        unit(
            "pulse.width_ns",
            "width_us",
            "pulse.width_us",
            "`width_ns`, in ns",
        ),
        unit(
            "index.width_us",
            "width_ns",
            "index.width_ns",
            "`width_us`, in µs",
        ),
        unit(
            "axes.offset_deg",
            "offset_rad",
            "axes.offset_rad",
            "`offset_deg`, in °",
        ),
        unit(
            "drift.tilt_limit_mrad",
            "tilt_limit_deg",
            "drift.tilt_limit_deg",
            "`tilt_limit_mrad`, in mrad",
        ),
        unit("late[0].by_us", "by_ms", "late[0].by_ms", "`by_us`, in µs"),
    ]);
}

#[test]
fn impossible_masses_and_lengths_are_refused() {
    let load = |name, value, wrong| -> Case {
        case(
            name,
            set("machine.load_kg", value),
            "machine.load_kg",
            wrong,
            "0.001 to 50 kg, the loads",
        )
    };
    assert_all_refused(&[
        load("negative mass", "-5", "-5 kg is outside"),
        load("no mass", "0", "0 kg is outside"),
        load("a negative nothing", "-0.0", "-0 kg is outside"),
        load("too heavy", "51", "51 kg is outside"),
        load("a star", "1e300", "1e300 kg is outside"),
        load("an atom", "1e-300", "1e-300 kg is outside"),
        load("not a number", "nan", "NaN is not a finite number"),
        load("endless", "inf", "inf is not a finite number"),
        load("endless downwards", "-inf", "-inf is not a finite number"),
        case(
            "more than a float holds",
            set("machine.load_kg", "1e400"),
            "machine.load_kg",
            "`1e400`: the number is too large",
            "such as `load_kg =",
        ),
    ]);
}

#[test]
fn unsuitable_mechanism_keys_are_refused() {
    let yoke = set("machine.mechanism", "\"scotch-yoke\"");
    assert_all_refused(&[
        case(
            "mechanism with a typing error",
            set("machine.mechanism", "\"slider-cranks\""),
            "machine.mechanism",
            "\"slider-cranks\" is none of its values",
            "did you mean \"slider-crank\"?",
        ),
        case(
            "Scotch yoke with a lambda",
            yoke.clone(),
            "machine.lambda",
            "is no dimension of machine.mechanism = \"scotch-yoke\"",
            "let machine.mechanism be \"slider-crank\"",
        ),
        case(
            "Scotch yoke with a rod",
            yoke.replace("lambda = 0.3", "rod_length_mm = 60"),
            "machine.rod_length_mm",
            "is no dimension of machine.mechanism = \"scotch-yoke\"",
            "leave it out",
        ),
    ]);
}

#[test]
fn invalid_crank_rockers_are_refused() {
    let rocker = library::find("crank-rocker").unwrap().text;
    let with = |from: &str, to: &str| {
        assert!(rocker.contains(from), "{from}");
        rocker.replacen(from, to, 1)
    };
    assert_all_refused(&[
        case(
            "crank-rocker with a crank radius",
            with("screw_lead_mm = 30", "crank_radius_mm = 30"),
            "machine.crank_radius_mm",
            "is no dimension of machine.mechanism = \"crank-rocker\"",
            "\"slider-crank\" or \"scotch-yoke\"",
        ),
        case(
            "crank-rocker without a lead",
            with("screw_lead_mm = 30", ""),
            "machine.screw_lead_mm",
            "missing",
            "\"crank-rocker\" needs it",
        ),
        case(
            "lead out of range",
            with("screw_lead_mm = 30", "screw_lead_mm = 0.5"),
            "machine.screw_lead_mm",
            "0.5 mm is outside",
            "0.63 to 3000 mm",
        ),
        case(
            "no crank-rocker",
            with("ground_ratio = 1.9279190", "ground_ratio = 2.2"),
            "machine.crank_ratio",
            "are no crank-rocker",
            "cophase design crank-rocker",
        ),
        case(
            "crank-rocker that jams",
            with("coupler_ratio = 1.5402148", "coupler_ratio = 1.4402148"),
            "machine.crank_ratio",
            "exceeds 70°",
            "cophase design crank-rocker",
        ),
    ]);
}

#[test]
fn invalid_lambda_and_rod_lengths_are_refused() {
    let ratio = "0.1 to 0.6, the ratios of crank radius to rod length";
    let rod = |name, length, wrong, right| {
        let text = super::edit::with_line("machine.lambda", &format!("rod_length_mm = {length}"));
        case(name, text, "machine.rod_length_mm", wrong, right)
    };
    assert_all_refused(&[
        case(
            "lambda 0.7",
            set("machine.lambda", "0.7"),
            "machine.lambda",
            "0.7 is outside",
            ratio,
        ),
        case(
            "lambda 0.05",
            set("machine.lambda", "0.05"),
            "machine.lambda",
            "0.05 is outside",
            ratio,
        ),
        case(
            "lambda NaN",
            set("machine.lambda", "nan"),
            "machine.lambda",
            "NaN is not a finite number",
            ratio,
        ),
        case(
            "both",
            before("machine.lambda", "rod_length_mm = 60"),
            "machine.rod_length_mm",
            "together with machine.lambda",
            "leave one out",
        ),
        case(
            "neither",
            without("machine.lambda"),
            "machine.lambda",
            "missing",
            "or machine.rod_length_mm",
        ),
        rod(
            "rod as long as the crank",
            "20",
            "20 mm is outside",
            "33.34 to 200 mm",
        ),
        rod("rod of nothing", "0", "0 mm is outside", "33.34 to 200 mm"),
        rod(
            "rod of 10 m",
            "10000",
            "10000 mm is outside",
            "33.34 to 200 mm",
        ),
        rod(
            "rod that is no number",
            "nan",
            "NaN is not a finite number",
            "33.34 to 200 mm",
        ),
    ]);
}
