//! The proof that no panic can be reached from given functions, and a bound on their stack.
//!
//! Words: the *root* is the function from which everything is walked. A function *may call* what it calls or
//! jumps to, and every function whose address stands among its literals. A *panic* is a function that
//! belongs to Rust's or defmt's panics, or a trap.
//!
//! The proof is as good as its reading: code is what mapping symbols say that it is; a call through a
//! register to an unknown place counts as forbidden, until an entry of the allow file bounds it; interrupts
//! are no part of the walk, nor are faults of the processor. The stack is without interrupts' frames.

mod allow;
mod flow;
mod graph;
mod thumb;

use std::io::Write;
use std::path::Path;

use crate::error::Error;
use crate::image::Image;
use crate::name;
use allow::Allowed;
use flow::Callee;
use graph::{Graph, Reached, Stack};

/// Functions whose names a pattern matches.
pub fn find(image: &Image, pattern: &str) -> Vec<usize> {
    let is = |names: &[String]| names.iter().any(|name| name::matches(pattern, name));
    (0..image.functions.len())
        .filter(|&function| is(&image.functions[function].names))
        .collect()
}

/// The command: walks from every function that a root matches and prints what is reached.
///
/// False if a panic, or code that is not known, can be reached, or an entry of the allow file is of no use.
///
/// # Errors
/// Files that cannot be read; a root that matches nothing.
pub fn check(elf: &Path, patterns: &[String], allow: Option<&Path>) -> Result<bool, Error> {
    let image = Image::read(elf)?;
    let mut allowed = match allow {
        Some(path) => Allowed::read(path, &image)?,
        None => Allowed::default(),
    };
    let mut roots = Vec::new();
    for pattern in patterns {
        let found = find(&image, pattern);
        if found.is_empty() {
            return Err(Error::NoRoot(pattern.clone(), near(&image, pattern)));
        }
        roots.extend(
            found
                .into_iter()
                .filter(|root| !roots.contains(root))
                .collect::<Vec<_>>(),
        );
    }
    if roots.is_empty() {
        return Err(Error::NothingToCheck);
    }
    let mut out = std::io::stdout().lock();
    let mut holds = true;
    let mut graph = Graph::new(&image, &mut allowed);
    for root in roots {
        let reached = graph.reach(root);
        holds &= reached.forbidden.is_empty();
        print(&mut out, &image, root, &reached)?;
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

fn print(out: &mut impl Write, image: &Image, root: usize, reached: &Reached) -> Result<(), Error> {
    let name = |function: usize| image.functions[function].name();
    writeln!(out, "{}", name(root))?;
    writeln!(out, "  functions reached: {}", reached.functions)?;
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

/// Names that share a pattern's last segment, for whoever gave a wrong root.
fn near(image: &Image, pattern: &str) -> String {
    let plain = name::plain(pattern);
    let last = plain.rsplit("::").next().unwrap_or(&plain);
    let mut found: Vec<&str> = find(image, last)
        .into_iter()
        .map(|function| image.functions[function].names[0].as_str())
        .collect();
    found.truncate(3);
    if found.is_empty() {
        String::new()
    } else {
        format!(". Names alike: {}", found.join(", "))
    }
}
