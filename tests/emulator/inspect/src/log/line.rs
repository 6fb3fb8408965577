//! One line of the log, for people and as JSON.

use std::fmt;

use defmt_decoder::{Frame, Locations};
use serde::Serialize;

/// A frame as text.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// The cycle in which the frame's last byte was sent, if the stream has stamps.
    #[serde(skip_serializing_if = "Option::is_none")]
    cycle: Option<u64>,
    /// Text of the firmware's timestamp; none if it has no timestamp.
    timestamp: Option<String>,
    /// `trace` to `error`; none for `println`.
    level: Option<&'static str>,
    message: String,
    /// Location of the statement; none without debug information.
    location: Option<Location>,
}

#[derive(Clone, Debug, Serialize)]
struct Location {
    file: String,
    line: u64,
    module: String,
}

impl Line {
    /// Makes the line of a frame.
    pub fn new(frame: &Frame<'_>, cycle: Option<u64>, locations: &Locations) -> Self {
        Self {
            cycle,
            timestamp: frame.display_timestamp().map(|time| time.to_string()),
            level: frame.level().map(|level| level.as_str()),
            message: frame.display_message().to_string(),
            location: locations.get(&frame.index()).map(|place| Location {
                file: place.file.display().to_string(),
                line: place.line,
                module: place.module.clone(),
            }),
        }
    }
}

/// Cycle, if there is one, time, level and message. A message of many lines continues below.
impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(cycle) = self.cycle {
            write!(f, "{cycle:>12} ")?;
        }
        write!(
            f,
            "{:>10} {:<5} {}",
            self.timestamp.as_deref().unwrap_or("-"),
            self.level.unwrap_or("-"),
            self.message
        )
    }
}
