//! A solid cut by a plane, and a surface in its shells.

use glam::DVec3;

use super::{BooleanError, BooleanOptions, BooleanReport, BooleanSolid, Operation, compute};
use crate::PolyMesh;
use crate::boolean::box_tree::Span;
use crate::disjoint_sets::DisjointSets;
use crate::job::Job;

/// The solid above the plane `normal . p = offset` and the solid below it, both closed by the cut;
/// where the solid is on one side, the other is empty. Faces of the cut have the origin B. Phases
/// by `now`, as in [`compute`].
///
/// # Errors
/// As [`compute`]; [`BooleanError::NotFinite`] for a normal without a direction.
pub fn split(
    mesh: &PolyMesh,
    normal: DVec3,
    offset: f64,
    options: &BooleanOptions,
    job: &Job,
    now: impl Fn() -> f64,
) -> Result<([BooleanSolid; 2], BooleanReport), BooleanError> {
    let plane = BooleanError::NotFinite { operand: "the plane" };
    let length = normal.length();
    if !(length > 0.0 && length.is_finite() && offset.is_finite()) {
        return Err(plane);
    }
    let below = block(mesh, normal / length, offset / length);
    let operations = [Operation::Difference, Operation::Intersection];
    let (solids, report) = compute([mesh, &below], &operations, options, job, now)?;
    let solids = <[BooleanSolid; 2]>::try_from(solids).map_err(|_| plane)?;
    Ok((solids, report))
}

/// Returns a block below the plane that encloses the whole mesh.
fn block(mesh: &PolyMesh, n: DVec3, offset: f64) -> PolyMesh {
    let span = Span::of(mesh.positions.iter().copied());
    let (middle, size) =
        ((span.lo + span.hi) * 0.5, (span.hi - span.lo).length().max(f64::MIN_POSITIVE));
    let top = n.dot(middle) - offset;
    let (x, y) = n.any_orthonormal_pair();
    // From the plane down to below all, however far above the solid the plane is.
    let deep = size + top.abs();
    let mut out = crate::shapes::cuboid(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 0.0));
    let foot = middle - n * top;
    for p in &mut out.positions {
        *p = foot + (x * p.x + y * p.y) * size + n * (p.z * deep);
    }
    out
}

/// Returns each connected shell as a separate mesh with its colours and groups, in the order of
/// their first faces.
pub fn shells(mesh: &PolyMesh) -> Vec<PolyMesh> {
    shells_of_faces(mesh).into_iter().map(|shell| shell.0).collect()
}

/// As [`shells`], with the face of `mesh` that each face is.
pub(super) fn shells_of_faces(mesh: &PolyMesh) -> Vec<(PolyMesh, Vec<u32>)> {
    let mut sets = DisjointSets::new(mesh.positions.len());
    for f in mesh.faces() {
        f.windows(2).for_each(|w| sets.join(w[0], w[1]));
    }
    let mut number = vec![u32::MAX; mesh.positions.len()];
    let mut names = vec![u32::MAX; mesh.positions.len()];
    let mut out: Vec<(PolyMesh, Vec<u32>)> = Vec::new();
    for (f, corners) in mesh.faces().enumerate() {
        let Some(&first) = corners.first() else { continue };
        let root = sets.root(first) as usize;
        if number[root] == u32::MAX {
            number[root] = out.len() as u32;
            let mut shell = PolyMesh::new();
            shell.colours = mesh.colours.as_ref().map(|_| Vec::new());
            shell.groups = mesh.groups.as_ref().map(|_| Vec::new());
            out.push((shell, Vec::new()));
        }
        let (shell, faces) = &mut out[number[root] as usize];
        faces.push(f as u32);
        let ring: Vec<u32> = corners
            .iter()
            .map(|&v| {
                if names[v as usize] == u32::MAX {
                    names[v as usize] = shell.positions.len() as u32;
                    shell.positions.push(mesh.positions[v as usize]);
                    if let (Some(to), Some(from)) = (&mut shell.colours, &mesh.colours) {
                        to.push(from[v as usize]);
                    }
                }
                names[v as usize]
            })
            .collect();
        shell.push_face(&ring);
        if let (Some(to), Some(from)) = (&mut shell.groups, &mesh.groups) {
            to.push(from[f]);
        }
    }
    out
}

