//! Wires of `steps.vcd`, read back.

use std::collections::{BTreeMap, HashMap};
use std::io::BufReader;
use std::path::Path;

use cophase_scene::input_file::{self, MAX_TABLE_BYTES};
use vcd::{Command, IdCode, ScopeItem, TimescaleUnit, Value};

use super::error::CompareError;

/// Levels of a wire over a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Wire {
    /// Level at the window's start. `None` if the recorder of the run had no access to it.
    pub initial: Option<bool>,
    /// Times of rising and of falling edges, ns since power-up.
    pub edges: [Vec<i64>; 2],
}

impl Wire {
    /// Level just before a time. `None` if it is not known.
    pub fn level_before(&self, t_ns: i64) -> Option<bool> {
        let last = |times: &[i64]| {
            let before = times.partition_point(|at| *at < t_ns);
            before.checked_sub(1).map(|i| times[i])
        };
        match (last(&self.edges[0]), last(&self.edges[1])) {
            (None, None) => self.initial,
            (rise, fall) => Some(rise > fall),
        }
    }
}

/// Window of a file with its wires.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wires {
    pub from_ns: i64,
    pub to_ns: i64,
    pub wires: BTreeMap<String, Wire>,
}

impl Wires {
    /// Reads a whole file.
    pub fn read(path: &Path) -> Result<Self, CompareError> {
        let wrong = |problem: String| {
            CompareError::new(
                path,
                format!("{problem}; write the run again, or give its trace.csv alone"),
            )
        };
        let file = input_file::open(path, MAX_TABLE_BYTES).map_err(|e| wrong(e.to_string()))?;
        let mut parser = vcd::Parser::new(BufReader::new(file));
        let header = parser.parse_header().map_err(|e| wrong(e.to_string()))?;
        if header.timescale != Some((1, TimescaleUnit::NS)) {
            return Err(wrong("the timescale is not 1 ns".to_owned()));
        }
        let scope = header
            .find_scope(&["cophase"])
            .ok_or_else(|| wrong("there is no module `cophase`".to_owned()))?;
        let vars = scope.items.iter().filter_map(|item| match item {
            ScopeItem::Var(var) => Some((var.code, var.reference.clone())),
            _ => None,
        });
        let names: HashMap<IdCode, String> = vars.collect();
        let mut wires: HashMap<IdCode, Wire> = HashMap::new();
        let (mut from_ns, mut now_ns, mut is_initial) = (None, 0, false);
        for command in parser {
            match command.map_err(|e| wrong(e.to_string()))? {
                Command::Timestamp(t_ns) => {
                    now_ns = i64::try_from(t_ns).unwrap_or(i64::MAX);
                    from_ns.get_or_insert(now_ns);
                }
                Command::Begin(_) => is_initial = true,
                Command::End(_) => is_initial = false,
                Command::ChangeScalar(id, value) => {
                    let wire = wires.entry(id).or_default();
                    match (is_initial, value) {
                        (true, Value::V0 | Value::V1) => wire.initial = Some(value == Value::V1),
                        (false, Value::V1) => wire.edges[0].push(now_ns),
                        (false, Value::V0) => wire.edges[1].push(now_ns),
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        let from_ns = from_ns.ok_or_else(|| wrong("there is no time".to_owned()))?;
        let named = names
            .into_iter()
            .map(|(id, name)| (name, wires.remove(&id).unwrap_or_default()));
        Ok(Self {
            from_ns,
            to_ns: now_ns,
            wires: named.collect(),
        })
    }
}
