//! Arrays of more than 32 things for `serde`, which stops there: `#[serde(with = "long_array")]`.

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes the array as a sequence.
pub fn serialize<T: Serialize, S: Serializer, const N: usize>(
    all: &[T; N],
    to: S,
) -> Result<S::Ok, S::Error> {
    all.as_slice().serialize(to)
}

/// Exactly `N` of them, or an error.
pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<[T; N], D::Error> {
    let all = Vec::<T>::deserialize(from)?;
    let found = all.len();
    all.try_into().map_err(|_| D::Error::invalid_length(found, &"another number of entries"))
}