/// Comparisons of boxes after which shells count as near each other.
const MOST_BOXES: usize = 1 << 20;

/// Returns true if the boxes of two shells meet: only then can shells touch or cross each other.
/// Costs less than a tenth of a Boolean.
pub(super) fn shells_may_meet(mesh: &PolyMesh) -> bool {
    let mut sets = DisjointSets::new(mesh.positions.len());
    for f in mesh.faces() {
        f.windows(2).for_each(|w| sets.join(w[0], w[1]));
    }
    let mut number = vec![u32::MAX; mesh.positions.len()];
    let mut boxes: Vec<Span> = Vec::new();
    for f in mesh.faces() {
        let Some(&first) = f.first() else { continue };
        let root = sets.root(first) as usize;
        if number[root] == u32::MAX {
            number[root] = boxes.len() as u32;
            boxes.push(Span::EMPTY);
        }
        let own = &mut boxes[number[root] as usize];
        *own = Span::join(*own, Span::of(f.iter().map(|&v| mesh.positions[v as usize])));
    }
    boxes.sort_by(|a, b| a.lo.x.total_cmp(&b.lo.x));
    let mut looked = 0;
    for (i, a) in boxes.iter().enumerate() {
        for b in boxes[i + 1..].iter().take_while(|b| b.lo.x <= a.hi.x) {
            looked += 1;
            if a.meets(b) || looked > MOST_BOXES {
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, icosphere};

    #[test]
    fn a_ball_in_two_by_a_plane() {
        let ball = icosphere(1.0, 10).to_poly();
        let whole = super::super::emit::measure(&ball).0;
        let n = DVec3::new(0.3, -0.5, 0.8);
        for offset in [-0.4, 0.0, 0.25] {
            let ([above, below], report) =
                split(&ball, n, offset, &BooleanOptions::default(), &Job::default(), || 0.0)
                    .expect("two parts");
            assert!((above.facts.volume + below.facts.volume - whole).abs() < 1e-12 * whole);
            assert!(above.facts.volume > 0.0 && below.facts.volume > 0.0);
            assert!(above.mesh.positions.iter().all(|p| p.dot(n) >= offset - 1e-9));
            assert!(below.mesh.positions.iter().all(|p| p.dot(n) <= offset + 1e-9));
            // One closed curve, and one face that closes each part.
            assert_eq!(report.cut.len(), 1);
            assert_eq!(report.cut[0].first(), report.cut[0].last());
            assert_eq!(above.origins.iter().filter(|o| o.operand == 1).count(), 1);
        }
        let far = split(&ball, DVec3::Z, 9.0, &BooleanOptions::default(), &Job::default(), || 0.0);
        let ([above, below], _) = far.expect("two parts");
        assert_eq!((above.mesh.face_count(), below.mesh.face_count()), (0, ball.face_count()));
        assert!(
            split(&ball, DVec3::ZERO, 0.0, &BooleanOptions::default(), &Job::default(), || 0.0)
                .is_err()
        );
    }

    #[test]
    fn two_cubes_in_one_mesh_are_two_shells() {
        let mut both = cuboid(DVec3::ZERO, DVec3::ONE);
        let other = cuboid(DVec3::splat(2.0), DVec3::splat(3.0));
        let base = both.positions.len() as u32;
        both.positions.extend(&other.positions);
        other.faces().for_each(|f| both.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
        both.groups = Some((0..12).collect());
        let made = shells(&both);
        assert_eq!(made.len(), 2);
        assert_eq!((made[1].positions.len(), made[1].face_count()), (8, 6));
        assert_eq!(made[1].groups.as_deref(), Some(&[6, 7, 8, 9, 10, 11][..]));
        // The vertices are numbered as the faces name them.
        let corners = |mesh: &PolyMesh| -> Vec<Vec<DVec3>> {
            mesh.faces().map(|f| f.iter().map(|&v| mesh.positions[v as usize]).collect()).collect()
        };
        assert_eq!(corners(&made[1]), corners(&other));
    }
}
