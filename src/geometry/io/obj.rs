//! Wavefront OBJ. Own code, so that errors name their line, double precision and polygons are kept,
//! and pieces of the file are read on all cores.
//!
//! Read: `v` (with `w` ignored or colours after it), `vt`, `f` with any number of corners, negative
//! indices, a backslash that continues a line, `g`, `usemtl`, `o` as groups with their names, and
//! `mtllib`. Normals, lines, points and smoothing groups are passed over in silence; a third
//! texture coordinate, free-form curves and surfaces with a warning.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::problem::{FilePlace, FileProblem, ParseError};
use super::text::{TextCursor, float, integer, line_of, pieces, refuse, unexpected};
use crate::face_attributes::NO_UV;
use crate::job::Job;
use crate::{FaceAttributes, GroupName, PolyMesh};

/// Large enough that a piece's start-up costs nothing, small enough that two cores end together.
const PIECE: usize = 1 << 20;

/// The content of one piece of the file. Corners count from the whole file's first vertex if
/// positive (from 1), else from the piece's first vertex: `RELATIVE + n`.
#[derive(Default)]
struct ObjPiece {
    positions: Vec<DVec3>,
    colours: Vec<[u8; 4]>,
    corners: Vec<i64>,
    /// Texture coordinates.
    uvs: Vec<[f64; 2]>,
    /// Of each corner its texture coordinate, counted as corners are, 0 for none; shorter than
    /// `corners` where the last ones have none.
    uv_corners: Vec<i64>,
    lengths: Vec<u32>,
    /// (face of this piece from which it holds, kind, name)
    names: Vec<(u32, u8, String)>,
    libraries: Vec<String>,
    short_faces: u64,
    /// Texture coordinates with a third number other than 0, and ones that are not numbers.
    deep_uvs: u64,
    bad_uvs: u64,
    free_form: u64,
}

const RELATIVE: i64 = i64::MIN / 2;

pub(super) fn parse(
    text: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let spans = pieces(text, PIECE);
    let parts: Vec<Result<ObjPiece, ParseError>> = spans
        .par_iter()
        .map(|&(start, end)| {
            job.check()?;
            piece(&text[start..end]).map_err(|e| place(text, start, e))
        })
        .collect();
    let parts = parts.into_iter().collect::<Result<Vec<ObjPiece>, ParseError>>()?;
    job.progress(0.7);

    let vertices: usize = parts.iter().map(|p| p.positions.len()).sum();
    let corners: usize = parts.iter().map(|p| p.corners.len()).sum();
    if vertices == 0 {
        let found = if text.is_empty() {
            "an empty file".into()
        } else {
            super::problem::excerpt(text.trim_ascii_start())
        };
        return Err(FileProblem::new(
            FilePlace::File,
            "OBJ text with vertices (lines \"v x y z\")",
            found,
        )
        .into());
    }
    if vertices >= u32::MAX as usize || corners >= u32::MAX as usize {
        return Err(FileProblem::new(
            FilePlace::File,
            "fewer than 2^32 vertices and corners",
            format!("{vertices} and {corners}"),
        )
        .into());
    }
    let mut mesh = PolyMesh::new();
    mesh.positions.reserve_exact(vertices);
    mesh.corners.reserve_exact(corners);
    mesh.face_starts.reserve_exact(parts.iter().map(|p| p.lengths.len()).sum());
    let coloured = parts.iter().any(|p| !p.colours.is_empty());
    let mut colours = Vec::new();
    let mut groups = ObjGroups::default();
    let (mut short, mut free, mut deep, mut bad) = (0, 0, 0, 0);
    let mut uvs = UvList::new(&parts);
    for (part, &(start, end)) in parts.iter().zip(&spans) {
        job.check()?;
        let base = mesh.positions.len() as i64;
        mesh.positions.extend_from_slice(&part.positions);
        if coloured {
            colours.extend_from_slice(&part.colours);
            colours.resize(mesh.positions.len(), [255; 4]);
        }
        groups.take(part, mesh.face_count());
        uvs.take(part);
        let mut at = 0;
        for (f, &n) in part.lengths.iter().enumerate() {
            for &c in &part.corners[at..at + n as usize] {
                let v = if c > 0 { c - 1 } else { base + (c - RELATIVE) };
                if v < 0 || v >= vertices as i64 {
                    return Err(out_of_range(
                        text,
                        start,
                        end,
                        f,
                        if c > 0 { c } else { v + 1 },
                        vertices,
                    )
                    .into());
                }
                mesh.corners.push(v as u32);
            }
            at += n as usize;
            mesh.face_starts.push(mesh.corners.len() as u32);
        }
        short += part.short_faces;
        free += part.free_form;
        deep += part.deep_uvs;
        bad += part.bad_uvs;
    }
    groups.fill(mesh.face_count());
    let attributes = FaceAttributes {
        groups: groups.names(),
        uvs: uvs.values,
        uv_corners: uvs.corners,
        libraries: parts.iter().flat_map(|p| p.libraries.iter().cloned()).collect(),
    };
    mesh.attributes = (!attributes.is_empty()).then(|| Arc::new(attributes));
    mesh.groups = groups.used.then_some(groups.of_face);
    mesh.colours = coloured.then_some(colours);
    if short > 0 {
        warnings.push(format!("{short} faces of fewer than three corners left out"));
    }
    if deep > 0 {
        warnings.push(format!("the third number of {deep} texture coordinates (vt) left out"));
    }
    if bad > 0 {
        warnings.push(format!("{bad} texture coordinates (vt) that are no numbers taken as 0"));
    }
    if uvs.missing > 0 {
        let count = uvs.missing;
        warnings.push(format!("{count} corners name a texture coordinate (vt) that is not there"));
    }
    if free > 0 {
        warnings.push(format!("{free} free-form curves or surfaces left out"));
    }
    Ok(mesh)
}

