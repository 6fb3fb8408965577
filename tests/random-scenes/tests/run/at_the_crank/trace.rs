//! Columns of `trace.csv`, by the names that `docs/formats.md` gives them.

use std::collections::HashMap;
use std::path::Path;

use super::super::files::read;

/// Rows of a trace, one a tick.
pub struct Trace {
    columns: HashMap<String, Vec<f64>>,
    pub states: Vec<String>,
}

impl Trace {
    pub fn read(folder: &Path) -> Result<Self, String> {
        let text = read(folder, "trace.csv")?;
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let mut columns = vec![Vec::new(); names.len()];
        let mut states = Vec::new();
        for line in lines {
            for ((name, field), column) in names.iter().zip(line.split(',')).zip(&mut columns) {
                if *name == "state" {
                    states.push(field.to_owned());
                } else if !["version", "commit"].contains(name) {
                    column.push(field.parse().map_err(|_| format!("{name} is {field}"))?);
                }
            }
        }
        let names = names.into_iter().map(str::to_owned);
        Ok(Self {
            columns: names.zip(columns).collect(),
            states,
        })
    }

    /// A column of numbers.
    pub fn column(&self, name: &str) -> Result<&[f64], String> {
        let column = self.columns.get(name).map(Vec::as_slice);
        column.ok_or_else(|| format!("trace.csv has no column {name}"))
    }

    /// Turns that the cranks have made, from power-up.
    pub fn cranks(&self, count: usize) -> Result<Vec<&[f64]>, String> {
        (0..count)
            .map(|axis| self.column(&format!("actual_turns_{axis}")))
            .collect()
    }

    /// Mean angle of all cranks in each row, turns. Cranks whose turns differ by whole ones are at one angle.
    pub fn angle(&self, count: usize) -> Result<Vec<f64>, String> {
        let cranks = self.cranks(count)?;
        let first = cranks[0];
        let mean = |row: usize| {
            let off: f64 = cranks
                .iter()
                .map(|turns| apart(turns[row], first[row]))
                .sum();
            first[row] + off / count as f64
        };
        Ok((0..first.len()).map(mean).collect())
    }
}

/// Angle from one crank to another, turns, −0.5 to 0.5.
pub fn apart(one: f64, other: f64) -> f64 {
    let turns = one - other;
    turns - turns.round()
}
