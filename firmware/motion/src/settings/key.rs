//! Rows of keys: each key of a scene is written once, with its type, unit, default, range and reason.
//!
//! The unit of a key is at the end of its name. [`keys!`](crate::keys) makes a struct and its rows from one text, and
//! [`words!`](crate::words) an enum and the words of its values. A table of the core also has a check, with the bounds as constants.
//! Firmware that does not use the words of a row does not contain them.

#[cfg(feature = "alloc")]
extern crate alloc;

use super::{SettingsError, inside};

/// Row of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name in its table.
    pub name: &'static str,
    /// Sentences for the manual, and for editors.
    pub doc: &'static str,
    /// Form of its value.
    pub kind: Kind,
    /// Value if the key is left out.
    pub absent: Absent,
    /// Value for messages, if the default is none; written as in a scene, and text without quotes.
    pub example: &'static str,
    /// Least value; of a list, of each number in it.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Least value by other keys, if it is above the one before.
    pub at_least: Option<Product>,
    /// Greatest value by other keys, if it is below the one before.
    pub at_most: Option<Product>,
    /// Reason of the range, if it does not follow from the numbers.
    pub reason: Option<&'static str>,
    /// Names of the numbers in a list, if they differ in meaning.
    pub parts: &'static [&'static str],
}

/// End of a range that other keys determine: a factor times powers of their numbers.
#[derive(Clone, Copy, Debug)]
pub struct Product {
    /// Factor, in the unit that is left.
    pub factor: f64,
    /// Paths of keys that are numbers, with the power of each.
    pub keys: &'static [(&'static str, i32)],
}

impl Product {
    /// Returns its value; `None` if the number of a key is unknown.
    #[inline]
    pub fn of(&self, number: impl Fn(&str) -> Option<f64>) -> Option<f64> {
        let mut product = self.factor;
        for &(key, power) in self.keys {
            let number = number(key)?;
            for _ in 0..power.unsigned_abs() {
                product = if power > 0 {
                    product * number
                } else {
                    product / number
                };
            }
        }
        Some(product)
    }
}