/// Moves a piece's problem to its line in the whole text.
fn place(text: &[u8], start: usize, e: FileProblem) -> ParseError {
    let before = line_of(text, start) - 1;
    match e.at {
        FilePlace::Line(n) => FileProblem { at: FilePlace::Line(n + before), ..e }.into(),
        _ => e.into(),
    }
}

/// The line of the piece's face `f`, found by reading again: only a bad file pays for it.
#[cold]
fn out_of_range(
    text: &[u8],
    start: usize,
    end: usize,
    f: usize,
    index: i64,
    vertices: usize,
) -> FileProblem {
    let part = &text[start..end];
    let mut cursor = TextCursor::new(part);
    let mut count = 0;
    let mut line = start;
    while !cursor.ended() {
        let at = cursor.at;
        if cursor.word() == Some(b"f") {
            let mut corners = 0;
            while words_on(&mut cursor).is_some() {
                corners += 1;
            }
            if corners >= 3 {
                if count == f {
                    line = start + at;
                    break;
                }
                count += 1;
            }
        }
        skip_logical(&mut cursor);
    }
    FileProblem::new(
        FilePlace::Line(line_of(text, line)),
        format!("a vertex index from 1 to {vertices}"),
        format!("{index}"),
    )
}

/// The next word of the logical line: a backslash at the end continues it.
#[inline]
fn words_on<'a>(cursor: &mut TextCursor<'a>) -> Option<&'a [u8]> {
    loop {
        match cursor.word() {
            Some(b"\\") if at_line_end(cursor) => cursor.skip_line(),
            Some(w) if w[0] == b'#' => {
                while cursor.word().is_some() {}
                return None;
            }
            Some(w) if w.last() == Some(&b'\\') && at_line_end(cursor) => {
                cursor.skip_line();
                return Some(&w[..w.len() - 1]);
            }
            w => return w,
        }
    }
}

fn at_line_end(cursor: &TextCursor) -> bool {
    let rest = &cursor.text[cursor.at..];
    rest.is_empty() || rest.starts_with(b"\n") || rest.starts_with(b"\r\n")
}

fn skip_logical(cursor: &mut TextCursor) {
    loop {
        let start = cursor.at;
        cursor.skip_line();
        let line = &cursor.text[start..cursor.at];
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if line.last() != Some(&b'\\') || cursor.ended() {
            return;
        }
    }
}

