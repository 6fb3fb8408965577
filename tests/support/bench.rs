//! Scenes of tests: one small sound machine, of which each test changes single keys.

use cophase_files::trace::{Every, Window};
use cophase_scene::{SceneError, keys, library, load};
use host_sim::checked::Checked;
use toml::{Table, Value};

use crate::{Run, record};

/// Three steppers under a light platform, with a program of a second. Keys that have a default are left to it.
const BENCH: &str = r#"
name = "bench"
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 5
[limits]
speed_hz = 20
acceleration_hz_per_s = 40
jerk_hz_per_s2 = 800
[axes]
count = 3
drive = "stepper"
steps_per_turn = 3200
[[program]]
amax_g = 8
ramp_s = 0.5
hold_s = 0.5
"#;

/// The machine of most tests.
pub fn bench_scene() -> SceneBuilder {
    SceneBuilder(Table::new()).with(BENCH)
}

/// A built-in scene, to be changed.
///
/// # Panics
/// If there is none of that name.
pub fn built_in_scene(name: &str) -> SceneBuilder {
    let scene = library::find(name).unwrap_or_else(|| panic!("no built-in scene `{name}`"));
    SceneBuilder(Table::new()).with(scene.text)
}

/// A scene whose keys are changed one by one. Every method panics with the name of a key that no scene has.
#[derive(Clone, Debug)]
pub struct SceneBuilder(Table);

impl SceneBuilder {
    /// Sets a key by its path, such as `limits.speed_hz`.
    #[must_use]
    pub fn set(mut self, path: &str, value: impl Into<Value>) -> Self {
        let (table, key) = self.table_of(path);
        table.insert(key.to_owned(), value.into());
        self
    }

    /// Sets a key of an axis.
    #[must_use]
    pub fn axis(self, number: usize, key: &str, value: impl Into<Value>) -> Self {
        let mut own = Table::new();
        own.insert("number".to_owned(), (number as i64).into());
        own.insert(key.to_owned(), value.into());
        let mut axis = Table::new();
        axis.insert("axis".to_owned(), Value::Array(vec![own.into()]));
        self.merged(axis)
    }

    /// Replaces the program: level in g, ramp and hold in seconds of each segment.
    #[must_use]
    pub fn program<const N: usize>(self, segments: [(f64, f64, f64); N]) -> Self {
        let segment = |(amax_g, ramp_s, hold_s)| {
            format!("[[program]]\namax_g = {amax_g:?}\nramp_s = {ramp_s:?}\nhold_s = {hold_s:?}\n")
        };
        self.with(&segments.map(segment).concat())
    }

    /// Changes what a piece of a scene file states, and keeps all else. Entries of lists, such as `[[fault]]`, come after those that are
    /// there, apart from those of an axis that has one, and of the program, which is replaced.
    #[must_use]
    pub fn with(self, toml: &str) -> Self {
        let change = toml
            .parse()
            .unwrap_or_else(|error| panic!("{error}\n{toml}"));
        self.merged(change)
    }

    /// Removes a key or a table that is there.
    #[must_use]
    pub fn without(mut self, path: &str) -> Self {
        let (table, key) = self.table_of(path);
        assert!(
            table.remove(key).is_some(),
            "the scene has no `{path}` to remove"
        );
        self
    }

    /// The scene file.
    pub fn text(&self) -> String {
        toml::to_string(&self.0).expect("a scene is TOML")
    }

    /// The checked scene.
    ///
    /// # Panics
    /// If it is refused, with the message that a user would get.
    pub fn checked(&self) -> Checked {
        self.check()
            .unwrap_or_else(|error| panic!("{error}\n{}", self.text()))
    }

    /// A run with each tick's row from the first motion on.
    ///
    /// # Panics
    /// See [`SceneBuilder::checked`] and [`record`].
    pub fn run(&self) -> Run {
        record(&self.checked(), Every::Ticks(1), Window::FirstMotion)
    }

    /// The error for which the scene is refused.
    ///
    /// # Panics
    /// If it is accepted.
    pub fn refusal(&self) -> SceneError {
        match self.check() {
            Ok(_) => panic!("it is accepted:\n{}", self.text()),
            Err(error) => error,
        }
    }

    /// Returns the message with which the scene is refused. See [`SceneBuilder::refusal`].
    pub fn refused(&self) -> String {
        self.refusal().to_string()
    }

    /// Checks a scene whose form is right.
    ///
    /// # Errors
    /// Those of [`Checked::new`].
    ///
    /// # Panics
    /// If its form is wrong.
    pub fn check(&self) -> Result<Checked, SceneError> {
        let text = self.text();
        Checked::new(load::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}")))
    }

    /// The table of a key path, made if need be, and the key in it.
    fn table_of<'a>(&mut self, path: &'a str) -> (&mut Table, &'a str) {
        assert!(keys::row(path).is_some(), "no scene has a key `{path}`");
        let (tables, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut table = &mut self.0;
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            let inner = table.entry(name).or_insert_with(|| Table::new().into());
            table = inner
                .as_table_mut()
                .unwrap_or_else(|| panic!("`{name}` of `{path}` is no table"));
        }
        (table, key)
    }

    fn merged(mut self, change: Table) -> Self {
        merge(&mut self.0, change, "");
        self
    }
}

fn merge(table: &mut Table, change: Table, within: &str) {
    for (key, value) in change {
        let path = format!("{within}{key}");
        assert!(keys::row(&path).is_some(), "no scene has a key `{path}`");
        match (table.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) => merge(old, new, &format!("{path}.")),
            (old, Value::Array(entries)) if within.is_empty() => {
                let kept = old.and_then(|old| old.as_array_mut().map(std::mem::take));
                let mut list = kept.filter(|_| key != "program").unwrap_or_default();
                for entry in entries {
                    add(&mut list, entry, &format!("{path}."));
                }
                table.insert(key, list.into());
            }
            (_, Value::Table(new)) => {
                let mut inner = Table::new();
                merge(&mut inner, new, &format!("{path}."));
                table.insert(key, inner.into());
            }
            (_, value) => {
                table.insert(key, value);
            }
        }
    }
}

/// Adds an entry to a list of tables, or changes the entry of the same number.
fn add(list: &mut Vec<Value>, entry: Value, within: &str) {
    let Value::Table(entry) = entry else {
        list.push(entry);
        return;
    };
    let number = entry.get("number").cloned();
    let same = |old: &&mut Value| number.is_some() && old.get("number") == number.as_ref();
    if let Some(Value::Table(old)) = list.iter_mut().find(same) {
        merge(old, entry, within);
    } else {
        let mut table = Table::new();
        merge(&mut table, entry, within);
        list.push(table.into());
    }
}
