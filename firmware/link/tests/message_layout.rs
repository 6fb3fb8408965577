//! The tables of messages in docs/link.md, against the types. `COPHASE_BLESS=1 cargo test -p cophase-link --test integration message_layout` writes
//! them.

use std::fmt::Write;
use std::path::Path;

use cophase_core::program::{EntrySettings, Shape};
use cophase_core::supervisor::{Command, RefusalReason, State};
use cophase_link::frame::{self, MAX_FRAME_BYTES};
use cophase_link::message::{
    Control, ControlRequest, Event, File, Message, Output, Refusal, ReplyBody, Request, StopKind,
    VERSION,
};
use cophase_link::sample::{Channel, flags};
use serde_reflection::{
    ContainerFormat, Format, Named, Registry, Samples, Tracer, TracerConfig, VariantFormat,
};

const BEGIN: &str =
    "<!-- The tables below are written by firmware/link/tests/message_layout.rs. -->\n";
const END: &str =
    "<!-- The tables above are written by firmware/link/tests/message_layout.rs. -->\n";

/// The types, with all that they consist of.
fn registry() -> Registry {
    let mut tracer = Tracer::new(TracerConfig::default());
    let samples = Samples::new();
    macro_rules! trace {
        ($($of:ty),*) => { $(tracer.trace_type::<$of>(&samples).unwrap();)* };
    }
    trace!(File, ControlRequest, StopKind, Output, Request<'_>);
    trace!(Shape, EntrySettings);
    trace!(Control, Event, Refusal, ReplyBody<'_>, Message<'_>);
    let mut registry = tracer.registry_unchecked();
    // serde has no names of its variants: its place has them ([`type_name`]).
    registry.remove("Result");
    registry
}

/// A type as the text above the tables names it.
fn type_name(format: &Format) -> String {
    match format {
        Format::TypeName(name) if name == "Result" => {
            "0 and a `ReplyBody`, or 1 and a `Refusal`".to_owned()
        }
        Format::TypeName(name) => format!("`{name}`"),
        Format::Bool => "bool".to_owned(),
        Format::U8 => "u8".to_owned(),
        Format::U16 => "u16".to_owned(),
        Format::U32 => "u32".to_owned(),
        Format::U64 => "u64".to_owned(),
        Format::F32 => "f32".to_owned(),
        Format::F64 => "f64".to_owned(),
        Format::Str => "text".to_owned(),
        Format::Bytes => "bytes".to_owned(),
        Format::Option(inner) => format!("optional {}", type_name(inner)),
        Format::Seq(inner) => format!("list of {}", type_name(inner)),
        Format::TupleArray { content, size } => format!("{size} × {}", type_name(content)),
        other => panic!("{other:?} has no name in docs/link.md yet"),
    }
}

fn fields(named: &[Named<Format>]) -> String {
    let field = |field: &Named<Format>| format!("{}: {}", field.name, type_name(&field.value));
    named.iter().map(field).collect::<Vec<_>>().join(", ")
}

fn variant(format: &VariantFormat) -> String {
    match format {
        VariantFormat::Unit => String::new(),
        VariantFormat::NewType(inner) => type_name(inner),
        VariantFormat::Struct(named) => fields(named),
        other => panic!("{other:?} has no form in docs/link.md yet"),
    }
}

/// One type: a table of its variants, or a sentence with its fields.
fn section(name: &str, registry: &Registry) -> String {
    match &registry[name] {
        ContainerFormat::Enum(variants) => {
            let mut table = format!("| `{name}` | number | fields |\n| --- | ---: | --- |\n");
            for (number, named) in variants {
                let fields = variant(&named.value);
                writeln!(table, "| `{}` | {number} | {fields} |", named.name).unwrap();
            }
            table
        }
        ContainerFormat::Struct(named) => format!("`{name}`: {}.\n", fields(named)),
        ContainerFormat::NewTypeStruct(inner) => format!("`{name}`: {}.\n", type_name(inner)),
        other => panic!("{name}: {other:?} has no form in docs/link.md yet"),
    }
}

fn numbered<'a>(what: &str, names: impl IntoIterator<Item = (u32, &'a str)>) -> String {
    let mut table = format!("| {what} | number |\n| --- | ---: |\n");
    for (number, name) in names {
        writeln!(table, "| {name} | {number} |").unwrap();
    }
    table
}

