//! The mesh as a PLY file is read, whatever the encoding.

use glam::DVec3;

use super::super::problem::{FilePlace, FileProblem};
use super::super::text::refuse;
use super::header::PlyHeader;
use crate::PolyMesh;

/// The mesh as it grows, whatever the encoding.
#[derive(Default)]
pub(super) struct PlyBuilder {
    pub(super) mesh: PolyMesh,
    pub(super) colours: Vec<[u8; 4]>,
    pub(super) short: u64,
}

impl PlyBuilder {
    /// One vertex of the values of [`super::header::ROLES`]. `scale`: 1 where colours are bytes,
    /// 255 where they are 0 to 1, and so on.
    #[inline]
    pub(super) fn vertex(&mut self, values: &[f64; 7], coloured: bool, scale: f64) {
        self.mesh.positions.push(DVec3::new(values[0], values[1], values[2]));
        if coloured {
            self.colours.push(colour(values, scale));
        }
    }

    /// Closes the face whose corners were pushed from `first` on. `Err` with an index that is out
    /// of range.
    #[inline]
    pub(super) fn face(&mut self, first: usize, vertices: usize) -> Result<(), u32> {
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
    pub(super) fn strip(&mut self, indices: &[i64], vertices: usize) -> Result<(), i64> {
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
pub(super) fn colour(values: &[f64; 7], scale: f64) -> [u8; 4] {
    let byte = |v: f64| (v * scale).round().clamp(0.0, 255.0) as u8;
    [byte(values[3]), byte(values[4]), byte(values[5]), byte(values[6])]
}

/// Refuses a position that is no place.
#[inline]
pub(super) fn place(values: &[f64; 7]) -> Option<&'static str> {
    values[..3].iter().find_map(|&v| refuse(v))
}

pub(super) fn index_problem(at: FilePlace, bad: i64, vertices: usize) -> FileProblem {
    let expected = match vertices {
        0 => "no face before the vertices".to_string(),
        n => format!("a vertex index from 0 to {}", n - 1),
    };
    FileProblem::new(at, expected, format!("{bad}"))
}

pub(super) fn too_many(header: &PlyHeader) -> FileProblem {
    FileProblem::new(
        FilePlace::Line(1),
        "fewer than 2^32 corners",
        format!("more, in {} elements", header.elements.len()),
    )
}
