//! Decoding what an older version wrote, where a struct has since grown.
//!
//! Postcard stores a struct as its fields in order, without their names or their number. A file
//! that was written when a struct had fewer fields is therefore decoded with a table of the number
//! of fields that each struct had then ([`FieldCounts`]). The decoder reads that many fields, and
//! the fields appended since take their defaults. The struct must declare this with
//! `#[serde(default)]`, on itself or on each appended field. Fields are only ever appended; a
//! struct that must change in another way keeps its old definition beside the new one.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use serde::{Deserialize, de};

/// The number of fields of each struct, by its name, sorted by name. A struct that is not in the
/// table has as many as it has today.
pub type FieldCounts = [(&'static str, usize)];

/// Decodes one value and returns it with the bytes that follow it.
///
/// # Errors
/// Fails if the bytes are not a valid encoding of the value.
pub fn take_from_bytes<'de, T: Deserialize<'de>>(
    bytes: &'de [u8],
    counts: &FieldCounts,
) -> Result<(T, &'de [u8]), postcard::Error> {
    let find = |name: &str| counts.binary_search_by(|c| c.0.cmp(name)).ok().map(|i| counts[i].1);
    let mut inner = postcard::Deserializer::from_bytes(bytes);
    let value = T::deserialize(Counted { inner: &mut inner, count: &|name, _| find(name) })?;
    Ok((value, inner.finalize()?))
}

/// Decodes one value.
///
/// # Errors
/// Fails if the bytes are not a valid encoding of the value.
pub fn from_bytes<'de, T: Deserialize<'de>>(
    bytes: &'de [u8],
    counts: &FieldCounts,
) -> Result<T, postcard::Error> {
    take_from_bytes(bytes, counts).map(|(value, _)| value)
}

/// Decodes one value as it is written today and notes how many fields each struct in it has. Two
/// structs of one name must have the same number: the larger one is noted.
///
/// # Errors
/// Fails if the bytes are not a valid encoding of the value.
pub fn note_counts<'de, T: Deserialize<'de>>(
    bytes: &'de [u8],
    counts: &mut BTreeMap<String, usize>,
) -> Result<(), postcard::Error> {
    let seen = RefCell::new(counts);
    let mut inner = postcard::Deserializer::from_bytes(bytes);
    let note = |name: &'static str, fields: usize| {
        let mut seen = seen.borrow_mut();
        let entry = seen.entry(name.into()).or_insert(fields);
        *entry = (*entry).max(fields);
        None
    };
    T::deserialize(Counted { inner: &mut inner, count: &note }).map(|_| ())
}

/// The number of fields to read of a struct, from its name and its number of fields today.
type Count<'c> = &'c dyn Fn(&'static str, usize) -> Option<usize>;

/// A deserializer, visitor, seed or access that passes everything on and limits structs.
#[derive(Clone, Copy)]
struct Counted<'c, I> {
    inner: I,
    count: Count<'c>,
}

macro_rules! plain {
    ($($name:ident)*) => {
        $(fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.inner.$name(visitor)
        })*
    };
}

