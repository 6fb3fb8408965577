//! Call graph of the linked firmware, and the depth of its stack.
//!
//! Words: the *root* is the function from which everything is walked. A function *may call* what it calls or
//! jumps to, and every function whose address stands among its literals.
//!
//! The walk is as good as its reading: code is what mapping symbols say that it is; interrupts are no part of
//! it, nor are faults of the processor. The stack is without interrupts' frames.

pub mod allow;
pub mod flow;
pub mod graph;
mod thumb;

use crate::error::Error;
use crate::image::Image;
use crate::name;

/// Functions whose names a pattern matches.
pub fn find(image: &Image, pattern: &str) -> Vec<usize> {
    let is = |names: &[String]| names.iter().any(|name| name::matches(pattern, name));
    (0..image.functions.len())
        .filter(|&function| is(&image.functions[function].names))
        .collect()
}

/// The roots that patterns match, each once, in the patterns' order.
///
/// # Errors
/// A pattern that matches nothing; none at all.
pub fn roots(image: &Image, patterns: &[String]) -> Result<Vec<usize>, Error> {
    let mut roots = Vec::new();
    for pattern in patterns {
        let found = find(image, pattern);
        if found.is_empty() {
            return Err(Error::NoRoot(pattern.clone(), near(image, pattern)));
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
