//! STL, both kinds. Own code, so that errors name their byte or line, and the weld's rule and order
//! are ours.
//!
//! A file is binary if its length is what its triangle count says, whatever its header starts with.
//! Corners that are equal in all three coordinates are one vertex, in the order of first use (minus
//! zero is zero); nothing else is merged, so that what was written apart stays apart.

use glam::DVec3;
use rayon::prelude::*;

use super::face_colours::FaceColours;
use super::problem::{FilePlace, FileProblem, ParseError, excerpt};
use super::text::{TextCursor, float, refuse, unexpected};
use crate::PolyMesh;
use crate::job::Job;
use crate::weld::weld_keys;

/// Bytes before the first triangle: 80 of header, 4 of count.
const HEAD: usize = 84;
/// Bytes a triangle: a normal, three corners, two of attributes.
const RECORD: usize = 50;

/// The triangle count in the header, if there is a whole header.
pub(super) fn binary_count(bytes: &[u8]) -> Option<u64> {
    Some(u32::from_le_bytes(bytes.get(80..HEAD)?.try_into().ok()?) as u64)
}

/// Returns true if the length matches a binary file's count exactly.
pub(super) fn binary_exact(bytes: &[u8]) -> bool {
    binary_count(bytes).is_some_and(|n| HEAD as u64 + n * RECORD as u64 == bytes.len() as u64)
}

/// Returns whether this is text: "solid", and after its line a facet or the end. The name on the
/// first line may be of any length, and end with zeros.
pub(super) fn looks_ascii(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    if !start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    let line = memchr::memchr(b'\n', start).map_or(0, |at| at + 1);
    let lower = start[line..start.len().min(line + 4096)].to_ascii_lowercase();
    let has = |word: &[u8]| memchr::memmem::find(&lower, word).is_some();
    !lower.contains(&0) && (has(b"facet") || has(b"endsolid"))
}

pub(super) fn parse_binary(
    bytes: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let Some(count) = binary_count(bytes) else {
        let problem = FileProblem::new(
            FilePlace::Byte(bytes.len() as u64),
            "a binary STL header of 84 bytes",
            format!("the end of the file after {} bytes", bytes.len()),
        );
        return Err(problem.into());
    };
    let need = HEAD as u64 + count * RECORD as u64;
    if need > bytes.len() as u64 {
        let whole = (bytes.len() - HEAD) / RECORD;
        let problem = FileProblem::new(
            FilePlace::Byte(bytes.len() as u64),
            format!("{need} bytes for the {count} triangles that the header at byte 80 states"),
            format!(
                "the end of the file after {whole} whole triangles (not text either: it starts \
                 with {})",
                excerpt(bytes)
            ),
        );
        return Err(problem.into());
    }
    if count == 0 {
        return Err(
            FileProblem::new(FilePlace::Byte(80), "at least one triangle", "a count of 0").into()
        );
    }
    if count * 3 >= u32::MAX as u64 {
        return Err(FileProblem::new(
            FilePlace::Byte(80),
            "fewer than 2^32 corners",
            format!("{count} triangles"),
        )
        .into());
    }
    if need < bytes.len() as u64 {
        warnings
            .push(format!("{} bytes after the last triangle left out", bytes.len() as u64 - need));
    }
    let records = &bytes[HEAD..need as usize];
    let mut corners = vec![[0u32; 3]; count as usize * 3];
    let bad = corners
        .par_chunks_mut(3 << 14)
        .enumerate()
        .filter_map(|(block, out)| {
            if job.cancelled() {
                return Some(None);
            }
            let first = block << 14;
            for (t, three) in out.chunks_exact_mut(3).enumerate() {
                let record = &records[(first + t) * RECORD + 12..];
                for (c, corner) in three.iter_mut().enumerate() {
                    for (axis, value) in corner.iter_mut().enumerate() {
                        let at = c * 12 + axis * 4;
                        let raw = [record[at], record[at + 1], record[at + 2], record[at + 3]];
                        let float = f32::from_le_bytes(raw);
                        if let Some(found) = refuse(float as f64) {
                            return Some(Some((HEAD + (first + t) * RECORD + 12 + at, found)));
                        }
                        *value = float.to_bits();
                    }
                }
            }
            None
        })
        .min_by_key(|b| b.map_or(0, |(at, _)| at));
    match bad {
        None => {}
        Some(None) => return Err(ParseError::Cancelled),
        Some(Some((at, found))) => {
            return Err(
                FileProblem::new(FilePlace::Byte(at as u64), "a finite coordinate", found).into()
            );
        }
    }
    let whole = memchr::memmem::find(&bytes[..80], b"COLOR=");
    let whole = whole.and_then(|at| bytes[..80].get(at + 6..at + 10)?.try_into().ok());
    job.progress(0.3);
    let (positions, corners) =
        weld_keys(corners.len(), job, |i| corners[i].map(|b| if b == 1 << 31 { 0 } else { b }))?;
    let positions =
        positions.into_iter().map(|p| glam::Vec3::from(p.map(f32::from_bits)).as_dvec3()).collect();
    let mut mesh = triangles(positions, corners);
    mesh.colours = colours(records, whole, &mesh, warnings);
    Ok(mesh)
}

