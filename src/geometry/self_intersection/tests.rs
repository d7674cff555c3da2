//! Crossings against an oracle in whole numbers: tetrahedra and boxes with corners in a small
//! lattice, where nearly every case is a special one.

use glam::{DVec3, I64Vec3};

use super::*;
use crate::shapes;

type Flat = (Vec<I64Vec3>, Vec<[u32; 3]>);

/// A generator that is the same everywhere (Steele, Lea and Flood's SplitMix, 2014).
struct SplitMix(u64);

impl SplitMix {
    fn below(&mut self, n: u64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n) as i64
    }

    fn point(&mut self, n: u64) -> I64Vec3 {
        I64Vec3::new(self.below(n), self.below(n), self.below(n))
    }
}

fn tetrahedron(p: [I64Vec3; 4]) -> Option<Flat> {
    let six = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let turned = |f: [u32; 3]| if six > 0 { f } else { [f[0], f[2], f[1]] };
    (six != 0).then(|| (p.to_vec(), faces.map(turned).to_vec()))
}

fn cuboid(a: I64Vec3, b: I64Vec3) -> Option<Flat> {
    let (lo, hi) = (a.min(b), a.max(b));
    let at = (0..8).map(|k| {
        let pick = |bit: i32, l: i64, h: i64| if k >> bit & 1 == 1 { h } else { l };
        I64Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z))
    });
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces =
        quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    (hi - lo).cmpgt(I64Vec3::ZERO).all().then(|| (at.collect(), faces))
}

/// Outward normal and offset of each face.
fn planes((at, faces): &Flat) -> Vec<(I64Vec3, i64)> {
    faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| at[v as usize]);
            let n = (b - a).cross(c - a);
            (n, n.dot(a))
        })
        .collect()
}

fn edges((at, faces): &Flat) -> Vec<I64Vec3> {
    faces
        .iter()
        .flat_map(|f| [(0, 1), (1, 2), (2, 0)].map(|(i, j)| at[f[j] as usize] - at[f[i] as usize]))
        .collect()
}

/// Returns true if two convex solids have inner points in common: no direction separates them.
fn overlap_inside(a: &Flat, b: &Flat) -> bool {
    let mut ways: Vec<I64Vec3> = planes(a).iter().chain(&planes(b)).map(|p| p.0).collect();
    for e in edges(a) {
        ways.extend(edges(b).iter().map(|&f| e.cross(f)));
    }
    ways.iter().filter(|n| **n != I64Vec3::ZERO).all(|n| {
        let range = |s: &Flat| {
            s.0.iter()
                .map(|p| p.dot(*n))
                .fold((i64::MAX, i64::MIN), |(l, h), d| (l.min(d), h.max(d)))
        };
        let ((al, ah), (bl, bh)) = (range(a), range(b));
        al < bh && bl < ah
    })
}

fn within(a: &Flat, b: &Flat) -> bool {
    let planes = planes(b);
    a.0.iter().all(|p| planes.iter().all(|&(n, d)| n.dot(*p) <= d))
}

/// Returns true if faces of both are coplanar and have an area in common.
fn faces_overlap(a: &Flat, b: &Flat) -> bool {
    let corners = |s: &Flat, f: usize| s.1[f].map(|v| s.0[v as usize]);
    (0..a.1.len()).any(|i| {
        (0..b.1.len()).any(|j| {
            let (s, t) = (corners(a, i), corners(b, j));
            let n = (s[1] - s[0]).cross(s[2] - s[0]);
            let one = t.iter().all(|p| n.dot(*p - s[0]) == 0);
            // Lines of the edges, each looking away from its triangle.
            let parts = |s: [I64Vec3; 3], t: [I64Vec3; 3]| {
                let n = (s[1] - s[0]).cross(s[2] - s[0]);
                (0..3).any(|k| {
                    let out = (s[(k + 1) % 3] - s[k]).cross(n);
                    t.iter().all(|p| out.dot(*p - s[k]) >= 0)
                })
            };
            one && !parts(s, t) && !parts(t, s)
        })
    })
}

/// Returns true if the surfaces of two convex solids cross or coincide in part.
fn expected(a: &Flat, b: &Flat) -> bool {
    faces_overlap(a, b) || overlap_inside(a, b) && !within(a, b) && !within(b, a)
}

fn counted(a: &Flat, b: &Flat) -> usize {
    let at: Vec<DVec3> = a.0.iter().chain(&b.0).map(|p| p.as_dvec3()).collect();
    let base = a.0.len() as u32;
    let faces: Vec<[u32; 3]> =
        a.1.iter().copied().chain(b.1.iter().map(|f| f.map(|v| v + base))).collect();
    pairs(&at, &faces, &Job::default()).expect("not cancelled").len()
}

