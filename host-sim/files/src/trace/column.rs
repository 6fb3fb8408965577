//! Columns of a row: name, unit, source, resolution and value, defined once for every writer.
//!
//! *Resolution*: a number is rounded to a fixed count of decimals, so that all writers give the same number. *Topic*: columns
//! that belong together, for formats that have groups.

use super::rounding::rounded;
use super::{AxisRow, Row, RowShape};

/// Source of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Controller, which requests, commands or measures the value.
    Controller,
    /// True state of the simulated machine, to which no controller has access.
    Machine,
}

impl Source {
    /// Returns the source in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Machine => "simulated machine",
        }
    }
}

/// Group of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topic {
    /// Control loop.
    Loop,
    /// Axis, counted from 0.
    Axis(usize),
    /// Platform, or the part that another machine moves.
    Platform,
    /// Pitch of that part.
    Pitch,
}

impl Topic {
    /// Returns the topics of a run, in the order of their columns.
    pub fn of_run(shape: RowShape) -> impl Iterator<Item = Self> {
        let each = (0..shape.axes).map(Self::Axis);
        let pitch = shape.pitches.then_some(Self::Pitch);
        ([Self::Loop].into_iter().chain(each))
            .chain([Self::Platform])
            .chain(pitch)
    }

    const fn fields(self) -> &'static [Field] {
        match self {
            Self::Loop => LOOP,
            Self::Axis(_) => AXIS,
            Self::Platform => PLATFORM,
            Self::Pitch => PITCH,
        }
    }
}

/// Value of a column in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Number, rounded to the column's resolution. It need not be finite.
    Number(f64),
    /// A whole number.
    Count(i64),
    /// A word.
    Word(&'static str),
}

/// Function that reads a value from a row. The second argument is the axis; columns without an axis ignore it.
#[derive(Clone, Copy, Debug)]
pub enum Read {
    /// A number with this count of decimals, at most 9.
    Number(u32, fn(&Row, usize) -> f64),
    /// A whole number.
    Count(fn(&Row, usize) -> i64),
    /// A word.
    Word(fn(&Row, usize) -> &'static str),
}

/// Column, without the axis to which it belongs.
#[derive(Debug)]
pub struct Field {
    /// Name, without the number of an axis.
    pub name: &'static str,
    /// Unit; empty for a column without one.
    pub unit: &'static str,
    /// Source of the value.
    pub source: Source,
    /// Function that reads the value.
    pub read: Read,
}

impl Field {
    const fn new(name: &'static str, unit: &'static str, source: Source, read: Read) -> Self {
        Self {
            name,
            unit,
            source,
            read,
        }
    }
}

/// Column of a run.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Group to which it belongs.
    pub topic: Topic,
    /// Properties that all columns of its kind share.
    pub field: &'static Field,
}

impl Column {
    /// Returns the columns of a run, in the order of `trace.csv`.
    pub fn of_run(shape: RowShape) -> impl Iterator<Item = Self> {
        Topic::of_run(shape).flat_map(Self::of_topic)
    }

    /// Returns the columns of a topic.
    pub fn of_topic(topic: Topic) -> impl Iterator<Item = Self> {
        let fields = topic.fields().iter();
        fields.map(move |field| Self { topic, field })
    }

    /// Returns the name, which is unique in a run: that of the field, and the number of the axis.
    pub fn name(&self) -> String {
        match self.topic {
            Topic::Axis(i) => format!("{}_{i}", self.field.name),
            Topic::Loop | Topic::Platform | Topic::Pitch => self.field.name.to_owned(),
        }
    }

    /// Returns true if its values are numbers.
    pub const fn is_numeric(&self) -> bool {
        !matches!(self.field.read, Read::Word(_))
    }

    /// Returns the count of decimals of its numbers; 0 if its values are words or whole numbers.
    pub const fn decimals(&self) -> u32 {
        match self.field.read {
            Read::Number(decimals, _) => decimals,
            Read::Count(_) | Read::Word(_) => 0,
        }
    }

