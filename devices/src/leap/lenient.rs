//! JSON values that a tracker may have got wrong: whatever is not of the expected shape reads as an
//! absence.

use std::fmt;

use glam::Vec3;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// Beyond ten metres nothing over a tracker can be; such a number is a fault and reads as absent.
const MAX_MM: f32 = 10_000.0;

/// Any scalar, distinguished only as far as hands need it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) enum Scalar {
    #[default]
    Absent,
    Number(f64),
    Bool(bool),
    Left,
    Right,
}

impl Scalar {
    pub(super) fn number(self) -> Option<f64> {
        if let Scalar::Number(n) = self { Some(n).filter(|n| n.is_finite()) } else { None }
    }

    pub(super) fn f32(self) -> Option<f32> {
        self.number().map(|n| n as f32).filter(|n| n.is_finite())
    }

    pub(super) fn int(self) -> Option<i64> {
        // Beyond 2^53 a JSON number names no single integer.
        self.number().filter(|n| n.abs() <= 9_007_199_254_740_992.0).map(|n| n as i64)
    }

    pub(super) fn bool(self) -> Option<bool> {
        if let Scalar::Bool(b) = self { Some(b) } else { None }
    }

    pub(super) fn left(self) -> Option<bool> {
        match self {
            Scalar::Left => Some(true),
            Scalar::Right => Some(false),
            _ => None,
        }
    }
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ScalarVisitor)
    }
}

struct ScalarVisitor;

impl<'de> Visitor<'de> for ScalarVisitor {
    type Value = Scalar;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("any JSON value")
    }
    fn visit_bool<E>(self, v: bool) -> Result<Scalar, E> {
        Ok(Scalar::Bool(v))
    }
    fn visit_i64<E>(self, v: i64) -> Result<Scalar, E> {
        Ok(Scalar::Number(v as f64))
    }
    fn visit_u64<E>(self, v: u64) -> Result<Scalar, E> {
        Ok(Scalar::Number(v as f64))
    }
    fn visit_f64<E>(self, v: f64) -> Result<Scalar, E> {
        Ok(Scalar::Number(v))
    }
    fn visit_str<E>(self, v: &str) -> Result<Scalar, E> {
        Ok(match v {
            "left" => Scalar::Left,
            "right" => Scalar::Right,
            _ => Scalar::Absent,
        })
    }
    fn visit_unit<E>(self) -> Result<Scalar, E> {
        Ok(Scalar::Absent)
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Scalar, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Scalar::Absent)
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Scalar, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Scalar::Absent)
    }
}

/// Three numbers in an array, or nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Triple(Option<[f64; 3]>);

impl Triple {
    /// A place in mm, or a speed in mm a second.
    pub(super) fn vec(self) -> Option<Vec3> {
        let v = self.0.map(|[x, y, z]| Vec3::new(x as f32, y as f32, z as f32))?;
        // The comparison is false for NaN as well.
        (v.abs().max_element() <= MAX_MM && v.is_finite()).then_some(v)
    }

    /// A direction, made unit length; nothing if it has none.
    pub(super) fn unit(self) -> Option<Vec3> {
        self.vec().filter(|v| v.length_squared() > 1e-6).map(Vec3::normalize)
    }
}

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(TripleVisitor)
    }
}

struct TripleVisitor;

impl<'de> Visitor<'de> for TripleVisitor {
    type Value = Triple;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("any JSON value")
    }
    fn visit_bool<E>(self, _: bool) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_i64<E>(self, _: i64) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_u64<E>(self, _: u64) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_f64<E>(self, _: f64) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_str<E>(self, _: &str) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_unit<E>(self) -> Result<Triple, E> {
        Ok(Triple(None))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Triple, A::Error> {
        let mut found = [0.0; 3];
        let mut n = 0;
        let mut good = true;
        while let Some(value) = seq.next_element::<Scalar>()? {
            match (value.number(), found.get_mut(n)) {
                (Some(number), Some(slot)) => *slot = number,
                _ => good = false,
            }
            n += 1;
        }
        Ok(Triple((good && n == 3).then_some(found)))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Triple, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Triple(None))
    }
}
