//! `steps.vcd`, read back.

use std::collections::{BTreeMap, HashMap};

use vcd::{Command, IdCode, Value};

/// One wire over the window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wire {
    /// Its level at the window's start.
    pub initial: bool,
    /// Its changes, ns since power-up and the level from then on.
    pub changes: Vec<(u64, bool)>,
}

impl Wire {
    /// Its level at a time. A change at exactly that time is included.
    pub fn level_at(&self, ns: u64) -> bool {
        let after = self.changes.partition_point(|&(at, _)| at <= ns);
        after
            .checked_sub(1)
            .map_or(self.initial, |last| self.changes[last].1)
    }

    /// The times of its rising edges.
    pub fn rises(&self) -> impl Iterator<Item = u64> {
        self.changes
            .iter()
            .filter(|(_, level)| *level)
            .map(|(at, _)| *at)
    }

    /// Returns its edges in a window from `from_ns` up to, not including, `to_ns`.
    pub fn cut(&self, from_ns: u64, to_ns: u64) -> Self {
        let before = from_ns
            .checked_sub(1)
            .map_or(self.initial, |ns| self.level_at(ns));
        let inside = self
            .changes
            .iter()
            .filter(|(at, _)| (from_ns..to_ns).contains(at));
        Self {
            initial: before,
            changes: inside.copied().collect(),
        }
    }
}

/// All wires of a file, by name.
#[derive(Clone, Debug)]
pub struct Edges {
    /// The window's start, ns since power-up.
    pub from_ns: u64,
    /// Its end.
    pub to_ns: u64,
    /// The wires.
    pub wires: BTreeMap<String, Wire>,
}

impl Edges {
    /// Reads a whole `steps.vcd`.
    ///
    /// # Panics
    /// If it is not well-formed.
    pub fn read(file: &[u8]) -> Self {
        let mut parser = vcd::Parser::new(file);
        let header = parser.parse_header().expect("a header");
        let scope = header.find_scope(&["cophase"]).expect("module cophase");
        let mut names: HashMap<IdCode, String> = HashMap::new();
        for item in &scope.items {
            if let vcd::ScopeItem::Var(var) = item {
                names.insert(var.code, var.reference.clone());
            }
        }
        let mut wires: BTreeMap<String, Wire> = names
            .values()
            .map(|name| (name.clone(), Wire::default()))
            .collect();
        let (mut from_ns, mut now_ns, mut dump) = (None, 0, false);
        for command in parser {
            match command.expect("a well-formed command") {
                Command::Timestamp(ns) => {
                    assert!(
                        from_ns.is_none() || ns > now_ns,
                        "time goes on: {now_ns}, {ns}"
                    );
                    from_ns.get_or_insert(ns);
                    now_ns = ns;
                }
                Command::Begin(_) => dump = true,
                Command::End(_) => dump = false,
                Command::ChangeScalar(id, value) => {
                    let wire = wires.get_mut(&names[&id]).expect("a declared wire");
                    let level = value == Value::V1;
                    if dump {
                        wire.initial = level;
                    } else {
                        wire.changes.push((now_ns, level));
                    }
                }
                _ => {}
            }
        }
        Self {
            from_ns: from_ns.expect("a timestamp"),
            to_ns: now_ns,
            wires,
        }
    }

    /// A wire by its name.
    ///
    /// # Panics
    /// If there is none.
    pub fn wire(&self, name: &str) -> &Wire {
        self.wires
            .get(name)
            .unwrap_or_else(|| panic!("no wire `{name}`"))
    }

    /// Steps of an axis in the window, in its own sense: rising edges of STEP, with DIR's sign.
    pub fn steps(&self, axis: usize, reversed: bool) -> i64 {
        let dir = self.wire(&format!("dir_{axis}"));
        let step = self.wire(&format!("step_{axis}"));
        let sign = |ns| if dir.level_at(ns) == reversed { -1 } else { 1 };
        step.rises().map(sign).sum()
    }
}
