//! `cophase link record`: writes the stream of a controller as the files of a run.

use std::io::Write;

use clap::ValueEnum;
use cophase_core::settings::Settings;
use cophase_files::record::{Recorded, Recording, Stream};
use cophase_files::report::{Frames, Report, mark, recorded_summary};
use cophase_files::trace::{Format, RunFiles, Window};
use cophase_link::board::{Board, Rp2040};
use cophase_link::decode;
use cophase_link::message::{Counters, File, Identity, Request};
use cophase_link::sample::{ALL_CHANNELS, Channel, Channels};

use super::Problem;
use super::args::{LinkArgs, RecordArgs};
use super::connection::Connection;
use super::error::LinkError;
use super::operate::{begin, confirm};
use super::session::Session;
use crate::Status;
use crate::run::{PAGE, REPORT, optional_files, refuse_folders, removed_line};

/// Channel of a sample, as `--channels` names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ChannelName {
    /// Requested amax
    Amax,
    /// Speed, and the amax of it
    Speed,
    /// Acceleration of the master; it has no column
    Acceleration,
    /// Phase of the master
    Phase,
    /// Commanded phases of the axes, together with the phase
    Lead,
    /// Commanded steps
    Steps,
    /// Measured phase errors
    PhaseError,
    /// Common lag, tilt and warp of the phase errors; it has no column
    Modes,
    /// Corrections
    Correction,
    /// Time of the program
    Program,
}

impl ChannelName {
    const fn channel(self) -> Channel {
        match self {
            Self::Amax => Channel::Amax,
            Self::Speed => Channel::Speed,
            Self::Acceleration => Channel::Acceleration,
            Self::Phase => Channel::Phase,
            Self::Lead => Channel::Lead,
            Self::Steps => Channel::Steps,
            Self::PhaseError => Channel::PhaseError,
            Self::Modes => Channel::Modes,
            Self::Correction => Channel::Correction,
            Self::Program => Channel::Program,
        }
    }
}

/// Files of a recording.
const FILES: [&str; 4] = [
    REPORT,
    Format::Csv.file_name(),
    Format::Vcd.file_name(),
    PAGE,
];

/// Returns the streamed channels: the named ones and the state, or all.
fn channels(names: &[ChannelName]) -> Channels {
    if names.is_empty() {
        return ALL_CHANNELS;
    }
    names.iter().fold(Channel::State as Channels, |all, name| {
        all | name.channel() as Channels
    })
}

/// Records until the program or the time is over, or until Ctrl-C.
pub(super) fn record(
    args: &RecordArgs,
    link_args: &LinkArgs,
    link: &mut Connection,
    identity: &Identity,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, Problem> {
    if args.window.is_some() && args.every > 1 {
        return Err(LinkError::Input(format!(
            "--window: with --every {} there are no edges to show, as those need every tick; leave one of the two out",
            args.every
        ))
        .into());
    }
    let settings = settings(link, identity)?;
    let starts = args.start || link.is_simulated();
    if args.start && !link.is_simulated() {
        confirm(args.yes, "runs its program", err)?;
    }
    let input = |problem: String| Problem::from(LinkError::Input(problem));
    refuse_folders(&args.out, FILES.into_iter()).map_err(input)?;
    let mut files = RunFiles::create(&args.out).map_err(|e| {
        input(format!(
            "--out: {e}; give a directory that is there or can be made"
        ))
    })?;
    let mut file = |name| files.file(name).map_err(|e| input(e.to_string()));
    let [mut report, csv, vcd, mut svg] = [
        file(FILES[0])?,
        file(FILES[1])?,
        file(FILES[2])?,
        file(FILES[3])?,
    ];
    let stream = Stream {
        channels: channels(&args.channels),
        every: args.every,
    };
    let window = args.window.unwrap_or(Window::FirstMotion);
    let recording =
        Recording::new(&settings, stream, csv, vcd, window).map_err(|e| input(e.to_string()))?;

    let next = link.events(0)?.last().map_or(0, |event| event.number + 1);
    let request = Request::Stream {
        channels: stream.channels,
        every: stream.every,
    };
    link.repeatable("record", &request)?;
    let mut session = Session::new(recording, identity, args.quiet);
    if starts {
        link.take_control(link_args.take_over)?;
        // Otherwise the recording may begin with a machine whose drives are already on.
        session.wait_for_sample(link)?;
        begin(link, "start", &Request::Start)?;
    }
    let recorded = session.record(link, args.for_s);
    let (counters, lost_line) = match recorded.and_then(|()| session.end(link, next)) {
        Ok(counters) => (counters, None),
        // The samples before the loss are still recorded.
        Err(Problem::Link(error)) if error.is_of_line() => {
            (Counters::default(), Some(error.to_string()))
        }
        Err(problem) => return Err(problem),
    };
    let frames = link.frames();
    let mut recorded = session.finish(&counters).map_err(input)?;
    let record = &recorded.record;
    mark(&mut recorded.scope, record, &record.events);
    let frames = Frames {
        damaged: frames.bad,
        missing: frames.missing,
    };
    let written = Report::of_recording(
        identity,
        &settings.axes,
        &recorded,
        frames,
        lost_line.as_deref(),
    );
    write_page(&mut report, &mut svg, &written, &recorded).map_err(|e| input(e.to_string()))?;
    drop((report, svg));
    let without_edges = recorded.no_edges.is_some().then_some(FILES[2]);
    let others = optional_files().filter(|name| !FILES.contains(name));
    let mut removed: Vec<_> = others.chain(without_edges).collect();
    removed.retain(|name| files.leave_out(name));
    let written_files = files.commit().map_err(|e| input(e.to_string()))?;
    if !args.quiet {
        out.write_all(recorded_summary(identity, &recorded, lost_line.as_deref()).as_bytes())?;
        let names: Vec<_> = written_files
            .iter()
            .filter_map(|path| path.file_name()?.to_str())
            .collect();
        writeln!(
            out,
            "Written to {}: {}.",
            args.out.display(),
            names.join(", ")
        )?;
        out.write_all(removed_line(&removed).as_bytes())?;
    }
    let went_wrong = recorded.has_fault() || lost_line.is_some();
    Ok(if went_wrong {
        Status::Fault
    } else {
        Status::Done
    })
}

/// Returns the settings that the controller runs, with the clock of its board.
fn settings(link: &mut Connection, identity: &Identity) -> Result<Settings, LinkError> {
    let mut settings = decode(&link.read_file(File::Settings)?)
        .map_err(|e| LinkError::Input(format!("the controller's settings: {e}")))?;
    settings.clock_hz = Rp2040::CLOCK_HZ;
    settings.controller().map_err(|e| {
        LinkError::Input(format!("the controller's settings: {e}; load other ones"))
    })?;
    if settings.axes.len() != usize::from(identity.axes) {
        return Err(LinkError::Input(format!(
            "the controller runs {} of the {} axes of its settings; end the bring-up with `cophase link restart`",
            identity.axes,
            settings.axes.len()
        )));
    }
    Ok(settings)
}

fn write_page(
    report: &mut impl Write,
    svg: &mut impl Write,
    written: &Report<'_>,
    recorded: &Recorded,
) -> std::io::Result<()> {
    serde_json::to_writer_pretty(&mut *report, written)?;
    report.write_all(b"\n")?;
    report.flush()?;
    svg.write_all(recorded.scope.render().as_bytes())?;
    svg.flush()
}
