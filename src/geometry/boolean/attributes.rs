//! What faces carry besides their shape, from the operands to a result: colours by place within the
//! face of origin, groups by face.

use std::sync::Arc;

use glam::DVec3;

use super::BooleanSolid;
use super::emit::FaceOrigin;
use crate::{FaceAttributes, GroupName, PolyMesh, triangulate};

/// Returns the names of the groups, with B's numbers after A's; `None` if neither operand names
/// any.
fn names(operands: [&PolyMesh; 2], first: u32) -> Option<Arc<FaceAttributes>> {
    let own = operands.map(|m| m.attributes.as_deref().filter(|a| !a.groups.is_empty()));
    if own.iter().all(|a| a.is_none()) {
        return None;
    }
    let mut all = FaceAttributes::default();
    for attributes in own.into_iter().enumerate() {
        let (operand, Some(attributes)) = attributes else { continue };
        all.groups.resize(if operand == 0 { 0 } else { first as usize }, GroupName::default());
        all.groups.extend_from_slice(&attributes.groups);
        all.libraries.extend_from_slice(&attributes.libraries);
    }
    all.libraries.dedup();
    Some(Arc::new(all))
}

/// Gives a result its colours and groups where an operand has some. Vertices of an operand without
/// colours are white; B's groups are counted on from A's, so that no two become one.
pub fn carry(mesh: &mut PolyMesh, origins: &[FaceOrigin], operands: [&PolyMesh; 2]) {
    let first = operands[0].groups.as_ref().map_or(1, |g| g.iter().max().map_or(0, |m| m + 1));
    carry_from(mesh, origins, operands, first);
}

/// As [`carry`], with the number of B's group 0 in the result.
pub fn carry_from(
    mesh: &mut PolyMesh,
    origins: &[FaceOrigin],
    operands: [&PolyMesh; 2],
    first: u32,
) {
    if operands.iter().any(|m| m.groups.is_some()) {
        let group = |o: &FaceOrigin| {
            let own = operands[o.operand as usize].groups.as_ref();
            let own = own.and_then(|g| g.get(o.face as usize)).copied().unwrap_or(0);
            if o.operand == 0 { own } else { first + own }
        };
        mesh.groups = Some(origins.iter().map(group).collect());
        mesh.attributes = names(operands, first);
    }
    if operands.iter().any(|m| m.colours.is_some()) {
        let mut colours: Vec<Option<[u8; 4]>> = vec![None; mesh.positions.len()];
        // A's faces speak first where both meet.
        for operand in 0..2 {
            let source = operands[operand as usize];
            for (f, _) in origins.iter().enumerate().filter(|(_, o)| o.operand == operand) {
                for &v in mesh.face(f) {
                    let place = mesh.positions[v as usize];
                    let slot = &mut colours[v as usize];
                    if slot.is_none() {
                        *slot = Some(colour(source, origins[f].face as usize, place));
                    }
                }
            }
        }
        mesh.colours = Some(colours.into_iter().map(|c| c.unwrap_or([255; 4])).collect());
    }
}

/// A number for each vertex of a result from one for each vertex of A, such as a mask: mixed by
/// place within the face that it came from; 0 where it came from B alone.
pub fn mixed(solid: &BooleanSolid, a: &PolyMesh, values: &[f32]) -> Vec<f32> {
    let mut out: Vec<Option<f32>> = vec![None; solid.mesh.positions.len()];
    for (f, o) in solid.origins.iter().enumerate().filter(|(_, o)| o.operand == 0) {
        for &v in solid.mesh.face(f) {
            let slot = &mut out[v as usize];
            if slot.is_none() {
                let shares = shares(a, o.face as usize, solid.mesh.positions[v as usize]);
                let sum =
                    shares.iter().map(|&(v, w)| f64::from(values[v as usize]) * w).sum::<f64>();
                *slot = Some(sum as f32);
            }
        }
    }
    out.into_iter().map(Option::unwrap_or_default).collect()
}