/// Form of a value.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Number.
    Number,
    /// Whole number, between the least and the greatest one that its type holds.
    Whole(i64, i64),
    /// True or false.
    Flag,
    /// Text.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// List of values, with a fixed length if there is one.
    List(&'static Kind, Option<usize>),
    /// Table with these rows. It is a function, because a table may contain itself.
    Table(fn() -> &'static [Key]),
}

/// Value of a key that is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Absent {
    /// The key is required.
    Needed,
    /// Nothing.
    Nothing,
    /// A number.
    Number(f64),
    /// Another value, written as in a scene, and text without quotes.
    Value(&'static str),
}

const ROW: Key = Key {
    name: "",
    doc: "",
    kind: Kind::Number,
    absent: Absent::Nothing,
    example: "",
    low: f64::MIN,
    high: f64::MAX,
    at_least: None,
    at_most: None,
    reason: None,
    parts: &[],
};

/// Begins the row of a key that is required, with an example for messages.
pub const fn needed(example: &'static str) -> Key {
    Key {
        absent: Absent::Needed,
        ..optional(example)
    }
}

/// Begins the row of a key that can be left out, with an example for messages.
pub const fn optional(example: &'static str) -> Key {
    Key { example, ..ROW }
}

/// Begins the row of a key whose default is a number.
pub const fn or(default: f64) -> Key {
    Key {
        absent: Absent::Number(default),
        ..ROW
    }
}

/// Begins the row of a key whose default is no number. It is written as in a scene, and text without quotes.
pub const fn or_value(default: &'static str) -> Key {
    Key {
        absent: Absent::Value(default),
        ..ROW
    }
}

impl Key {
    /// Sets the range, ends included.
    #[must_use]
    pub const fn from(mut self, low: f64, high: f64) -> Self {
        self.low = low;
        self.high = high;
        self
    }

    /// Narrows the range to at least a factor times powers of other keys.
    #[must_use]
    pub const fn at_least(mut self, factor: f64, keys: &'static [(&'static str, i32)]) -> Self {
        self.at_least = Some(Product { factor, keys });
        self
    }

    /// Narrows the range to at most a factor times powers of other keys.
    #[must_use]
    pub const fn at_most(mut self, factor: f64, keys: &'static [(&'static str, i32)]) -> Self {
        self.at_most = Some(Product { factor, keys });
        self
    }

    /// Names the numbers of a list.
    #[must_use]
    pub const fn of_parts(mut self, parts: &'static [&'static str]) -> Self {
        self.parts = parts;
        self
    }

    /// Sets the reason of the range.
    #[must_use]
    pub const fn because(mut self, reason: &'static str) -> Self {
        self.reason = Some(reason);
        self
    }

    /// Sets the example for messages, where the default is none.
    #[must_use]
    pub const fn such_as(mut self, example: &'static str) -> Self {
        self.example = example;
        self
    }

    /// The same row for a key that can be left out.
    #[must_use]
    pub const fn or_left_out(mut self) -> Self {
        self.absent = Absent::Nothing;
        self
    }

    /// Returns the ends of the range, where the numbers of other keys are these. A number that is unknown does not narrow it.
    #[inline(always)]
    pub fn ends(&self, number: impl Fn(&str) -> Option<f64>) -> (f64, f64) {
        let end = |product: Option<Product>| product.and_then(|product| product.of(&number));
        (
            end(self.at_least).map_or(self.low, |end| end.max(self.low)),
            end(self.at_most).map_or(self.high, |end| end.min(self.high)),
        )
    }

    /// Checks that a number is within the range; `path` is its key. Inlined, so that a firmware keeps the range only.
    ///
    /// # Errors
    /// The number is outside.
    #[inline(always)]
    pub fn check(&self, path: &'static str, value: f64) -> Result<f64, SettingsError> {
        inside(path, value, self.low, self.high)
    }

    /// Checks that a number is within the range that it has beside these numbers of other keys.
    ///
    /// # Errors
    /// The number is outside.
    #[inline(always)]
    pub fn check_beside(
        &self,
        others: &[(&str, f64)],
        path: &'static str,
        value: f64,
    ) -> Result<f64, SettingsError> {
        let number = |key: &str| {
            others
                .iter()
                .find(|other| other.0 == key)
                .map(|other| other.1)
        };
        let (low, high) = self.ends(number);
        inside(path, value, low, high)
    }

    /// True if it has no range.
    pub const fn is_open(&self) -> bool {
        self.high == f64::MAX
    }

    /// Default that is a number.
    ///
    /// # Panics
    /// The row has another default, or none; at compile time.
    pub const fn number(&self) -> f64 {
        match self.absent {
            Absent::Number(default) => default,
            _ => panic!("a table of the core has numbers with defaults"),
        }
    }
}

/// Type that a value of a scene can have.
pub trait Value {
    /// Its form.
    const KIND: Kind;

    /// Returns true if a scene with this value is written without the key.
    fn is_left_out(&self) -> bool {
        false
    }
}

macro_rules! whole {
    ($($Type:ty: $min:expr, $max:expr;)+) => {
        $(impl Value for $Type {
            const KIND: Kind = Kind::Whole($min as i64, $max as i64);
        })+
    };
}

whole! {
    u32: 0, u32::MAX;
    i32: i32::MIN, i32::MAX;
    // A whole number of a TOML file has 64 bits with a sign.
    u64: 0, i64::MAX;
    usize: 0, i64::MAX;
    i64: i64::MIN, i64::MAX;
}

impl Value for f64 {
    const KIND: Kind = Kind::Number;
}

impl Value for bool {
    const KIND: Kind = Kind::Flag;
}

impl<T: Value> Value for Option<T> {
    const KIND: Kind = T::KIND;

    fn is_left_out(&self) -> bool {
        self.is_none()
    }
}

impl<T: Value> Value for (T, T) {
    const KIND: Kind = Kind::List(&T::KIND, Some(2));
}

impl<T: Value, const N: usize> Value for [T; N] {
    const KIND: Kind = Kind::List(&T::KIND, Some(N));
}

#[cfg(feature = "alloc")]
impl<T: Value> Value for alloc::vec::Vec<T> {
    const KIND: Kind = Kind::List(&T::KIND, None);