#[test]
fn solids_in_a_small_lattice_cross_where_whole_numbers_say_so() {
    let mut mix = SplitMix(7);
    let (mut crossed, mut special) = (0, 0);
    let cases = if std::env::var_os("SCULPTD_LONG").is_some() { 2_000_000 } else { 20_000 };
    for case in 0..cases {
        let n = 3 + case % 4;
        let mut solid = |boxes: bool| loop {
            let made = if boxes {
                cuboid(mix.point(n), mix.point(n))
            } else {
                tetrahedron([mix.point(n), mix.point(n), mix.point(n), mix.point(n)])
            };
            if let Some(made) = made {
                return made;
            }
        };
        let (a, b) = (solid(case % 3 == 0), solid(case % 5 == 0));
        let (want, got) = (expected(&a, &b), counted(&a, &b));
        assert_eq!(got > 0, want, "case {case}: {a:?} {b:?}: {got} pairs");
        crossed += usize::from(want);
        special += usize::from(want && !faces_overlap(&a, &b));
    }
    assert!(crossed > 1000 && special > 1000, "{crossed} {special}");
}

#[test]
fn two_boxes_that_cross_only_along_edges_and_diagonals() {
    let solid = |a: [i64; 3], b: [i64; 3]| cuboid(a.into(), b.into()).expect("a box");
    let first = solid([0; 3], [4; 3]);
    assert!(counted(&first, &solid([2; 3], [6; 3])) > 0);
    // Beams through each other, their diagonals crossing.
    assert!(counted(&solid([0, 1, 1], [4, 3, 3]), &solid([1, 0, 1], [3, 4, 3])) > 0);
    // An edge on an edge, and a corner on a corner, from outside.
    assert_eq!(counted(&first, &solid([4, 4, 0], [6, 6, 4])), 0);
    assert_eq!(counted(&first, &solid([4; 3], [6; 3])), 0);
    // One in the other, an edge of it on a face: touching from inside.
    let wedge = tetrahedron([[0, 1, 1], [0, 3, 3], [2, 1, 3], [2, 3, 1]].map(I64Vec3::from))
        .expect("a solid");
    assert_eq!(counted(&first, &wedge), 0);
}

/// A strip of two faces with a bend along the x axis.
fn bend(a: [f64; 2], b: [f64; 2], from: f64, to: f64) -> ([DVec3; 4], [[u32; 3]; 2]) {
    let at = |[y, z]: [f64; 2]| DVec3::new((from + to) * 0.5, y, z);
    ([DVec3::new(from, 0., 0.), DVec3::new(to, 0., 0.), at(a), at(b)], [[0, 1, 2], [1, 0, 3]])
}

#[test]
fn faces_around_one_line_cross_where_they_come_in_turns() {
    let (n, e, s, w) = ([0., 1.], [1., 0.], [0., -1.], [-1., 0.]);
    let ne = [1., 1.];
    for (first, second, crosses) in [
        ([n, s], [e, w], true),
        ([n, e], [s, w], false),
        ([n, e], [w, s], false),
        ([n, e], [ne, w], true),
        ([e, n], [ne, s], true),
        ([n, s], [e, ne], false),
        ([n, w], [ne, e], false),
    ] {
        for (from, to) in [(0., 1.), (0.25, 2.), (-1., 0.5)] {
            let (a, faces) = bend(first[0], first[1], 0., 1.);
            let (b, more) = bend(second[0], second[1], from, to);
            let at: Vec<DVec3> = a.into_iter().chain(b).collect();
            let faces: Vec<[u32; 3]> =
                faces.into_iter().chain(more.map(|f| f.map(|v| v + 4))).collect();
            let got = pairs(&at, &faces, &Job::default()).expect("not cancelled").len();
            assert_eq!(got > 0, crosses, "{first:?} {second:?} {from}..{to}: {got}");
        }
    }
}