fn piece(text: &[u8]) -> Result<ObjPiece, FileProblem> {
    let mut out = ObjPiece::default();
    let mut cursor = TextCursor::new(text);
    while !cursor.ended() {
        let line = cursor.at;
        let Some(keyword) = cursor.word() else {
            cursor.skip_line();
            continue;
        };
        match keyword {
            b"v" => vertex(&mut cursor, &mut out, text, line)?,
            b"f" | b"fo" => face(&mut cursor, &mut out, text)?,
            b"g" | b"usemtl" | b"o" => {
                let name = rest_of_line(&mut cursor);
                out.names.push((out.lengths.len() as u32, keyword[0], name));
                continue;
            }
            b"vt" => texture(&mut cursor, &mut out),
            b"mtllib" => {
                let name = rest_of_line(&mut cursor);
                out.libraries.extend((!name.is_empty()).then_some(name));
                continue;
            }
            b"curv" | b"curv2" | b"surf" => out.free_form += 1,
            _ => {}
        }
        skip_logical(&mut cursor);
    }
    Ok(out)
}

/// The words that are left on the line, a blank between each two.
fn rest_of_line(cursor: &mut TextCursor) -> String {
    let mut name = Vec::new();
    while let Some(w) = words_on(cursor) {
        name.extend_from_slice(w);
        name.push(b' ');
    }
    String::from_utf8_lossy(&name).trim_end().to_string()
}

/// A texture coordinate. It moves nothing, so invalid ones are counted and reported.
fn texture(cursor: &mut TextCursor, out: &mut ObjPiece) {
    let mut values = [0f64; 3];
    let mut good = true;
    for value in &mut values {
        let Some(word) = words_on(cursor) else { break };
        let number = float(word).filter(|v| v.is_finite());
        good &= number.is_some();
        *value = number.unwrap_or(0.0);
    }
    out.bad_uvs += u64::from(!good);
    out.deep_uvs += u64::from(values[2] != 0.0);
    out.uvs.push([values[0], values[1]]);
}

#[inline]
fn vertex(
    cursor: &mut TextCursor,
    out: &mut ObjPiece,
    text: &[u8],
    line: usize,
) -> Result<(), FileProblem> {
    let mut values = [0f64; 8];
    let mut n = 0;
    loop {
        let at = cursor.at;
        let Some(word) = words_on(cursor) else { break };
        let Some(value) = float(word) else {
            return Err(unexpected(text, at, "a number of the vertex"));
        };
        if n < 3
            && let Some(found) = refuse(value)
        {
            return Err(FileProblem::new(
                FilePlace::Line(line_of(text, line)),
                "a finite coordinate",
                found,
            ));
        }
        if n < 8 {
            values[n] = value;
            n += 1;
        }
    }
    if n < 3 {
        return Err(unexpected(text, line, "three coordinates after \"v\""));
    }
    out.positions.push(DVec3::new(values[0], values[1], values[2]));
    // x y z r g b, or x y z w r g b; sRGB from 0 to 1 as every writer of this custom has it.
    let from = if n == 6 {
        Some(3)
    } else if n >= 7 {
        Some(n - 4 + (n == 7) as usize)
    } else {
        None
    };
    if let Some(from) = from {
        let byte = |v: f64| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        let alpha = if n >= 8 { byte(values[from + 3]) } else { 255 };
        out.colours.resize(out.positions.len() - 1, [255; 4]);
        out.colours.push([
            byte(values[from]),
            byte(values[from + 1]),
            byte(values[from + 2]),
            alpha,
        ]);
    }
    Ok(())
}