macro_rules! wrapped {
    ($($name:ident($($arg:ident: $kind:ty),*))*) => {
        $(fn $name<V: Visitor<'de>>(self, $($arg: $kind,)* v: V) -> Result<V::Value, D::Error> {
            self.inner.$name($($arg,)* Counted { inner: v, count: self.count })
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Counted<'_, D> {
    type Error = D::Error;

    plain! {
        deserialize_bool deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
        deserialize_i128 deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64
        deserialize_u128 deserialize_f32 deserialize_f64 deserialize_char deserialize_str
        deserialize_string deserialize_bytes deserialize_byte_buf deserialize_unit
        deserialize_identifier deserialize_ignored_any
    }

    wrapped! {
        deserialize_any()
        deserialize_option()
        deserialize_unit_struct(name: &'static str)
        deserialize_newtype_struct(name: &'static str)
        deserialize_seq()
        deserialize_tuple(len: usize)
        deserialize_tuple_struct(name: &'static str, len: usize)
        deserialize_map()
        deserialize_enum(name: &'static str, variants: &'static [&'static str])
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        v: V,
    ) -> Result<V::Value, D::Error> {
        let had = (self.count)(name, fields.len()).unwrap_or(fields.len());
        let fields = fields.get(..had).ok_or_else(|| {
            de::Error::custom(format!("{name} has fewer fields than it had; fields only ever grow"))
        })?;
        self.inner.deserialize_struct(name, fields, Counted { inner: v, count: self.count })
    }

    fn is_human_readable(&self) -> bool {
        self.inner.is_human_readable()
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Counted<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inner.expecting(f)
    }

    fn visit_none<E: de::Error>(self) -> Result<V::Value, E> {
        self.inner.visit_none()
    }

    fn visit_unit<E: de::Error>(self) -> Result<V::Value, E> {
        self.inner.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, d: D) -> Result<V::Value, D::Error> {
        self.inner.visit_some(Counted { inner: d, count: self.count })
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, d: D) -> Result<V::Value, D::Error> {
        self.inner.visit_newtype_struct(Counted { inner: d, count: self.count })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, a: A) -> Result<V::Value, A::Error> {
        self.inner.visit_seq(Counted { inner: a, count: self.count })
    }

    fn visit_map<A: MapAccess<'de>>(self, a: A) -> Result<V::Value, A::Error> {
        self.inner.visit_map(Counted { inner: a, count: self.count })
    }

    fn visit_enum<A: EnumAccess<'de>>(self, a: A) -> Result<V::Value, A::Error> {
        self.inner.visit_enum(Counted { inner: a, count: self.count })
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Counted<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<S::Value, D::Error> {
        self.inner.deserialize(Counted { inner: d, count: self.count })
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Counted<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.inner.next_element_seed(Counted { inner: seed, count: self.count })
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Counted<'_, A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.inner.next_key_seed(Counted { inner: seed, count: self.count })
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.inner.next_value_seed(Counted { inner: seed, count: self.count })
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

impl<'de, 'c, A: EnumAccess<'de>> EnumAccess<'de> for Counted<'c, A> {
    type Error = A::Error;
    type Variant = Counted<'c, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        let (value, variant) = self.inner.variant_seed(seed)?;
        Ok((value, Counted { inner: variant, count: self.count }))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Counted<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.inner.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        self.inner.newtype_variant_seed(Counted { inner: seed, count: self.count })
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, v: V) -> Result<V::Value, A::Error> {
        self.inner.tuple_variant(len, Counted { inner: v, count: self.count })
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        v: V,
    ) -> Result<V::Value, A::Error> {
        self.inner.struct_variant(fields, Counted { inner: v, count: self.count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;

    #[derive(Serialize, Deserialize)]
    struct Before {
        a: u8,
        inner: Vec<Option<InnerBefore>>,
        last: (u16, Choice<InnerBefore>),
    }

    #[derive(Clone, Copy, Serialize, Deserialize)]
    struct InnerBefore {
        x: f32,
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    enum Choice<T> {
        None,
        One(T),
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Before")]
    struct Now {
        a: u8,
        inner: Vec<Option<InnerNow>>,
        last: (u16, Choice<InnerNow>),
        #[serde(default)]
        appended: Option<u8>,
    }

    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(default, rename = "InnerBefore")]
    struct InnerNow {
        x: f32,
        y: f32,
    }

    impl Default for InnerNow {
        fn default() -> Self {
            InnerNow { x: 1.0, y: 2.5 }
        }
    }

    #[test]
    fn fields_that_were_appended_take_their_defaults_wherever_the_struct_lies() {
        let i = InnerBefore { x: 7.0 };
        let old = Before { a: 3, inner: vec![Some(i), None, Some(i)], last: (9, Choice::One(i)) };
        let mut bytes = postcard::to_stdvec(&old).expect("plain data");
        bytes.push(77);
        let mut counts = BTreeMap::new();
        note_counts::<Before>(&bytes, &mut counts).expect("decodes");
        assert_eq!(counts, [("Before".into(), 3), ("InnerBefore".into(), 1)].into());
        let table = [("Before", 3), ("InnerBefore", 1)];
        let (now, rest) = take_from_bytes::<Now>(&bytes, &table).expect("decodes");
        let i = InnerNow { x: 7.0, y: 2.5 };
        let inner = vec![Some(i), None, Some(i)];
        assert_eq!(now, Now { a: 3, inner, last: (9, Choice::One(i)), appended: None });
        assert_eq!(rest, [77]);
        // Without the table the bytes of the next value are taken for the new field.
        assert_ne!(postcard::from_bytes::<Now>(&bytes).ok(), Some(now));
    }

    #[test]
    fn cut_bytes_and_a_struct_that_shrank_are_errors() {
        let bytes = postcard::to_stdvec(&InnerNow::default()).expect("plain data");
        for cut in 0..bytes.len() {
            assert!(from_bytes::<InnerNow>(&bytes[..cut], &[]).is_err());
        }
        assert!(from_bytes::<InnerNow>(&bytes, &[("InnerBefore", 3)]).is_err());
    }
}