#[test]
fn thousands_of_faces_at_one_edge_are_sorted_around_it() {
    // A fan of 8,000 faces around the z axis; then three that repeat a direction of it.
    let fan = 8000;
    let mut positions = vec![DVec3::ZERO, DVec3::Z];
    positions.extend((0..fan).map(|i| {
        let (s, c) = (i as f64 * std::f64::consts::TAU / fan as f64).sin_cos();
        DVec3::new(c, s, 0.5)
    }));
    let mut triangles: Vec<[u32; 3]> = (0..fan).map(|i| [0, 1, i + 2]).collect();
    let job = Job::default();
    assert_eq!(pairs(&positions, &triangles, &job).unwrap(), []);
    for i in [0usize, 2345, 7999] {
        positions.push(positions[i + 2] * 0.5 + DVec3::Z * 0.1);
        triangles.push([1, 0, positions.len() as u32 - 1]);
    }
    let found = pairs(&positions, &triangles, &job).unwrap();
    // Halves and sums of coordinates are exact, and so is the test for four coplanar points.
    assert!(found.contains(&(0, 8000)), "{found:?}");
    assert!(found.iter().all(|&(a, b)| [0, 2345, 7999].contains(&a) && b >= 8000), "{found:?}");
}

#[test]
fn ribs_along_a_diagonal_are_compared_in_their_own_frame() {
    let mut random = SplitMix(5);
    let mut place = |size: f64| {
        let p = random.point(1 << 20);
        DVec3::new(p.x as f64, p.y as f64, p.z as f64) * (size / f64::from(1 << 20))
    };
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..300 {
        let along = DVec3::new(20.0, 31.0, -17.0) + place(1.0);
        let start = place(3.0);
        positions.extend([start, start + along, start + along * 0.4 + place(1.0)]);
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    assert!(tight_frame(&positions, &triangles).is_some());
    let found = pairs(&positions, &triangles, &Job::default()).expect("not cancelled");
    let mut want = Vec::new();
    for t in 0..triangles.len() {
        for u in t + 1..triangles.len() {
            if crosses(&positions, triangles[t], triangles[u]) {
                want.push((t as u32, u as u32));
            }
        }
    }
    assert!(want.len() > 20);
    assert_eq!(found, want);
}

/// All pairs, each two triangles compared.
fn reference(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let (mut found, mut uses) = (Found::default(), Vec::new());
    for t in 0..triangles.len() as u32 {
        (0..t).for_each(|u| compare(positions, triangles, u, t, &mut found));
        let [a, b, c] = triangles[t as usize];
        if a != b && b != c && c != a {
            uses.extend([(a, b), (b, c), (c, a)].map(|(a, b)| ((a.min(b), a.max(b)), t)));
        }
    }
    let mut out = found.0;
    through(positions, triangles, found.1, |_| true, &mut out);
    uses.sort_unstable();
    for edge in uses.chunk_by(|x, y| x.0 == y.0).filter(|e| e.len() > 1) {
        let around: Vec<u32> = edge.iter().map(|e| e.1).collect();
        along_shared_edge(positions, triangles, edge[0].0, &around, &mut out);
    }
    out.sort_unstable();
    out.dedup();
    out
}

#[test]
fn folded_surfaces_cross_as_each_two_of_their_triangles_do() {
    let mut mix = SplitMix(11);
    let (mut some, mut clean) = (0, 0);
    for case in 0..60u64 {
        let mut mesh = match case % 3 {
            0 => shapes::icosphere(8.0, 5).to_poly(),
            1 => shapes::torus(8.0, 3.0, 14, 9),
            _ => shapes::cuboid(DVec3::ZERO, DVec3::splat(8.0)),
        };
        if case % 2 == 0 {
            // In a lattice, where nearly every case is a special one.
            mesh.positions.iter_mut().for_each(|p| *p = p.round());
        }
        for _ in 0..case / 6 {
            let v = mix.below(mesh.positions.len() as u64) as usize;
            let by = mix.point(9) - 4;
            mesh.positions[v] += by.as_dvec3() * if case % 4 < 2 { 0.25 } else { 1.0 };
        }
        let (triangles, _) = mesh.triangles();
        let job = Job::default();
        let found = pairs(&mesh.positions, &triangles, &job).expect("not cancelled");
        assert_eq!(found, reference(&mesh.positions, &triangles), "case {case}");
        some += usize::from(!found.is_empty());
        clean += usize::from(found.is_empty());
        // A few of the triangles, a third of them, and all.
        for share in [40, 5, 3, 1] {
            let mut changed: Vec<u32> = (0..triangles.len() as u32).collect();
            changed.retain(|_| mix.below(share) == 0);
            let mut want = found.clone();
            let counts = |t: &u32| changed.binary_search(t).is_ok();
            want.retain(|(t, u)| counts(t) || counts(u));
            let got = pairs_with(&mesh.positions, &triangles, &changed, &job);
            assert_eq!(got.expect("not cancelled"), want, "case {case}, one of {share}");
        }
    }
    assert!(some > 10 && clean > 5, "{some} {clean}");
}
