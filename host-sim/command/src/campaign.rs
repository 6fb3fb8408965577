//! `cophase campaign`: thousands of faults, each on its own machine, and the reactions of the loop.

use std::ffi::OsStr;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use cophase_files::trace::RunFiles;
use cophase_lab::campaign::example::{Example, example};
use cophase_lab::campaign::plan::Plan;
use cophase_lab::campaign::selection::Selection;
use cophase_lab::campaign::shards::{Header, MACHINES, Shard, join};
use cophase_lab::campaign::tally::Counter;
use cophase_lab::campaign::{self, picture, table};
use cophase_scene::input_file::{self, MAX_TABLE_BYTES};
use indicatif::{ProgressBar, ProgressStyle};

use super::{CommandError, Status, run, scenes};
use cophase_lab::numbers::whole;

/// Inject one random fault into each of thousands of machines, and compare every reaction with the claims
///
/// Each case is run twice: with its fault, and without it, with noise alone. Without SCENE, machines are drawn: three mechanisms, two to six axes, steppers with index sensors alone or with encoders, and
/// servos. So `--runs 10000` makes 10,000 faulty runs and 10,000 clean ones.
#[derive(Debug, clap::Args)]
pub(super) struct CampaignArgs {
    /// A scene file, or the name of a built-in scene, to draw faults for [default: machines are drawn]
    #[arg(value_name = "SCENE")]
    scene: Option<String>,
    /// Number of cases, each a faulty and a clean run; with --only, of those that are simulated
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole::<u64>(1..=u64::MAX), allow_negative_numbers = true)]
    runs: u64,
    /// Seed of all random draws; the same seed gives the same rows
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = whole::<u64>(0..=u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Simulate only cases of these kinds of faults, on axes with this sensor: `index` (alone) or `encoder` [default: both]
    #[arg(
        long,
        value_name = "KIND[:SENSOR]",
        value_delimiter = ',',
        conflicts_with = "join"
    )]
    only: Vec<String>,
    /// With --only: simulate 1 in K of all other cases too, for rates over all faulty runs
    #[arg(long, value_name = "K", conflicts_with = "join", value_parser = whole::<u64>(1..=u64::MAX), allow_negative_numbers = true)]
    others: Option<u64>,
    /// First case of this shard, to split a campaign over several computers; with --join, of those that are joined
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = whole::<u64>(0..=u64::MAX), allow_negative_numbers = true)]
    from: u64,
    /// Case after the last of this shard [default: all of --runs]
    #[arg(long, value_name = "K", value_parser = whole::<u64>(1..=u64::MAX), allow_negative_numbers = true)]
    to: Option<u64>,
    /// Number of threads [default: one for each core]; rows do not depend on it
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Folder for campaign.csv (of a shard: campaign-FROM-TO.csv), campaign.svg and campaign-table.md [default: out/campaign; with --replay,
    /// out/case-K]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Run case K alone, as `cophase run` does, and write its scene.toml too; scene, seed and K define it, and other options of its campaign
    /// may stay
    #[arg(long, value_name = "K", conflicts_with = "join", value_parser = whole::<u64>(0..=u64::MAX), allow_negative_numbers = true)]
    replay: Option<u64>,
    /// With --replay: make the clean run of the case, without its fault
    #[arg(long, requires = "replay")]
    clean: bool,
    /// Run nothing, and join shards: files, or folders with campaign-*.csv. Together they must be the whole campaign, or the cases from --from to --to
    #[arg(long, value_name = "PATH", num_args = 1.., conflicts_with_all = ["scene", "threads", "runs", "seed"])]
    join: Vec<PathBuf>,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

impl CampaignArgs {
    /// Returns the output folder. A run, a campaign and each case have folders of their own unless one is given.
    fn folder(&self) -> PathBuf {
        let own = || match self.replay {
            None => "out/campaign".into(),
            Some(number) if self.clean => format!("out/case-{number}-clean").into(),
            Some(number) => format!("out/case-{number}").into(),
        };
        self.out.clone().unwrap_or_else(own)
    }
}

pub(super) fn campaign(
    args: &CampaignArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, CommandError> {
    if !args.join.is_empty() {
        let mut shards = shards(&args.join)?;
        let header = join(&mut shards, args.from, args.to);
        let mut shards = shards.into_iter().map(|(path, _)| {
            let place = path.display().to_string();
            Shard::parse(&read(&path)?).map_err(|error| input(&place, &error))
        });
        let header = match header {
            Ok(header) => header,
            Err(error) => {
                // The cause may be a damaged shard, which is named instead.
                shards.try_for_each(|shard| shard.map(drop))?;
                return Err(input("--join", &error));
            }
        };
        return print_result(args, &header, shards, out);
    }
    let scene = args.scene.as_deref();
    let checked = scene
        .map(scenes::read)
        .transpose()
        .map_err(CommandError::Input)?;
    let plan = Plan::new(args.seed, checked).map_err(|error| {
        CommandError::Input(error.in_file(scene.unwrap_or_default()).to_string())
    })?;
    match args.replay {
        Some(number) => replay(args, &plan, number, out, err),
        None => {
            let (numbers, selection) = (numbers(args)?, selection(args, &plan)?);
            let folder = writable(&args.folder())?;
            let shard = run_shard(args, &plan, numbers, selection)?;
            let header = shard.header.clone();
            let status = print_result(args, &header, std::iter::once(Ok(shard)), out)?;
            drop(folder);
            Ok(status)
        }
    }
}

fn input(place: &str, error: &dyn std::fmt::Display) -> CommandError {
    CommandError::Input(format!("{place}: {error}"))
}

/// Returns the requested cases.
fn numbers(args: &CampaignArgs) -> Result<Range<u64>, CommandError> {
    let to = args.to.unwrap_or(args.runs);
    if to > args.runs {
        let problem = format!(
            "{to} is more than --runs {}; cases are 0 to {}",
            args.runs,
            args.runs - 1
        );
        return Err(input("--to", &problem));
    }
    if args.from >= to {
        let problem = format!("{} is not before --to {to}; give a smaller one", args.from);
        return Err(input("--from", &problem));
    }
    Ok(args.from..to)
}

fn run_shard(
    args: &CampaignArgs,
    plan: &Plan,
    numbers: Range<u64>,
    selection: Option<Selection>,
) -> Result<Shard, CommandError> {
    let bar = progress_bar(args.quiet, numbers.end - numbers.start);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.map_or_else(cores, usize::from))
        .build()
        .map_err(|error| input("--threads", &error))?;
    let rows = pool
        .install(|| match &selection {
            Some(selection) => {
                let taken = selection.numbers(plan, numbers.clone());
                campaign::run_all(plan, taken, &|| bar.inc(1))
            }
            None => campaign::run_all(plan, numbers.clone(), &|| bar.inc(1)),
        })
        .map_err(|error| CommandError::Input(error.to_string()))?;
    bar.finish_and_clear();
    Ok(Shard {
        header: Header::new(plan, selection, numbers, args.runs),
        rows,
    })
}

/// Returns the requested strata.
fn selection(args: &CampaignArgs, plan: &Plan) -> Result<Option<Selection>, CommandError> {
    if args.only.is_empty() {
        return match args.others {
            None => Ok(None),
            Some(_) => Err(input(
                "--others",
                &"needs --only, as it is for the cases that --only leaves out; give --only, or leave --others out",
            )),
        };
    }
    let selection = Selection::new(plan, &args.only, args.others);
    selection.map(Some).map_err(|error| input("--only", &error))
}

/// Returns the number of cores. rayon uses the same number, unless an environment variable sets another one.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Writes a shard with its picture and its table, and prints the table. It is the union of shards that come in their order, of which only
/// one is in memory at a time: a campaign of millions of cases has gigabytes.
fn print_result(
    args: &CampaignArgs,
    header: &Header,
    shards: impl Iterator<Item = Result<Shard, CommandError>>,
    out: &mut impl Write,
) -> Result<Status, CommandError> {
    let Range { start, end } = header.numbers;
    let name = if header.is_whole() {
        "campaign.csv".to_owned()
    } else {
        format!("campaign-{start}-{end}.csv")
    };
    let folder = args.folder();
    let mut files = RunFiles::create(&folder).map_err(|error| unwritable(&error))?;
    let mut rows = files.file(&name).map_err(|error| unwritable(&error))?;
    let mut counter = Counter::new(header);
    for (place, shard) in shards.enumerate() {
        let shard = shard?;
        counter.add(&shard.rows);
        let text = shard.text_in(header, place == 0);
        let text = text.map_err(|error| input("rows", &error))?;
        (rows.write_all(text.as_bytes())).map_err(|error| unwritable(&error))?;
    }
    rows.flush().map_err(|error| unwritable(&error))?;
    drop(rows);
    let tally = counter.finish();
    let text = table::text(header, &tally);
    let svg = picture::svg(header, &tally);
    write_texts(
        &mut files,
        &[("campaign.svg", &svg), ("campaign-table.md", &text)],
    )?;
    files.commit().map_err(|error| unwritable(&error))?;
    if !args.quiet {
        writeln!(
            out,
            "{text}\nWritten to {}: {name}, campaign.svg, campaign-table.md.",
            folder.display()
        )?;
        if let Some(example) = example(&tally) {
            writeln!(out, "\n{}", how_to_replay(args, header, &example))?;
        }
    }
    Ok(if tally.is_kept() {
        Status::Done
    } else {
        Status::Fault
    })
}

/// Returns the words on how to run a case again, with a command for the shell that calls the program as it was called.
fn how_to_replay(args: &CampaignArgs, header: &Header, example: &Example) -> String {
    let program = std::env::args_os().next();
    // A path that is not UTF-8 cannot be printed as a shell has to get it.
    let program = program.as_deref().and_then(OsStr::to_str);
    let mut words = vec![quoted(program.unwrap_or("cophase"))];
    words.push("campaign".to_owned());
    let mut with = "";
    match &args.scene {
        Some(scene) => words.push(quoted(scene)),
        // A shard has only the checksum of its scene.
        None if header.scene != MACHINES => {
            words.push("SCENE".to_owned());
            with = ", with the campaign's scene for SCENE";
        }
        None => {}
    }
    words.push(format!(
        "--seed {} --replay {}",
        header.seed, example.number
    ));
    if example.clean {
        words.push("--clean".to_owned());
    }
    let command = words.join(" ");
    format!("To run a case again, such as {example}{with}:\n\n    {command}")
}

/// Returns a word as a shell has to get it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:@%+,=".contains(c);
    if word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Creates the folder and refuses one that cannot be written, before hours of simulation. The folder stays at least until the result is
/// dropped: other shards that start in it need it.
fn writable(folder: &Path) -> Result<RunFiles, CommandError> {
    let kept = RunFiles::create(folder).map_err(|error| unwritable(&error))?;
    // The drop of this probe removes its file, but not the folder, because `kept` has created it.
    let mut probe = RunFiles::create(folder).map_err(|error| unwritable(&error))?;
    probe.file("probe").map_err(|error| unwritable(&error))?;
    Ok(kept)
}

/// Writes texts into files.
fn write_texts(files: &mut RunFiles, texts: &[(&str, &str)]) -> Result<(), CommandError> {
    for (name, text) in texts {
        let mut file = files.file(name).map_err(|error| unwritable(&error))?;
        file.write_all(text.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|error| unwritable(&error))?;
    }
    Ok(())
}

fn unwritable(error: &dyn std::fmt::Display) -> CommandError {
    input(
        "--out",
        &format!("{error}; give a folder that can be written"),
    )
}

/// Runs one case again. Writes its scene and all files of `cophase run`.
fn replay(
    args: &CampaignArgs,
    plan: &Plan,
    number: u64,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, CommandError> {
    if let Some(selection) = selection(args, plan)? {
        let stratum = plan.stratum(number);
        if !selection.has(number, stratum) {
            let problem = format!(
                "case {number} is of `{stratum}`, which --only leaves out; leave --only out, or give one of its cases"
            );
            return Err(input("--replay", &problem));
        }
    }
    let case = plan.case(number);
    let row =
        campaign::run(&case, args.clean).map_err(|error| CommandError::Input(error.to_string()))?;
    let text =
        toml::to_string(&case.scene_of(args.clean)).map_err(|error| input("scene.toml", &error))?;
    let folder = args.folder();
    let mut files = RunFiles::create(&folder).map_err(|error| unwritable(&error))?;
    write_texts(&mut files, &[("scene.toml", &text)])?;
    files.commit().map_err(|error| unwritable(&error))?;
    let scene = folder.join("scene.toml");
    let status = run::run(&run::RunArgs::new(&scene, &folder, args.quiet), out, err)?;
    if !args.quiet {
        let row = serde_json::to_string_pretty(&row).map_err(|error| input("row", &error))?;
        writeln!(
            out,
            "\nscene.toml is beside them. As the campaign has it:\n{row}"
        )?;
    }
    Ok(status)
}

/// Returns the paths and identities of shards. From a folder, it takes all files with the name of a shard.
fn shards(paths: &[PathBuf]) -> Result<Vec<(PathBuf, Header)>, CommandError> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let place = path.display().to_string();
        let entries = std::fs::read_dir(path).map_err(|error| input(&place, &error))?;
        let mut inside: Vec<_> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|file| is_shard(file))
            .collect();
        if inside.is_empty() {
            return Err(input(
                &place,
                &"has no campaign-FROM-TO.csv in it; give a folder with shards",
            ));
        }
        inside.sort();
        files.append(&mut inside);
    }
    let identity = |path: PathBuf| {
        let place = path.display().to_string();
        let header = Shard::identity(&read(&path)?).map_err(|error| input(&place, &error))?;
        Ok((path, header))
    };
    files.into_iter().map(identity).collect()
}

/// Reads the text of a shard.
fn read(path: &Path) -> Result<String, CommandError> {
    input_file::read_text(path, MAX_TABLE_BYTES).map_err(|error| {
        let problem = format!("{error}; give shards, or a folder with them");
        input(&path.display().to_string(), &problem)
    })
}

/// Returns true if a file has the name of a shard. The joined file beside the shards has another name.
fn is_shard(file: &Path) -> bool {
    let name = file.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.starts_with("campaign-") && name.ends_with(".csv"))
}

/// Creates a progress bar. It shows on a terminal only: indicatif draws to stderr, and only if stderr is a terminal.
fn progress_bar(quiet: bool, cases: u64) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(
        "{wide_bar} {pos} of {len} cases  {per_sec}  {elapsed} gone, {eta} to go",
    );
    ProgressBar::new(cases).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