fn example() -> String {
    let hex = |bytes: &[u8]| {
        let digits: Vec<_> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        digits.join(" ")
    };
    let mut payload = [0; 8];
    let request = Request::Override { permille: 500 };
    let payload = postcard::to_slice(&request, &mut payload).unwrap();
    let mut buffer = [0; MAX_FRAME_BYTES];
    let fill = |room: &mut [u8]| {
        room[..payload.len()].copy_from_slice(payload);
        Some(payload.len())
    };
    let length = frame::encode(0, &mut buffer, fill).unwrap();
    format!(
        "`Override` with 500 thousandths is `{}`. As a frame with the number 0 it is `{}`.\n",
        hex(payload),
        hex(&buffer[..length])
    )
}

fn tables() -> String {
    let registry = registry();
    // From the outside in; the test fails for a type that is missing here.
    let order = [
        "Request",
        "File",
        "ControlRequest",
        "StopKind",
        "Output",
        "Message",
        "ReplyBody",
        "Refusal",
        "Identity",
        "Counters",
        "FrameCounts",
        "Inputs",
        "Status",
        "Control",
        "EventRecord",
        "Event",
        "FaultRecord",
        "RefusedRecord",
        "EntrySettings",
        "SegmentSettings",
        "Shape",
    ];
    let missing: Vec<_> = registry
        .keys()
        .filter(|name| !order.contains(&name.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "{missing:?} are missing in the order of the tables"
    );
    let mut sections = vec![format!("Version of the protocol: {VERSION}.\n"), example()];
    sections.extend(order.iter().map(|name| section(name, &registry)));
    let count = |names: Vec<&'static str>| (0..).zip(names);
    let states = State::ALL.map(State::name).to_vec();
    sections.push(numbered("state", count(states)));
    let commands = Command::REFUSABLE.map(|command| command.name()).to_vec();
    sections.push(numbered("command that can be refused", count(commands)));
    let reasons = RefusalReason::ALL.map(RefusalReason::text).to_vec();
    sections.push(numbered("reason of a refused command", count(reasons)));
    let flag = |flag: u8, name| (u32::from(flag), name);
    sections.push(numbered(
        "flag",
        [
            flag(flags::DRIVES, "the drives are on"),
            flag(flags::HOLDING, "a hold stops the program's time"),
            flag(flags::FAULT, "a fault has latched"),
            flag(flags::ENABLE, "the enable input is closed"),
            flag(flags::STOP, "the stop input is active"),
            flag(flags::HOMED, "the cranks are homed"),
            flag(flags::PROGRAM_DONE, "the program is over"),
            flag(flags::JOGS, "a jog turns the machine"),
        ],
    ));
    let channel = |channel: Channel, name| (channel as u32, name);
    sections.push(numbered(
        "channel, in the order of the values in a packet",
        [
            channel(Channel::State, "state"),
            channel(Channel::Program, "program"),
            channel(Channel::Amax, "amax"),
            channel(Channel::Speed, "speed"),
            channel(Channel::Acceleration, "acceleration"),
            channel(Channel::Phase, "phase"),
            channel(Channel::Lead, "lead"),
            channel(Channel::Steps, "steps"),
            channel(Channel::PhaseError, "phase error"),
            channel(Channel::Correction, "correction"),
            channel(Channel::Modes, "modes"),
        ],
    ));
    sections.join("\n")
}

#[test]
fn the_manual_has_the_layout_of_every_message() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/link.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page
        .split_once(BEGIN)
        .expect("the mark before the tables is gone");
    let (written, after) = rest
        .split_once(END)
        .expect("the mark after the tables is gone");
    let tables = format!("\n{}\n", tables());
    if std::env::var_os("COPHASE_BLESS").is_some() {
        std::fs::write(&path, [before, BEGIN, &tables, END, after].concat()).unwrap();
        return;
    }
    assert!(
        written == tables,
        "docs/link.md differs; `COPHASE_BLESS=1 cargo test -p cophase-link --test integration message_layout` writes it"
    );
}
