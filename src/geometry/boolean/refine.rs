//! Smaller triangles along the cut of a result: a blend, a smoothing or a simulation needs them
//! where two surfaces meet, and the cut of two coarse solids leaves long ones there.
//!
//! The longest edge of a triangle is halved, and its neighbour's longest edge first if that is
//! longer (longest-edge propagation path: Rivara, "New longest-edge algorithms for the refinement
//! and/or improvement of unstructured triangulations", 1997). So no vertex is placed inside an
//! edge, no angle becomes less than half of its old value, and triangles grow gradually away from
//! the cut. The surface does not move: each new vertex is the middle of an edge.

use glam::DVec3;

use super::points::Map;
use super::{BooleanSolid, FaceOrigin, emit};
use crate::job::{Cancelled, Job};
use crate::{PolyMesh, triangulate};

/// What [`refine_cut`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CutRefinement {
    /// Triangles more than there were.
    pub added: usize,
    /// No triangle at the cut has a longer edge than was asked for.
    pub reached: bool,
}

/// Triangles beyond which no more are made, about 2 GiB.
const MOST: usize = 20_000_000;

/// Splits the triangles of `solid` at the cut, the edges between faces of A and faces of B, until
/// none with a corner on the cut has an edge longer than `edge` (in the operands' unit, above 0).
/// Interpolates colours along edges and keeps groups. Stops, and reports it, at 20 million
/// triangles or where an edge is too short to have a middle.
pub fn refine_cut(
    solid: &mut BooleanSolid,
    edge: f64,
    job: &Job,
) -> Result<CutRefinement, Cancelled> {
    let before = solid.mesh.face_count();
    let mut work = Refinement::of(solid);
    let mut reached = true;
    let mut waiting: Vec<u32> = (0..work.triangles.len() as u32).collect();
    let mut steps = 0usize;
    while let Some(t) = waiting.pop() {
        while work.at_cut(t) && work.length_squared(work.longest(t)) > edge * edge {
            steps += 1;
            if steps.is_multiple_of(4096) {
                job.check()?;
            }
            if work.triangles.len() >= MOST || !work.halve_before(t, &mut waiting) {
                reached = false;
                break;
            }
        }
    }
    if work.triangles.len() > before {
        work.put_into(solid);
        let facts = emit::facts(&solid.mesh, job)?;
        let known = solid.facts;
        solid.facts =
            super::BooleanFacts { closed: known.closed, manifold: known.manifold, ..facts };
    }
    Ok(CutRefinement { added: solid.mesh.face_count() - before, reached })
}

struct Refinement {
    at: Vec<DVec3>,
    colours: Option<Vec<[u8; 4]>>,
    triangles: Vec<[u32; 3]>,
    origins: Vec<FaceOrigin>,
    groups: Option<Vec<u32>>,
    /// The triangle that each directed edge belongs to.
    edges: Map<(u32, u32), u32>,
    /// True for each vertex on the cut.
    on_cut: Vec<bool>,
}

