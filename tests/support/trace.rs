//! `trace.csv`, read back.

use std::collections::HashMap;
use std::ops::Range;

/// Columns that are no numbers: the state, and the command that wrote the file.
fn is_word(name: &str) -> bool {
    ["state", "version", "commit"].contains(&name)
}

/// A trace, column by column.
#[derive(Clone, Debug)]
pub struct Trace {
    columns: HashMap<String, Vec<f64>>,
    /// The column `state`.
    pub states: Vec<String>,
    /// Number of axes.
    pub axes: usize,
}

impl Trace {
    /// Reads a whole `trace.csv`.
    ///
    /// # Panics
    /// If it is not well-formed, or a field other than the state is no number.
    pub fn read(csv: &[u8]) -> Self {
        let mut reader = csv::Reader::from_reader(csv);
        let names: Vec<String> = reader
            .headers()
            .expect("a header")
            .iter()
            .map(str::to_owned)
            .collect();
        let mut values = vec![Vec::new(); names.len()];
        let mut states = Vec::new();
        let mut record = csv::StringRecord::new();
        while reader
            .read_record(&mut record)
            .expect("a row of the header's length")
        {
            for ((field, name), column) in record.iter().zip(&names).zip(&mut values) {
                if name == "state" {
                    states.push(field.to_owned());
                } else if !is_word(name) {
                    column.push(
                        field
                            .parse()
                            .unwrap_or_else(|_| panic!("{name}: `{field}`")),
                    );
                }
            }
        }
        let axes = names
            .iter()
            .filter(|name| name.starts_with("steps_"))
            .count();
        Self {
            columns: names
                .into_iter()
                .zip(values)
                .filter(|(name, _)| !is_word(name))
                .collect(),
            states,
            axes,
        }
    }

    /// A column by its name.
    ///
    /// # Panics
    /// If there is none.
    pub fn column(&self, name: &str) -> &[f64] {
        self.columns
            .get(name)
            .unwrap_or_else(|| panic!("no column `{name}`"))
    }

    /// A column of an axis, such as `steps`.
    pub fn axis(&self, name: &str, axis: usize) -> &[f64] {
        self.column(&format!("{name}_{axis}"))
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.states.len()
    }

    /// The first row at or after a time.
    pub fn row_at(&self, t_s: f64) -> usize {
        self.column("t_s").partition_point(|&t| t < t_s - 1e-10)
    }

    /// The rows of the first stretch in a state.
    ///
    /// # Panics
    /// If the state does not occur.
    pub fn first(&self, state: &str) -> Range<usize> {
        let is = |row: &String| row == state;
        let from = self
            .states
            .iter()
            .position(is)
            .unwrap_or_else(|| panic!("never `{state}`"));
        let rows = self.states[from..].iter().take_while(|row| is(row)).count();
        from..from + rows
    }
}
