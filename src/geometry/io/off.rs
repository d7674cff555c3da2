//! OFF, the Object File Format of Geomview, as text: `OFF`, `COFF` (colours), `NOFF`, `STOFF` and
//! their mixtures. Own code: there is no kept library.

use glam::DVec3;

use super::face_colours::FaceColours;
use super::problem::{FilePlace, FileProblem, ParseError, excerpt};
use super::text::{TextCursor, float, integer, line_of, refuse, unexpected};
use crate::PolyMesh;
use crate::job::Job;

/// The first word that is no comment, if it is an OFF header.
pub(super) fn header(text: &[u8]) -> Option<&[u8]> {
    let word =
        TextCursor::new(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)).word_anywhere(true)?;
    let flags = word.strip_suffix(b"OFF")?;
    let rest = flags.strip_prefix(b"ST").unwrap_or(flags);
    rest.iter().all(|b| b"CN4n".contains(b)).then_some(word)
}

pub(super) fn parse(
    text: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let mut cursor = TextCursor::new(text);
    let Some(kind) = header(text) else {
        return Err(FileProblem::new(FilePlace::Line(1), "\"OFF\"", excerpt(text)).into());
    };
    let _ = cursor.word_anywhere(true);
    if kind.contains(&b'4') || kind.contains(&b'n') {
        return Err(FileProblem::new(
            FilePlace::Line(1),
            "three coordinates a vertex (OFF)",
            excerpt(kind),
        )
        .into());
    }
    let (textured, coloured, normals) =
        (kind.starts_with(b"ST"), kind.contains(&b'C'), kind.contains(&b'N'));
    let mut counts = [0usize; 3];
    for (n, slot) in counts.iter_mut().enumerate() {
        let at = cursor.at;
        // The count of edges is often missing: it is looked for on the same line only.
        let word = if n == 2 { cursor.word() } else { cursor.word_anywhere(true) };
        if n == 0 && word == Some(b"BINARY") {
            return Err(FileProblem::new(FilePlace::Line(1), "OFF text", "binary OFF").into());
        }
        match word.and_then(integer) {
            Some(v) if v >= 0 => *slot = v as usize,
            _ if n == 2 => {}
            _ => return Err(unexpected(text, at, "the counts of vertices, faces and edges").into()),
        }
    }
    let [vertices, faces, _] = counts;
    // The shortest vertex is "0 0 0\n", the shortest face "3 0 1 2\n"; so no count makes us take
    // memory that the file's length does not warrant.
    let room = text.len() as u64;
    if vertices as u64 * 6 > room + 6
        || faces as u64 * 4 > room + 6
        || vertices >= u32::MAX as usize
    {
        let found =
            format!("counts of {vertices} vertices and {faces} faces in a file of {room} bytes");
        return Err(FileProblem::new(
            FilePlace::Line(line_of(text, cursor.at)),
            "as many vertices and faces as the file has room for",
            found,
        )
        .into());
    }
    if vertices == 0 {
        return Err(FileProblem::new(
            FilePlace::Line(line_of(text, cursor.at)),
            "at least one vertex",
            "a count of 0",
        )
        .into());
    }
    if !text[..cursor.at].ends_with(b"\n") {
        cursor.skip_line();
    }
    let mut mesh = PolyMesh::new();
    mesh.positions.reserve_exact(vertices);
    mesh.face_starts.reserve_exact(faces);
    let mut colours = Vec::new();
    for v in 0..vertices {
        if v.is_multiple_of(1 << 14) {
            job.check()?;
        }
        let line = start_of_row(&mut cursor);
        let mut xyz = [0f64; 3];
        for c in &mut xyz {
            let Some(value) = cursor.word().and_then(float) else {
                return Err(
                    unexpected(text, line, format!("three coordinates of vertex {v}")).into()
                );
            };
            if let Some(found) = refuse(value) {
                return Err(FileProblem::new(
                    FilePlace::Line(line_of(text, line)),
                    "a finite coordinate",
                    found,
                )
                .into());
            }
            *c = value;
        }
        mesh.positions.push(DVec3::from(xyz));
        if coloured {
            if normals {
                for _ in 0..3 {
                    cursor.word();
                }
            }
            colours.push(colour(&mut cursor, if textured { 2 } else { 0 }).0);
        }
        cursor.skip_line();
    }
    job.progress(0.5);
    let (mut short, mut painted) = (0u64, 0u64);
    let mut of_faces = FaceColours::default();
    for f in 0..faces {
        if f.is_multiple_of(1 << 14) {
            job.check()?;
        }
        let line = start_of_row(&mut cursor);
        let n = match cursor.word().and_then(integer) {
            Some(n) if n >= 0 => n as usize,
            _ => return Err(unexpected(text, line, format!("the corner count of face {f}")).into()),
        };
        let first = mesh.corners.len();
        for _ in 0..n {
            match cursor.word().and_then(integer) {
                Some(i) if i >= 0 && (i as usize) < vertices => mesh.corners.push(i as u32),
                Some(i) => {
                    let at = FilePlace::Line(line_of(text, line));
                    return Err(FileProblem::new(
                        at,
                        format!("a vertex index from 0 to {}", vertices - 1),
                        i.to_string(),
                    )
                    .into());
                }
                None => {
                    return Err(
                        unexpected(text, line, format!("{n} vertex indices of face {f}")).into()
                    );
                }
            }
        }
        if mesh.corners.len() >= u32::MAX as usize {
            return Err(FileProblem::new(
                FilePlace::Line(line_of(text, line)),
                "fewer than 2^32 corners",
                "more",
            )
            .into());
        }
        if n < 3 {
            mesh.corners.truncate(first);
            short += 1;
        } else {
            mesh.face_starts.push(mesh.corners.len() as u32);
            let (own, words) = colour(&mut cursor, 0);
            // A single number is a place in a list of colours that no file has.
            painted += u64::from(words > 0 && (words < 3 || coloured));
            if words >= 3 && !coloured {
                mesh.corners[first..].iter().for_each(|v| of_faces.add(*v, Some(own)));
            }
        }
        cursor.skip_line();
    }
    if short > 0 {
        warnings.push(format!("{short} faces of fewer than three corners left out"));
    }
    if painted > 0 {
        warnings.push(format!("the colours of {painted} faces left out"));
    }
    mesh.colours =
        if coloured { Some(colours) } else { of_faces.of(mesh.positions.len(), warnings) };
    Ok(mesh)
}

/// Past blank lines and comments; where the row starts.
fn start_of_row(cursor: &mut TextCursor) -> usize {
    loop {
        let at = cursor.at;
        match cursor.word() {
            Some(w) if w[0] == b'#' => cursor.skip_line(),
            Some(_) => {
                cursor.at = at;
                return at;
            }
            None if cursor.ended() => return at,
            None => cursor.skip_line(),
        }
    }
}

/// Three or four numbers, bytes or 0 to 1: floats have a point in them. Returns how many there are,
/// too.
fn colour(cursor: &mut TextCursor, after: usize) -> ([u8; 4], usize) {
    let mut words = Vec::with_capacity(6);
    while words.len() < 6 {
        match cursor.word() {
            Some(w) if w[0] != b'#' => words.push(w),
            _ => break,
        }
    }
    words.truncate(words.len().saturating_sub(after));
    let floats = words.iter().any(|w| w.contains(&b'.'));
    let mut out = [255u8; 4];
    for (o, w) in out.iter_mut().zip(&words) {
        let value = float(w).unwrap_or(1.0);
        *o = (if floats { value * 255.0 } else { value }).round().clamp(0.0, 255.0) as u8;
    }
    (out, words.len())
}
