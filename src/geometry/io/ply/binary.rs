//! Binary data of either byte order.

use rayon::prelude::*;

use super::super::problem::{FilePlace, FileProblem, ParseError};
use super::builder::{PlyBuilder, colour, index_problem, place, too_many};
use super::header::{self, PlyElement, PlyHeader, PlyRole, PlyScalar, ROLES};
use crate::job::Job;

/// A byte order. The two are compiled apart, so that neither asks a question a value.
pub(super) trait ByteOrder: Sync {
    fn u16(b: [u8; 2]) -> u16;
    fn u32(b: [u8; 4]) -> u32;
    fn u64(b: [u8; 8]) -> u64;
}

pub(super) struct LittleEndian;
pub(super) struct BigEndian;

impl ByteOrder for LittleEndian {
    fn u16(b: [u8; 2]) -> u16 {
        u16::from_le_bytes(b)
    }
    fn u32(b: [u8; 4]) -> u32 {
        u32::from_le_bytes(b)
    }
    fn u64(b: [u8; 8]) -> u64 {
        u64::from_le_bytes(b)
    }
}

impl ByteOrder for BigEndian {
    fn u16(b: [u8; 2]) -> u16 {
        u16::from_be_bytes(b)
    }
    fn u32(b: [u8; 4]) -> u32 {
        u32::from_be_bytes(b)
    }
    fn u64(b: [u8; 8]) -> u64 {
        u64::from_be_bytes(b)
    }
}

fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

#[inline]
fn number<O: ByteOrder>(bytes: &[u8], at: usize, kind: PlyScalar) -> Option<f64> {
    Some(match kind {
        PlyScalar::I8 => *bytes.get(at)? as i8 as f64,
        PlyScalar::U8 => *bytes.get(at)? as f64,
        PlyScalar::I16 => O::u16(bytes_at(bytes, at)?) as i16 as f64,
        PlyScalar::U16 => O::u16(bytes_at(bytes, at)?) as f64,
        PlyScalar::I32 => O::u32(bytes_at(bytes, at)?) as i32 as f64,
        PlyScalar::U32 => O::u32(bytes_at(bytes, at)?) as f64,
        PlyScalar::F32 => f32::from_bits(O::u32(bytes_at(bytes, at)?)) as f64,
        PlyScalar::F64 => f64::from_bits(O::u64(bytes_at(bytes, at)?)),
    })
}

pub(super) fn read<O: ByteOrder>(
    bytes: &[u8],
    header: &PlyHeader,
    made: &mut PlyBuilder,
    job: &Job,
) -> Result<(), ParseError> {
    let mut at = header.data;
    made.mesh.face_starts.push(0);
    for element in &header.elements {
        at = match element.role {
            PlyRole::Vertex if element.fixed() => {
                vertices::<O>(bytes, at, element, header, made, job)?
            }
            _ if element.fixed() => fixed_end(bytes, at, element)?,
            _ => rows::<O>(bytes, at, element, header, made, job)?,
        };
        job.progress(at as f32 / bytes.len() as f32);
    }
    Ok(())
}

fn ended(bytes: &[u8], what: &str) -> ParseError {
    FileProblem::new(FilePlace::Byte(bytes.len() as u64), what.to_string(), "the end of the file")
        .into()
}

/// Returns the end of an element whose rows have one length.
fn fixed_end(bytes: &[u8], at: usize, element: &PlyElement) -> Result<usize, ParseError> {
    element
        .least()
        .checked_mul(element.count)
        .and_then(|n| n.checked_add(at))
        .filter(|&end| end <= bytes.len())
        .ok_or_else(|| {
            ended(
                bytes,
                &format!(
                    "{} of \"{}\" with {} bytes each",
                    element.count,
                    element.name,
                    element.least()
                ),
            )
        })
}

