//! Rows as files: CSV, in which each row also states the campaign to which it belongs.
//!
//! A *shard* has the rows of a range of case numbers. Shards of one campaign have the same plan, version, commit, seed, scene and number of
//! cases. If they are all cases of a range, each once, they can be joined into one shard. It is the same, byte for byte, as that of a single
//! run. The last column is the CRC-32 of the rest of its row, so that damage is detected.

use std::ops::Range;
use std::path::PathBuf;

use cophase_files::version;
use cophase_scene::Scene;
use serde::{Deserialize, Serialize};

use super::plan::strata::Stratum;
use super::plan::{Plan, VERSION};
use super::row::Row;
use super::selection::Selection;

/// Scene of a campaign whose machines are drawn.
pub const MACHINES: &str = "machines";

/// Identity of a shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Columns", try_from = "Columns")]
pub struct Header {
    /// Version of the command.
    pub version: String,
    /// Commit of the command.
    pub commit: String,
    /// Version of the plan.
    pub plan: u32,
    /// The campaign's seed.
    pub seed: u64,
    /// [`MACHINES`], or the scene's checksum.
    pub scene: String,
    /// Strata that are simulated; none if all cases are.
    pub selection: Option<Selection>,
    /// Numbers of its cases. With a selection, these are their positions in it.
    pub numbers: Range<u64>,
    /// Number of cases of the whole campaign.
    pub of: u64,
}

/// Columns of the identity of a shard, after those of a [`Row`].
#[derive(Serialize, Deserialize)]
struct Columns {
    version: String,
    commit: String,
    plan: u32,
    seed: u64,
    scene: String,
    only: Option<String>,
    others: Option<u64>,
    from: u64,
    to: u64,
    of: u64,
}

/// The last column.
#[derive(Serialize, Deserialize)]
struct Sum {
    crc32: String,
}

impl From<Header> for Columns {
    fn from(header: Header) -> Self {
        let selection = header.selection.as_ref();
        Self {
            version: header.version,
            commit: header.commit,
            plan: header.plan,
            seed: header.seed,
            scene: header.scene,
            only: selection.map(Selection::only),
            others: selection.and_then(Selection::others),
            from: header.numbers.start,
            to: header.numbers.end,
            of: header.of,
        }
    }
}

impl TryFrom<Columns> for Header {
    type Error = &'static str;

    fn try_from(columns: Columns) -> Result<Self, Self::Error> {
        let numbers = columns.from..columns.to;
        if numbers.is_empty() || numbers.end > columns.of {
            return Err("`from`, `to` and `of` are no part of a campaign");
        }
        let parse =
            |only: String| Selection::parse(&only, columns.others).ok_or("`only` has no strata");
        Ok(Self {
            version: columns.version,
            commit: columns.commit,
            plan: columns.plan,
            seed: columns.seed,
            scene: columns.scene,
            selection: columns.only.map(parse).transpose()?,
            numbers,
            of: columns.of,
        })
    }
}

impl Header {
    /// Header for a range of a plan's cases, or of those that a selection takes.
    pub fn new(plan: &Plan, selection: Option<Selection>, numbers: Range<u64>, of: u64) -> Self {
        Self {
            version: version::RELEASE.to_owned(),
            commit: version::commit().to_owned(),
            plan: VERSION,
            seed: plan.seed(),
            scene: plan.scene().map_or(MACHINES.to_owned(), checksum),
            selection,
            numbers,
            of,
        }
    }

    /// Returns true if the shard has all cases of its campaign.
    pub fn is_whole(&self) -> bool {
        self.numbers == (0..self.of)
    }

    /// Returns true if a row can follow the rows before it. Runs come in pairs, and cases in the order of their numbers. The numbers that a
    /// selection takes depend on the plan, and are not checked here.
    fn expects(&self, row: &Row, before: &[Row]) -> bool {
        let is_clean_due = before.len() % 2 == 1;
        let last = before.last().map(|last| last.number);
        let is_case_due = match &self.selection {
            _ if is_clean_due => last == Some(row.number),
            None => row.number.checked_sub(self.numbers.start) == Some(before.len() as u64 / 2),
            Some(selection) => takes(selection, row) && last < Some(row.number),
        };
        row.clean == is_clean_due && is_case_due
    }