#[inline]
fn face(cursor: &mut TextCursor, out: &mut ObjPiece, text: &[u8]) -> Result<(), FileProblem> {
    let first = out.corners.len();
    let own = out.positions.len() as i64;
    loop {
        let at = cursor.at;
        let Some(word) = words_on(cursor) else { break };
        let digits = match memchr::memchr(b'/', word) {
            Some(n) => {
                uv_of_corner(&word[n + 1..], out);
                &word[..n]
            }
            None => word,
        };
        match integer(digits) {
            Some(i) if i > 0 => out.corners.push(i),
            Some(i) if i < 0 => out.corners.push(RELATIVE + own + i),
            _ => return Err(unexpected(text, at, "a vertex index (not 0) of the face")),
        }
    }
    let n = out.corners.len() - first;
    if n < 3 {
        out.corners.truncate(first);
        out.uv_corners.truncate(first);
        out.short_faces += 1;
    } else {
        out.lengths.push(n as u32);
    }
    Ok(())
}

/// The texture coordinate of the corner that is read now, from what follows its first slash.
#[inline]
fn uv_of_corner(word: &[u8], out: &mut ObjPiece) {
    let digits = &word[..memchr::memchr(b'/', word).unwrap_or(word.len())];
    let index = match integer(digits) {
        Some(i) if i > 0 => i,
        Some(i) if i < 0 => RELATIVE + out.uvs.len() as i64 + i,
        _ => return,
    };
    out.uv_corners.resize(out.corners.len(), 0);
    out.uv_corners.push(index);
}

/// Texture coordinates of the whole file.
struct UvList {
    values: Vec<[f64; 2]>,
    /// One a corner; empty where no corner has any.
    corners: Vec<u32>,
    /// Texture coordinates of the whole file.
    count: i64,
    used: bool,
    missing: u64,
}

impl UvList {
    fn new(parts: &[ObjPiece]) -> UvList {
        let count = parts.iter().map(|p| p.uvs.len() as i64).sum();
        let used = parts.iter().any(|p| !p.uv_corners.is_empty());
        UvList { values: Vec::new(), corners: Vec::new(), count, used, missing: 0 }
    }

    fn take(&mut self, part: &ObjPiece) {
        if !self.used {
            return;
        }
        let base = self.values.len() as i64;
        self.values.extend_from_slice(&part.uvs);
        let first = self.corners.len();
        for &c in &part.uv_corners {
            let at = match c {
                0 => -1,
                c if c > 0 => c - 1,
                c => base + (c - RELATIVE),
            };
            let there = (0..self.count.min(i64::from(NO_UV))).contains(&at);
            self.missing += u64::from(c != 0 && !there);
            self.corners.push(if there { at as u32 } else { NO_UV });
        }
        self.corners.resize(first + part.corners.len(), NO_UV);
    }
}

/// Numbers groups in the order in which faces use them: one for each different set of object, group
/// and material.
#[derive(Default)]
struct ObjGroups {
    now: [String; 3],
    id: Option<u32>,
    known: BTreeMap<[String; 3], u32>,
    of_face: Vec<u32>,
    used: bool,
}

impl ObjGroups {
    /// Returns the name of each group, by its number; empty if the names only repeat the numbers.
    fn names(&self) -> Vec<GroupName> {
        let number = |(names, id): (&[String; 3], &u32)| {
            names[0].is_empty() && names[1] == format!("group_{id}") && names[2].is_empty()
        };
        if self.known.iter().all(number) {
            return Vec::new();
        }
        let mut all = vec![GroupName::default(); self.known.len()];
        for ([object, group, material], id) in &self.known {
            all[*id as usize] = GroupName {
                object: object.clone(),
                group: group.clone(),
                material: material.clone(),
            };
        }
        all
    }

    fn take(&mut self, part: &ObjPiece, first_face: usize) {
        for (face, kind, name) in &part.names {
            self.used = true;
            self.fill(first_face + *face as usize);
            let slot = match kind {
                b'o' => 0,
                b'g' => 1,
                _ => 2,
            };
            if self.now[slot] != *name {
                self.now[slot].clone_from(name);
                self.id = None;
            }
        }
    }

    fn fill(&mut self, faces: usize) {
        if !self.used || self.of_face.len() >= faces {
            return;
        }
        let next = self.known.len() as u32;
        let id =
            *self.id.get_or_insert_with(|| *self.known.entry(self.now.clone()).or_insert(next));
        self.of_face.resize(faces, id);
    }
}
