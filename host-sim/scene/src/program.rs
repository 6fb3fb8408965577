//! Conversion of a scene's program, with its levels and blocks, into the core's flat list of entries.

use cophase_core::problem::{Problem, SettingsError};
use cophase_core::program::{CAPACITY, EntrySettings, SegmentSettings, Shape as ProgramShape};

use crate::SceneError;
use crate::digits::hundredths;
use crate::file::{self, Segment};
use crate::units::STANDARD_GRAVITY_MPS2;

/// Greatest nesting of blocks, which is still readable.
const MAX_NESTING: usize = 8;

/// Entry, and its key path in the file.
pub type Placed = (EntrySettings, String);

/// Returns all entries of a program. The repeat of a block comes after its entries.
///
/// # Errors
/// An entry is neither level nor block, or there are too many entries.
pub fn flat(entries: &[Segment]) -> Result<Vec<Placed>, SceneError> {
    let mut all = Vec::new();
    append(&mut all, entries, "program", 0)?;
    Ok(all)
}

fn append(
    all: &mut Vec<Placed>,
    entries: &[Segment],
    path: &str,
    depth: usize,
) -> Result<(), SceneError> {
    if depth > MAX_NESTING {
        return Err(SceneError::for_key(
            path,
            format!("blocks are nested more than {MAX_NESTING} deep; write some of them out"),
        ));
    }
    for (i, entry) in entries.iter().enumerate() {
        let here = format!("{path}[{i}]");
        let flat = match block_or_level(entry, &here)? {
            Entry::Block { segments, times } => {
                let first = all.len() as u8; // no overflow: at most CAPACITY
                append(all, segments, &format!("{here}.segments"), depth + 1)?;
                EntrySettings::Repeat { first, times }
            }
            Entry::Level(amax_g) => EntrySettings::Segment(SegmentSettings {
                amax_mps2: amax_g * STANDARD_GRAVITY_MPS2,
                ramp_s: entry.ramp_s.unwrap_or(0.0),
                hold_s: entry.hold_s.unwrap_or(0.0),
                shape: match entry.shape.unwrap_or(file::Shape::Smooth) {
                    file::Shape::Linear => ProgramShape::Linear,
                    file::Shape::Smooth => ProgramShape::Smooth,
                },
            }),
        };
        if all.len() == CAPACITY {
            return Err(SceneError::from_problem(
                here,
                Problem::ProgramTooLong(CAPACITY + 1, CAPACITY),
            ));
        }
        all.push((flat, here));
    }
    Ok(())
}

const _: () = assert!(CAPACITY <= 255, "an entry's number fits a byte");

/// Returns the core's error about an entry at its key in the file; `None` for errors that concern no entry.
pub fn placed(entries: &[Segment], error: &SettingsError) -> Option<SceneError> {
    let name = error.key.strip_prefix("program")?;
    let all = flat(entries).ok()?;
    let (_, path) = all.get(error.entry?)?;
    Some(match name {
        ".amax_mps2" => in_g(format!("{path}.amax_g"), error.problem),
        _ => SceneError::from_problem(format!("{path}{name}"), error.problem),
    })
}

/// Converts a problem with a level from the core's m/s² into the file's g.
fn in_g(key: String, problem: Problem) -> SceneError {
    let g = |mps2: f64| mps2 / STANDARD_GRAVITY_MPS2;
    match problem {
        Problem::LevelOutOfReach {
            requested_mps2,
            needed_hz,
            limit_hz,
            max_mps2,
        } => SceneError::for_key(
            key,
            format!(
                "{} g ({requested_mps2:.2} m/s²) needs {needed_hz:.3} rev/s, over limits.speed_hz = {limit_hz}; \
                 give at most {} g, or raise limits.speed_hz",
                hundredths(g(requested_mps2), f64::round),
                // Rounded down, so that the suggested value is accepted.
                hundredths(g(max_mps2), f64::floor)
            ),
        ),
        other => SceneError::from_problem(key, other),
    }
}

enum Entry<'a> {
    Level(f64),
    Block { segments: &'a [Segment], times: u32 },
}

fn block_or_level<'a>(entry: &'a Segment, path: &str) -> Result<Entry<'a>, SceneError> {
    let key = |name: &str| format!("{path}.{name}");
    match (entry.amax_g, &entry.segments, entry.repeat) {
        (Some(amax_g), None, None) => Ok(Entry::Level(amax_g)),
        (None, Some(segments), Some(times)) => {
            for (name, given) in [
                ("ramp_s", entry.ramp_s.is_some()),
                ("hold_s", entry.hold_s.is_some()),
                ("shape", entry.shape.is_some()),
            ] {
                if given {
                    return Err(SceneError::for_key(
                        key(name),
                        "belongs to a level, not to a block that is repeated; put it into the block's segments",
                    ));
                }
            }
            Ok(Entry::Block { segments, times })
        }
        (None, None, None) => Err(SceneError::for_key(
            key("amax_g"),
            "missing; give the level to go to, or `repeat` and `segments`",
        )),
        (None, Some(_), None) => Err(SceneError::for_key(
            key("repeat"),
            "missing; say how often `segments` are to be played",
        )),
        (None, None, Some(_)) => Err(SceneError::for_key(
            key("segments"),
            "missing; give the block that is to be repeated",
        )),
        (Some(_), _, _) => Err(SceneError::for_key(
            key("amax_g"),
            "given together with a block; a program entry is either a level or a block: split it in two",
        )),
    }
}
