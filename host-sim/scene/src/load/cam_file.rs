//! Points of a cam table from a CSV file.
//!
//! Each row has one number, the position of the axis in turns, or two: the phase of the master and the position, both in turns. Points are
//! equally spaced over the turn, and the first is at phase 0. A row at phase 1 closes the curve: it must be the net travel further
//! than the first. A first row of words is a heading; empty rows and those that begin with `#` are skipped.

use std::path::Path;

use cophase_core::axes::{MAX_CAM_POINTS, MIN_CAM_POINTS};

use crate::SceneError;
use crate::file::{CamTable, Scene};
use crate::input_file::{self, Unreadable};

/// Difference up to which two phases or positions are equal, turns: the rounding of six decimals.
const SAME_TURNS: f64 = 2e-6;
/// Position of an axis, turns, from which a message asks for its unit: few machines turn a screw so far.
const LIKE_DEGREES: f64 = 30.0;
/// Largest size of a file, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Reads the files of all cam tables of a scene in `folder`, if it is in one.
pub(super) fn read_all(scene: &mut Scene, folder: Option<&Path>) -> Result<(), SceneError> {
    for (entry, table) in scene.cam_table.iter_mut().enumerate() {
        let Some(name) = &table.file else {
            continue;
        };
        let read = folder
            .ok_or_else(|| {
                " cannot be opened: the scene is text without a folder; give the curve as [[cam_table.segment]]".to_owned()
            })
            .and_then(|folder| read_text(&folder.join(name)))
            .and_then(|text| points(&text, table));
        table.points_turns = read.map_err(|problem| {
            SceneError::for_key(
                format!("cam_table[{entry}].file"),
                format!("{name}{problem}"),
            )
        })?;
    }
    Ok(())
}

fn read_text(path: &Path) -> Result<String, String> {
    input_file::read_text(path, MAX_BYTES).map_err(|error| {
        let fix = match &error {
            Unreadable::Open(_) => "its path is relative to the scene's folder".to_owned(),
            Unreadable::TooLarge(_) => format!("a table has at most {MAX_CAM_POINTS} rows"),
            _ => "give a CSV file".to_owned(),
        };
        format!(" {error}; {fix}")
    })
}

/// Row of a file: its line, and its numbers.
struct Row {
    line: usize,
    phase: Option<f64>,
    turns: f64,
}

/// Points of a file, or the problem with it, in a sentence that follows the name of the file.
fn points(text: &str, table: &CamTable) -> Result<Vec<f64>, String> {
    let mut rows = rows(text)?;
    close(&mut rows, f64::from(table.net_turns))?;
    if !(MIN_CAM_POINTS..=MAX_CAM_POINTS).contains(&rows.len()) {
        return Err(format!(
            " has {} points; a table has {MIN_CAM_POINTS} to {MAX_CAM_POINTS}, equally spaced over a turn of the master",
            rows.len()
        ));
    }
    let count = rows.len() as f64;
    for (i, row) in rows.iter().enumerate() {
        let due = i as f64 / count;
        if row
            .phase
            .is_some_and(|phase| (phase - due).abs() > SAME_TURNS)
        {
            let phase = row.phase.unwrap_or_default();
            let is = |scale: f64| (phase - due * scale).abs() <= SAME_TURNS * scale;
            let max = rows.iter().map(|row| row.turns.abs()).fold(0.0, f64::max);
            let fix = if is(360.0) && max >= LIKE_DEGREES {
                &format!(
                    "the first column has degrees; divide them by 360, as it is in turns, and so is the second one: its {max} look like degrees or mm, so divide it by 360, or by the screw's lead"
                )
            } else if is(360.0) {
                "the first column has degrees; divide them by 360, as it is in turns"
            } else if is(std::f64::consts::TAU) {
                "the first column has radians; divide them by 2π, as it is in turns"
            } else if is(count) {
                "the first column has numbers of rows; leave it out, or give the master's turns"
            } else {
                "space them equally, from 0 on"
            };
            return Err(format!(
                ":{}: the master's phase is {phase}, where that of {count} equally spaced points is {due:.6}; {fix}",
                row.line,
            ));
        }
    }
    Ok(rows.into_iter().map(|row| row.turns).collect())
}

/// Removes the row at phase 1, which repeats the first one a turn later.
fn close(rows: &mut Vec<Row>, net_turns: f64) -> Result<(), String> {
    let closes = |row: &Row| {
        row.phase
            .is_some_and(|phase| (phase - 1.0).abs() <= SAME_TURNS)
    };
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Ok(());
    };
    if !closes(last) {
        return Ok(());
    }
    let travel = last.turns - first.turns;
    if (travel - net_turns).abs() > SAME_TURNS {
        let meant = meant_net_turns(travel, SAME_TURNS);
        return Err(format!(
            ":{}: the axis is {travel} turns from where it was at phase 0, and net_turns = {net_turns}; {meant}a table must close, so change one of the two",
            last.line
        ));
    }
    rows.pop();
    Ok(())
}

