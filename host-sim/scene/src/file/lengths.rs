//! Lists of a fixed length. The TOML reader would fill a tuple with the first values and ignore the rest.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};

/// List of exactly `N` values.
struct Exactly<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_seq(List(PhantomData))
    }
}

struct List<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for List<T, N> {
    type Value = Exactly<T, N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of length {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut values = Vec::with_capacity(N);
        while values.len() < N
            && let Some(value) = list.next_element()?
        {
            values.push(value);
        }
        let mut length = values.len();
        while list.next_element::<IgnoredAny>()?.is_some() {
            length += 1;
        }
        match values.try_into() {
            Ok(values) if length == N => Ok(Exactly(values)),
            _ => Err(A::Error::invalid_length(length, &self)),
        }
    }
}

/// Reads `[a, b]`.
pub(super) fn pair<'de, D: Deserializer<'de>>(from: D) -> Result<(u32, u32), D::Error> {
    let Exactly([a, b]) = Exactly::deserialize(from)?;
    Ok((a, b))
}

/// Reads `[a, b]` of a key that may be missing; give the field `default` as well.
pub(super) fn some_pair<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<(u32, u32)>, D::Error> {
    pair(from).map(Some)
}

/// Reads `[[a, b], …]`.
pub(super) fn pairs<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(f64, f64)>, D::Error> {
    Ok(each(from)?.into_iter().map(|[a, b]| (a, b)).collect())
}

/// Reads `[a, b]` of numbers.
pub(crate) fn two<'de, D: Deserializer<'de>>(from: D) -> Result<(f64, f64), D::Error> {
    all(from).map(|[a, b]| (a, b))
}

/// Reads a list of numbers.
pub(crate) fn all<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<[f64; N], D::Error> {
    Exactly::deserialize(from).map(|Exactly(values)| values)
}

/// Reads a list of numbers of a key that may be missing; give the field `default` as well.
pub(crate) fn some_of<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<Option<[f64; N]>, D::Error> {
    all(from).map(Some)
}

/// Reads a list of lists of numbers.
pub(crate) fn each<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<Vec<[f64; N]>, D::Error> {
    let lists = Vec::<Exactly<f64, N>>::deserialize(from)?;
    Ok(lists.into_iter().map(|Exactly(values)| values).collect())
}
