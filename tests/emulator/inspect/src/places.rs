//! The check that all code that must not wait for the flash lies in RAM.
//!
//! Calls through a register to an unknown place are not followed: their possible callees must be given as
//! roots. Panics are not followed either.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use crate::calls::allow::Allowed;
use crate::calls::graph::Graph;
use crate::calls::roots;
use crate::error::Error;
use crate::firmware::{Firmware, in_ram};

/// The command: walks from every function that a root matches, and names the functions outside RAM.
///
/// False if there are any.
///
/// # Errors
/// A file that cannot be read; a root that matches nothing.
pub fn check(elf: &Path, patterns: &[String]) -> Result<bool, Error> {
    let firmware = Firmware::read(elf)?;
    let mut none = Allowed::default();
    let mut graph = Graph::new(&firmware, &mut none);
    let mut reached = BTreeMap::new();
    for root in roots(&firmware, patterns)? {
        reached.extend(graph.reach(root).functions);
    }
    let mut out = std::io::stdout().lock();
    let mut holds = true;
    for (&function, &by) in &reached {
        let Some(found) = firmware.functions.get(function) else {
            continue;
        };
        if !in_ram(found.address) {
            holds = false;
            let (name, by) = (found.name(), firmware.functions[by].name());
            writeln!(out, "NOT IN RAM {name}, which is called by {by}")?;
        }
    }
    writeln!(out, "functions reached: {}", reached.len())?;
    Ok(holds)
}