/// The colour of a face at a place in it.
fn colour(mesh: &PolyMesh, face: usize, place: DVec3) -> [u8; 4] {
    let Some(colours) = &mesh.colours else { return [255; 4] };
    let shares = shares(mesh, face, place);
    [0, 1, 2, 3].map(|k| {
        shares.iter().map(|&(v, w)| f64::from(colours[v as usize][k]) * w).sum::<f64>().round()
            as u8
    })
}

/// The corners of a face, and their weights at a place in it.
fn shares(mesh: &PolyMesh, face: usize, place: DVec3) -> [(u32, f64); 3] {
    let corners = mesh.face(face);
    let first = corners.first().copied().unwrap_or(0);
    if let Some(&v) = corners.iter().find(|&&v| mesh.positions[v as usize] == place) {
        return [(v, 1.0), (v, 0.0), (v, 0.0)];
    }
    let mut parts = Vec::new();
    match *corners {
        [a, b, c] => parts.push([a, b, c]),
        _ => triangulate::face(&mesh.positions, corners, &mut parts),
    }
    // The triangle that the place is in, or the one that it is least beside.
    let mut best: Option<(f64, [u32; 3], [f64; 3])> = None;
    for t in parts {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let n = (b - a).cross(c - a);
        let whole = n.length_squared();
        if whole == 0.0 {
            continue;
        }
        let share = |x: DVec3, y: DVec3| (y - x).cross(place - x).dot(n) / whole;
        let w = [share(b, c), share(c, a), share(a, b)];
        let least = w[0].min(w[1]).min(w[2]);
        if best.is_none_or(|b| least > b.0) {
            best = Some((least, t, w));
        }
    }
    let Some((_, t, w)) = best else { return [(first, 1.0), (first, 0.0), (first, 0.0)] };
    let w = w.map(|x| x.max(0.0));
    let sum: f64 = w.iter().sum();
    [0, 1, 2].map(|k| (t[k], w[k] / sum))
}

#[cfg(test)]
mod tests {
    use super::super::{BooleanOptions, Operation, compute};
    use super::*;
    use crate::job::Job;
    use crate::shapes::cuboid;

    #[test]
    fn colours_and_groups_come_from_where_a_face_came_from() {
        let mut a = cuboid(DVec3::ZERO, DVec3::splat(2.0));
        // Black at x = 0, red at x = 2.
        let red = |p: &DVec3| [(p.x * 127.5) as u8, 0, 0, 255];
        a.colours = Some(a.positions.iter().map(red).collect());
        a.groups = Some((0..a.face_count() as u32).collect());
        let mut b = cuboid(DVec3::splat(1.0), DVec3::splat(3.0));
        b.groups = Some(vec![2; b.face_count()]);
        let (solids, _) =
            compute([&a, &b], &Operation::ALL, &BooleanOptions::default(), &Job::default(), || 0.0)
                .expect("a result");
        for s in &solids {
            let (colours, groups) =
                (s.mesh.colours.as_ref().expect("some"), s.mesh.groups.as_ref().expect("some"));
            assert_eq!(
                (colours.len(), groups.len()),
                (s.mesh.positions.len(), s.mesh.face_count())
            );
            for (f, o) in s.origins.iter().enumerate() {
                assert_eq!(groups[f], if o.operand == 0 { o.face } else { 8 });
                for &v in s.mesh.face(f) {
                    let (p, c) = (s.mesh.positions[v as usize], colours[v as usize]);
                    let of_a = s
                        .origins
                        .iter()
                        .enumerate()
                        .any(|(g, o)| o.operand == 0 && s.mesh.face(g).contains(&v));
                    if of_a {
                        assert!(
                            (f64::from(c[0]) - p.x * 127.5).abs() <= 1.0 && c[1] == 0,
                            "{p}: {c:?}"
                        );
                    } else {
                        assert_eq!(c, [255; 4], "{p}");
                    }
                }
            }
        }
    }
}
