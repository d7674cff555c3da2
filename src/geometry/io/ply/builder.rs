//! The mesh as a PLY file is read, whatever the encoding.

use glam::DVec3;

use super::super::face_colours::FaceColours;
use super::super::problem::{FilePlace, FileProblem};
use super::super::text::refuse;
use super::header::{PlyHeader, PlyValues};
use crate::face_attributes::NO_UV;
use crate::{FaceAttributes, PolyMesh};

/// The mesh as it grows, whatever the encoding.
#[derive(Default)]
pub(super) struct PlyBuilder {
    pub(super) mesh: PolyMesh,
    pub(super) colours: Vec<[u8; 4]>,
    /// Texture coordinates: of the vertices, or of the corners by `uv_corners`.
    pub(super) uvs: Vec<[f64; 2]>,
    pub(super) uv_corners: Vec<u32>,
    pub(super) short: u64,
    pub(super) of_faces: FaceColours,
}

impl PlyBuilder {
    /// One vertex of the values of [`super::header::ROLES`]. `scale`: 1 where colours are bytes,
    /// 255 where they are 0 to 1, and so on.
    #[inline]
    pub(super) fn vertex(
        &mut self,
        values: &PlyValues,
        (coloured, scale): (bool, f64),
        textured: bool,
    ) {
        self.mesh.positions.push(DVec3::new(values[0], values[1], values[2]));
        if coloured {
            self.colours.push(colour(values, scale));
        }
        if textured {
            self.uvs.push([values[7], values[8]]);
        }
    }

    /// Gives the corners of a face, pushed from `first` on and closed, two values each; none where
    /// there are not as many.
    pub(super) fn textures(&mut self, first: usize, values: &[f64]) {
        let count = self.mesh.corners.len() - first;
        self.uv_corners.resize(first, NO_UV);
        let (pairs, _) = values.as_chunks::<2>();
        if pairs.len() == count && values.iter().all(|v| v.is_finite()) {
            let from = self.uvs.len() as u32;
            self.uv_corners.extend(from..from + count as u32);
            self.uvs.extend_from_slice(pairs);
        }
    }

    /// Gives the corners of a face, pushed from `first` on and closed, its colour.
    pub(super) fn paint(&mut self, first: usize, values: &PlyValues, scale: f64) {
        let own = colour(values, scale);
        self.mesh.corners[first..].iter().for_each(|v| self.of_faces.add(*v, Some(own)));
    }

    /// Returns the texture coordinates that were read.
    pub(super) fn attributes(&mut self) -> Option<FaceAttributes> {
        if self.uvs.is_empty() {
            return None;
        }
        if self.uv_corners.is_empty() {
            let uv = |c: &u32| {
                let known =
                    self.uvs.get(*c as usize).is_some_and(|uv| uv.iter().all(|v| v.is_finite()));
                if known { *c } else { NO_UV }
            };
            self.uv_corners = self.mesh.corners.iter().map(uv).collect();
        }
        self.uv_corners.resize(self.mesh.corners.len(), NO_UV);
        let (uvs, uv_corners) =
            (std::mem::take(&mut self.uvs), std::mem::take(&mut self.uv_corners));
        Some(FaceAttributes { uvs, uv_corners, ..FaceAttributes::default() })
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
pub(super) fn colour(values: &PlyValues, scale: f64) -> [u8; 4] {
    let byte = |v: f64| (v * scale).round().clamp(0.0, 255.0) as u8;
    [byte(values[3]), byte(values[4]), byte(values[5]), byte(values[6])]
}

/// Refuses a position that is no place.
#[inline]
pub(super) fn place(values: &PlyValues) -> Option<&'static str> {
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