    /// Returns the value in a row.
    ///
    /// # Panics
    /// If the row does not have the column's axis.
    pub fn value(&self, row: &Row) -> Value {
        let axis = match self.topic {
            Topic::Axis(i) => i,
            Topic::Loop | Topic::Platform | Topic::Pitch => 0,
        };
        match self.field.read {
            Read::Number(decimals, read) => Value::Number(rounded(read(row, axis), decimals)),
            Read::Count(read) => Value::Count(read(row, axis)),
            Read::Word(read) => Value::Word(read(row, axis)),
        }
    }
}

/// Decimals of each kind of number.
pub(crate) mod decimals {
    /// Seconds: 1 ns.
    pub const TIME: u32 = 9;
    /// m/s²: 0.1 mm/s², 1e-5 g.
    pub const ACCELERATION: u32 = 4;
    /// rad/s: 1 µrad/s.
    pub const SPEED: u32 = 6;
    /// Turns: 1e-9, about the resolution of a phase with 32 fraction bits (2.3e-10).
    pub const TURNS: u32 = 9;
    /// Degrees: 10 µdeg.
    pub const DEGREES: u32 = 5;
    /// Milliradians: 10 nrad.
    pub const TILT: u32 = 5;
    /// Metres: 1 nm.
    pub const HEIGHT: u32 = 9;
}

use Read::{Count, Number, Word};
use Source::{Controller, Machine};

const LOOP: &[Field] = &[
    Field::new(
        "t_s",
        "s",
        Controller,
        Number(decimals::TIME, |row, _| row.t_s),
    ),
    Field::new("state", "", Controller, Word(|row, _| row.state)),
    Field::new(
        "state_code",
        "",
        Controller,
        Count(|row, _| row.state_code.into()),
    ),
    Field::new(
        "amax_requested_mps2",
        "m/s²",
        Controller,
        Number(decimals::ACCELERATION, |row, _| row.amax_requested_mps2),
    ),
    Field::new(
        "amax_commanded_mps2",
        "m/s²",
        Controller,
        Number(decimals::ACCELERATION, |row, _| row.amax_commanded_mps2),
    ),
    Field::new(
        "omega_rad_s",
        "rad/s",
        Controller,
        Number(decimals::SPEED, |row, _| row.omega_rad_s),
    ),
    Field::new(
        "phase_turns",
        "turns",
        Controller,
        Number(decimals::TURNS, |row, _| row.phase_turns),
    ),
];

const AXIS: &[Field] = &[
    Field::new("steps", "", Controller, Count(|row, i| axis(row, i).steps)),
    Field::new(
        "command_turns",
        "turns",
        Controller,
        Number(decimals::TURNS, |row, i| axis(row, i).command_turns),
    ),
    Field::new(
        "actual_turns",
        "turns",
        Machine,
        Number(decimals::TURNS, |row, i| axis(row, i).actual_turns),
    ),
    Field::new(
        "phase_error_deg",
        "deg",
        Controller,
        Number(decimals::DEGREES, |row, i| axis(row, i).phase_error_deg),
    ),
];

const PLATFORM: &[Field] = &[
    Field::new(
        "tilt_x_mrad",
        "mrad",
        Machine,
        Number(decimals::TILT, |row, _| row.tilt_x_mrad),
    ),
    Field::new(
        "tilt_y_mrad",
        "mrad",
        Machine,
        Number(decimals::TILT, |row, _| row.tilt_y_mrad),
    ),
    Field::new(
        "warp_deg",
        "deg",
        Machine,
        Number(decimals::DEGREES, |row, _| row.warp_deg),
    ),
    Field::new(
        "z_m",
        "m",
        Machine,
        Number(decimals::HEIGHT, |row, _| row.z_m),
    ),
    Field::new(
        "accel_mps2",
        "m/s²",
        Machine,
        Number(decimals::ACCELERATION, |row, _| row.accel_mps2),
    ),
    Field::new(
        "amax_actual_mps2",
        "m/s²",
        Machine,
        Number(decimals::ACCELERATION, |row, _| row.amax_actual_mps2),
    ),
];

const PITCH: &[Field] = &[Field::new(
    "pitch_mrad",
    "mrad",
    Machine,
    Number(decimals::TILT, |row, _| row.pitch_mrad),
)];

fn axis(row: &Row, i: usize) -> &AxisRow {
    &row.axes[i]
}
