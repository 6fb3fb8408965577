//! Events from outside: `[[command]]`, `[[input]]`, `[[late]]`; and `[scope]`.

use cophase_scene::file::{CommandAt, CommandName, InputAt, InputLine, LateAt, Scope};

use crate::basis::Basis;
use crate::source::Source;

#[derive(Default)]
pub struct Events {
    pub commands: Vec<CommandAt>,
    pub inputs: Vec<InputAt>,
    pub late: Vec<LateAt>,
    pub scope: Option<Scope>,
}

pub fn events(source: &mut Source, basis: &Basis) -> Events {
    if !basis.kinds.disturbed {
        return Events::default();
    }
    Events {
        commands: commands(source, basis),
        inputs: inputs(source, basis),
        late: late(source, basis),
        scope: source.maybe(10, |source| {
            let from_s = source.number(0.0, basis.begins_s + 0.5 * basis.program_s);
            Scope {
                from_s,
                to_s: from_s + source.log_between(1e-3, 0.5),
            }
        }),
    }
}

/// Commands in any order, and a stop at the end. Without it, a machine on hold would run on for two
/// minutes.
fn commands(source: &mut Source, basis: &Basis) -> Vec<CommandAt> {
    if !source.percent(30) {
        return Vec::new();
    }
    let names = [
        CommandName::Start,
        CommandName::Stop,
        CommandName::Hold,
        CommandName::Resume,
        CommandName::Reset,
        CommandName::ResetPeak,
    ];
    let mut commands: Vec<CommandAt> = (0..1 + source.below(4))
        .map(|_| CommandAt {
            at_s: basis.time_s(source),
            r#do: source.one_of(&names),
        })
        .collect();
    if source.percent(80) {
        commands.push(CommandAt {
            at_s: 0.0,
            r#do: CommandName::Start,
        });
    }
    commands.push(CommandAt {
        at_s: basis.begins_s + 1.3 * basis.program_s,
        r#do: CommandName::Stop,
    });
    commands
}

fn inputs(source: &mut Source, basis: &Basis) -> Vec<InputAt> {
    if !source.percent(15) {
        return Vec::new();
    }
    (0..1 + source.below(3))
        .map(|_| InputAt {
            at_s: basis.time_s(source),
            line: source.one_of(&[InputLine::Enable, InputLine::Stop]),
            active: source.percent(50),
        })
        .collect()
}

/// Deadlines met late, by a second at most.
fn late(source: &mut Source, basis: &Basis) -> Vec<LateAt> {
    if !source.percent(15) {
        return Vec::new();
    }
    (0..1 + source.below(3))
        .map(|_| LateAt {
            at_s: basis.time_s(source),
            by_us: source.usual((1.0, 3000.0), (0.0, 1e6)).round(),
        })
        .collect()
}
