//! Random parts of which the least wall is known by formula, and what the search says of them.

use glam::{DQuat, DVec2, DVec3};

use super::least::Comparison;
use super::refine::refine;
use super::{Thickness, ThicknessMethod, ThicknessSettings, WallQuery, measure_at_places};
use crate::distance::DistanceSolid;
use crate::job::Job;
use crate::remesh::{RemeshSettings, remesh};
use crate::shapes::uv_sphere;
use crate::{CentredMesh, PolyMesh, TriMesh};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

/// A part, its least wall, and its name.
struct KnownPart {
    name: &'static str,
    mesh: PolyMesh,
    wall: f64,
}

fn poly(positions: Vec<DVec3>, faces: &[Vec<u32>]) -> PolyMesh {
    let mut mesh = PolyMesh { positions, ..PolyMesh::new() };
    for f in faces {
        mesh.corners.extend(f);
        mesh.face_starts.push(mesh.corners.len() as u32);
    }
    mesh
}

/// A profile in x and z, counter-clockwise seen from -y, drawn out along y.
pub(super) fn drawn_out(profile: &[[f64; 2]], length: f64) -> PolyMesh {
    let n = profile.len() as u32;
    let at = |y: f64| profile.iter().map(move |p| DVec3::new(p[0], y, p[1]));
    let positions = at(0.0).chain(at(length)).collect();
    let mut faces = vec![(0..n).collect(), (n..2 * n).rev().collect()];
    faces.extend((0..n).map(|i| vec![i, i + n, (i + 1) % n + n, (i + 1) % n]));
    poly(positions, &faces)
}

/// A section in radius and z, counter-clockwise, that does not reach the axis, turned around it.
fn turned(section: &[[f64; 2]], around: u32) -> PolyMesh {
    let n = section.len() as u32;
    let mut positions = Vec::new();
    for s in 0..around {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(s) / f64::from(around)).sin_cos();
        positions.extend(section.iter().map(|p| DVec3::new(p[0] * cos, p[0] * sin, p[1])));
    }
    let at = |s: u32, i: u32| (s % around) * n + i % n;
    let mut faces = Vec::new();
    for s in 0..around {
        for i in 0..n {
            faces.push(vec![at(s, i), at(s + 1, i), at(s + 1, i + 1), at(s, i + 1)]);
        }
    }
    poly(positions, &faces)
}

fn flipped(mut mesh: PolyMesh) -> PolyMesh {
    let starts = mesh.face_starts.clone();
    for w in starts.windows(2) {
        mesh.corners[w[0] as usize..w[1] as usize].reverse();
    }
    mesh
}

fn joined(mut a: PolyMesh, b: &PolyMesh) -> PolyMesh {
    let (first, corners) = (a.positions.len() as u32, a.corners.len() as u32);
    a.positions.extend(&b.positions);
    a.corners.extend(b.corners.iter().map(|v| v + first));
    a.face_starts.extend(b.face_starts[1..].iter().map(|s| s + corners));
    a
}

