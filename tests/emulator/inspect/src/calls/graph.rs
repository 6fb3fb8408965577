//! Walk of the call graph: functions reached from a root, the shortest path to each, and the depth of the stack.

use std::collections::{BTreeMap, VecDeque};

use super::allow::Allowed;
use super::flow::{Body, Callee};
use crate::firmware::Firmware;
use crate::name;

/// The call graph of a firmware, built as far as the walk has come.
pub struct Graph<'a> {
    firmware: &'a Firmware,
    allowed: &'a mut Allowed,
    /// Calls of each function less the allowed ones, with the depth of its own stack then.
    bodies: BTreeMap<usize, Calls>,
}

/// Calls of one function.
#[derive(Clone, Debug)]
struct Calls {
    calls: Vec<(Callee, u32)>,
    depth: Option<u32>,
}

/// Result of a walk from one root.
#[derive(Clone, Debug)]
pub struct Reached {
    /// Functions that are reached, with the root and without panics, and the first caller of each. The root's
    /// caller is itself.
    pub functions: BTreeMap<usize, usize>,
    /// Forbidden calls that are reached: for each the functions of its path, root first, and its callee.
    pub forbidden: Vec<(Vec<usize>, Callee)>,
    /// Depth of the stack.
    pub stack: Stack,
}

/// Depth of the stack; panics and allowed calls are not counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stack {
    /// An upper bound in bytes, and the path of functions with the share of each.
    Bytes(u32, Vec<(usize, u32)>),
    /// No bound is known; the reason.
    Unbounded(String),
}

impl<'a> Graph<'a> {
    /// Makes the graph of a firmware, less the edges that are allowed.
    pub fn new(firmware: &'a Firmware, allowed: &'a mut Allowed) -> Self {
        Self {
            firmware,
            allowed,
            bodies: BTreeMap::new(),
        }
    }

    /// Walks from a root.
    pub fn reach(&mut self, root: usize) -> Reached {
        let mut from = BTreeMap::from([(root, root)]);
        let mut waiting = VecDeque::from([root]);
        let mut forbidden = Vec::new();
        while let Some(function) = waiting.pop_front() {
            for (callee, _) in self.calls(function).calls {
                match callee {
                    Callee::Function(next) if !self.is_panic(next) => {
                        from.entry(next).or_insert_with(|| {
                            waiting.push_back(next);
                            function
                        });
                    }
                    end => forbidden.push((path(&from, root, function), end)),
                }
            }
        }
        forbidden.sort_by_key(|(path, _)| path.len());
        let mut known = BTreeMap::new();
        let stack = match self.stack(root, &mut Vec::new(), &mut known) {
            Err(why) => Stack::Unbounded(why),
            Ok(bytes) => Stack::Bytes(bytes, deepest(root, &known)),
        };
        Reached {
            functions: from,
            forbidden,
            stack,
        }
    }

    /// Follows a thunk to its function: the linker reaches between flash and RAM by way of *thunks*, which only
    /// jump to the function whose address they hold.
    fn through(&self, callee: Callee) -> Callee {
        let Callee::Function(thunk) = callee else {
            return callee;
        };
        let thunk = &self.firmware.functions[thunk];
        if !thunk.names.iter().any(|name| name::is_thunk(name)) {
            return callee;
        }
        let body = Body::new(self.firmware, thunk);
        body.calls.into_keys().next().unwrap_or(Callee::Unknown)
    }

    fn is_panic(&self, function: usize) -> bool {
        let names = &self.firmware.functions[function].names;
        names.iter().any(|name| name::is_panic(name))
    }

    fn calls(&mut self, function: usize) -> Calls {
        if let Some(calls) = self.bodies.get(&function) {
            return calls.clone();
        }
        let body = Body::new(self.firmware, &self.firmware.functions[function]);
        let mut calls = Vec::new();
        for (callee, depth) in body.calls {
            let callee = self.through(callee);
            match self.allowed.take(self.firmware, function, callee) {
                None => calls.push((callee, depth)),
                Some(instead) => calls.extend(instead.into_iter().map(|callee| (callee, depth))),
            }
        }
        let depth = body.depth;
        let calls = Calls { calls, depth };
        self.bodies.insert(function, calls.clone());
        calls
    }

    /// The depth of the stack below a function; `above` holds its callers. `known`: depth, own part of it, and
    /// the deepest callee.
    fn stack(
        &mut self,
        function: usize,
        above: &mut Vec<usize>,
        known: &mut BTreeMap<usize, (u32, u32, Option<usize>)>,
    ) -> Result<u32, String> {
        if let Some(&(bytes, ..)) = known.get(&function) {
            return Ok(bytes);
        }
        let name = self.firmware.functions[function].name();
        if above.contains(&function) {
            return Err(format!(
                "{name} may call itself, directly or through others"
            ));
        }
        let body = self.calls(function);
        let Some(own) = body.depth else {
            return Err(format!(
                "{name} moves its stack by amounts that are not constant"
            ));
        };
        let mut max = (own, own, None);
        above.push(function);
        for (callee, depth) in body.calls {
            match callee {
                Callee::Function(next) if !self.is_panic(next) => {
                    let bytes = depth + self.stack(next, above, known)?;
                    if bytes > max.0 {
                        max = (bytes, depth, Some(next));
                    }
                }
                Callee::Unknown | Callee::Nowhere(_) => {
                    return Err(format!("{name} calls what is not known"));
                }
                Callee::Function(_) | Callee::Trap => {}
            }
        }
        above.pop();
        known.insert(function, max);
        Ok(max.0)
    }
}

fn path(from: &BTreeMap<usize, usize>, root: usize, end: usize) -> Vec<usize> {
    let mut path = vec![end];
    let mut at = end;
    while at != root {
        at = from[&at];
        path.push(at);
    }
    path.reverse();
    path
}

fn deepest(root: usize, known: &BTreeMap<usize, (u32, u32, Option<usize>)>) -> Vec<(usize, u32)> {
    let mut path = Vec::new();
    let mut at = Some(root);
    while let Some(function) = at {
        let (_, own, next) = known[&function];
        path.push((function, own));
        at = next;
    }
    path
}
