//! Buffer views packed by `EXT_meshopt_compression`, as gltfpack writes them.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf_json::buffer::Buffer;
use gltf_json::{Root, buffer};
use meshopt_rs::index::buffer::decode_index_buffer;
use meshopt_rs::index::sequence::decode_index_sequence;
use meshopt_rs::vertex::buffer::decode_vertex_buffer;
use meshopt_rs::vertex::filter::{decode_filter_exp, decode_filter_quat};
use serde_json::Value;

use super::{MAX_INSTANCED, bad};
use crate::io::problem::{FilePlace, ParseError};
use crate::job::Job;

/// The extension, under its two names.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Returns true if a buffer has no bytes, since all its views are packed elsewhere.
pub(super) fn is_fallback(buffer: &Buffer) -> bool {
    let own = |name| buffer.extensions.as_ref()?.others.get(name)?["fallback"].as_bool();
    MESHOPT.into_iter().any(|name| own(name) == Some(true))
}

/// Unpacks all packed views, by their numbers.
pub(super) fn unpack(
    root: &Root,
    buffers: &[Cow<'_, [u8]>],
    job: &Job,
) -> Result<BTreeMap<usize, Vec<u8>>, ParseError> {
    let mut all = BTreeMap::new();
    for (n, view) in root.buffer_views.iter().enumerate() {
        job.check()?;
        if let Some(packed) = extension(view) {
            let bytes = unpack_view(packed, buffers).map_err(|(expected, found)| {
                bad(FilePlace::File, format!("{expected} in the packed view {n}"), found)
            })?;
            all.insert(n, bytes);
        }
    }
    Ok(all)
}

fn extension(view: &buffer::View) -> Option<&Value> {
    let others = &view.extensions.as_ref()?.others;
    MESHOPT.into_iter().find_map(|name| others.get(name))
}

/// The expectation and the finding.
type PackedProblem = (String, String);

fn unpack_view(packed: &Value, buffers: &[Cow<'_, [u8]>]) -> Result<Vec<u8>, PackedProblem> {
    let whole = |name: &str, otherwise: Option<u64>| {
        let found = || (format!("a whole number \"{name}\""), packed[name].to_string());
        packed[name].as_u64().or(otherwise).map(|n| n as usize).ok_or_else(found)
    };
    let (from, length) = (whole("byteOffset", Some(0))?, whole("byteLength", None)?);
    let (stride, count) = (whole("byteStride", None)?, whole("count", None)?);
    let number = whole("buffer", None)?;
    let bytes = buffers.get(number).and_then(|b| b.get(from..from.checked_add(length)?));
    let bytes = bytes.ok_or_else(|| {
        ("bytes inside its buffer".to_owned(), format!("{length} bytes from {from} of {number}"))
    })?;
    // Two bits stand for sixteen equal bytes: no byte unpacks to more than 64.
    if count > MAX_INSTANCED || count.saturating_mul(stride) > (bytes.len() + 64) * 64 {
        return Err(("a count that its bytes can hold".into(), count.to_string()));
    }
    let mode = packed["mode"].as_str().unwrap_or("none");
    let mut out = match (mode, stride) {
        ("ATTRIBUTES", 4..=256) if stride % 4 == 0 => attributes(bytes, count, stride)?,
        ("TRIANGLES", 2 | 4) if count % 3 == 0 => {
            let mut all = vec![0u32; count];
            decode_index_buffer(&mut all, bytes).map_err(damaged)?;
            indices(&all, stride)
        }
        ("INDICES", 2 | 4) => {
            // The decoder reads on where numbers are cut: as many must end before the tail.
            let ends = bytes.len().saturating_sub(4);
            let ended = bytes[..ends].iter().skip(1).filter(|b| **b < 128).count();
            if ended < count {
                return Err(("as many indices as its count".into(), ended.to_string()));
            }
            let mut all = vec![0u32; count];
            decode_index_sequence(&mut all, bytes).map_err(damaged)?;
            indices(&all, stride)
        }
        _ => {
            let expected = "the mode ATTRIBUTES, TRIANGLES or INDICES with a fitting stride";
            return Err((expected.into(), format!("{mode} with {stride}")));
        }
    };
    match (packed["filter"].as_str().unwrap_or("NONE"), stride) {
        // Normals and tangents alone have it, and these follow from the surface.
        ("NONE", _) | ("OCTAHEDRAL", 4 | 8) => {}
        ("QUATERNION", 8) => {
            let word = |b: &[u8], k: usize| u16::from_le_bytes([b[2 * k], b[2 * k + 1]]);
            let four = |b: &[u8]| [word(b, 0), word(b, 1), word(b, 2), word(b, 3)];
            let mut words: Vec<[u16; 4]> = out.chunks_exact(8).map(four).collect();
            decode_filter_quat(&mut words);
            out = words.into_flattened().into_iter().flat_map(u16::to_le_bytes).collect();
        }
        ("EXPONENTIAL", _) if stride % 4 == 0 => {
            let (words, _) = out.as_chunks::<4>();
            let mut words: Vec<u32> = words.iter().map(|b| u32::from_le_bytes(*b)).collect();
            decode_filter_exp(&mut words);
            out = words.into_iter().flat_map(u32::to_le_bytes).collect();
        }
        (other, _) => return Err(("a filter of the extension".into(), other.to_owned())),
    }
    Ok(out)
}

fn indices(all: &[u32], stride: usize) -> Vec<u8> {
    match stride {
        2 => all.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect(),
        _ => all.iter().flat_map(|i| i.to_le_bytes()).collect(),
    }
}

/// Values of `stride` bytes each; the decoder has a type for each length.
fn attributes(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, PackedProblem> {
    macro_rules! by_length {
        ($($n:literal)*) => {
            match stride {
                $($n => {
                    let mut all = vec![[0u8; $n]; count];
                    decode_vertex_buffer(&mut all, bytes).map_err(damaged)?;
                    Ok(all.into_flattened())
                })*
                _ => Err(("a stride of at most 64 bytes".into(), stride.to_string())),
            }
        };
    }
    by_length!(4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64)
}

fn damaged(error: impl std::fmt::Debug) -> PackedProblem {
    ("packed data that unpacks".into(), format!("damage ({error:?})"))
}
