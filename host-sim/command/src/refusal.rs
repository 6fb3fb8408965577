//! Refusal of the command line in one sentence, with the place, the problem and the fix.
//!
//! clap finds the problem and the nearest name. Its own text for it is a paragraph that often leaves out the fix.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use cophase_scene::load;

use cophase_lab::numbers;

/// Returns the refusal of the arguments of `cophase` as a sentence, or none if clap's text is not a refusal but a page of help.
pub(super) fn sentence(
    error: &clap::Error,
    cophase: &clap::Command,
    arguments: impl IntoIterator<Item = OsString>,
) -> Option<String> {
    let arguments: Vec<_> = arguments.into_iter().skip(1).collect();
    let words = |kind| error.get(kind).map(list).unwrap_or_default();
    let one = |kind| words(kind).join(", ");
    let (place, value) = (one(ContextKind::InvalidArg), one(ContextKind::InvalidValue));
    // The option without the name of its value, as the user wrote it.
    let option = place.split([' ', '=', '[']).next().unwrap_or_default();
    let (innermost, its) = subcommand(cophase, arguments.iter().cloned());
    // Most errors have the usage of the command that met the problem, which may be an outer one.
    let usage = one(ContextKind::Usage);
    let usage = usage.trim_start_matches("Usage:").trim();
    let is_name = |word: &&str| !word.starts_with(['-', '[', '<']);
    let (named, command) = if usage.is_empty() {
        (innermost.clone(), its.clone())
    } else {
        let names = usage.split_whitespace().skip(1).take_while(is_name);
        subcommand(cophase, names.map(OsString::from))
    };
    let help = format!("`{named} --help`");
    let commands = command.get_subcommands().map(clap::Command::get_name);
    let commands: Vec<_> = commands.collect();
    // clap also suggests names that are hardly alike.
    let meant = |word: &str, kind| {
        let suggested = words(kind);
        let names: Vec<_> = suggested
            .iter()
            .map(|name| name.trim_start_matches('-'))
            .collect();
        let usual = USUAL
            .iter()
            .find(|(usual, name)| *usual == word && commands.contains(name));
        if let Some((_, name)) = usual {
            return format!("did you mean `{name}`? ");
        }
        let dashes = &word[..word.len() - word.trim_start_matches('-').len()];
        let near = load::nearest(word.trim_start_matches('-'), &names);
        near.map_or_else(String::new, |near| {
            format!("did you mean `{dashes}{near}`? ")
        })
    };
    let sentence = match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
        | ErrorKind::DisplayVersion => return None,
        ErrorKind::UnknownArgument if its.get_arguments().any(|known| is_named(known, &place)) => {
            format!("{place}: `{named}` has no such option; give it after `{innermost}`")
        }
        ErrorKind::UnknownArgument if place.starts_with('-') => {
            let meant = meant(&place, ContextKind::SuggestedArg);
            format!("{place}: `{named}` has no such option; {meant}{help} has all")
        }
        ErrorKind::UnknownArgument => {
            format!("{place}: `{named}` takes no further argument; leave it out, or see {help}")
        }
        ErrorKind::InvalidSubcommand => {
            let word = one(ContextKind::InvalidSubcommand);
            let meant = meant(&word, ContextKind::SuggestedSubcommand);
            format!(
                "{word}: `{named}` has no such command; {meant}there are {}",
                commands.join(", ")
            )
        }
        ErrorKind::MissingSubcommand => {
            let all = commands.join(", ");
            format!("`{named}`: a further command is missing; give one of {all}")
        }
        ErrorKind::InvalidValue if value.is_empty() => {
            format!("{option}: its value is missing; give {place}, or see {help}")
        }
        ErrorKind::InvalidValue => {
            let all = one(ContextKind::ValidValue);
            let meant = meant(&value, ContextKind::SuggestedValue);
            format!("{option} {value}: there is no such value; {meant}give one of {all}")
        }
        ErrorKind::ValueValidation => {
            let source = std::error::Error::source(error);
            let reason = source.map(|source| numbers::reason(source, option));
            let what = match option {
                "--every" => "; it counts control ticks",
                _ => "",
            };
            format!(
                "{option} {}: {}{what}",
                visible(&value),
                reason.unwrap_or_default()
            )
        }
        ErrorKind::MissingRequiredArgument => {
            let form = usage.lines().next().unwrap_or_default();
            format!("{place}: missing; give `{form}`, or see {help}")
        }
        ErrorKind::ArgumentConflict => {
            // clap names no argument if the conflict is with a subcommand.
            let place = if place.is_empty() {
                format!("`{innermost}`")
            } else {
                place
            };
            let prior = words(ContextKind::PriorArg);
            let all = prior.join(", ");
            match prior.len() {
                1 if all == place => format!("{place}: given twice; give it once"),
                0 | 1 => format!("{place}: cannot be used with {all}; leave one of the two out"),
                _ => format!("{place}: cannot be used with {all}; leave it, or them, out"),
            }
        }
        ErrorKind::TooManyValues => {
            format!("{option}: takes no value; leave {} out", visible(&value))
        }
        ErrorKind::InvalidUtf8 => {
            // The error of clap does not contain the argument.
            let wrong = arguments.iter().filter(|word| word.to_str().is_none());
            let wrong: Vec<_> = wrong.map(|word| word.to_string_lossy()).collect();
            format!("{}: not UTF-8; give it in UTF-8", wrong.join(", "))
        }
        _ => {
            let text = error.to_string();
            let problem = text.lines().next().unwrap_or_default();
            format!("{}; see {help}", problem.trim_start_matches("error: "))
        }
    };
    Some(sentence)
}

/// Returns a word, or quotation marks for an empty one.
pub(super) fn visible(word: &str) -> &str {
    if word.is_empty() { "''" } else { word }
}

/// Returns the words of a context.
fn list(value: &ContextValue) -> Vec<String> {
    match value {
        ContextValue::Strings(words) => words.clone(),
        ContextValue::None => Vec::new(),
        other => vec![other.to_string()],
    }
}

/// Returns true if an option has this name, with its dashes.
fn is_named(option: &clap::Arg, name: &str) -> bool {
    let long = name.strip_prefix("--");
    long.is_some() && long == option.get_long()
}

/// Names that other programs have for commands. None of them moves a machine.
const USUAL: [(&str, &str); 9] = [
    ("simulate", "run"),
    ("sim", "run"),
    ("diff", "compare"),
    ("plot", "scope"),
    ("status", "identify"),
    ("info", "identify"),
    ("upload", "load"),
    ("pause", "hold"),
    ("abort", "stop"),
];

/// Returns the innermost subcommand that words name, with its name in full. Other words are skipped.
fn subcommand(
    cophase: &clap::Command,
    words: impl Iterator<Item = OsString>,
) -> (String, clap::Command) {
    let mut command = cophase.clone();
    let mut named = command.get_name().to_owned();
    for word in words {
        let subcommand = word.to_str().and_then(|word| command.find_subcommand(word));
        if let Some(subcommand) = subcommand.cloned() {
            named = format!("{named} {}", subcommand.get_name());
            command = subcommand;
        }
    }
    (named, command)
}