/// One of eight kinds, of random size.
fn part(kind: u64, r: &mut Random) -> KnownPart {
    let wall = r.between(0.4, 3.0);
    let around = 8 + r.below(40) as u32;
    // Facets stand off the axis by this share of the radius.
    let flat = (std::f64::consts::PI / f64::from(around)).cos();
    match kind {
        0 => {
            // A round plate with a counterbore, whose ledge is `wall` thick and may be narrow.
            let (hole, height) = (r.between(1.0, 3.0), wall * r.between(2.5, 6.0));
            let (bore, rim) = (hole + r.between(0.05, 4.0), hole + 8.0 + wall * 8.0);
            let section = [
                [hole, 0.0],
                [rim * 1.5, 0.0],
                [rim * 1.5, height],
                [bore, height],
                [bore, wall],
                [hole, wall],
            ];
            KnownPart { name: "counterbore", mesh: turned(&section, around), wall }
        }
        1 => {
            let (base, height, long) = (wall * 2.0, wall * r.between(3.0, 9.0), wall * 12.0);
            let x = wall * r.between(4.0, 6.0);
            let profile = [
                [0.0, 0.0],
                [wall * 14.0, 0.0],
                [wall * 14.0, base],
                [x + wall, base],
                [x + wall, base + height],
                [x, base + height],
                [x, base],
                [0.0, base],
            ];
            KnownPart { name: "rib", mesh: drawn_out(&profile, long), wall }
        }
        2 => {
            // A wedge that ends in a land: from the base straight up at its thin end.
            let angle = r.between(2.0, 38.0).to_radians();
            let long = wall * r.between(4.0, 20.0);
            let profile = [[0.0, 0.0], [long, 0.0], [long, wall + long * angle.tan()], [0.0, wall]];
            KnownPart { name: "wedge", mesh: drawn_out(&profile, wall * 15.0), wall }
        }
        3 => {
            let inner = wall * r.between(3.0, 10.0);
            let (outer, long) = (inner + wall / flat, wall * r.between(4.0, 30.0));
            let section = [[inner, 0.0], [outer, 0.0], [outer, long], [inner, long]];
            KnownPart { name: "pipe", mesh: turned(&section, around), wall }
        }
        4 => {
            let (rings, inner) = (6 + r.below(12) as u32, wall * r.between(3.0, 8.0));
            let outer = uv_sphere(inner + wall, rings, around);
            let inner = flipped(uv_sphere(inner, rings, around));
            let ball = uv_sphere(1.0, rings, around).triangulate().0;
            let plane = |t: usize| {
                let [a, b, c] = ball.corners(t).map(|p| p.as_dvec3());
                (b - a).cross(c - a).normalize().dot(a)
            };
            let share = (0..ball.triangles.len()).map(plane).fold(1.0, f64::min);
            KnownPart { name: "shell", mesh: joined(outer, &inner), wall: wall * share }
        }
        5 => {
            // A plate with a boss of another height.
            let boss = wall * r.between(2.0, 4.0);
            let hole = wall * r.between(1.0, 3.0);
            let section = [
                [hole, 0.0],
                [hole + wall * 12.0, 0.0],
                [hole + wall * 12.0, wall],
                [hole + wall * 3.0, wall],
                [hole + wall * 3.0, wall + boss],
                [hole, wall + boss],
            ];
            KnownPart { name: "boss", mesh: turned(&section, around), wall }
        }
        6 => {
            // A groove with flanks of 45 degrees or steeper leaves `wall` below it.
            let (top, half) = (wall * r.between(3.0, 5.0), wall * r.between(0.5, 1.5));
            let x = wall * 10.0;
            let profile = [
                [0.0, 0.0],
                [2.0 * x, 0.0],
                [2.0 * x, top],
                [x + half, top],
                [x, wall],
                [x - half, top],
                [0.0, top],
            ];
            KnownPart { name: "groove", mesh: drawn_out(&profile, wall * 12.0), wall }
        }
        _ => {
            // A gable of 60 degrees on a plate: its edges are no walls.
            let side = wall * 20.0;
            let profile = [
                [0.0, 0.0],
                [side, 0.0],
                [side, wall],
                [side * 0.75, wall],
                [side * 0.5, wall + side * 0.25 * 3f64.sqrt()],
                [side * 0.25, wall],
                [0.0, wall],
            ];
            KnownPart { name: "gable", mesh: drawn_out(&profile, side), wall }
        }
    }
}

/// Cuts one triangle in ten into three, one of them a sliver.
fn with_slivers(mut mesh: TriMesh, r: &mut Random) -> TriMesh {
    for t in 0..mesh.triangles.len() {
        if r.below(10) != 0 {
            continue;
        }
        let [a, b, c] = mesh.corners(t);
        let (u, v) = (r.between(0.2, 0.8), 10f64.powf(r.between(-3.0, -1.0)));
        let middle = a.as_dvec3() * (1.0 - u - v * 0.1) + b.as_dvec3() * u + c.as_dvec3() * v * 0.1;
        let m = mesh.positions.len() as u32;
        mesh.positions.push(middle.as_vec3());
        let [a, b, c] = mesh.triangles[t];
        mesh.triangles[t] = [a, b, m];
        mesh.triangles.extend([[b, c, m], [c, a, m]]);
    }
    mesh
}