impl Refinement {
    fn of(solid: &BooleanSolid) -> Refinement {
        let mesh = &solid.mesh;
        let (mut triangles, mut face_of) = (Vec::new(), Vec::new());
        for (f, ring) in mesh.faces().enumerate() {
            match *ring {
                [a, b, c] => triangles.push([a, b, c]),
                _ => triangulate::face(&mesh.positions, ring, &mut triangles),
            }
            face_of.resize(triangles.len(), f);
        }
        let origins: Vec<FaceOrigin> = face_of.iter().map(|&f| solid.origins[f]).collect();
        let mut seen = vec![[false; 2]; mesh.positions.len()];
        let mut edges = Map::default();
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                edges.insert((a, b), t as u32);
                seen[a as usize][usize::from(origins[t].operand & 1)] = true;
            }
        }
        Refinement {
            at: mesh.positions.clone(),
            colours: mesh.colours.clone(),
            groups: mesh.groups.as_ref().map(|g| face_of.iter().map(|&f| g[f]).collect()),
            on_cut: seen.into_iter().map(|s| s == [true; 2]).collect(),
            triangles,
            origins,
            edges,
        }
    }

    fn put_into(self, solid: &mut BooleanSolid) {
        let mut mesh = PolyMesh { positions: self.at, ..PolyMesh::new() };
        mesh.face_starts.reserve(self.triangles.len());
        mesh.corners.reserve(self.triangles.len() * 3);
        self.triangles.iter().for_each(|t| mesh.push_face(t));
        (mesh.colours, mesh.groups) = (self.colours, self.groups);
        (solid.mesh, solid.origins) = (mesh, self.origins);
    }

    fn at_cut(&self, t: u32) -> bool {
        self.triangles[t as usize].iter().any(|&v| self.on_cut[v as usize])
    }

    fn length_squared(&self, (a, b): (u32, u32)) -> f64 {
        self.at[a as usize].distance_squared(self.at[b as usize])
    }

    /// The longest edge in the direction of the triangle. Of equals one and the same, whichever
    /// triangle is asked, so that a path from neighbour to neighbour ends.
    fn longest(&self, t: u32) -> (u32, u32) {
        let [a, b, c] = self.triangles[t as usize];
        let key = |&(a, b): &(u32, u32)| {
            // In one order of the ends: the same number from both sides.
            let (a, b) = (a.min(b), a.max(b));
            (self.length_squared((a, b)), a, b)
        };
        let later = |e: (u32, u32), f: (u32, u32)| {
            let (p, q) = (key(&e), key(&f));
            if p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))).is_ge() { e } else { f }
        };
        later(later((a, b), (b, c)), (c, a))
    }

    /// Halves the edge at the end of the path of ever longer edges from `t` on; false where that
    /// edge has no middle.
    fn halve_before(&mut self, t: u32, waiting: &mut Vec<u32>) -> bool {
        let mut t = t;
        loop {
            let (a, b) = self.longest(t);
            match self.edges.get(&(b, a)) {
                Some(&next) if self.longest(next) != (b, a) => t = next,
                _ => return self.halve((a, b), waiting),
            }
        }
    }

    fn halve(&mut self, (a, b): (u32, u32), waiting: &mut Vec<u32>) -> bool {
        let (p, q) = (self.at[a as usize], self.at[b as usize]);
        let middle = p + (q - p) * 0.5;
        if middle == p || middle == q || self.at.len() >= u32::MAX as usize {
            return false;
        }
        let m = self.at.len() as u32;
        self.at.push(middle);
        let sides = [(a, b), (b, a)].map(|e| self.edges.get(&e).copied());
        let operands = sides.map(|t| t.map(|t| self.origins[t as usize].operand));
        // The middle of an edge between A and B; any other edge only has its ends there.
        self.on_cut.push(matches!(operands, [Some(one), Some(other)] if one != other));
        if let Some(colours) = &mut self.colours {
            let (x, y) = (colours[a as usize], colours[b as usize]);
            colours.push([0, 1, 2, 3].map(|k| u8::midpoint(x[k], y[k])));
        }
        for ((a, b), t) in [(a, b), (b, a)].into_iter().zip(sides) {
            let Some(t) = t else { continue };
            let new = self.triangles.len() as u32;
            let own = self.triangles[t as usize];
            let c = own.into_iter().find(|v| *v != a && *v != b).unwrap_or(a);
            self.triangles[t as usize] = [a, m, c];
            self.triangles.push([m, b, c]);
            self.origins.push(self.origins[t as usize]);
            if let Some(groups) = &mut self.groups {
                groups.push(groups[t as usize]);
            }
            self.edges.remove(&(a, b));
            self.edges.extend([
                ((a, m), t),
                ((m, c), t),
                ((m, b), new),
                ((b, c), new),
                ((c, m), new),
            ]);
            // The triangle itself, where it was met on the way of another, has been or will be
            // looked at; with a new corner it may be at the cut only now.
            waiting.extend([t, new]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BooleanOptions, Operation, compute};
    use super::*;
    use crate::check;
    use crate::shapes::cuboid;

    #[test]
    fn triangles_at_the_cut_are_as_small_as_asked_and_the_solid_is_the_same() {
        let mut a = cuboid(DVec3::ZERO, DVec3::splat(10.0));
        a.groups = Some((0..a.face_count() as u32).collect());
        a.colours = Some(a.positions.iter().map(|p| [(p.x * 25.5) as u8, 0, 9, 255]).collect());
        let b = cuboid(DVec3::new(3.1, 3.3, -1.0), DVec3::new(6.7, 7.9, 11.0));
        let job = Job::default();
        let options = BooleanOptions::default();
        let (mut made, _) =
            compute([&a, &b], &[Operation::Difference], &options, &job, || 0.0).expect("a result");
        let whole = made[0].clone();
        let solid = &mut made[0];
        let told = refine_cut(solid, 0.5, &job).expect("not cancelled");
        assert!(told.reached && told.added > 500, "{told:?}");
        assert_eq!(told.added, solid.mesh.face_count() - whole.mesh.face_count());
        assert_eq!(solid.origins.len(), solid.mesh.face_count());
        let facts = check::report(&solid.mesh, true, &job).expect("a report");
        assert!(facts.closed && facts.manifold && facts.self_intersections == Some(0), "{facts:?}");
        assert_eq!(facts.genus, Some(1));
        assert!((solid.facts.volume - (1000.0 - 3.6 * 4.6 * 10.0)).abs() < 1e-9);
        assert!((solid.facts.area - whole.facts.area).abs() < 1e-9);
        let mut sides = vec![[false; 2]; solid.mesh.positions.len()];
        for (f, o) in solid.mesh.faces().zip(&solid.origins) {
            f.iter().for_each(|&v| sides[v as usize][usize::from(o.operand)] = true);
        }
        let (mut cut, mut farther) = (0, 0);
        for f in solid.mesh.faces() {
            let p = [f[0], f[1], f[2]].map(|v| solid.mesh.positions[v as usize]);
            let longest = p[0].distance(p[1]).max(p[1].distance(p[2])).max(p[2].distance(p[0]));
            if f.iter().any(|&v| sides[v as usize] == [true; 2]) {
                cut += 1;
                assert!(longest <= 0.5, "{longest}");
            } else {
                farther += usize::from(longest > 2.0);
            }
        }
        // Both rims, 2 * 16.4 long, and what lies far from them stays coarse.
        assert!(cut >= 2 * 2 * 33 && farther > 4, "{cut} {farther}");
        let (groups, colours) = (solid.mesh.groups.as_ref(), solid.mesh.colours.as_ref());
        let (groups, colours) = (groups.expect("groups"), colours.expect("colours"));
        assert_eq!((groups.len(), colours.len()), (solid.origins.len(), sides.len()));
        for (f, o) in solid.origins.iter().enumerate().filter(|(_, o)| o.operand == 0) {
            assert_eq!(groups[f], o.face);
            for &v in solid.mesh.face(f) {
                let (x, c) = (solid.mesh.positions[v as usize].x, colours[v as usize]);
                assert!((f64::from(c[0]) - x * 25.5).abs() <= 4.0, "{x}: {c:?}");
            }
        }

        // Nothing to do: the faces stay as they are.
        let mut coarse = whole;
        let told = refine_cut(&mut coarse, 100.0, &job).expect("not cancelled");
        assert!(told.reached);
    }
}