/// Rows of one length: on all cores.
fn vertices<O: ByteOrder>(
    bytes: &[u8],
    at: usize,
    element: &PlyElement,
    header: &PlyHeader,
    made: &mut PlyBuilder,
    job: &Job,
) -> Result<usize, ParseError> {
    const BLOCK: usize = 1 << 14;
    let end = fixed_end(bytes, at, element)?;
    let stride = element.least();
    let mut plan = [None; ROLES.len()];
    let mut offset = 0;
    for (p, role) in element.properties.iter().zip(element.roles()) {
        if let Some(role) = role {
            plan[role] = Some((offset, p.kind));
        }
        offset += p.kind.size();
    }
    let (coloured, scale) = (header.coloured(), header.colour_scale());
    made.mesh.positions.resize(element.count, glam::DVec3::ZERO);
    made.colours.resize(if coloured { element.count } else { 0 }, [255; 4]);
    let mut none: Vec<[u8; 4]> =
        vec![[0; 4]; if coloured { 0 } else { element.count.div_ceil(BLOCK) }];
    let colours: Vec<&mut [[u8; 4]]> = if coloured {
        made.colours.chunks_mut(BLOCK).collect()
    } else {
        none.chunks_mut(1).collect()
    };
    let textured = header.textured() && !header.textures_faces();
    made.uvs.resize(if textured { element.count } else { 0 }, [0.0; 2]);
    let mut no_uvs = vec![[0.0; 2]; if textured { 0 } else { element.count.div_ceil(BLOCK) }];
    let uvs: Vec<&mut [[f64; 2]]> = if textured {
        made.uvs.chunks_mut(BLOCK).collect()
    } else {
        no_uvs.chunks_mut(1).collect()
    };
    let bad = made
        .mesh
        .positions
        .par_chunks_mut(BLOCK)
        .zip(bytes[at..end].par_chunks(BLOCK * stride))
        .zip(colours)
        .zip(uvs)
        .enumerate()
        .filter_map(|(block, (((positions, rows), colours), uvs))| {
            if job.cancelled() {
                return Some(None);
            }
            for (n, (position, row)) in
                positions.iter_mut().zip(rows.chunks_exact(stride)).enumerate()
            {
                let mut values = header::values(scale);
                for (value, step) in values.iter_mut().zip(&plan) {
                    if let Some((offset, kind)) = *step
                        && let Some(v) = number::<O>(row, offset, kind)
                    {
                        *value = v;
                    }
                }
                if let Some(found) = place(&values) {
                    return Some(Some((block * BLOCK + n, found)));
                }
                *position = glam::DVec3::new(values[0], values[1], values[2]);
                if coloured {
                    colours[n] = colour(&values, scale);
                }
                if textured {
                    uvs[n] = [values[7], values[8]];
                }
            }
            None
        })
        .min_by_key(|b| b.map_or(0, |(v, _)| v));
    match bad {
        None => Ok(end),
        Some(None) => Err(ParseError::Cancelled),
        Some(Some((v, found))) => {
            let at = FilePlace::Byte((at + v * stride) as u64);
            Err(FileProblem::new(at, format!("a finite coordinate of vertex {v}"), found).into())
        }
    }
}

