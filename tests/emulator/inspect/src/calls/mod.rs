//! Call graph of the linked firmware, and the depth of its stack.
//!
//! Words: the *root* is the function from which everything is walked. A function *may call* its callees, its
//! jump targets, and every function whose address is among its literals.
//!
//! The walk depends on its reading: mapping symbols determine which bytes are code. Interrupts and faults of
//! the processor are not part of it. The stack is without interrupts' frames.

pub mod allow;
pub mod flow;
pub mod graph;
mod thumb;

use crate::error::Error;
use crate::firmware::Firmware;
use crate::name;

/// Functions whose names a pattern matches.
pub fn find(firmware: &Firmware, pattern: &str) -> Vec<usize> {
    let is = |names: &[String]| names.iter().any(|name| name::matches(pattern, name));
    (0..firmware.functions.len())
        .filter(|&function| is(&firmware.functions[function].names))
        .collect()
}

/// The roots that patterns match, each once, in the patterns' order.
///
/// # Errors
/// A pattern that matches nothing; none at all.
pub fn roots(firmware: &Firmware, patterns: &[String]) -> Result<Vec<usize>, Error> {
    let mut roots = Vec::new();
    for pattern in patterns {
        let found = find(firmware, pattern);
        if found.is_empty() {
            return Err(Error::NoRoot(pattern.clone(), near(firmware, pattern)));
        }
        for root in found {
            if !roots.contains(&root) {
                roots.push(root);
            }
        }
    }
    if roots.is_empty() {
        return Err(Error::NothingToCheck);
    }
    Ok(roots)
}

/// Names that share a pattern's last segment, for the message about a wrong root.
fn near(firmware: &Firmware, pattern: &str) -> String {
    let plain = name::plain(pattern);
    let last = plain.rsplit("::").next().unwrap_or(&plain);
    let mut found: Vec<&str> = find(firmware, last)
        .into_iter()
        .map(|function| firmware.functions[function].names[0].as_str())
        .collect();
    found.truncate(3);
    if found.is_empty() {
        String::new()
    } else {
        format!(". Names alike: {}", found.join(", "))
    }
}
