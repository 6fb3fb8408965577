//! Errors in cam tables, in the axes that follow them, and in the screws that these axes turn.

use cophase_scene::library;
use host_sim::setup;

use super::{Case, assert_all_refused, case};

/// Returns the built-in scene of an electronic cam with a part of its text replaced.
#[track_caller]
fn edited(
    name: &'static str,
    from: &str,
    to: &str,
    key: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Case {
    let text = library::find("electronic-cam").unwrap().text;
    assert!(text.contains(from), "the scene has no {from}");
    case(name, text.replacen(from, to, 1), key, wrong, right)
}

#[test]
fn invalid_cam_tables_are_refused() {
    assert_all_refused(&[
        edited(
            "no end",
            "turns = -4.2",
            "turns = -4.1",
            "cam_table[0].net_turns",
            "0 is not the travel of the segments",
            "whole turns further, or back",
        ),
        edited(
            "too long",
            "{ deg = 135 }",
            "{ deg = 136 }",
            "cam_table[0].segment[2].deg",
            "361 of the 360",
            "shorten",
        ),
        edited(
            "neither",
            "segment = [\n  { deg = 120, turns = 4.2 },    # 84 mm at 20 mm a turn\n  { deg = 135 },\n  { deg = 105, turns = -4.2 },\n]\n",
            "",
            "cam_table[0].segment",
            "missing",
            "file =",
        ),
        edited(
            "both",
            "name = \"lobe\"\n",
            "name = \"lobe\"\nfile = \"lobe.csv\"\n",
            "cam_table[0].file",
            "cannot be opened",
            "relative to the scene's folder",
        ),
        edited(
            "two of a name",
            "[control]",
            "[[cam_table]]\nname = \"lobe\"\nsegment = [{ deg = 90 }]\n[control]",
            "cam_table[1].name",
            "name of the 1st [[cam_table]] entry already",
            "lobe",
        ),
        edited(
            "a forgotten net travel",
            "turns = -4.2",
            "turns = -0.2",
            "cam_table[0].net_turns",
            "0 is not the travel of the segments, 4 turns",
            "did you mean net_turns = 4?",
        ),
        edited(
            "too fast",
            "name = \"lobe\"\n",
            "name = \"lobe\"\nmax_speed_hz = 38\n",
            "cam_table[0].max_speed_hz",
            "at limits.speed_hz = 1.5 rev/s the table moves its axes at up to 38.01 rev/s",
            "raise the limit to what the motors reach",
        ),
        edited(
            "too hard",
            "name = \"lobe\"\n",
            "name = \"lobe\"\nmax_acceleration_hz_per_s = 600\n",
            "cam_table[0].max_acceleration_hz_per_s",
            "the table accelerates its axes by up to 6",
            "over larger angles",
        ),
        edited(
            "off its law",
            "{ deg = 120, turns = 4.2 },    # 84 mm at 20 mm a turn\n  { deg = 135 },\n  { deg = 105, turns = -4.2 },",
            "{ deg = 120, turns = 0.1 }, { deg = 15, turns = -0.1 },",
            "cam_table[0].segment[1].deg",
            "15 is too short: the curve through",
            "extend the segment over a larger angle",
        ),
        edited(
            "too steep",
            "{ deg = 120, turns = 4.2 },    # 84 mm at 20 mm a turn\n  { deg = 135 },\n  { deg = 105, turns = -4.2 },",
            "{ deg = 60, turns = 200 }, { deg = 60, turns = -200 },",
            "cam_table[0].points",
            "too steep",
            "larger angles",
        ),
    ]);
}

#[test]
fn invalid_cam_keys_of_axes_are_refused() {
    assert_all_refused(&[
        edited(
            "another name",
            "cam = \"lobe\"\ncam_shift_deg = -90",
            "cam = \"lobes\"\ncam_shift_deg = -90",
            "axis[1].cam",
            "no [[cam_table]] of the name \"lobes\"",
            "did you mean \"lobe\"",
        ),
        edited(
            "a shift of nothing",
            "cam = \"lobe\"\ncam_shift_deg = -90",
            "cam_shift_deg = -90",
            "axis[1].cam_shift_deg",
            "shifts nothing",
            "leave it out",
        ),
        edited(
            "a gear as well",
            "cam_shift_deg = -90",
            "ratio = [1, 2]",
            "axis[1].ratio",
            "given together with cam",
            "leave one out",
        ),
        edited(
            "more than a turn",
            "cam_shift_deg = -90",
            "cam_shift_deg = -361",
            "axis[1].cam_shift_deg",
            "-361° is outside",
            "-360 to 360",
        ),
        edited(
            "an index",
            "index = false",
            "index = true",
            "axes.index",
            "does not pass its index once in each turn",
            "give index = false",
        ),
        edited(
            "too many steps",
            "steps_per_turn = 1600",
            "steps_per_turn = 65536",
            "axis[0].cam",
            "the table and its trims move the axis at up to 38.02",
            "flatten the steepest part",
        ),
    ]);
}

#[test]
fn unsuitable_screw_settings_are_refused() {
    assert_all_refused(&[
        edited(
            "no screw",
            "screw_lead_mm = 20",
            "# screw_lead_mm = 20",
            "axis[0].cam",
            "turns neither a crank nor a cam",
            "cam.screw_lead_mm",
        ),
        edited(
            "no lead",
            "screw_lead_mm = 20",
            "screw_lead_mm = 0",
            "cam.screw_lead_mm",
            "0 mm is outside",
            "0.1 to 1000",
        ),
        edited(
            "no table",
            "number = 0\ncam = \"lobe\"",
            "number = 0",
            "cam.screw_lead_mm",
            "axis 0 has none",
            "cam =",
        ),
        edited(
            "masses",
            "screw_lead_mm = 20",
            "screw_lead_mm = 20\nmasses_kg = [1, 1, 1]\nstiffness_n_per_mm = [1000, 1000, 1000]\nzeta = 0.1",
            "cam.masses_kg",
            "hang on a cam shaft",
            "leave it out",
        ),
        edited(
            "setpoints",
            "drive = \"stepper\"",
            "drive = \"servo\"",
            "axes.drive",
            "axis 0 is a servo",
            "STEP and DIR",
        ),
    ]);
}

/// If this fails, a user who forgets `net_turns` gets an axis that flies back by four turns within a step of the table.
#[test]
fn a_table_from_a_file_without_its_net_travel_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |rows: &str| {
        std::fs::write(folder.path().join("jump.csv"), rows).unwrap();
        let text = library::find("electronic-cam").unwrap().text;
        let (head, rest) = text.split_once("law = \"modified-sine\"\nsegment").unwrap();
        let (_, rest) = rest.split_once("[control]").unwrap();
        let file = folder.path().join("jump.toml");
        std::fs::write(&file, format!("{head}file = \"jump.csv\"\n[control]{rest}")).unwrap();
        setup::checked_from_file(&file)
            .expect_err("a jump")
            .to_string()
    };
    let row = |i: u32| format!("{:.6},{:.6}\n", f64::from(i) / 36.0, f64::from(i) / 9.0);
    // Without a row at phase 1, and with it.
    for (rows, key) in [(36, "cam_table[0].net_turns"), (37, "cam_table[0].file")] {
        let said = scene(&(0..rows).map(row).collect::<String>());
        assert!(said.contains(key), "{said}");
        assert!(said.contains("did you mean net_turns = 4?"), "{said}");
    }
}