    /// Returns the first field in which another shard is of another campaign, as `key = theirs, not ours`.
    fn differs(&self, other: &Self) -> Option<String> {
        let selected = |header: &Self| match &header.selection {
            Some(selection) => format!("`{selection}`"),
            None => "all cases".to_owned(),
        };
        let pairs = [
            ("version", &self.version, &other.version),
            ("commit", &self.commit, &other.commit),
            ("plan", &self.plan.to_string(), &other.plan.to_string()),
            ("seed", &self.seed.to_string(), &other.seed.to_string()),
            ("scene", &self.scene, &other.scene),
            ("--only", &selected(self), &selected(other)),
            ("--runs", &self.of.to_string(), &other.of.to_string()),
        ];
        let (key, ours, theirs) = pairs.into_iter().find(|(_, ours, theirs)| ours != theirs)?;
        Some(format!("{key} = {theirs}, not {ours}"))
    }
}

/// Returns true if a selection takes the case of a faulty run.
fn takes(selection: &Selection, row: &Row) -> bool {
    row.kind.is_some_and(|kind| {
        let encoder = row.encoder;
        selection.has(row.number, Stratum { kind, encoder })
    })
}

/// Returns the checksum of a scene after parsing. It does not depend on the layout of its file.
fn checksum(scene: &Scene) -> String {
    let text = toml::to_string(scene).unwrap_or_default();
    crc32(text.as_bytes())
}

/// Returns the CRC-32 of a text, as eight digits.
fn crc32(text: &[u8]) -> String {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    format!("{:08x}", crc.checksum(text))
}

/// Returns the CRC-32 of the cells of a row before that of the sum.
fn sum(row: &Row, header: &Header) -> Result<Sum, csv::Error> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    writer.serialize((row, header))?;
    let line = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(Sum {
        crc32: crc32(line.trim_ascii_end()),
    })
}

/// Rows of a range of cases, with their identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Shard {
    /// Identity of the shard.
    pub header: Header,
    /// Both rows of each case, faulty and clean, in the order of their numbers.
    pub rows: Vec<Row>,
}

/// Reason why a shard is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ShardError(pub String);

impl Shard {
    /// Returns the shard as text.
    ///
    /// # Errors
    /// None in practice: rows have only plain values.
    pub fn to_text(&self) -> Result<String, ShardError> {
        self.text_in(&self.header, true)
    }

    /// Returns the rows as text, in a joined shard with another header, with the names of the columns before the first row or without them.
    ///
    /// # Errors
    /// As [`Self::to_text`].
    pub fn text_in(&self, header: &Header, has_names: bool) -> Result<String, ShardError> {
        let text = || {
            let mut writer = csv::WriterBuilder::new()
                .has_headers(has_names)
                .from_writer(Vec::new());
            for row in &self.rows {
                writer.serialize((row, header, sum(row, header)?))?;
            }
            writer
                .into_inner()
                .map_err(|error| error.into_error().into())
        };
        let text = text().map_err(|error: csv::Error| ShardError(error.to_string()))?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// Returns the identity of a shard by the first row of its text, in which only a defect before that is found.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn identity(text: &str) -> Result<Header, ShardError> {
        let first = text.match_indices('\n').nth(1);
        let first = first.map_or(text, |(end, _)| &text[..=end]);
        Ok(Self::read(first)?.header)
    }

    /// Parses a shard from text.
    ///
    /// # Errors
    /// The text has a defect. The message contains its place.
    pub fn parse(text: &str) -> Result<Self, ShardError> {
        let shard = Self::read(text)?;
        let cases = shard.header.numbers.end - shard.header.numbers.start;
        if shard.rows.len() as u64 != 2 * cases {
            return Err(ShardError(format!(
                "is truncated: it has {} rows, and its rows state {cases} cases of two; {AGAIN}",
                shard.rows.len()
            )));
        }
        // What the sums do not cover: the names of the columns, and other spellings of the same values.
        if shard.to_text()? != text {
            return Err(ShardError(format!(
                "is damaged: it is not, byte for byte, what its rows are written as; {AGAIN}"
            )));
        }
        Ok(shard)
    }

