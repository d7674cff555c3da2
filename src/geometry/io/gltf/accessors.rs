//! The numbers of accessors, dense and sparse, each length checked against the bytes there are.

use std::collections::BTreeMap;

use glam::DVec3;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

use super::{GltfFile, MAX_INSTANCED, bad};
use crate::io::problem::{FilePlace, ParseError};

impl GltfFile<'_> {
    pub(super) fn accessor(&self, n: usize, what: &str) -> Result<AccessorValues<'_>, ParseError> {
        let wrong = |expected: &str, found: String| {
            bad(FilePlace::File, format!("{expected} for the {what}"), found)
        };
        let a = self.root.accessors.get(n).ok_or_else(|| {
            wrong("an accessor", format!("number {n} of {}", self.root.accessors.len()))
        })?;
        let (Checked::Valid(kind), Checked::Valid(shape)) = (a.component_type, a.type_) else {
            return Err(wrong("a known type", "another".into()));
        };
        let parts =
            parts_of(shape).ok_or_else(|| wrong("numbers or vectors", "matrices".into()))?;
        let (kind, count) = (kind.0, a.count.0 as usize);
        let mut all = match a.buffer_view {
            Some(view) => {
                let offset = a.byte_offset.map_or(0, |o| o.0) as usize;
                self.values((view.value(), offset), count, (kind, parts), what)?
            }
            // Without a view all are zero, but for the sparse ones.
            None if a.sparse.is_some() && count <= MAX_INSTANCED => AccessorValues::zeros(count),
            None => return Err(wrong("a buffer view", "none".into())),
        };
        (all.kind, all.parts, all.normalized) = (kind, parts, a.normalized);
        if let Some(sparse) = &a.sparse {
            let Checked::Valid(index) = sparse.indices.component_type else {
                return Err(wrong("a known type of sparse indices", "another".into()));
            };
            let number = sparse.count.0 as usize;
            let from = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0 as usize);
            let places = self.values(from, number, (index.0, 1), what)?;
            let from = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0 as usize);
            let values = self.values(from, number, (kind, parts), what)?;
            for i in 0..number {
                let at = places.get(i, 0);
                if !(at >= 0.0 && at < count as f64) {
                    let found = format!("{at} of {count}");
                    return Err(wrong("sparse indices within the count", found));
                }
                let mut row = [0.0; 4];
                for (part, value) in row.iter_mut().enumerate().take(parts) {
                    *value = values.get(i, part);
                }
                all.sparse.insert(at as usize, row);
            }
        }
        Ok(all)
    }

    /// So many values of a kind and so many parts in a buffer view, from a byte of it on.
    pub(super) fn values(
        &self,
        (view, offset): (usize, usize),
        count: usize,
        (kind, parts): (ComponentType, usize),
        what: &str,
    ) -> Result<AccessorValues<'_>, ParseError> {
        let wrong = |expected: &str, found: String| {
            bad(FilePlace::File, format!("{expected} for the {what}"), found)
        };
        let number = view;
        let view = self
            .root
            .buffer_views
            .get(number)
            .ok_or_else(|| wrong("a buffer view", format!("number {number}")))?;
        let bytes = match self.unpacked.get(&number) {
            Some(bytes) => bytes.get(offset..),
            None => {
                let n = view.buffer.value();
                let buffer =
                    self.buffers.get(n).ok_or_else(|| wrong("a buffer", format!("number {n}")))?;
                let start = view.byte_offset.map_or(0, |o| o.0) as usize;
                let end = start.checked_add(view.byte_length.0 as usize);
                end.and_then(|end| buffer.get(start..end)).and_then(|b| b.get(offset..))
            }
        };
        let bytes = bytes.ok_or_else(|| {
            wrong("bytes inside its buffer", format!("view {number}, which ends past it"))
        })?;
        let size = kind.size();
        let stride = view.byte_stride.map_or(size * parts, |s| s.0);
        let need = count
            .checked_sub(1)
            .map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size * parts));
        if stride == 0 || need.is_none_or(|n| n > bytes.len()) || count >= u32::MAX as usize {
            return Err(wrong(
                "as many bytes as its count needs",
                format!("a count of {count} in {} bytes", bytes.len()),
            ));
        }
        let (normalized, sparse) = (false, BTreeMap::new());
        Ok(AccessorValues { bytes, stride, count, parts, kind, size, normalized, sparse })
    }
}

/// Numbers of an element; `None` of a matrix.
fn parts_of(shape: Type) -> Option<usize> {
    match shape {
        Type::Scalar => Some(1),
        Type::Vec2 => Some(2),
        Type::Vec3 => Some(3),
        Type::Vec4 => Some(4),
        _ => None,
    }
}

/// The numbers of an accessor; all within `bytes`.
pub(super) struct AccessorValues<'a> {
    bytes: &'a [u8],
    stride: usize,
    pub(super) count: usize,
    pub(super) parts: usize,
    pub(super) kind: ComponentType,
    size: usize,
    /// Whole numbers stand for parts of 1.
    normalized: bool,
    /// The sparse values, which replace those in `bytes`.
    sparse: BTreeMap<usize, [f64; 4]>,
}

impl AccessorValues<'_> {
    fn zeros(count: usize) -> Self {
        let (kind, sparse) = (ComponentType::F32, BTreeMap::new());
        let (stride, parts, size, normalized) = (0, 1, 0, false);
        AccessorValues { bytes: &[], stride, count, parts, kind, size, normalized, sparse }
    }

    pub(super) fn get(&self, i: usize, part: usize) -> f64 {
        if let Some(row) = self.sparse.get(&i) {
            return row[part.min(3)];
        }
        let b = &self.bytes[i * self.stride + (part * self.size).min(self.bytes.len())..];
        match (self.kind, &b[..self.size]) {
            (_, &[]) => 0.0,
            (ComponentType::I8, &[a]) => a as i8 as f64,
            (ComponentType::U8, &[a]) => a as f64,
            (ComponentType::I16, &[a, b]) => i16::from_le_bytes([a, b]) as f64,
            (ComponentType::U16, &[a, b]) => u16::from_le_bytes([a, b]) as f64,
            (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f64,
            (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]) as f64,
            _ => f64::NAN,
        }
    }

    /// The value that a whole number stands for where the accessor is normalized (glTF 2.0, 3.11):
    /// a signed one's least is -1 too.
    pub(super) fn value(&self, i: usize, part: usize) -> f64 {
        let raw = self.get(i, part);
        match self.kind {
            _ if !self.normalized => raw,
            ComponentType::I8 => (raw / 127.0).max(-1.0),
            ComponentType::U8 => raw / 255.0,
            ComponentType::I16 => (raw / 32767.0).max(-1.0),
            ComponentType::U16 => raw / 65535.0,
            ComponentType::U32 | ComponentType::F32 => raw,
        }
    }

    /// Three values of an element as a vector.
    pub(super) fn vector(&self, i: usize) -> DVec3 {
        DVec3::new(self.value(i, 0), self.value(i, 1), self.value(i, 2))
    }
}
