//! Connected regions of faces.

use glam::DVec3;
use sculptd_geometry::disjoint_sets::DisjointSets;

use crate::part::PreparedPart;

/// A connected region of faces.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceRegion {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// The sum of their areas.
    pub area: f64,
    /// The centre of the face of the region that is nearest to the region's centre.
    pub position: DVec3,
}

/// The connected regions of some triangles, the largest first.
pub fn connected(part: &PreparedPart, faces: &[u32]) -> Vec<FaceRegion> {
    let place = |t: u32| faces.binary_search(&t).ok();
    let mut sets = DisjointSets::new(faces.len());
    for (i, &t) in faces.iter().enumerate() {
        for k in 0..3 {
            if let Some(j) = part.across(t, k).filter(|&u| u > t).and_then(place) {
                sets.join(i as u32, j as u32);
            }
        }
    }
    let mut by_root: Vec<(u32, u32)> =
        faces.iter().enumerate().map(|(i, &t)| (sets.root(i as u32), t)).collect();
    by_root.sort_unstable();
    let mut out: Vec<FaceRegion> = by_root
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| {
            let triangles: Vec<u32> = group.iter().map(|g| g.1).collect();
            let (mut area, mut moment) = (0.0, DVec3::ZERO);
            for &t in &triangles {
                area += part.areas[t as usize];
                moment += part.middle(t) * part.areas[t as usize];
            }
            let centre = moment / area;
            let away = |t: &&u32| part.middle(**t).distance_squared(centre);
            let nearest = triangles.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let position = nearest.map_or(centre, |&t| part.middle(t));
            FaceRegion { triangles, area, position }
        })
        .collect();
    out.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangles[0].cmp(&b.triangles[0])));
    out
}
