//! PLY: text, little-endian and big-endian; any elements and properties in any order; lists;
//! colours.
//!
//! Own code, so that errors name their byte or line, counts are checked before memory is taken, and
//! double precision and polygons are kept. The header becomes a plan (offset and type of the few
//! properties that matter), and rows are read by it; rows of one length on all cores.

mod binary;
mod header;
mod text;

use glam::DVec3;

use super::problem::{At, Problem, Stop};
use super::{Format, text::refuse};
use crate::PolyMesh;
use crate::job::Job;
use header::{Encoding, Header};

pub(super) fn parse(
    bytes: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<(PolyMesh, Format), Stop> {
    let header = header::parse(bytes)?;
    header.check(bytes.len())?;
    let mut made = Making::default();
    match header.encoding {
        Encoding::Ascii => text::read(bytes, &header, &mut made, job)?,
        Encoding::Little => binary::read::<binary::Little>(bytes, &header, &mut made, job)?,
        Encoding::Big => binary::read::<binary::Big>(bytes, &header, &mut made, job)?,
    }
    let format = match header.encoding {
        Encoding::Ascii => Format::PlyAscii,
        Encoding::Little => Format::PlyLittle,
        Encoding::Big => Format::PlyBig,
    };
    if made.short > 0 {
        warnings.push(format!("{} faces of fewer than three corners left out", made.short));
    }
    let mut mesh = made.mesh;
    if header.coloured() {
        mesh.colours = Some(made.colours);
    }
    if mesh.face_starts.is_empty() {
        mesh.face_starts.push(0);
    }
    Ok((mesh, format))
}

/// The mesh as it grows, whatever the encoding.
#[derive(Default)]
struct Making {
    mesh: PolyMesh,
    colours: Vec<[u8; 4]>,
    short: u64,
}

/// The roles that a vertex's properties play, as places in [`Making::vertex`]'s array.
const ROLES: [&str; 7] = ["x", "y", "z", "red", "green", "blue", "alpha"];

impl Making {
    /// One vertex of the values of [`ROLES`]. `scale`: 1 where colours are bytes, 255 where they
    /// are 0 to 1, and so on.
    #[inline]
    fn vertex(&mut self, values: &[f64; 7], coloured: bool, scale: f64) {
        self.mesh.positions.push(DVec3::new(values[0], values[1], values[2]));
        if coloured {
            self.colours.push(colour(values, scale));
        }
    }

    /// Closes the face whose corners were pushed from `first` on. `Err` with an index that is out
    /// of range.
    #[inline]
    fn face(&mut self, first: usize, vertices: usize) -> Result<(), u32> {
        let corners = &self.mesh.corners[first..];
        if corners.len() < 3 {
            self.short += 1;
            self.mesh.corners.truncate(first);
            return Ok(());
        }
        if let Some(&bad) = corners.iter().find(|&&c| c as usize >= vertices) {
            return Err(bad);
        }
        self.mesh.face_starts.push(self.mesh.corners.len() as u32);
        Ok(())
    }

    /// A triangle strip; a negative index starts a new one. Every second triangle is turned.
    fn strip(&mut self, indices: &[i64], vertices: usize) -> Result<(), i64> {
        for strip in indices.split(|&i| i < 0) {
            if let Some(&bad) = strip.iter().find(|&&i| i >= vertices as i64) {
                return Err(bad);
            }
            for (n, w) in strip.windows(3).enumerate() {
                let [a, b, c] = [w[0] as u32, w[1] as u32, w[2] as u32];
                if a != b && b != c && c != a {
                    self.mesh.push_face(&if n % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
        Ok(())
    }
}

#[inline]
fn colour(values: &[f64; 7], scale: f64) -> [u8; 4] {
    let byte = |v: f64| (v * scale).round().clamp(0.0, 255.0) as u8;
    [byte(values[3]), byte(values[4]), byte(values[5]), byte(values[6])]
}

/// Refuses a position that is no place.
#[inline]
fn place(values: &[f64; 7]) -> Option<&'static str> {
    values[..3].iter().find_map(|&v| refuse(v))
}

fn index_problem(at: At, bad: i64, vertices: usize) -> Problem {
    let expected = match vertices {
        0 => "no face before the vertices".to_string(),
        n => format!("a vertex index from 0 to {}", n - 1),
    };
    Problem::new(at, expected, format!("{bad}"))
}

fn too_many(header: &Header) -> Problem {
    Problem::new(
        At::Line(1),
        "fewer than 2^32 corners",
        format!("more, in {} elements", header.elements.len()),
    )
}