/// Rows that hold lists, one after another.
fn rows<O: ByteOrder>(
    bytes: &[u8],
    mut at: usize,
    element: &PlyElement,
    header: &PlyHeader,
    made: &mut PlyBuilder,
    job: &Job,
) -> Result<usize, ParseError> {
    let (corners, textures) = (element.corners(), element.texture_coordinates());
    let textured = header.textured() && !header.textures_faces();
    let roles = element.roles();
    let (coloured, scale) = (header.coloured(), header.colour_scale());
    let painted = header.face_colour_scale().filter(|_| element.role == PlyRole::Face);
    let plain =
        element.role == PlyRole::Face && corners == Some(0) && element.properties.len() == 1;
    let fast = plain.then(|| &element.properties[0]).filter(|p| {
        p.list == Some(PlyScalar::U8) && matches!(p.kind, PlyScalar::I32 | PlyScalar::U32)
    });
    if element.role == PlyRole::Face {
        made.mesh.face_starts.reserve_exact(element.count);
        // As if all were triangles: never more than the file can hold.
        made.mesh.corners.reserve(element.count.saturating_mul(3).min(bytes.len()));
    }
    let count = made.mesh.positions.len();
    let (mut list, mut uvs): (Vec<i64>, Vec<f64>) = (Vec::new(), Vec::new());
    for row in 0..element.count {
        if row.is_multiple_of(1 << 16) {
            job.check()?;
        }
        let start = at;
        let first = made.mesh.corners.len();
        let mut values = header::values(painted.unwrap_or(scale));
        if fast.is_some() {
            let n = *bytes.get(at).ok_or_else(|| row_ended(bytes, element, row))? as usize;
            let indices =
                bytes.get(at + 1..at + 1 + n * 4).ok_or_else(|| row_ended(bytes, element, row))?;
            made.mesh.corners.extend(indices.as_chunks::<4>().0.iter().map(|&b| O::u32(b)));
            at += 1 + n * 4;
        } else {
            for (p, property) in element.properties.iter().enumerate() {
                let wanted = corners == Some(p);
                let Some(count_kind) = property.list else {
                    let v = number::<O>(bytes, at, property.kind)
                        .ok_or_else(|| row_ended(bytes, element, row))?;
                    at += property.kind.size();
                    if let Some(role) = roles[p] {
                        values[role] = v;
                    }
                    continue;
                };
                let n = number::<O>(bytes, at, count_kind)
                    .ok_or_else(|| row_ended(bytes, element, row))?;
                if n < 0.0 {
                    let found = n.to_string();
                    return Err(FileProblem::new(
                        FilePlace::Byte(at as u64),
                        "a list's length",
                        found,
                    )
                    .into());
                }
                at += count_kind.size();
                let size = property.kind.size();
                let end = (n as usize).checked_mul(size).and_then(|s| s.checked_add(at));
                let Some(items) = end.and_then(|end| bytes.get(at..end)) else {
                    return Err(row_ended(bytes, element, row));
                };
                at += items.len();
                if textures == Some(p) {
                    uvs.clear();
                    let value = |i: usize| number::<O>(items, i * size, property.kind);
                    uvs.extend((0..n as usize).filter_map(value));
                }
                if !wanted {
                    continue;
                }
                list.clear();
                for i in 0..n as usize {
                    let v = number::<O>(items, i * size, property.kind).unwrap_or(-1.0);
                    if element.role == PlyRole::Face {
                        let whole = (0.0..u32::MAX as f64).contains(&v) && v.fract() == 0.0;
                        made.mesh.corners.push(if whole { v as u32 } else { u32::MAX });
                    } else {
                        list.push(v as i64);
                    }
                }
            }
            if element.role == PlyRole::Vertex {
                if let Some(found) = place(&values) {
                    return Err(FileProblem::new(
                        FilePlace::Byte(start as u64),
                        "a finite coordinate",
                        found,
                    )
                    .into());
                }
                made.vertex(&values, (coloured, scale), textured);
            }
        }
        if made.mesh.corners.len() >= u32::MAX as usize {
            return Err(too_many(header).into());
        }
        let here = FilePlace::Byte(start as u64);
        match element.role {
            PlyRole::Face if corners.is_some() => {
                made.face(first, count)
                    .map_err(|bad| index_problem(here, bad as i32 as i64, count))?;
                if let Some(scale) = painted {
                    made.paint(first, &values, scale);
                }
                if textures.is_some() {
                    made.textures(first, &uvs);
                }
            }
            PlyRole::Strips if corners.is_some() => {
                made.strip(&list, count).map_err(|bad| index_problem(here, bad, count))?;
            }
            _ => {}
        }
    }
    Ok(at)
}

#[cold]
fn row_ended(bytes: &[u8], element: &PlyElement, row: usize) -> ParseError {
    ended(bytes, &format!("the rest of {} {row} of {}", element.name, element.count))
}