/// Turned, moved, meshed and scaled at random; half of them rounded as STL rounds.
fn placed(part: &KnownPart, scale: f64, r: &mut Random) -> CentredMesh {
    let axis = DVec3::new(r.between(-1.0, 1.0), r.between(-1.0, 1.0), 1.0).normalize();
    let turn = DQuat::from_axis_angle(axis, r.between(0.0, 6.0));
    let move_by = DVec3::new(r.between(-50.0, 50.0), r.between(-50.0, 50.0), 10.0);
    let as_is = r.below(4) == 0;
    let single = r.below(2) == 0;
    let mut mesh = part.mesh.clone();
    let (tri, _) = mesh.triangulate();
    let size = tri.bounds().1.distance(tri.bounds().0);
    let cut = match r.below(3) {
        0 => tri,
        1 => refine(&tri, size / 12.0).mesh,
        _ => with_slivers(tri, r),
    };
    // New vertices are on the faces to single precision of the unturned part.
    let rounded = cut.positions.len() > mesh.positions.len();
    let before = mesh.positions.clone();
    mesh = cut.to_poly();
    for (p, exact) in mesh.positions.iter_mut().zip(&before) {
        *p = *exact;
    }
    for p in &mut mesh.positions {
        *p = if as_is { *p } else { turn * *p + move_by } * scale;
        if single || rounded {
            *p = p.as_vec3().as_dvec3();
        }
    }
    CentredMesh::new(&mesh, 1.0)
}

fn measured(part: &CentredMesh, limit: Option<f64>) -> Thickness {
    let query = WallQuery { limit, thinnest: false, grain: part.grain };
    let settings = ThicknessSettings::default();
    measure_at_places(&part.mesh, None, &settings, query, &Job::default()).expect("measured")
}

fn parts() -> u64 {
    if std::env::var_os("SCULPTD_LONG").is_some() { 2000 } else { 200 }
}

#[test]
fn no_verdict_on_a_known_wall_is_wrong() {
    let mut r = Random(46);
    let mut bad = Vec::new();
    for n in 0..parts() {
        let part = part(n % 8, &mut r);
        let scale = if n % 5 == 0 { 10f64.powf(r.between(-6.0, 6.0)) } else { 1.0 };
        let placed = placed(&part, scale, &mut r);
        let (found, wall) = (measured(&placed, None), part.wall * scale);
        let least = found.least.expect("a wall");
        // Refining and slivers round new vertices in the part's own frame.
        let slack = wall * 1e-5;
        if !(least.certified && least.lower - slack <= wall && wall <= least.upper + slack) {
            bad.push(format!("{n} {} at {scale}: {wall} is not in {least:?}", part.name));
        }
        for factor in [0.5, 0.9, 0.99, 0.999, 1.0, 1.001, 1.01, 1.1, 2.0] {
            let limit = (wall * factor) as f32;
            let right = if factor > 1.0 { Comparison::Below } else { Comparison::Reached };
            if found.compare(limit) != right {
                let name = part.name;
                bad.push(format!("{n} {name} at {scale}: {factor} of {wall} against {least:?}"));
            }
        }
    }
    assert!(bad.is_empty(), "{} of {}: {bad:#?}", bad.len(), parts());
}