fn rows(text: &str) -> Result<Vec<Row>, String> {
    let mut rows: Vec<Row> = Vec::new();
    let mut is_first = true;
    for (line, source) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let source = source.trim();
        if source.is_empty() || source.starts_with('#') {
            continue;
        }
        if let Some(number) = decimal_comma(source) {
            return Err(format!(
                ":{line}: `{number}` has a decimal comma; write `{}`, and a comma between two columns",
                number.replace(',', ".")
            ));
        }
        let fields: Vec<&str> = source.split([',', ';', '\t']).map(str::trim).collect();
        let numbers: Result<Vec<f64>, _> =
            fields.iter().map(|field| field.parse::<f64>()).collect();
        let is_heading = std::mem::take(&mut is_first)
            && fields.iter().all(|field| field.parse::<f64>().is_err());
        let row = match numbers.as_deref() {
            _ if is_heading => continue,
            Ok(&[turns]) => Row {
                line,
                phase: None,
                turns,
            },
            Ok(&[phase, turns]) => Row {
                line,
                phase: Some(phase),
                turns,
            },
            Ok(many) => {
                return Err(format!(
                    ":{line}: {} numbers; give the axis's turns, or the master's turns and the axis's",
                    many.len()
                ));
            }
            Err(_) => {
                return Err(format!(
                    ":{line}: not a number; give the axis's turns, or the master's turns and the axis's, with a comma between"
                ));
            }
        };
        if !row.turns.is_finite() || row.phase.is_some_and(|phase| !phase.is_finite()) {
            return Err(format!(":{line}: not a finite number"));
        }
        if rows
            .first()
            .is_some_and(|first| first.phase.is_some() != row.phase.is_some())
        {
            return Err(format!(
                ":{line}: one number and two numbers in the same file; give the same in every row"
            ));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Returns a number with a decimal comma. In a row without other separators it is one if zeros follow the comma: `0,031904`.
fn decimal_comma(source: &str) -> Option<&str> {
    let cells = || source.split([';', '\t']).map(str::trim);
    let is_alone = cells().count() == 1;
    cells().find(|cell| {
        let Some((whole, fraction)) = cell.split_once(',') else {
            return false;
        };
        let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let has_zeros = fraction.len() > 1 && fraction.starts_with('0');
        is_digits(whole.trim_start_matches(['-', '+']))
            && is_digits(fraction)
            && (!is_alone || has_zeros)
    })
}

/// Returns the question for the net travel that was meant, if `travel` is whole turns within `rounding`; else nothing.
pub fn meant_net_turns(travel: f64, rounding: f64) -> String {
    if (travel - travel.round()).abs() > rounding {
        return String::new();
    }
    format!("did you mean net_turns = {}? ", travel.round())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(net_turns: i32) -> CamTable {
        CamTable {
            net_turns,
            ..CamTable::of_points("t", Vec::new())
        }
    }

    #[test]
    fn tables_of_one_or_two_columns_are_read() {
        let expected = vec![0.0, 0.5, 1.0, 0.25];
        for text in [
            "0\n0.5\n1\n0.25\n",
            "axis_turns\n# lift\n0\n0.5\n\n1\n0.25",
            "\u{feff}master_turns,axis_turns\r\n0,0\r\n0.25,0.5\r\n0.5,1\r\n0.75,0.25\r\n",
            "0;0\n0.25;0.5\n0.5;1\n0.75;0.25\n1;0\n",
        ] {
            assert_eq!(points(text, &table(0)), Ok(expected.clone()), "{text}");
        }
        assert_eq!(
            points("0,0\n0.25,0.5\n0.5,1\n0.75,0.25\n1,-2\n", &table(-2)),
            Ok(expected)
        );
    }

    /// If this fails, an invalid table is accepted, and an axis follows another curve than the user's.
    #[test]
    fn an_invalid_table_is_refused_with_its_line() {
        for (text, said) in [
            ("0\n1\n", " has 2 points"),
            ("", " has 0 points"),
            ("turns\n0\nx\n", ":3: not a number"),
            ("0,1,2\n", ":1: 3 numbers"),
            ("0\n0,1\n", ":2: one number and two"),
            ("0\nNaN\n", ":2: not a finite"),
            (
                "0,0\n0.2,1\n0.5,1\n0.75,0\n",
                ":2: the master's phase is 0.2, where",
            ),
            (
                "0,0\n0.25,1\n0.5,1\n0.75,0\n1,0.5\n",
                ":5: the axis is 0.5 turns",
            ),
            (
                "0,000000\n0,031904\n0,126645\n",
                ":1: `0,000000` has a decimal comma; write `0.000000`",
            ),
            (
                "master;axis\n0;0\n0,25;0,5\n",
                ":3: `0,25` has a decimal comma; write `0.25`",
            ),
            (
                "0,0\n90,1\n180,2\n270,1\n",
                ":2: the master's phase is 90, where that of 4 equally spaced points is 0.250000; the first column has degrees",
            ),
            (
                "0,0\n90,100\n180,200\n270,100\n",
                ":2: the master's phase is 90, where that of 4 equally spaced points is 0.250000; the first column has degrees; divide them by 360, as it is in turns, and so is the second one: its 200 look like degrees or mm",
            ),
            (
                "0,0\n1.5707963,1\n3.1415927,2\n4.712389,1\n",
                ":2: the master's phase is 1.5707963, where that of 4 equally spaced points is 0.250000; the first column has radians",
            ),
            (
                "0,0\n1,1\n2,2\n3,1\n",
                ":2: the master's phase is 1, where that of 4 equally spaced points is 0.250000; the first column has numbers of rows",
            ),
        ] {
            let problem = points(text, &table(0)).unwrap_err();
            assert!(problem.starts_with(said), "{text:?}: {problem}");
        }
    }
}
