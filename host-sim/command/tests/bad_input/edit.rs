//! Ways to break the base scene. A *key path* is written as in messages: `program[0].ramp_s`.

/// A scene that runs, with every key given.
pub const BASE: &str = include_str!("base.toml");

/// Returns the base scene with another value at a key.
#[track_caller]
pub fn set(path: &str, value: &str) -> String {
    let (_, key) = parts(path);
    with_line(path, &format!("{key} = {value}"))
}

/// Returns the base scene with a key renamed.
#[track_caller]
pub fn rename(path: &str, to: &str) -> String {
    let (_, value) = BASE
        .lines()
        .nth(line_of(path))
        .unwrap()
        .split_once(" = ")
        .unwrap();
    with_line(path, &format!("{to} = {value}"))
}

/// Returns the base scene without a key.
#[track_caller]
pub fn without(path: &str) -> String {
    with_line(path, "")
}

/// Returns the base scene with one more line before a key.
#[track_caller]
pub fn before(path: &str, line: &str) -> String {
    let own = BASE.lines().nth(line_of(path)).unwrap();
    with_line(path, &format!("{line}\n{own}"))
}

/// Returns the base scene with another line in place of a key's line.
#[track_caller]
pub fn with_line(path: &str, line: &str) -> String {
    let at = line_of(path);
    let lines: Vec<&str> = (0..)
        .zip(BASE.lines())
        .map(|(i, own)| if i == at { line } else { own })
        .collect();
    lines.join("\n") + "\n"
}

/// Returns the base scene with every occurrence of a text replaced.
#[track_caller]
pub fn replace(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "the base scene has no {from}");
    BASE.replace(from, to)
}

/// Returns the base scene with text appended.
pub fn append(text: &str) -> String {
    format!("{BASE}\n{text}")
}

/// Returns the base scene with another program in place of its own.
pub fn program(text: &str) -> String {
    let (before, _) = BASE.split_once("[[program]]").unwrap();
    format!("{before}{text}")
}

fn parts(path: &str) -> (String, &str) {
    let Some((table, key)) = path.rsplit_once('.') else {
        return (String::new(), path);
    };
    (table.to_owned(), key)
}

#[track_caller]
fn line_of(path: &str) -> usize {
    let (table, key) = parts(path);
    let (name, entry) = table.split_once('[').unwrap_or((&table, ""));
    let (heading, entry) = match entry.trim_end_matches(']').parse::<usize>() {
        Ok(entry) => (format!("[[{name}]]"), entry),
        Err(_) => (format!("[{name}]"), 0),
    };
    let mut lines = BASE.lines().enumerate();
    if !name.is_empty() {
        lines
            .by_ref()
            .filter(|(_, line)| *line == heading)
            .nth(entry)
            .expect("a heading of the base scene");
    }
    let own = |line: &str| line.starts_with(&format!("{key} = "));
    lines
        .find(|(_, line)| own(line))
        .expect("a key of the base scene")
        .0
}
