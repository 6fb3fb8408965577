//! The proof that no panic can be reached from given functions, and a bound on their stack.
//!
//! A *panic* is a function that belongs to Rust's or defmt's panics, or a trap. A call through a register to an
//! unknown place counts as forbidden, until an entry of the allow file bounds it.

use std::io::Write;
use std::path::Path;

use crate::calls::allow::Allowed;
use crate::calls::flow::Callee;
use crate::calls::graph::{Graph, Reached, Stack};
use crate::calls::roots;
use crate::error::Error;
use crate::firmware::Firmware;

/// The command: walks from every function that a root matches and prints the functions that are reached.
///
/// False if a panic or unknown code can be reached, or an entry of the allow file is never used.
///
/// # Errors
/// Files that cannot be read; a root that matches nothing.
pub fn check(elf: &Path, patterns: &[String], allow: Option<&Path>) -> Result<bool, Error> {
    let firmware = Firmware::read(elf)?;
    let mut allowed = match allow {
        Some(path) => Allowed::read(path, &firmware)?,
        None => Allowed::default(),
    };
    let roots = roots(&firmware, patterns)?;
    let mut out = std::io::stdout().lock();
    let mut holds = true;
    let mut graph = Graph::new(&firmware, &mut allowed);
    for root in roots {
        let reached = graph.reach(root);
        holds &= reached.forbidden.is_empty();
        print(&mut out, &firmware, root, &reached)?;
    }
    for (entry, met) in allowed.entries() {
        let (from, to) = (&entry.from, &entry.to);
        if met {
            writeln!(out, "allowed: {from} → {to}: {}", entry.reason)?;
        } else {
            holds = false;
            writeln!(
                out,
                "allowed, but never met: {from} → {to}; delete the entry"
            )?;
        }
    }
    Ok(holds)
}

fn print(
    out: &mut impl Write,
    firmware: &Firmware,
    root: usize,
    reached: &Reached,
) -> Result<(), Error> {
    let name = |function: usize| firmware.functions[function].name();
    writeln!(out, "{}", name(root))?;
    writeln!(out, "  functions reached: {}", reached.functions.len())?;
    match &reached.stack {
        Stack::Unbounded(why) => writeln!(out, "  stack: no bound, as {why}")?,
        Stack::Bytes(bytes, path) => {
            writeln!(out, "  stack: at most {bytes} bytes, of which")?;
            for &(function, own) in path {
                writeln!(out, "    {own:>6} {}", name(function))?;
            }
        }
    }
    if reached.forbidden.is_empty() {
        writeln!(out, "  panics: none")?;
    }
    for (path, end) in &reached.forbidden {
        let end = match *end {
            Callee::Function(panic) => name(panic),
            Callee::Nowhere(address) => format!("unknown: code at {address:#010x}"),
            Callee::Unknown => "unknown: a call through a register".to_owned(),
            Callee::Trap => "trap: an undefined instruction".to_owned(),
        };
        writeln!(out, "  REACHED {end}, by")?;
        for &function in path {
            writeln!(out, "    {}", name(function))?;
        }
    }
    Ok(())
}