    fn is_left_out(&self) -> bool {
        self.is_empty()
    }
}

#[cfg(feature = "alloc")]
impl Value for alloc::string::String {
    const KIND: Kind = Kind::Text;
}

/// Defines a table of a scene: its struct and the rows of its keys. With a path, it is a table of numbers of the core, with its defaults
/// and its check. `left out if` has a function of a table: whether a scene is written without it. Fields of the last part are no keys.
#[macro_export]
macro_rules! keys {
    ($(#[$attribute:meta])+ pub struct $Table:ident in $path:literal {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $row:expr,)+
    }) => {
        $(#[$attribute])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
        pub struct $Table { $($(#[doc = $doc])+ pub $name: $Type,)+ }

        $crate::keys! { rows of $Table { $($(#[doc = $doc])+ $name: $Type = $row,)+ } }

        impl $Table {
            /// Values of keys that are left out.
            pub const DEFAULT: Self = Self { $($name: $row.number() as $Type),+ };

            /// Checks that every number is within its range.
            ///
            /// # Errors
            /// The first number that is not.
            #[cold]
            pub fn check(&self) -> Result<(), $crate::settings::SettingsError> {
                $($crate::settings::inside(
                    concat!($path, ".", stringify!($name)),
                    f64::from(self.$name),
                    const { $row.low },
                    const { $row.high },
                )?;)+
                Ok(())
            }

            /// Calls a function for each number with its row. It may change the number.
            pub fn visit(&mut self, mut each: impl FnMut(&'static $crate::settings::key::Key, &mut f64)) {
                let mut rows = Self::KEYS.iter();
                $(if let Some(row) = rows.next() {
                    let mut value = f64::from(self.$name);
                    each(row, &mut value);
                    self.$name = value as $Type;
                })+
            }
        }

        impl Default for $Table {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };
    ($(#[$attribute:meta])+ pub struct $Table:ident $(left out if $is_left_out:path,)? {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $row:expr,)+
    } $(and { $($(#[$note:meta])+ $field:ident: $Field:ty,)+ })?) => {
        $(#[$attribute])+
        pub struct $Table {
            $(
                $(#[doc = $doc])+
                #[serde(skip_serializing_if = "cophase_core::settings::key::Value::is_left_out")]
                pub $name: $Type,
            )+
            $($($(#[$note])+ pub $field: $Field,)+)?
        }

        $crate::keys! { rows of $Table $(left out if $is_left_out,)? { $($(#[doc = $doc])+ $name: $Type = $row,)+ } }
    };
    (rows of $Table:ident $(left out if $is_left_out:path,)? {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $row:expr,)+
    }) => {
        impl $Table {
            /// Rows of the keys.
            pub const KEYS: &'static [$crate::settings::key::Key] = &[$($crate::settings::key::Key {
                name: $crate::settings::key::plain(stringify!($name)),
                doc: concat!($($doc),+),
                kind: <$Type as $crate::settings::key::Value>::KIND,
                ..$row
            }),+];
        }

        impl $crate::settings::key::Value for $Table {
            const KIND: $crate::settings::key::Kind = $crate::settings::key::Kind::Table(|| Self::KEYS);

            $(fn is_left_out(&self) -> bool {
                $is_left_out(self)
            })?
        }
    };
}

/// Name of a field that may be a word of Rust, such as `do`.
pub const fn plain(name: &'static str) -> &'static str {
    match name.as_bytes() {
        [b'r', b'#', ..] => name.split_at(2).1,
        _ => name,
    }
}

/// Defines an enum whose values are words in a scene.
#[macro_export]
macro_rules! words {
    ($(#[$attribute:meta])+ pub enum $Words:ident { $($(#[$note:meta])+ $Word:ident = $text:literal,)+ }) => {
        $(#[$attribute])+
        pub enum $Words { $($(#[$note])+ #[serde(rename = $text)] $Word,)+ }

        impl $Words {
            /// Returns its word in a scene.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$Word => $text,)+ }
            }
        }

        impl $crate::settings::key::Value for $Words {
            const KIND: $crate::settings::key::Kind = $crate::settings::key::Kind::Word(&[$($text),+]);
        }
    };
}
