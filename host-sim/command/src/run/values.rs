//! Values of the options of `cophase run`.

use std::net::{SocketAddr, ToSocketAddrs};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use cophase_files::trace::{Format, Window};
use cophase_scene::file::MAX_S;

use crate::address::Parts;
use cophase_lab::numbers::{in_range, meant};

pub(crate) fn window(text: &str) -> Result<Window, String> {
    if text == "all" {
        return Ok(Window::All);
    }
    let wrong = || {
        let form = "give FROM..TO in seconds, 0 or later";
        let ends = text.split_once("..");
        let meant = ends.and_then(|(from, to)| meant(from, Some("s")).zip(meant(to, Some("s"))));
        match meant {
            Some((from, to)) if 0.0 <= from && from < to && to <= MAX_S => {
                format!("{form}, without a unit, with a point for fractions: {from}..{to}")
            }
            _ => format!("{form}, such as 2.5..2.6, or `all`"),
        }
    };
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let seconds = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|s| (0.0..=MAX_S).contains(s))
    };
    let (from_s, to_s) = seconds(from).zip(seconds(to)).ok_or_else(wrong)?;
    if to_s <= from_s {
        return Err(format!(
            "it ends at {to_s} s, not after its beginning at {from_s} s; swap the two"
        ));
    }
    Ok(Window::seconds(from_s, to_s))
}

/// A format of a trace, by its name.
pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::ALL.map(Format::name)).try_map(|name| {
        let named = Format::ALL.into_iter().find(|format| format.name() == name);
        named.ok_or("no such format")
    })
}

pub(super) fn receiver(text: &str) -> Result<SocketAddr, String> {
    let parts = Parts::parse(text);
    if let Some(problem) = parts.problem() {
        let full = parts.full();
        return Err(format!(
            "{problem}; give {full} of the receiver, such as 127.0.0.1:9870"
        ));
    }
    let mut addresses = (text.to_socket_addrs()).map_err(|error| {
        format!("{error}; give HOST:PORT of the receiver, such as 127.0.0.1:9870")
    })?;
    addresses
        .next()
        .ok_or_else(|| "no such receiver; give HOST:PORT, such as 127.0.0.1:9870".to_owned())
}

pub(super) fn speed(text: &str) -> Result<f64, String> {
    in_range(
        text,
        1e-3..=1e3,
        "x",
        "give simulated seconds per second, 0.001 to 1000",
    )
}