    /// Reads the rows of a text.
    fn read(text: &str) -> Result<Self, ShardError> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names = reader.headers().cloned().unwrap_or_default();
        let is_shard = names.get(0) == Some("number") && names.iter().next_back() == Some("crc32");
        if !is_shard {
            let problem = "is no campaign: its columns are not from `number` to `crc32`; give a file that `cophase campaign` wrote";
            return Err(ShardError(problem.to_owned()));
        }
        let mut shard: Option<Self> = None;
        for record in reader.records() {
            let record =
                record.map_err(|error| at_line(error.position(), &brief(&error, &names)))?;
            let cells: Result<(Row, Header, Sum), _> = record.deserialize(None);
            let (row, header, found) =
                cells.map_err(|error| at_line(record.position(), &brief(&error, &names)))?;
            let expected = sum(&row, &header).map_err(|error| ShardError(error.to_string()))?;
            if found.crc32 != expected.crc32 {
                return Err(at_line(
                    record.position(),
                    &"its CRC-32 is not that of the row",
                ));
            }
            let shard = shard.get_or_insert_with(|| Self {
                header: header.clone(),
                rows: Vec::new(),
            });
            if header != shard.header {
                let what = shard.header.differs(&header);
                let what = what.unwrap_or_else(|| "cases of another range".to_owned());
                return Err(at_line(
                    record.position(),
                    &format!("is of another shard: {what}"),
                ));
            }
            shard
                .expect(&row)
                .map_err(|problem| at_line(record.position(), &problem))?;
            shard.rows.push(row);
        }
        shard.ok_or_else(|| ShardError(format!("has no rows; {AGAIN}")))
    }

    /// Returns the problem if a row is not the next one.
    fn expect(&self, row: &Row) -> Result<(), String> {
        let (header, rows) = (&self.header, &self.rows);
        if header.expects(row, rows) {
            return Ok(());
        }
        let run = if rows.len() % 2 == 1 {
            "clean"
        } else {
            "faulty"
        };
        let case = match &header.selection {
            None => {
                let number = header.numbers.start.saturating_add(rows.len() as u64 / 2);
                format!("case {number}")
            }
            Some(selection) => format!("the next case of {selection}"),
        };
        Err(format!("here the {run} run of {case} should be"))
    }
}

/// Fix for a file that is not as it was written.
const AGAIN: &str = "copy the file again, or run that range again";

/// Returns the error of a row.
fn at_line(place: Option<&csv::Position>, problem: &dyn std::fmt::Display) -> ShardError {
    let line = place.map_or(0, csv::Position::line);
    ShardError(format!("line {line}: {problem}; {AGAIN}"))
}

/// Returns the message of the CSV reader without its place, with the name of the column.
fn brief(error: &csv::Error, names: &csv::StringRecord) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => {
            let name = err.field().and_then(|field| names.get(field as usize));
            match name {
                Some(name) => format!("{name}: {}", err.kind()),
                None => err.kind().to_string(),
            }
        }
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("has {len} columns, not {expected_len}"),
        _ => error.to_string(),
    }
}

/// Returns the identity of the shard that others are joined into, and sorts those. Together they are the cases from `from` to before `to`, by default to the last.
///
/// # Errors
/// No shards are given, or they are of different campaigns, overlap, or are not exactly the cases that are requested.
pub fn join(
    shards: &mut [(PathBuf, Header)],
    from: u64,
    to: Option<u64>,
) -> Result<Header, ShardError> {
    shards.sort_by_key(|(_, header)| header.numbers.start);
    let Some(((first, header), others)) = shards.split_first() else {
        return Err(ShardError(
            "no shards; give files that `cophase campaign` wrote, or a folder of them".to_owned(),
        ));
    };
    let (mut last, mut joined) = (first.display(), header.clone());
    let requested = from..to.unwrap_or(joined.of);
    let missing = |what: &str, from: u64, to: u64| {
        ShardError(format!(
            "{what}; give the missing cases, --from {from} --to {to}"
        ))
    };
    let start = joined.numbers.start;
    if start > requested.start {
        let what = format!("{last}: is the first shard, and begins with case {start}");
        return Err(missing(&what, requested.start, start));
    }
    for (path, header) in others {
        let name = path.display();
        if let Some(what) = joined.differs(header) {
            return Err(ShardError(format!(
                "{name}: is of another campaign than {last}: {what}"
            )));
        }
        let (end, start) = (joined.numbers.end, header.numbers.start);
        if start < end {
            return Err(ShardError(format!(
                "{name}: begins with case {start}, and {last} goes up to {}; leave one out",
                end - 1
            )));
        }
        if start > end {
            let what = format!(
                "{name}: begins with case {start}, and {last} ends with {}",
                end - 1
            );
            return Err(missing(&what, end, start));
        }
        joined.numbers.end = header.numbers.end;
        last = name;
    }
    let Range { start, end } = joined.numbers;
    if end < requested.end {
        let of = joined.of;
        let what = format!("{last}: is the last shard, and the campaign has {of} cases");
        return Err(missing(&what, end, requested.end));
    }
    if (start..end) != requested {
        return Err(ShardError(format!(
            "the shards have cases {start} to {}; leave out those that are not requested",
            end - 1
        )));
    }
    Ok(joined)
}
