//! Converts a mesh file to a manifold surface in a local frame: the middle of the box is the
//! origin, the target side of a quad is the unit.

use glam::DVec3;

use super::surface::EditSurface;
use super::{QuadError, QuadSettings, creases};
use crate::edges::EdgeTable;
use crate::job::Job;
use crate::{PolyMesh, TriMesh, repair};

/// The surface to be remeshed, its frame and its lines.
pub(super) struct QuadInput {
    pub surface: EditSurface,
    /// A point `p` of the frame is `p * unit + centre` in the file.
    pub centre: DVec3,
    pub unit: f64,
    /// The triangles of the input, for projection.
    pub mesh: TriMesh,
    /// The segments of each chain of lines, as triangles without area.
    pub chains: Vec<TriMesh>,
    /// The changes that made the input a manifold.
    pub warnings: Vec<String>,
}

pub(super) fn prepare(
    mesh: &PolyMesh,
    settings: &QuadSettings,
    job: &Job,
) -> Result<QuadInput, QuadError> {
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        return Err(QuadError::NotFinite);
    }
    let mut clean = mesh.clone();
    (clean.colours, clean.groups) = (None, None);
    let mut warnings = Vec::new();
    repair::weld(&mut clean, 0.0);
    repair::remove_degenerate(&mut clean);
    let (mut triangles, _) = clean.triangles();
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    let mut clean = triangles_of(clean.positions, &triangles);
    repair::drop_unused(&mut clean);
    job.check()?;
    let (bad, turned) = edge_faults(&clean);
    if bad > 0 {
        return Err(QuadError::NonManifold(bad));
    }
    if turned > 0 {
        let flipped = repair::orient(&mut clean);
        warnings.push(format!("{flipped} faces were turned to agree with their neighbours"));
        let (_, left) = edge_faults(&clean);
        if left > 0 {
            return Err(QuadError::OneSided(left));
        }
    }
    let (lo, hi) = clean
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let centre = lo / 2.0 + hi / 2.0;
    let size = (hi / 2.0 - lo / 2.0).max_element();
    if clean.face_count() == 0 || !(size > 0.0) || !(size < f64::MAX) {
        return Err(QuadError::Empty);
    }
    // Into a box of half side 1 first: areas of tiny and huge meshes do not fit.
    let mut positions: Vec<DVec3> = clean.positions.iter().map(|&p| (p - centre) / size).collect();
    let mut triangles: Vec<[u32; 3]> = clean.faces().map(|f| [f[0], f[1], f[2]]).collect();
    let split = split_fans(&mut positions, &mut triangles);
    if split > 0 {
        warnings.push(format!("{split} vertices where the surface only touches itself were split"));
    }
    let area: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            (b - a).cross(c - a).length() / 2.0
        })
        .sum();
    let side = (area / settings.quads as f64).sqrt();
    if !(side > 1e-6) {
        return Err(QuadError::Empty);
    }
    positions.iter_mut().for_each(|p| *p /= side);
    let mesh = TriMesh {
        positions: positions.iter().map(|p| p.as_vec3()).collect(),
        triangles: triangles.clone(),
        colours: None,
    };
    let mut surface = EditSurface::new(positions, triangles);
    creases::find_lines(&mut surface, settings.creases);
    let chains = creases::number_chains(&mut surface);
    let as_mesh = |segments: &Vec<[u32; 2]>| TriMesh {
        positions: segments
            .iter()
            .flat_map(|s| s.map(|v| surface.positions[v as usize].as_vec3()))
            .collect(),
        triangles: (0..segments.len() as u32).map(|k| [k * 2, k * 2 + 1, k * 2 + 1]).collect(),
        colours: None,
    };
    let chains = chains.iter().map(as_mesh).collect();
    Ok(QuadInput { surface, centre, unit: size * side, mesh, chains, warnings })
}

fn triangles_of(positions: Vec<DVec3>, triangles: &[[u32; 3]]) -> PolyMesh {
    PolyMesh {
        positions,
        face_starts: (0..=triangles.len() as u32).map(|i| i * 3).collect(),
        corners: triangles.iter().flatten().copied().collect(),
        ..PolyMesh::new()
    }
}

/// Edges of more than two faces, and edges that two faces pass in the same direction.
fn edge_faults(mesh: &PolyMesh) -> (usize, usize) {
    let edges = EdgeTable::of(mesh);
    let (mut bad, mut turned) = (0, 0);
    for halves in edges.each() {
        let first = |i: usize| mesh.corners[halves[i].corner as usize];
        match halves.len() {
            1 => {}
            2 => turned += usize::from(first(0) == first(1)),
            _ => bad += 1,
        }
    }
    (bad, turned)
}

/// Gives each fan of triangles at a vertex a separate vertex; returns the number of vertices added.
fn split_fans(positions: &mut Vec<DVec3>, triangles: &mut [[u32; 3]]) -> usize {
    let before = positions.len();
    let mut around = vec![Vec::new(); before];
    for (t, tri) in triangles.iter().enumerate() {
        tri.iter().for_each(|&v| around[v as usize].push(t as u32));
    }
    for (v, own) in around.iter().enumerate() {
        let v = v as u32;
        let mut left = own.clone();
        let mut first = true;
        while let Some(start) = left.pop() {
            let mut fan = vec![start];
            let mut at = 0;
            while at < fan.len() {
                let here = triangles[fan[at] as usize];
                left.retain(|&t| {
                    let meets = triangles[t as usize].iter().any(|w| *w != v && here.contains(w));
                    if meets {
                        fan.push(t);
                    }
                    !meets
                });
                at += 1;
            }
            if !first {
                let copy = positions.len() as u32;
                positions.push(positions[v as usize]);
                for &t in &fan {
                    triangles[t as usize].iter_mut().filter(|w| **w == v).for_each(|w| *w = copy);
                }
            }
            first = false;
        }
    }
    positions.len() - before
}
