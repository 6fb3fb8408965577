//! A scene's program: levels and blocks, handed to the core's builder.

use cophase_core::program::{ProgramBuilder, SegmentSettings, Shape as ProgramShape};
use cophase_core::settings::{Problem, SettingsError};

use crate::design::STANDARD_GRAVITY_MPS2;
use crate::scene::SceneError;
use crate::scene::file::{self, Segment};

/// Blocks within blocks within blocks: what a person can still read.
const MOST_NESTING: usize = 8;

/// Appends entries to a program, blocks with all that is in them.
pub(super) fn append(
    builder: &mut ProgramBuilder,
    entries: &[Segment],
    path: &str,
    depth: usize,
) -> Result<(), SceneError> {
    if depth > MOST_NESTING {
        return Err(SceneError::at(
            path,
            format!("blocks are nested more than {MOST_NESTING} deep; write some of them out"),
        ));
    }
    for (i, entry) in entries.iter().enumerate() {
        let here = format!("{path}[{i}]");
        // The core knows keys, but not which entry they are of.
        let placed = |error: SettingsError| {
            let key = error.key.strip_prefix("program").unwrap_or(error.key);
            in_g(format!("{here}{key}"), error.problem)
        };
        match block_or_level(entry, &here)? {
            Entry::Block { segments, times } => {
                let first = builder.here();
                append(builder, segments, &format!("{here}.segments"), depth + 1)?;
                builder.repeat(first, times).map_err(placed)?;
            }
            Entry::Level(amax_g) => {
                let settings = SegmentSettings {
                    amax_mps2: amax_g * STANDARD_GRAVITY_MPS2,
                    ramp_s: entry.ramp_s.unwrap_or(0.0),
                    hold_s: entry.hold_s.unwrap_or(0.0),
                    shape: match entry.shape.unwrap_or_default() {
                        file::Shape::Linear => ProgramShape::Linear,
                        file::Shape::Smooth => ProgramShape::Smooth,
                    },
                };
                builder.segment(settings).map_err(placed)?;
            }
        }
    }
    Ok(())
}

/// A problem with a level: the core reckons in m/s², the file in g.
fn in_g(key: String, problem: Problem) -> SceneError {
    let g = |mps2: f64| mps2 / STANDARD_GRAVITY_MPS2;
    match problem {
        Problem::OutOfRange { value, low, high } if key.ends_with(".amax_g") => {
            let (value, low, high) = (g(value), g(low), (g(high) * 10.0).floor() / 10.0);
            SceneError::of(key, Problem::OutOfRange { value, low, high })
        }
        Problem::LevelOutOfReach {
            asked_mps2,
            needed_hz,
            limit_hz,
            most_mps2,
        } => SceneError::at(
            key,
            format!(
                "{:.2} g ({asked_mps2:.2} m/s²) needs {needed_hz:.3} rev/s, over limits.speed_hz = {limit_hz}; \
                 give at most {} g, or raise limits.speed_hz",
                g(asked_mps2),
                // Rounded down, so that what is advised is accepted.
                (g(most_mps2) * 100.0).floor() / 100.0
            ),
        ),
        other => SceneError::of(key, other),
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
                    return Err(SceneError::at(
                        key(name),
                        "belongs to a level, not to a block that is repeated; put it into the block's segments",
                    ));
                }
            }
            Ok(Entry::Block { segments, times })
        }
        (None, None, None) => Err(SceneError::at(
            key("amax_g"),
            "missing; give the level to go to, or `repeat` and `segments`",
        )),
        (None, Some(_), None) => Err(SceneError::at(
            key("repeat"),
            "missing; say how often `segments` are to be played",
        )),
        (None, None, Some(_)) => Err(SceneError::at(
            key("segments"),
            "missing; give the block that is to be repeated",
        )),
        (Some(_), _, _) => Err(SceneError::at(
            key("amax_g"),
            "given together with a block; a program entry is either a level or a block: split it in two",
        )),
    }
}