/// The share of the area below `limit` by rays in double precision against every triangle. A wall's
/// other side is turned by at most the angle of which `least` is the cosine.
fn by_rays(mesh: &TriMesh, limit: f64, least: f64, rays: u64, r: &mut Random) -> (f64, f64) {
    let corners: Vec<[DVec3; 3]> =
        (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| p.as_dvec3())).collect();
    let cross = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a);
    let mut sums = vec![0.0];
    corners.iter().for_each(|t| sums.push(sums[sums.len() - 1] + cross(t).length() * 0.5));
    let all = sums[corners.len()];
    let mut below = 0u64;
    for _ in 0..rays {
        let at = r.between(0.0, all);
        let t = sums.partition_point(|&s| s <= at).clamp(1, corners.len()) - 1;
        let (mut u, mut v) = (r.between(0.0, 1.0), r.between(0.0, 1.0));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = corners[t];
        let (from, dir) = (a + (b - a) * u + (c - a) * v, -cross(&corners[t]).normalize());
        let nearest = corners.iter().enumerate().filter_map(|(other, q)| {
            let normal = cross(q);
            let facing = normal.dot(dir);
            if other == t || facing <= 1e-9 * normal.length() {
                return None;
            }
            let depth = normal.dot(q[0] - from) / facing;
            let hit = from + dir * depth;
            let inside = (0..3).all(|k| {
                let edge = q[(k + 1) % 3] - q[k];
                normal.dot(edge.cross(hit - q[k])) >= 0.0
            });
            (depth > 1e-6 && inside).then_some((depth, facing / normal.length()))
        });
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        below += u64::from(nearest.is_some_and(|n| n.0 < limit && n.1 >= least));
    }
    let share = below as f64 / rays as f64;
    (share, 3.0 * (share.max(1e-4) / rays as f64).sqrt() + 1.0 / rays as f64)
}

#[test]
fn the_area_below_a_limit_agrees_with_independent_rays() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (parts, rays) = if long { (30, 1_000_000) } else { (18, 20_000) };
    let mut r = Random(7);
    for n in 0..parts {
        // The rays do not know that a gable's sides rise from a thin plate.
        let part = part(n as u64 % 7, &mut r);
        let placed = placed(&part, 1.0, &mut r);
        let limit = (part.wall * r.between(1.05, 3.0)) as f32;
        let found = measured(&placed, Some(f64::from(limit))).area_beyond(limit, false);
        // Only the groove has a valley, and no edges beside walls.
        let from = if part.name == "groove" { 0.0 } else { 40f64.to_radians().cos() };
        let (share, error) = by_rays(&placed.mesh, f64::from(limit), from, rays, &mut r);
        let own = found.area / found.all;
        let bound = error + found.error / found.all;
        let name = part.name;
        assert!((own - share).abs() <= bound, "{n} {name}: {own} for {share} +- {bound}, {limit}");
    }
}

#[test]
fn the_sphere_gives_one_verdict_for_one_solid() {
    let mut r = Random(3);
    let settings =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    for n in 0..48 {
        // A groove's flanks are turned too far to hold a ball.
        let part = part([0, 1, 2, 3, 5][n % 5], &mut r);
        let placed = placed(&part, 1.0, &mut r);
        let found = measure_at_places(
            &placed.mesh,
            None,
            &settings,
            WallQuery { grain: placed.grain, ..Default::default() },
            &Job::default(),
        )
        .expect("measured");
        let s = found.summary();
        let wall = part.wall as f32;
        assert!(s.min <= s.median && s.median <= s.max, "{n} {}: {s:?}", part.name);
        let min = s.min.expect("a wall");
        assert!((min / wall - 1.0).abs() < 0.02, "{n} {}: {min} for {wall}", part.name);
        assert_eq!(found.compare(wall * 0.9), Comparison::Reached, "{n} {}", part.name);
        assert_eq!(found.compare(wall * 1.1), Comparison::Below, "{n} {}", part.name);
    }
}

#[test]
fn the_mean_and_the_largest_do_not_depend_on_the_mesh() {
    let mut r = Random(11);
    for kind in [0, 1, 3, 5] {
        let part = part(kind, &mut r);
        let first = measured(&placed(&part, 1.0, &mut r), None).summary();
        for _ in 0..4 {
            let s = measured(&placed(&part, 1.0, &mut r), None).summary();
            let off = |a: Option<f32>, b: Option<f32>| (a.expect("a") / b.expect("b") - 1.0).abs();
            assert!(off(s.mean, first.mean) < 5e-3, "{} {s:?} {first:?}", part.name);
            assert!(off(s.max, first.max) < 0.02, "{} {s:?} {first:?}", part.name);
            assert!(off(s.median, first.median) < 5e-3, "{} {s:?} {first:?}", part.name);
        }
    }
}

