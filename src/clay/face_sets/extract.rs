//! Extracts a part of the surface as a solid: the part, its offset along the normals, and a rim
//! between the borders of both.

use glam::Vec3;

use super::{HIDDEN, MASKED};
use crate::snapshot::Snapshot;
use sculptd_geometry::TriMesh;
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::portable::PortableMath;

/// A part of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceSetPart {
    /// Triangles whose corners are all masked by half or more.
    Masked,
    /// Triangles whose corners are all in this set.
    Set(u16),
}

/// The reason why nothing was extracted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ExtractError {
    /// No triangle belongs to the part.
    #[error("no triangle that is shown has all its corners in it")]
    Nothing,
    /// A thickness that makes no solid.
    #[error("expected a thickness other than 0, negative for inwards")]
    Thickness,
}

/// Returns a closed shell around a part of the surface, without hidden triangles. `thickness`, in
/// mesh units, extends outwards along the normals of the part's vertices; a negative one extends
/// inwards. A vertex where pieces of the part only touch is duplicated for each of them, so that
/// every edge of the result has two triangles. Where the part bends more sharply than the thickness
/// allows, the shell intersects itself.
///
/// # Errors
/// Returns an error if the part is empty, or the thickness is 0 or not finite.
pub fn extract(
    clay: &Snapshot,
    part: FaceSetPart,
    thickness: f32,
) -> Result<TriMesh, ExtractError> {
    if !thickness.is_finite() || thickness == 0.0 {
        return Err(ExtractError::Thickness);
    }
    let plain = clay.to_tri();
    let ranks = clay.ranks();
    let mut belongs = vec![false; plain.positions.len()];
    for page in clay.pages() {
        for (v, &id) in page.topology().ids.iter().enumerate() {
            belongs[ranks.of(id)] = page.set_bits(v) & HIDDEN == 0
                && match part {
                    FaceSetPart::Masked => page.mask(v) >= MASKED,
                    FaceSetPart::Set(set) => page.face_set(v) == set,
                };
        }
    }
    let mut chosen = plain.triangles.clone();
    chosen.retain(|t| t.iter().all(|&v| belongs[v as usize]));
    if chosen.is_empty() {
        return Err(ExtractError::Nothing);
    }
    // Each corner is a separate vertex until triangles on both sides of an edge join theirs.
    let mut joined = DisjointSets::new(3 * chosen.len());
    // Lesser end, greater end, whether it is walked from the greater to the lesser, first corner.
    let mut edges: Vec<(u32, u32, bool, u32)> = Vec::with_capacity(3 * chosen.len());
    let after = |corner: u32| if corner % 3 == 2 { corner - 2 } else { corner + 1 };
    for corner in 0..3 * chosen.len() as u32 {
        let at = |c: u32| chosen[c as usize / 3][c as usize % 3];
        let (a, b) = (at(corner), at(after(corner)));
        edges.push((a.min(b), a.max(b), a > b, corner));
    }
    edges.sort_unstable();
    let mut rim: Vec<u32> = Vec::new();
    for all in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match all {
            [one, other] if one.2 != other.2 => {
                joined.join(one.3, after(other.3));
                joined.join(after(one.3), other.3);
            }
            // The border, or an edge of more than two triangles, each of which gets a separate rim.
            _ => rim.extend(all.iter().map(|e| e.3)),
        }
    }
    rim.sort_unstable();
    let mut number = vec![u32::MAX; 3 * chosen.len()];
    let mut from: Vec<u32> = Vec::new();
    let mut normals: Vec<Vec3> = Vec::new();
    let mut corners: Vec<u32> = Vec::with_capacity(3 * chosen.len());
    for (t, triangle) in chosen.iter().enumerate() {
        let p = triangle.map(|v| plain.positions[v as usize]);
        let facing = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for k in 0..3 {
            let root = joined.root(3 * t as u32 + k as u32) as usize;
            if number[root] == u32::MAX {
                number[root] = from.len() as u32;
                from.push(triangle[k]);
                normals.push(Vec3::ZERO);
            }
            let [u, v] = [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]];
            // Weighted by the angle (Thürmer and Wüthrich 1998), so that the cut does not show.
            normals[number[root] as usize] += facing * angle(u, v);
            corners.push(number[root]);
        }
    }
    let count = from.len() as u32;
    let place = |v: &u32| plain.positions[*v as usize];
    let near = from.iter().map(place);
    let far = from.iter().zip(&normals).map(|(v, n)| place(v) + n.normalize_or_zero() * thickness);
    let positions: Vec<Vec3> = near.chain(far).collect();
    // The offset surface is the outer one, or where the thickness goes inwards the inner one.
    let (outer, inner) = if thickness > 0.0 { (count, 0) } else { (0, count) };
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(2 * chosen.len() + 2 * rim.len());
    for t in corners.chunks_exact(3) {
        triangles.push([t[0] + outer, t[1] + outer, t[2] + outer]);
        triangles.push([t[2] + inner, t[1] + inner, t[0] + inner]);
    }
    for corner in rim {
        let (a, b) = (corners[corner as usize], corners[after(corner) as usize]);
        triangles.push([b + outer, a + outer, a + inner]);
        triangles.push([b + outer, a + inner, b + inner]);
    }
    let colours = plain.colours.as_ref().map(|colours| {
        let one = || from.iter().map(|v| colours[*v as usize]);
        one().chain(one()).collect()
    });
    Ok(TriMesh { positions, triangles, colours })
}

/// The angle between two directions, radians; 0 where one has no length.
fn angle(a: Vec3, b: Vec3) -> f32 {
    let lengths = a.length() * b.length();
    if lengths > 0.0 { (a.dot(b) / lengths).clamp(-1.0, 1.0).portable_acos() } else { 0.0 }
}
