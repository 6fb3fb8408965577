//! Writer of the file format [MCAP](https://mcap.dev/spec), as far as a trace needs it: chunks without compression, with an index.
//!
//! The crate of the format's authors brings seventeen others, which a first build would wait for.

use std::io::{self, Write};

/// Bytes at both ends of a file.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Size of a chunk after which the next one begins, bytes.
const CHUNK_BYTES: usize = 1024 * 1024;

/// Kinds of records.
mod op {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const CHUNK_INDEX: u8 = 0x08;
    pub const STATISTICS: u8 = 0x0B;
    pub const SUMMARY_OFFSET: u8 = 0x0E;
    pub const DATA_END: u8 = 0x0F;
}

/// Content of a record. Numbers are little-endian.
#[derive(Default)]
struct Content(Vec<u8>);

impl Content {
    fn u16(mut self, value: u16) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    /// Adds a value of variable length, with its length in bytes before it.
    fn bytes(self, bytes: &[u8]) -> Self {
        let mut content = self.u32(bytes.len() as u32);
        content.0.extend(bytes);
        content
    }
}

/// Appends a record.
fn put(to: &mut Vec<u8>, kind: u8, content: &[u8]) {
    to.push(kind);
    to.extend((content.len() as u64).to_le_bytes());
    to.extend(content);
}

/// First and last time of messages, ns.
type Times = Option<(u64, u64)>;

fn with(times: Times, time_ns: u64) -> Times {
    let (first, last) = times.unwrap_or((time_ns, time_ns));
    Some((first.min(time_ns), last.max(time_ns)))
}

/// File while it is written.
pub(super) struct McapFile<W> {
    w: W,
    /// Number of bytes written, and their checksum.
    written: u64,
    crc: Crc32,
    /// Contents of the records. Identifiers count from 1.
    schemas: Vec<Vec<u8>>,
    channels: Vec<Vec<u8>>,
    chunk: Vec<u8>,
    chunk_times: Times,
    /// Time and place in the chunk of each message, by channel.
    index: Vec<Vec<(u64, u64)>>,
    chunk_indexes: Vec<Vec<u8>>,
    times: Times,
    /// Number of messages, by channel.
    counts: Vec<u64>,
}

impl<W: Write> McapFile<W> {
    /// Begins a file.
    pub fn new(w: W, library: &str) -> io::Result<Self> {
        let mut file = Self {
            w,
            written: 0,
            crc: Crc32::default(),
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk: Vec::new(),
            chunk_times: None,
            index: Vec::new(),
            chunk_indexes: Vec::new(),
            times: None,
            counts: Vec::new(),
        };
        let mut begin = MAGIC.to_vec();
        let header = Content::default().bytes(b"").bytes(library.as_bytes());
        put(&mut begin, op::HEADER, &header.0);
        file.write(&begin)?;
        Ok(file)
    }

    /// Declares a schema in JSON, and returns its identifier. The same schema is declared once.
    pub fn schema(&mut self, name: &str, schema: &[u8]) -> u16 {
        let declared = |id: u16| {
            let content = Content::default().u16(id).bytes(name.as_bytes());
            content.bytes(b"jsonschema").bytes(schema).0
        };
        let mut known = (1..).zip(&self.schemas);
        if let Some((id, _)) = known.find(|(id, content)| **content == declared(*id)) {
            return id;
        }
        let id = self.schemas.len() as u16 + 1;
        put(&mut self.chunk, op::SCHEMA, &declared(id));
        self.schemas.push(declared(id));
        id
    }

    /// Declares a channel of messages in JSON, and returns its identifier.
    pub fn channel(&mut self, schema: u16, topic: &str) -> u16 {
        let id = self.channels.len() as u16 + 1;
        let content = Content::default().u16(id).u16(schema);
        let content = content.bytes(topic.as_bytes()).bytes(b"json").bytes(b"").0;
        put(&mut self.chunk, op::CHANNEL, &content);
        self.channels.push(content);
        self.index.push(Vec::new());
        self.counts.push(0);
        id
    }

