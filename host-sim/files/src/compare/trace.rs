//! `trace.csv`, read back column by column.

use std::path::Path;

use cophase_scene::input_file::{self, MAX_TABLE_BYTES};

use super::column::is_held;
use super::error::CompareError;
use super::points::Place;
use super::run::Origin;
use crate::trace::WRITTEN_BY;

/// Values of a column, one per row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// No row has a value, because the recorder of the run had no access to it.
    Empty,
    /// Every row has a number.
    Numbers(Vec<f64>),
    /// Every row has a name.
    Words(Vec<String>),
}

/// A trace: times and columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    times_ns: Vec<i64>,
    columns: Vec<(String, Values)>,
}

/// Column with the times.
const TIME: &str = "t_s";
/// Column with the supervisor's state, the only column of words.
pub(super) const STATE: &str = "state";

impl Trace {
    /// Reads a whole file.
    ///
    /// # Errors
    /// The file cannot be read, has no rows, is cut off, or has a field that is not a number.
    pub fn read(path: &Path) -> Result<Self, CompareError> {
        let text = input_file::read_text(path, MAX_TABLE_BYTES).map_err(|e| {
            CompareError::new(
                path,
                format!("{e}; give the folder of a run, or its trace.csv"),
            )
        })?;
        Self::parse(path, &text)
    }

    /// Reads the text of a file; `path` is for errors.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, CompareError> {
        let wrong = |problem: String| CompareError::new(path, problem);
        if !text.ends_with('\n') {
            return Err(wrong(
                "the file ends within a line; write it again, or delete that line".to_owned(),
            ));
        }
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| wrong(e.to_string()))?;
        let no_times = || {
            wrong(format!(
                "there is no row with a time in column {TIME}; give a trace.csv that `cophase run` wrote"
            ))
        };
        if !header.iter().any(|name| name == TIME) {
            return Err(no_times());
        }
        let mut fields: Vec<(String, Vec<String>)> = header
            .iter()
            .map(|name| (name.to_owned(), Vec::new()))
            .collect();
        for record in reader.records() {
            let record = record
                .map_err(|e| wrong(format!("{e}; the file may be cut off: write it again")))?;
            for ((_, column), field) in fields.iter_mut().zip(&record) {
                column.push(field.to_owned());
            }
        }
        let mut trace = Self {
            times_ns: Vec::new(),
            columns: Vec::with_capacity(fields.len()),
        };
        // Two builds of the command may write the same run.
        fields.retain(|(name, _)| !WRITTEN_BY.contains(&name.as_str()));
        for (name, column) in fields {
            let values = values(&name, column).map_err(&wrong)?;
            match values {
                Values::Numbers(times) if name == TIME => {
                    trace.times_ns = times.iter().map(|t_s| (t_s * 1e9).round() as i64).collect();
                }
                values => trace.columns.push((name, values)),
            }
        }
        if trace.times_ns.is_empty() {
            return Err(no_times());
        }
        if let Some(row) = trace
            .times_ns
            .windows(2)
            .position(|pair| pair[0] >= pair[1])
        {
            return Err(wrong(format!(
                "line {}: {TIME} does not rise; rows must be in the order of time",
                row + 3
            )));
        }
        Ok(trace)
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        let steps = |name: &&str| name.starts_with("steps_");
        self.names().filter(steps).count()
    }

    /// Names of the columns other than the time's, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// Values of a column; [`Values::Empty`] if there is no such column.
    pub fn column(&self, name: &str) -> &Values {
        const NONE: &Values = &Values::Empty;
        let found = self.columns.iter().find(|(known, _)| known == name);
        found.map_or(NONE, |(_, values)| values)
    }

    /// Times of the rows, ns since power-up.
    pub fn times_ns(&self) -> &[i64] {
        &self.times_ns
    }

    /// Rows with their times from an origin. If the origin is the start, the rows up to it are left out, because the
    /// machine is idle there.
    pub(super) fn times_from(&self, origin_ns: i64, origin: Origin) -> Vec<(usize, i64)> {
        let times = self
            .times_ns
            .iter()
            .map(|t_ns| t_ns - origin_ns)
            .enumerate();
        times
            .filter(|&(_, t_ns)| origin == Origin::PowerUp || t_ns > 0)
            .collect()
    }

    /// Value of a column at a place. NaN if the column has no numbers.
    pub(super) fn value(&self, name: &str, place: Place) -> f64 {
        match self.column(name) {
            Values::Numbers(numbers) => at(numbers, place, is_held(name)),
            Values::Empty | Values::Words(_) => f64::NAN,
        }
    }
}

/// Value at a place: that of the row, or one interpolated between this row and the next.
pub(super) fn at(numbers: &[f64], place: Place, is_held: bool) -> f64 {
    let here = numbers[place.row];
    if is_held || place.beyond == 0.0 {
        return here;
    }
    let next = numbers.get(place.row + 1).copied().unwrap_or(here);
    here + (next - here) * place.beyond
}

fn values(name: &str, fields: Vec<String>) -> Result<Values, String> {
    if fields.iter().all(String::is_empty) {
        return Ok(Values::Empty);
    }
    if name == STATE {
        return Ok(Values::Words(fields));
    }
    let number = |(row, field): (usize, &String)| {
        // Lines are counted from 1, and the first is the header.
        field.parse::<f64>().map_err(|_| {
            format!(
                "line {}: `{field}` in column {name} is no number; write the file again",
                row + 2
            )
        })
    };
    let numbers: Result<_, _> = fields.iter().enumerate().map(number).collect();
    Ok(Values::Numbers(numbers?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        let error = Trace::parse(Path::new("a/trace.csv"), text).unwrap_err();
        error.to_string()
    }

    #[test]
    fn an_invalid_trace_is_refused_with_its_line() {
        for (text, problem) in [
            ("", "ends within a line"),
            ("t_s,state\n", "no row"),
            ("a,b\n1,2\n", "no row with a time"),
            ("t_s,z_m\n1,2\n2", "ends within a line"),
            ("t_s,z_m\n1,2\n2\n", "cut off"),
            ("t_s,z_m\n1,2\n2,x\n", "line 3: `x` in column z_m"),
            ("t_s,z_m\n1,2\n2,\n", "line 3: `` in column z_m"),
            ("t_s,z_m\n1,2\n1,3\n", "line 3: t_s does not rise"),
        ] {
            let error = refused(text);
            assert!(error.starts_with("a/trace.csv: "), "{error}");
            assert!(error.contains(problem), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_column_without_values_is_empty() {
        let trace = Trace::parse(Path::new("a"), "t_s,z_m,steps_0\n0.5,,1\n1,,2\n").unwrap();
        assert_eq!(trace.column("z_m"), &Values::Empty);
        assert_eq!(trace.column("steps_0"), &Values::Numbers(vec![1.0, 2.0]));
        assert_eq!(trace.times_ns(), [500_000_000, 1_000_000_000]);
        assert_eq!(trace.axes(), 1);
    }
}