/// The largest error of a vertex and the stated bound, on curved shapes at four tessellations.
fn error_table() -> String {
    let mut out = String::from(
        "| shape | facets around | ray: error / bound | cone | sphere |\n|---|---|---|---|---|\n",
    );
    for around in [24, 48, 96, 192] {
        let ball = uv_sphere(10.0, around / 2, around);
        let shell = joined(ball.clone(), &flipped(uv_sphere(9.0, around / 2, around)));
        let pipe = turned(&[[8.0, 0.0], [10.0, 0.0], [10.0, 30.0], [8.0, 30.0]], around);
        for (name, mesh, wall) in [
            ("ball of 20 mm", ball, 20.0f32),
            ("shell of radii 10 and 9", shell, 1.0),
            ("pipe of radii 10 and 8", pipe, 2.0),
        ] {
            out.push_str(&format!("| {name} | {around} "));
            for method in [ThicknessMethod::Ray, ThicknessMethod::Cone, ThicknessMethod::Sphere] {
                let settings = ThicknessSettings { method, ..ThicknessSettings::default() };
                let part = CentredMesh::new(&mesh, 1.0);
                let mut fine = part.mesh.clone();
                if name.starts_with("pipe") {
                    fine = refine(&fine, 2.0).mesh;
                }
                let t = super::measure(&fine, &settings, &Job::default()).expect("measured");
                let bound = t.error_bound();
                // On a pipe the vertices of the turned sides, away from the ends.
                let counts = |p: &glam::Vec3| wall != 2.0 || p.z.abs() < 10.0;
                let known = t.values.iter().zip(&fine.positions).filter(|(_, p)| counts(p));
                let worst = known.map(|(v, _)| (v - wall).abs()).fold(0.0, f32::max);
                assert!(worst <= bound, "{name} {around} {method:?}: {worst} beyond {bound}");
                out.push_str(&format!("| {worst:.3} / {bound:.3} "));
            }
            out.push_str("|\n");
        }
    }
    out
}

/// The guide's table is what this computes. `SCULPTD_WRITE_GUIDE=1` writes it there.
#[allow(clippy::disallowed_methods)] // The page is under version control.
#[test]
fn the_map_keeps_its_bound_as_the_guide_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/guide/src/accuracy.md");
    let page = std::fs::read_to_string(path).expect("the page");
    let (begin, end) = ("<!-- errors: made by a test -->\n", "<!-- end of errors -->\n");
    let from = page.find(begin).expect("the table's beginning") + begin.len();
    let to = page.find(end).expect("the table's end");
    let table = error_table();
    if std::env::var_os("SCULPTD_WRITE_GUIDE").is_some() {
        let new = format!("{}{table}{}", &page[..from], &page[to..]);
        std::fs::write(path, new).expect("written");
        return;
    }
    assert!(page[from..to] == table, "SCULPTD_WRITE_GUIDE=1 writes this:\n{table}");
}

#[test]
fn a_fine_wedge_says_what_a_coarse_one_says() {
    // Small facets, whose normals rounding turns: an end of 80 degrees is an edge, not a wall.
    let tan = 10f64.to_radians().tan();
    let profile = [[5.0, 0.0], [40.0, 0.0], [40.0, 40.0 * tan], [5.0, 5.0 * tan]];
    let wedge = drawn_out(&profile, 20.0).triangulate().0;
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, 2.0);
    for spacing in [100.0, 2.0, 0.5] {
        let mut mesh = refine(&wedge, spacing).mesh;
        for p in &mut mesh.positions {
            *p = (turn * p.as_dvec3() + DVec3::splat(30.0)).as_vec3();
        }
        let part = CentredMesh::new(&mesh.to_poly(), 1.0);
        let found = measured(&part, None);
        let least = found.least.expect("a wall");
        assert!((least.value - 5.0 * tan).abs() < 1e-4, "{spacing}: {least:?}");
        assert_eq!(found.compare(0.88), Comparison::Reached);
        assert_eq!(found.compare(0.8825), Comparison::Below);
    }
}

