//! A row as one flat JSON object.
//!
//! A value that is not a finite number is `null`, because JSON has no such numbers.

use serde::{Serialize, Serializer};

use super::Row;
use super::column::{Column, Value};

/// Columns and the keys under which they are written.
pub(super) struct JsonColumns(Vec<(String, Column)>);

impl JsonColumns {
    pub fn new(columns: impl IntoIterator<Item = (String, Column)>) -> Self {
        Self(columns.into_iter().collect())
    }

    /// Replaces `text` by the object of a row, which must have the columns' axes.
    ///
    /// # Errors
    /// The serializer refuses. It refuses no value of a column.
    pub fn write(&self, row: &Row, text: &mut Vec<u8>) -> serde_json::Result<()> {
        text.clear();
        serde_json::to_writer(text, &Object { columns: self, row })
    }
}

struct Object<'a> {
    columns: &'a JsonColumns,
    row: &'a Row,
}

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.columns.0.iter();
        serializer.collect_map(values.map(|(key, column)| (key, column.value(self.row))))
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Number(number) => serializer.serialize_f64(number),
            Self::Count(count) => serializer.serialize_i64(count),
            Self::Word(word) => serializer.serialize_str(word),
        }
    }
}
