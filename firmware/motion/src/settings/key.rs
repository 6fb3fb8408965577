//! Rows of keys: each number of a settings table is written once, with its unit, default, range and reason.
//!
//! A *key* is the path of a number in a scene, such as `control.tick_hz`. Its unit is at the end of its name. [`keys!`](crate::keys) makes
//! a struct and its rows from one text. The struct's own `check` has the bounds as constants; firmware that does not use the words of a
//! row does not contain them.

/// Row of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Path in a scene.
    pub path: &'static str,
    /// Sentences for the manual, and for editors.
    pub doc: &'static str,
    /// True if the number has no fraction.
    pub is_whole: bool,
    /// Value if the key is left out.
    pub default: f64,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Reason of the range, if it does not follow from the numbers.
    pub reason: Option<&'static str>,
}

impl Key {
    /// Sets the range, ends included.
    #[must_use]
    pub const fn from(mut self, low: f64, high: f64) -> Self {
        self.low = low;
        self.high = high;
        self
    }

    /// Sets the reason of the range.
    #[must_use]
    pub const fn because(mut self, reason: &'static str) -> Self {
        self.reason = Some(reason);
        self
    }

    /// Name in its table: the last part of the path.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}

/// Begins the row of a key with a default.
pub const fn or(default: f64) -> Key {
    Key {
        path: "",
        doc: "",
        is_whole: false,
        default,
        low: f64::MIN,
        high: f64::MAX,
        reason: None,
    }
}

/// Type of a number in a settings table.
pub trait Number {
    /// True if it has no fraction.
    const IS_WHOLE: bool;
}

impl Number for f64 {
    const IS_WHOLE: bool = false;
}

impl Number for u32 {
    const IS_WHOLE: bool = true;
}

/// Defines a table of settings: its struct, the rows of its keys, its defaults and its check.
#[macro_export]
macro_rules! keys {
    ($(#[$attribute:meta])+ pub struct $Table:ident in $path:literal {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $row:expr,)+
    }) => {
        $(#[$attribute])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
        pub struct $Table { $($(#[doc = $doc])+ pub $name: $Type,)+ }

        impl $Table {
            /// Rows of the keys.
            pub const KEYS: &'static [$crate::settings::key::Key] = &[$($crate::settings::key::Key {
                path: concat!($path, ".", stringify!($name)),
                doc: concat!($($doc),+),
                is_whole: <$Type as $crate::settings::key::Number>::IS_WHOLE,
                ..$row
            }),+];
            /// Values of keys that are left out.
            pub const DEFAULT: Self = Self { $($name: $row.default as $Type),+ };

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
        }

        impl Default for $Table {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };
}