#[test]
fn a_wall_in_the_profile_of_a_star_is_where_it_should_be() {
    // Two inner corners face each other across 1 mm; the flanks are turned from each other.
    let corners: Vec<DVec2> = [(0.0, 0.0), (20.0, 0.0), (20.0, 9.0), (10.0, 1.0), (0.0, 9.0)]
        .map(|(x, y)| DVec2::new(x, y))
        .to_vec();
    let profile: Vec<[f64; 2]> = corners.iter().map(|c| c.to_array()).collect();
    let part = CentredMesh::new(&drawn_out(&profile, 10.0), 1.0);
    let least = measured(&part, None).least.expect("a wall");
    assert!((least.value - 1.0).abs() < 1e-4, "{least:?}");
    let place = least.place() + part.centre;
    assert!((place.x - 10.0).abs() < 1e-3 && place.z.abs() < 1e-3, "{place}");
}

/// A voxel mesh with sharp edges has no ledges along them, and at most one part of twenty a fold.
#[test]
fn a_part_remeshed_with_sharp_edges_keeps_its_wall() {
    let mut r = Random(21);
    let mut bad = Vec::new();
    let rounds = parts() / 4;
    for n in 0..rounds {
        let part = part([1, 3, 5, 0][n as usize % 4], &mut r);
        let mesh = placed(&part, 1.0, &mut r).mesh;
        let (lo, hi) = mesh.bounds();
        let side = f64::from((hi - lo).max_element()) / part.wall * r.between(3.0, 5.0);
        let settings = RemeshSettings { side: side.clamp(8.0, 160.0) as usize, sharp: true };
        let solid = DistanceSolid::build(&mesh, &Job::default()).expect("built");
        let made = remesh(&mesh, &solid, settings, &Job::default()).expect("made");
        assert_eq!(made.crossings, 0);
        let placed = CentredMesh::new(&made.mesh.to_poly(), 1.0);
        let least = measured(&placed, None).least.expect("a wall").value;
        let voxel = f64::from((hi - lo).max_element()) / settings.side as f64;
        if (least - part.wall).abs() > voxel {
            bad.push(format!("{n} {} at {}: {least} for {}", part.name, settings.side, part.wall));
        }
    }
    assert!(bad.len() as u64 * 20 <= rounds, "{} of {rounds}: {bad:#?}", bad.len());
}

/// Faces of a scan, or of a file with few decimals, are not quite flat: beside an edge a ray runs
/// along a side for long, and what it meets there is no wall.
#[test]
fn a_rough_part_has_the_wall_of_a_smooth_one() {
    let mut r = Random(33);
    let rounds = parts() / 5;
    for n in 0..rounds {
        let part = part([1, 3, 5, 6][n as usize % 4], &mut r);
        let whole = CentredMesh::new(&part.mesh, 1.0).mesh;
        let (lo, hi) = whole.bounds();
        let mut mesh = refine(&whole, lo.distance(hi) / 60.0).mesh;
        let turn = DQuat::from_scaled_axis(DVec3::new(r.between(0.0, 3.0), 0.7, -0.4)).as_quat();
        let height = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            f64::from((b - a).cross(c - a).length() / longest)
        };
        let narrowest = (0..mesh.triangles.len()).map(height).fold(part.wall, f64::min);
        let rough = narrowest * 10f64.powf(r.between(-3.0, -1.5));
        for p in &mut mesh.positions {
            let by = DVec3::from_array(std::array::from_fn(|_| r.between(-rough, rough)));
            *p = turn * *p + by.as_vec3();
        }
        let found = measured(&CentredMesh::new(&mesh.to_poly(), 1.0), None).least;
        let least = found.expect("a wall").value;
        let off = (least / part.wall - 1.0).abs();
        assert!(off < 0.06, "{n} {}: {least} for {}, rough by {rough}", part.name, part.wall);
    }
}
