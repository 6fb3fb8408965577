//! Rows as files: a line that identifies them, then CSV.
//!
//! A *shard* has the rows of a range of case numbers. Shards of one campaign have the same plan, version, seed, scene and number of cases. If
//! they are all cases, each once, they can be joined into one shard. It is the same, byte for byte, as that of a single run. The last field of
//! the line is the CRC-32 of all other bytes, so that damage is detected.

use std::ops::Range;

use super::plan::strata::Stratum;
use super::plan::{Plan, VERSION};
use super::row::Row;
use super::selection::Selection;
use host_sim::scene::Scene;

/// Beginning of the line that identifies a shard.
const MARK: &str = "# cophase campaign";

/// Key of the last field of that line, the CRC-32.
const SUM: &str = " crc32=";

/// Scene of a campaign whose machines are drawn.
pub const MACHINES: &str = "machines";

/// Identity of a shard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Version of the command.
    pub version: String,
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

impl Header {
    /// Header for a range of a plan's cases, or of those that a selection takes.
    pub fn new(plan: &Plan, selection: Option<Selection>, numbers: Range<u64>, of: u64) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
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

    fn line(&self) -> String {
        let Header {
            version,
            plan,
            seed,
            scene,
            selection,
            numbers,
            of,
        } = self;
        let selected = (selection.as_ref()).map_or(String::new(), |selection| {
            format!(" {}", selection.fields())
        });
        format!(
            "{MARK} version={version} plan={plan} seed={seed} scene={scene}{selected} from={} to={} of={of}",
            numbers.start, numbers.end
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let fields = line.strip_prefix(MARK)?;
        let field = |name: &str| {
            fields
                .split_whitespace()
                .find_map(|field| field.strip_prefix(name)?.strip_prefix('='))
        };
        let numbers = field("from")?.parse().ok()?..field("to")?.parse().ok()?;
        let of = field("of")?.parse().ok()?;
        let is_part = !numbers.is_empty() && numbers.end <= of;
        is_part.then_some(())?;
        Some(Self {
            version: field("version")?.to_owned(),
            plan: field("plan")?.parse().ok()?,
            seed: field("seed")?.parse().ok()?,
            scene: field("scene")?.to_owned(),
            selection: match field("only") {
                Some(only) => Some(Selection::parse(only, field("others"))?),
                None => None,
            },
            numbers,
            of,
        })
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
    crc32([text.as_str()])
}

/// Returns the CRC-32 of the parts of a text, as eight digits.
fn crc32<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    for part in parts {
        digest.update(part.as_bytes());
    }
    format!("{:08x}", digest.finalize())
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
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in &self.rows {
            writer
                .serialize(row)
                .map_err(|error| ShardError(error.to_string()))?;
        }
        let rows = writer
            .into_inner()
            .map_err(|error| ShardError(error.to_string()))?;
        let (line, rows) = (self.header.line(), String::from_utf8_lossy(&rows));
        let sum = crc32([line.as_str(), rows.as_ref()]);
        Ok(format!("{line}{SUM}{sum}\n{rows}"))
    }

    /// Parses a shard from text.
    ///
    /// # Errors
    /// The text has a defect. The message contains its place.
    pub fn parse(text: &str) -> Result<Self, ShardError> {
        let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
        let parts = first.split_once(SUM);
        let identified = parts.and_then(|(line, sum)| Some((Header::parse(line)?, line, sum)));
        let (header, line, sum) = identified.ok_or_else(|| {
            ShardError(format!(
                "line 1 does not state what it is of, as `{MARK} version=… plan=… seed=… scene=… from=… to=… of=…{SUM}…`; \
                 give a file that `cophase campaign` wrote"
            ))
        })?;
        if sum != crc32([line, rest]) {
            return Err(ShardError(
                "is damaged or truncated: its CRC-32 is not that of line 1; copy the file again, or run that range again"
                    .to_owned(),
            ));
        }
        let mut rows: Vec<Row> = Vec::new();
        for row in csv::Reader::from_reader(rest.as_bytes()).deserialize() {
            let row: Row = row.map_err(|error| {
                // The reader counts lines from the one after the first.
                let line = error.position().map_or(0, |position| position.line() + 1);
                ShardError(format!("line {line}: {}", brief(&error)))
            })?;
            if !header.expects(&row, &rows) {
                let run = if rows.len() % 2 == 1 {
                    "clean"
                } else {
                    "faulty"
                };
                let case = match &header.selection {
                    None => format!(
                        "case {}",
                        header.numbers.start.saturating_add(rows.len() as u64 / 2)
                    ),
                    Some(selection) => format!("the next case of {selection}"),
                };
                return Err(ShardError(format!(
                    "line {}: here the {run} run of {case} should be; run that range again",
                    rows.len() + 3
                )));
            }
            rows.push(row);
        }
        let cases = header.numbers.end - header.numbers.start;
        if !rows.len().is_multiple_of(2) || rows.len() as u64 / 2 != cases {
            return Err(ShardError(format!(
                "has {} rows, and its first line states {cases} cases of two; run that range again",
                rows.len()
            )));
        }
        Ok(Self { header, rows })
    }
}

/// Returns the message of the CSV reader without its place, which it counts from another line.
fn brief(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("has {len} columns, not {expected_len}"),
        _ => error.to_string(),
    }
}

/// Joins shards in any order. Each has a name that identifies it in messages.
///
/// # Errors
/// No shards are given, or they are of different campaigns, overlap, or leave cases out.
pub fn join(mut shards: Vec<(String, Shard)>) -> Result<Shard, ShardError> {
    shards.sort_by_key(|(_, shard)| shard.header.numbers.start);
    let mut shards = shards.into_iter();
    let Some((mut last, mut joined)) = shards.next() else {
        return Err(ShardError(
            "no shards; give files that `cophase campaign` wrote, or a folder of them".to_owned(),
        ));
    };
    let missing = |what: &str, from: u64, to: u64| {
        ShardError(format!(
            "{what}; give the missing cases, --from {from} --to {to}"
        ))
    };
    let start = joined.header.numbers.start;
    if start > 0 {
        let what = format!("{last}: is the first shard, and begins with case {start}");
        return Err(missing(&what, 0, start));
    }
    for (name, shard) in shards {
        if let Some(what) = joined.header.differs(&shard.header) {
            return Err(ShardError(format!(
                "{name}: is of another campaign than {last}: {what}"
            )));
        }
        let (end, start) = (joined.header.numbers.end, shard.header.numbers.start);
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
        joined.header.numbers.end = shard.header.numbers.end;
        joined.rows.extend(shard.rows);
        last = name;
    }
    let (end, of) = (joined.header.numbers.end, joined.header.of);
    if end < of {
        let what = format!("{last}: is the last shard, and the campaign has {of} cases");
        return Err(missing(&what, end, of));
    }
    Ok(joined)
}
