//! Text data. Rows are read word by word, as the format has it: line ends mean nothing.

use super::super::problem::{FilePlace, FileProblem, ParseError};
use super::super::text::{TextCursor, float, unexpected};
use super::builder::{PlyBuilder, index_problem, place, too_many};
use super::header::{self, PlyHeader, PlyRole};
use crate::job::Job;

pub(super) fn read(
    bytes: &[u8],
    header: &PlyHeader,
    made: &mut PlyBuilder,
    job: &Job,
) -> Result<(), ParseError> {
    let text = &bytes[header.data..];
    let shift = |mut p: FileProblem| {
        if let FilePlace::Line(n) = &mut p.at {
            *n += header.data_line - 1;
        }
        ParseError::Problem(p)
    };
    let mut cursor = TextCursor::new(text);
    let (coloured, scale) = (header.coloured(), header.colour_scale());
    let painted = header.face_colour_scale();
    let textured = header.textured() && !header.textures_faces();
    let (mut list, mut uvs): (Vec<i64>, Vec<f64>) = (Vec::new(), Vec::new());
    let rows: usize = header.elements.iter().map(|e| e.count).sum();
    let filled = |line: &&[u8]| !line.trim_ascii().is_empty();
    // Where there are as many lines as rows, a row is a line, and a number that is missing is not
    // taken from the next one.
    let by_line = text.split(|b| *b == b'\n').filter(filled).count() == rows;
    for element in &header.elements {
        let roles = element.roles();
        let (corners, textures) = (element.corners(), element.texture_coordinates());
        match element.role {
            PlyRole::Vertex => {
                made.mesh.positions.reserve_exact(element.count);
                if coloured {
                    made.colours.reserve_exact(element.count);
                }
            }
            PlyRole::Face => made.mesh.face_starts.reserve_exact(element.count + 1),
            _ => {}
        }
        if made.mesh.face_starts.is_empty() {
            made.mesh.face_starts.push(0);
        }
        for row in 0..element.count {
            if row.is_multiple_of(1 << 14) {
                job.check()?;
                job.progress(cursor.at as f32 / text.len() as f32);
            }
            let own_scale = painted.filter(|_| element.role == PlyRole::Face);
            let mut values = header::values(own_scale.unwrap_or(scale));
            uvs.clear();
            let first = made.mesh.corners.len();
            if by_line {
                cursor.skip_blanks();
            }
            let row_at = cursor.at;
            for (p, property) in element.properties.iter().enumerate() {
                let mut value = || -> Result<f64, ParseError> {
                    let at = cursor.at;
                    let word = if by_line { cursor.word() } else { cursor.word_anywhere(false) };
                    word.and_then(float).ok_or_else(|| {
                        let expected =
                            format!("a number for \"{}\" of {} {row}", property.name, element.name);
                        if by_line {
                            return shift(unexpected(text, row_at, expected));
                        }
                        // Past the blanks and line ends, so that the line named is that of the
                        // word.
                        let skip =
                            text[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
                        shift(unexpected(text, at + skip, expected))
                    })
                };
                if property.list.is_none() {
                    let v = value()?;
                    if let Some(role) = roles[p] {
                        values[role] = v;
                    }
                    continue;
                }
                let n = value()?;
                if !(0.0..=u32::MAX as f64).contains(&n) || n.fract() != 0.0 {
                    return Err(shift(unexpected(
                        text,
                        row_at,
                        format!("a list's length in {} {row}", element.name),
                    )));
                }
                let wanted = corners == Some(p);
                list.clear();
                for _ in 0..n as u64 {
                    let v = value()?;
                    if wanted && element.role == PlyRole::Face {
                        let whole = (0.0..u32::MAX as f64).contains(&v) && v.fract() == 0.0;
                        made.mesh.corners.push(if whole { v as u32 } else { u32::MAX });
                    } else if wanted {
                        list.push(v as i64);
                    } else if textures == Some(p) {
                        uvs.push(v);
                    }
                }
                if made.mesh.corners.len() >= u32::MAX as usize {
                    return Err(too_many(header).into());
                }
            }
            if by_line && let Some(word) = cursor.word() {
                let (at, expected) = (cursor.at - word.len(), "the end of the line");
                return Err(shift(unexpected(
                    text,
                    at,
                    format!("{expected} after {} {row}", element.name),
                )));
            }
            let line = || {
                let skip = text[row_at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
                FilePlace::Line(super::super::text::line_of(text, row_at + skip))
            };
            let vertices = made.mesh.positions.len();
            match element.role {
                PlyRole::Vertex => {
                    if let Some(found) = place(&values) {
                        return Err(shift(FileProblem::new(line(), "a finite coordinate", found)));
                    }
                    made.vertex(&values, (coloured, scale), textured);
                }
                PlyRole::Face if corners.is_some() => {
                    made.face(first, vertices)
                        .map_err(|bad| shift(index_problem(line(), bad as i64, vertices)))?;
                    if let Some(scale) = own_scale {
                        made.paint(first, &values, scale);
                    }
                    if textures.is_some() {
                        made.textures(first, &uvs);
                    }
                }
                PlyRole::Strips if corners.is_some() => {
                    made.strip(&list, vertices)
                        .map_err(|bad| shift(index_problem(line(), bad, vertices)))?;
                }
                _ => {}
            }
        }
    }
    Ok(())
}