    /// Writes a message to a channel.
    pub fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time_ns: u64,
        text: &[u8],
    ) -> io::Result<()> {
        if self.chunk.len() > CHUNK_BYTES {
            self.end_chunk()?;
        }
        let place = usize::from(channel) - 1;
        self.counts[place] += 1;
        self.index[place].push((time_ns, self.chunk.len() as u64));
        self.times = with(self.times, time_ns);
        self.chunk_times = with(self.chunk_times, time_ns);
        let chunk = &mut self.chunk;
        chunk.push(op::MESSAGE);
        chunk.extend((22 + text.len() as u64).to_le_bytes());
        chunk.extend(channel.to_le_bytes());
        chunk.extend(sequence.to_le_bytes());
        // Times of record and of publication.
        chunk.extend(time_ns.to_le_bytes());
        chunk.extend(time_ns.to_le_bytes());
        chunk.extend(text);
        Ok(())
    }

    /// Writes the last chunk, the summary and the footer.
    pub fn finish(mut self) -> io::Result<W> {
        self.end_chunk()?;
        let data_end = Content::default().u32(self.crc.value());
        let mut end = Vec::new();
        put(&mut end, op::DATA_END, &data_end.0);
        self.write(&end)?;

        let start = self.written;
        let mut summary = Vec::new();
        let mut offsets = Vec::new();
        let mut group = |kind: u8, contents: &[Vec<u8>]| {
            let from = summary.len();
            for content in contents {
                put(&mut summary, kind, content);
            }
            let content = Content(vec![kind]).u64(start + from as u64);
            let content = content.u64((summary.len() - from) as u64);
            if summary.len() > from {
                put(&mut offsets, op::SUMMARY_OFFSET, &content.0);
            }
        };
        group(op::SCHEMA, &self.schemas);
        group(op::CHANNEL, &self.channels);
        group(op::STATISTICS, &[self.statistics()]);
        group(op::CHUNK_INDEX, &self.chunk_indexes);
        let offsets_start = start + summary.len() as u64;
        summary.extend(offsets);
        summary.push(op::FOOTER);
        summary.extend(20_u64.to_le_bytes());
        summary.extend(start.to_le_bytes());
        summary.extend(offsets_start.to_le_bytes());
        let mut crc = Crc32::default();
        crc.add(&summary);
        summary.extend(crc.value().to_le_bytes());
        summary.extend(MAGIC);
        self.w.write_all(&summary)?;
        self.w.flush()?;
        Ok(self.w)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.crc.add(bytes);
        self.written += bytes.len() as u64;
        self.w.write_all(bytes)
    }

    /// Writes the chunk with its index, if it has anything.
    fn end_chunk(&mut self) -> io::Result<()> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        let chunk = std::mem::take(&mut self.chunk);
        let size = chunk.len() as u64;
        let (first_ns, last_ns) = self.chunk_times.take().unwrap_or_default();
        let mut crc = Crc32::default();
        crc.add(&chunk);
        let header = Content::default().u64(first_ns).u64(last_ns).u64(size);
        // Without compression both sizes are the same.
        let header = header.u32(crc.value()).bytes(b"").u64(size).0;
        let (start, length) = (self.written, (header.len() + chunk.len()) as u64);
        self.write(&[op::CHUNK])?;
        self.write(&length.to_le_bytes())?;
        self.write(&header)?;
        self.write(&chunk)?;
        let end = self.written;

        let mut offsets = Content::default();
        for place in 0..self.index.len() {
            let entries = std::mem::take(&mut self.index[place]);
            if entries.is_empty() {
                continue;
            }
            let channel = place as u16 + 1;
            offsets = offsets.u16(channel).u64(self.written);
            let mut list = Content::default();
            for (time_ns, at) in entries {
                list = list.u64(time_ns).u64(at);
            }
            let mut record = Vec::new();
            let content = Content::default().u16(channel).bytes(&list.0);
            put(&mut record, op::MESSAGE_INDEX, &content.0);
            self.write(&record)?;
        }
        let index = Content::default().u64(first_ns).u64(last_ns).u64(start);
        let index = index.u64(end - start).bytes(&offsets.0);
        let index = index.u64(self.written - end).bytes(b"").u64(size).u64(size);
        self.chunk_indexes.push(index.0);
        self.chunk = chunk;
        self.chunk.clear();
        Ok(())
    }

    fn statistics(&self) -> Vec<u8> {
        let (first_ns, last_ns) = self.times.unwrap_or_default();
        let mut counts = Content::default();
        for (place, count) in self
            .counts
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0)
        {
            counts = counts.u16(place as u16 + 1).u64(*count);
        }
        let content = Content::default().u64(self.counts.iter().sum());
        let content = content.u16(self.schemas.len() as u16);
        let content = content.u32(self.channels.len() as u32);
        // Attachments and metadata.
        let content = content.u32(0).u32(0);
        let content = content.u32(self.chunk_indexes.len() as u32);
        content.u64(first_ns).u64(last_ns).bytes(&counts.0).0
    }
}

/// CRC-32 of Ethernet and zip, eight bytes at a time.
struct Crc32(u32);

impl Default for Crc32 {
    fn default() -> Self {
        Self(u32::MAX)
    }
}

/// Remainders of each byte, with 0 to 7 bytes after it.
const REMAINDERS: [[u32; 256]; 8] = {
    let mut tables = [[0; 256]; 8];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            let is_odd = remainder & 1 == 1;
            remainder = remainder >> 1 ^ if is_odd { 0xEDB8_8320 } else { 0 };
            bit += 1;
        }
        tables[0][byte] = remainder;
        byte += 1;
    }
    let mut after = 1;
    while after < 8 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[after - 1][byte];
            tables[after][byte] = before >> 8 ^ tables[0][(before & 0xFF) as usize];
            byte += 1;
        }
        after += 1;
    }
    tables
};

impl Crc32 {
    fn add(&mut self, bytes: &[u8]) {
        let (eights, rest) = bytes.as_chunks::<8>();
        for eight in eights {
            let mut word = *eight;
            for (byte, own) in word.iter_mut().zip(self.0.to_le_bytes()) {
                *byte ^= own;
            }
            let remainders = word.iter().zip(REMAINDERS.iter().rev());
            self.0 = remainders.fold(0, |sum, (byte, table)| sum ^ table[usize::from(*byte)]);
        }
        for byte in rest {
            self.0 = self.0 >> 8 ^ REMAINDERS[0][usize::from(self.0 as u8 ^ byte)];
        }
    }

    const fn value(&self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, other programs refuse the file as damaged.
    #[test]
    fn the_checksum_has_its_published_check_value() {
        for split in 0..9 {
            let (before, after) = b"123456789".split_at(split);
            let mut crc = Crc32::default();
            crc.add(before);
            crc.add(after);
            assert_eq!(crc.value(), 0xCBF4_3926);
        }
    }
}