/// The colours that attribute bytes state: five bits each, red lowest where the header has the
/// colour of the whole (Materialise Magics), blue lowest elsewhere (VisCAM). The highest bit says
/// that there is none in the first, and that there is one in the second.
fn colours(
    records: &[u8],
    whole: Option<[u8; 4]>,
    mesh: &PolyMesh,
    warnings: &mut Vec<String>,
) -> Option<Vec<[u8; 4]>> {
    let mut found = FaceColours::default();
    let mut unread = 0u64;
    for (record, corners) in records.chunks_exact(RECORD).zip(mesh.faces()) {
        let bits = u16::from_le_bytes([record[48], record[49]]);
        let part = |shift: u32| ((f32::from(bits >> shift & 31) * 255.0 / 31.0).round()) as u8;
        let (low, middle, high) = (part(0), part(5), part(10));
        let own = match (whole, bits >> 15) {
            (Some(whole), 1) => Some(whole),
            (Some(_), _) => Some([low, middle, high, 255]),
            (None, 1) => Some([high, middle, low, 255]),
            (None, _) => {
                unread += u64::from(bits != 0);
                None
            }
        };
        corners.iter().for_each(|v| found.add(*v, own));
    }
    if unread > 0 {
        warnings
            .push(format!("attribute bytes of {unread} triangles left out: they are no colours"));
    }
    found.of(mesh.positions.len(), warnings)
}

pub(super) fn parse_ascii(
    text: &[u8],
    _warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let mut cursor = TextCursor::new(text);
    let mut corners: Vec<[u64; 3]> = Vec::new();
    let mut in_facet = 0;
    let mut ended = false;
    let mut lines = 0u32;
    while !cursor.ended() {
        lines = lines.wrapping_add(1);
        if lines.is_multiple_of(1 << 16) {
            job.check()?;
        }
        let line = cursor.at;
        let Some(word) = cursor.word() else {
            cursor.skip_line();
            continue;
        };
        let is = |name: &[u8]| word.eq_ignore_ascii_case(name);
        if is(b"vertex") {
            let mut bits = [0; 3];
            for b in &mut bits {
                let value = cursor.word().and_then(float);
                let Some(value) = value else {
                    return Err(unexpected(text, line, "\"vertex\" and three numbers").into());
                };
                if let Some(found) = refuse(value) {
                    let problem = FileProblem::new(
                        FilePlace::Line(super::text::line_of(text, line)),
                        "a finite coordinate",
                        found,
                    );
                    return Err(problem.into());
                }
                *b = (value + 0.0).to_bits();
            }
            corners.push(bits);
            in_facet += 1;
            if in_facet > 3 {
                return Err(unexpected(text, line, "three corners in a facet").into());
            }
        } else if is(b"endfacet") {
            if in_facet != 3 {
                return Err(unexpected(
                    text,
                    line,
                    format!("three corners before the facet's end, not {in_facet}"),
                )
                .into());
            }
            in_facet = 0;
        } else if is(b"solid") || is(b"endsolid") {
            ended = is(b"endsolid");
        } else if !(is(b"facet") || is(b"outer") || is(b"endloop") || is(b"end") || is(b"color")) {
            return Err(unexpected(
                text,
                line,
                "facet, outer loop, vertex, endloop, endfacet or endsolid",
            )
            .into());
        }
        cursor.skip_line();
    }
    if in_facet != 0 || !ended {
        return Err(unexpected(text, text.len(), "\"endsolid\"").into());
    }
    if corners.is_empty() {
        return Err(FileProblem::new(FilePlace::File, "at least one facet", "none").into());
    }
    if corners.len() >= u32::MAX as usize {
        return Err(FileProblem::new(
            FilePlace::File,
            "fewer than 2^32 corners",
            format!("{}", corners.len()),
        )
        .into());
    }
    job.progress(0.7);
    let (positions, corners) = weld_keys(corners.len(), job, |i| corners[i])?;
    Ok(triangles(
        positions.into_iter().map(|p| DVec3::from(p.map(f64::from_bits))).collect(),
        corners,
    ))
}

fn triangles(positions: Vec<DVec3>, corners: Vec<u32>) -> PolyMesh {
    let face_starts = (0..=corners.len() as u32 / 3).map(|t| t * 3).collect();
    PolyMesh { positions, face_starts, corners, ..Default::default() }
}
