//! `trace.mcap`: a channel for each [`Topic`], a message in JSON for each row.
//!
//! The time of a message is that of its row, ns since power-up. The JSON schema of a channel has the unit and the source of
//! each column. Nothing is compressed, because the crate can compress only with C libraries.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use serde_json::json;
use thiserror::Error;

use super::column::{Column, Read, Topic};
use super::json::JsonColumns;
use super::{Row, RowShape};

/// Reason why a trace could not be written.
#[derive(Debug, Error)]
pub enum McapTraceError {
    /// The `mcap` crate or the file under it refused.
    #[error("trace not written: {0}")]
    Mcap(#[from] mcap::McapError),
    /// A message or a schema is not JSON.
    #[error("trace not written: {0}")]
    Json(#[from] serde_json::Error),
    /// The last bytes could not be flushed.
    #[error("trace not flushed: {0}")]
    Flush(#[from] std::io::Error),
}

/// Writes rows as messages.
pub struct TraceMcap<W: Write + Seek> {
    file: mcap::Writer<W>,
    channels: Vec<(u16, JsonColumns)>,
    rows: u32,
    text: Vec<u8>,
}

impl<W: Write + Seek> TraceMcap<W> {
    /// Writes the header, with a channel for each topic.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(w: W, shape: impl Into<RowShape>) -> Result<Self, McapTraceError> {
        let options = WriteOptions::new().compression(None).library("cophase");
        let mut file = options.create(w)?;
        let mut channels = Vec::new();
        for topic in Topic::of_run(shape.into()) {
            let (name, path) = match topic {
                Topic::Loop => ("cophase.loop", "/loop".to_owned()),
                Topic::Axis(i) => ("cophase.axis", format!("/axis/{i}")),
                Topic::Platform => ("cophase.platform", "/platform".to_owned()),
                Topic::Pitch => ("cophase.pitch", "/pitch".to_owned()),
            };
            let schema = serde_json::to_vec(&schema(name, topic))?;
            // The same schema of another axis is the same record.
            let schema = file.add_schema(name, "jsonschema", &schema)?;
            let channel = file.add_channel(schema, &path, "json", &BTreeMap::new())?;
            let columns = Column::of_topic(topic).map(|column| (column.field.name.into(), column));
            channels.push((channel, JsonColumns::new(columns)));
        }
        Ok(Self {
            file,
            channels,
            rows: 0,
            text: Vec::new(),
        })
    }

    /// Writes one row, a message to each channel.
    ///
    /// # Errors
    /// When the writer refuses.
    ///
    /// # Panics
    /// If the row has fewer axes than the header.
    pub fn write(&mut self, row: &Row) -> Result<(), McapTraceError> {
        let time_ns = (row.t_s * 1e9).round() as u64;
        for (channel_id, columns) in &self.channels {
            columns.write(row, &mut self.text)?;
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: self.rows,
                log_time: time_ns,
                publish_time: time_ns,
            };
            self.file.write_to_known_channel(&header, &self.text)?;
        }
        self.rows = self.rows.wrapping_add(1);
        Ok(())
    }

    /// Writes the index and flushes.
    ///
    /// # Errors
    /// When the writer refuses the last bytes.
    pub fn finish(mut self) -> Result<W, McapTraceError> {
        self.file.finish()?;
        let mut w = self.file.into_inner();
        w.flush()?;
        Ok(w)
    }
}

fn schema(name: &str, topic: Topic) -> serde_json::Value {
    let properties = Column::of_topic(topic).map(|column| {
        let field = column.field;
        // A single type, although a number that is not finite is written as null: Foxglove refuses lists of types.
        let kind = match field.read {
            Read::Number(..) => "number",
            Read::Count(_) => "integer",
            Read::Word(_) => "string",
        };
        let source = field.source.name();
        let description = match field.unit {
            "" => source.to_owned(),
            unit => format!("{unit}; {source}"),
        };
        let property = json!({ "type": kind, "description": description });
        (field.name.to_owned(), property)
    });
    let properties: serde_json::Map<_, _> = properties.collect();
    json!({ "title": name, "type": "object", "properties": properties })
}
