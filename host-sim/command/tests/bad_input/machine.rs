//! The mechanism and what it carries.

use host_sim::scene::library;

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
fn masses_and_lengths_that_cannot_be() {
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
        case(
            "crank of 0.6 m",
            set("machine.crank_radius_mm", "600"),
            "machine.crank_radius_mm",
            "600 mm is outside",
            "0.1 to 500 mm",
        ),
        case(
            "gravity upwards",
            set("machine.gravity_mps2", "-9.8"),
            "machine.gravity_mps2",
            "-9.8 m/s² is outside",
            "0 to 20 m/s²",
        ),
        case(
            "mount circle of 1 mm",
            set("machine.mount_radius_mm", "1"),
            "machine.mount_radius_mm",
            "1 mm is outside",
            "10 to 5000 mm",
        ),
    ]);
}

#[test]
fn mechanisms() {
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
fn crank_rockers() {
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
fn lambda_and_the_rod() {
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

#[test]
fn crushers() {
    let crusher = library::find("jaw-crusher").unwrap().text;
    let with = |from: &str, to: &str| {
        assert!(crusher.contains(from), "{from}");
        crusher.replacen(from, to, 1)
    };
    assert_all_refused(&[
        case(
            "crusher whose shaft cannot turn",
            with("toggle_mm = 250", "toggle_mm = 5"),
            "crusher.ground_mm",
            "the shaft cannot turn all round",
            "change it, or the lengths",
        ),
        case(
            "crusher with two axes",
            with("count = 1", "count = 2"),
            "axes.count",
            "2",
            "1",
        ),
        case(
            "crusher with a force below its jaw's end",
            with("jaw_centre_mm = 463.4", "jaw_centre_mm = 900"),
            "crusher.jaw_centre_mm",
            "outside 0 to 800",
            "0 to 800",
        ),
        case(
            "crusher whose rock ends before it begins",
            with("rock_turns = [24, 54]", "rock_turns = [24, 20]"),
            "crusher.rock_turns[1]",
            "outside 24 to",
            "24",
        ),
        case(
            "induction drive without its motor",
            with(
                "induction = {",
                "servo = { velocity_gain_nms = 5, limit_nm = 5 } # {",
            ),
            "axes.servo.position_gain_per_s",
            "missing",
            "",
        ),
        case(
            "induction motor without its drive",
            with("drive = \"induction\"", "drive = \"pulse-servo\""),
            "axes.induction",
            "no axis here has drive = \"induction\"",
            "leave it out",
        ),
        case(
            "motor without slip",
            with("rated_slip_hz = 0.1351", "rated_slip_hz = 0"),
            "axes.induction.rated_slip_hz",
            "outside",
            "0.0001",
        ),
        case(
            "crusher that tilts",
            with("common_limit_deg = 25", "tilt_limit_mrad = 1 #"),
            "drift.tilt_limit_mrad",
            "[crusher] has none",
            "leave it out",
        ),
        case(
            "crusher with torque setpoints",
            with("drive = \"induction\"", "drive = \"servo\""),
            "axes.drive",
            "knows no torque of a jaw crusher",
            "takes STEP and DIR",
        ),
    ]);
}

#[test]
fn five_bar_arms() {
    let arm = library::find("five-bar").unwrap().text;
    let with = |from: &str, to: &str| {
        assert!(arm.contains(from), "{from}");
        arm.replacen(from, to, 1)
    };
    let path = "path_mm = [[0, 300], [200, 300]]";
    assert_all_refused(&[
        case(
            "path out of reach",
            with(path, "path_mm = [[450, 300], [0, 300]]"),
            "five_bar.path_mm",
            "from the axis, and links 1 and 4 reach 500 mm",
            "lengthen the links",
        ),
        case(
            "path through the axis",
            with(path, "path_mm = [[-100, 0.001], [100, 0.001]]"),
            "five_bar.path_mm",
            "nearly singular there",
            "move the path or lower the margin",
        ),
        case(
            "path to the edge of the reach",
            with(path, "path_mm = [[0, 300], [0, 499]]"),
            "five_bar.path_mm",
            "below five_bar.margin = 0.2",
            "move the path",
        ),
        case(
            "path of one point",
            with(path, "path_mm = [[0, 300]]"),
            "five_bar.path_mm",
            "fewer than two points",
            "give the points",
        ),
        case(
            "line that is too short for its blends",
            with(path, "path_mm = [[0, 300], [5, 300]]"),
            "five_bar.path_mm",
            "too short for blends",
            "shorten the blends",
        ),
        case(
            "surface along a triangle",
            with(path, "path_mm = [[0, 300], [200, 300], [100, 350]]"),
            "five_bar.contact",
            "more than two points",
            "give two",
        ),
        case(
            "arm with three motors",
            with("count = 2", "count = 3"),
            "axes.count",
            "is not 2",
            "a five-bar arm has",
        ),
        case(
            "arm with a table of its own",
            with(
                "[control]",
                "[[cam_table]]\nname = \"x\"\nsegment = [{ deg = 100 }]\n[control]",
            ),
            "cam_table[0]",
            "makes the tables of both joints",
            "leave it out",
        ),
        case(
            "arm without a mass",
            with(
                "links_kg = [1.2, 0.6, 0.6, 1.0]",
                "links_kg = [1.2, 0, 0.6, 1.0]",
            ),
            "five_bar.links_kg[1]",
            "outside",
            "0.001",
        ),
        case(
            "program level that is too fast",
            with("ramp_s = 1\n", "amax_g = 1\nramp_s = 1\n"),
            "program[0].amax_g",
            "over limits.speed_hz",
            "give at most",
        ),
    ]);
}
