use super::*;
use crate::measure::measures;
use crate::shapes::{cuboid, cylinder, icosphere, torus};

fn at(mesh: &PolyMesh, normal: DVec3, offset: f64) -> Section {
    let section = Slicer::new(mesh, normal).expect("a direction").at(offset);
    assert_eq!((section.open, section.contours.iter().all(|c| c.closed)), (0, true));
    section
}

fn close_to(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{value} {expected}");
}

fn both(a: &PolyMesh, b: &PolyMesh) -> PolyMesh {
    let mut out = a.clone();
    let base = a.positions.len() as u32;
    out.positions.extend(&b.positions);
    b.faces().for_each(|f| out.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
    out
}

#[test]
fn a_box_has_its_outline_in_its_faces_too() {
    let mesh = cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0));
    for z in [0.0, 1e-9, 5.0, 20.0 - 1e-9, 20.0] {
        let s = at(&mesh, DVec3::Z, z);
        assert_eq!(s.contours.len(), 1);
        close_to(s.area, 1200.0);
        close_to(s.perimeter, 140.0);
        assert!(s.centroid.expect("an area").distance(DVec3::new(20.0, 15.0, z)) < 1e-9);
    }
    for z in [-1e-9, 20.0 + 1e-9] {
        assert_eq!(at(&mesh, DVec3::Z, z), Section::default());
    }
    // Through four edges, and along one of them alone.
    close_to(at(&mesh, DVec3::new(3.0, -4.0, 0.0), 0.0).area, 50.0 * 20.0);
    let edge = Section { folded: 2.0 * 20.0, ..Section::default() };
    assert_eq!(at(&mesh, DVec3::new(1.0, 1.0, 0.0), 70.0), edge);
    assert!(Slicer::new(&mesh, DVec3::ZERO).is_none());
    assert!(Slicer::new(&mesh, DVec3::splat(f64::NAN)).is_none());
}

#[test]
fn a_step_is_cut_below_it_and_a_hole_runs_clockwise() {
    let (lo, hi) = (DVec3::ZERO, DVec3::splat(4.0));
    let mut hole = cuboid(DVec3::ONE, DVec3::new(2.0, 2.0, 3.0));
    crate::repair::flip(&mut hole);
    let part = both(&cuboid(lo, hi), &hole);
    let part = both(&part, &cuboid(DVec3::new(9.0, 0.0, 2.0), DVec3::new(12.0, 3.0, 7.0)));
    for (z, area, contours) in
        [(0.0, 16.0, 1), (1.0, 15.0, 2), (2.0, 24.0, 3), (3.0, 24.0, 3), (7.0, 9.0, 1)]
    {
        let s = at(&part, DVec3::Z, z);
        close_to(s.area, area);
        assert_eq!(s.contours.len(), contours, "at {z}");
    }
}

/// Between two heights of vertices the area is a polynomial of degree two: two points of Gauss
/// give the volume exactly.
#[test]
fn sections_of_closed_meshes_add_up_to_the_volume() {
    let prism = cylinder(3.0, 5.0, 7);
    let lens = both(&torus(9.0, 2.0, 24, 12), &icosphere(4.0, 6).to_poly());
    let tilted = DVec3::new(0.3, -0.5, 0.8);
    for (mesh, normal) in [
        (&prism, DVec3::Z),
        (&prism, DVec3::X),
        (&prism, tilted),
        (&lens, DVec3::Y),
        (&lens, DVec3::Z),
        (&lens, tilted),
    ] {
        let slicer = Slicer::new(mesh, normal).expect("a direction");
        let mut heights = slicer.heights.clone();
        heights.sort_by(f64::total_cmp);
        let mut volume = 0.0;
        for w in heights.windows(2).filter(|w| w[1] - w[0] > 1e-9) {
            let (middle, half) = ((w[0] + w[1]) * 0.5, (w[1] - w[0]) * 0.5);
            let x = half / 3f64.sqrt();
            volume +=
                half * (at(mesh, normal, middle - x).area + at(mesh, normal, middle + x).area);
            // At a vertex: what is just below it.
            let (here, below) = (at(mesh, normal, w[1]).area, at(mesh, normal, w[1] - 1e-10).area);
            assert!((here - below).abs() < 1e-6, "{here} {below}");
        }
        let triangles = mesh.triangulate().0;
        let whole = measures(&triangles).volume.abs();
        assert!((volume / normal.length() - whole).abs() < 1e-6 * whole, "{volume} {whole}");
    }
}

/// The sum over the triangles, without joining anything: a vertex in the plane is above it.
fn met(mesh: &PolyMesh, axis: usize, height: f64) -> f64 {
    let piece = |t: &[u32; 3]| {
        let p = t.map(|v| mesh.positions[v as usize]);
        let cuts = [[0, 1], [1, 2], [2, 0]].map(|e| e.map(|i: usize| p[i]));
        let cuts: Vec<DVec3> = cuts
            .iter()
            .filter(|[a, b]| (a[axis] >= height) != (b[axis] >= height))
            .map(|[a, b]| *a + (*b - *a) * ((height - a[axis]) / (b[axis] - a[axis])))
            .collect();
        if let [a, b] = cuts[..] { a.distance(b) } else { 0.0 }
    };
    mesh.triangles().0.iter().map(piece).sum()
}

#[test]
fn a_line_out_and_back_is_no_perimeter_and_is_measured() {
    // A roof: below its ridge a rectangle, in the plane of the ridge a line.
    let corners = [[0, 0, 0], [10, 0, 0], [10, 4, 0], [0, 4, 0], [0, 2, 3], [10, 2, 3]].map(|p| {
        let [x, y, z] = p.map(f64::from);
        DVec3::new(x, y, z)
    });
    let mut roof = PolyMesh { positions: corners.to_vec(), ..PolyMesh::new() };
    for f in [&[3, 2, 1, 0][..], &[0, 1, 5, 4], &[2, 3, 4, 5], &[0, 4, 3], &[1, 2, 5]] {
        roof.push_face(f);
    }
    let s = at(&roof, DVec3::Z, 3.0);
    assert_eq!((s.contours.len(), s.area, s.perimeter, s.folded), (0, 0.0, 0.0, 20.0));
    let s = at(&roof, DVec3::Z, 1.5);
    assert_eq!((s.contours.len(), s.folded), (1, 0.0));
    close_to(s.perimeter, 24.0);
    // A doubled face on an edge of the box, which then has four faces, and one by itself.
    let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    let find = |p: [f64; 3]| mesh.positions.iter().position(|q| *q == DVec3::from(p));
    let [low, high] = [[4.0, 4.0, 0.0], [4.0; 3]].map(|p| find(p).expect("a corner") as u32);
    let free = mesh.positions.len() as u32;
    for p in [[6.0, 6.0, 1.0], [9.0, 0.0, 0.0], [9.0, 0.0, 4.0], [9.0, 2.0, 1.0]] {
        mesh.positions.push(DVec3::from(p));
    }
    for f in [[low, high, free], [high, low, free], [free + 1, free + 2, free + 3]] {
        mesh.push_face(&f);
    }
    mesh.push_face(&[free + 2, free + 1, free + 3]);
    for (axis, height) in [(2, 0.5), (2, 1.0), (2, 3.25), (0, 5.0), (1, 1.0), (1, 4.5)] {
        let normal = [DVec3::X, DVec3::Y, DVec3::Z][axis];
        let s = at(&mesh, normal, height);
        close_to(s.perimeter + s.folded, met(&mesh, axis, height));
        close_to(s.perimeter, if axis != 0 && height < 4.0 { 16.0 } else { 0.0 });
        assert!(s.folded > 0.1, "{axis} {height}");
        close_to(s.contours.iter().map(|c| c.area).sum(), s.area);
    }
}

#[test]
fn an_open_mesh_has_contours_with_two_ends_and_a_crack_is_closed() {
    let mesh = cylinder(3.0, 5.0, 12);
    let z = mesh.positions.iter().map(|p| p.z).fold(f64::INFINITY, f64::min) + 2.0;
    let mut open = PolyMesh::new();
    open.positions.clone_from(&mesh.positions);
    mesh.faces().filter(|f| f.len() == 4).skip(2).for_each(|f| open.push_face(f));
    let s = Slicer::new(&open, DVec3::Z).expect("a direction").at(z);
    assert_eq!((s.open, s.contours.len(), s.contours[0].closed), (1, 1, false));
    // Each face with vertices of its own, off by less than single precision holds.
    let mut torn = PolyMesh::new();
    for (i, f) in mesh.faces().enumerate() {
        let base = torn.positions.len() as u32;
        let shift = DVec3::new(1.0, -1.0, 0.0) * (i % 3) as f64 * 1e-7;
        torn.positions.extend(f.iter().map(|&v| mesh.positions[v as usize] + shift));
        torn.push_face(&(base..base + f.len() as u32).collect::<Vec<_>>());
    }
    let s = at(&torn, DVec3::Z, z);
    assert_eq!(s.contours.len(), 1);
    assert!((s.area - at(&mesh, DVec3::Z, z).area).abs() < 1e-5);
}

/// The same with some faces turned.
fn turned(mesh: &PolyMesh, is: impl Fn(usize) -> bool) -> PolyMesh {
    let mut out = PolyMesh { positions: mesh.positions.clone(), ..PolyMesh::new() };
    for (i, f) in mesh.faces().enumerate() {
        let back: Vec<u32> = f.iter().rev().copied().collect();
        out.push_face(if is(i) { &back } else { f });
    }
    out
}

#[test]
fn faces_that_are_turned_leave_the_area_and_are_measured() {
    // A block with a hole through it, and a pin in the hole.
    let mut hole = cylinder(2.0, 20.0, 24);
    crate::repair::flip(&mut hole);
    let wall: Vec<Vec<u32>> = hole.faces().filter(|f| f.len() == 4).map(<[u32]>::to_vec).collect();
    let mut tube = PolyMesh { positions: hole.positions.clone(), ..PolyMesh::new() };
    wall.iter().for_each(|f| tube.push_face(f));
    let block = cuboid(DVec3::new(-5.0, -5.0, -9.0), DVec3::new(5.0, 5.0, 9.0));
    let part = both(&both(&block, &tube), &cylinder(1.0, 20.0, 12));
    for normal in [DVec3::Z, DVec3::new(0.1, -0.2, 1.0)] {
        let whole = at(&part, normal, 0.3);
        assert_eq!((whole.contours.len(), whole.turned), (3, 0.0));
        assert!(whole.contours.iter().filter(|c| c.area < 0.0).count() == 1);
        for step in [2, 3, 5, 7] {
            let s = at(&turned(&part, |i| i % step == 0), normal, 0.3);
            close_to(s.area, whole.area);
            close_to(s.perimeter, whole.perimeter);
            assert!(s.turned > 0.0 && s.turned < s.perimeter, "{step}");
            close_to(s.contours.iter().map(|c| c.turned).sum(), s.turned);
            let (old, new) = (whole.centroid.expect("an area"), s.centroid.expect("an area"));
            assert!(old.distance(new) < 1e-9);
        }
        // A surface that is inside out as a whole has a negative area.
        let s = at(&turned(&part, |_| true), normal, 0.3);
        close_to(s.area, -whole.area);
        assert_eq!(s.turned, 0.0);
    }
}

/// The side of the plane that a face in it counts as: the lowest one of a shell as just above, all
/// others as just below.
#[test]
fn the_lowest_and_the_highest_plane_of_a_part_have_its_outline() {
    let frustum = |low: f64, high: f64| {
        let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE);
        for p in &mut mesh.positions {
            let half = if p.z == 0.0 { low } else { high };
            *p = DVec3::new((p.x - 0.5) * 2.0 * half, (p.y - 0.5) * 2.0 * half, p.z * 10.0);
        }
        mesh
    };
    for (low, high) in [(5.0, 5.0), (5.0, 3.0), (3.0, 5.0)] {
        let mesh = frustum(low, high);
        for (z, half) in [(0.0, low), (5.0, (low + high) / 2.0), (10.0, high)] {
            let s = at(&mesh, DVec3::Z, z);
            close_to(s.area, 4.0 * half * half);
            close_to(s.perimeter, 8.0 * half);
            // The same plane from the other side.
            let s = at(&mesh, -DVec3::Z, -z);
            close_to(s.area, 4.0 * half * half);
        }
        for z in [-1e-9, 10.0 + 1e-9] {
            assert_eq!(at(&mesh, DVec3::Z, z), Section::default());
        }
    }
    // A step is cut below it; a second shell that begins at that height, just above its bottom.
    let stair = both(
        &cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 2.0)),
        &cuboid(DVec3::new(6.0, 0.0, 2.0), DVec3::new(7.0, 1.0, 3.0)),
    );
    close_to(at(&stair, DVec3::Z, 2.0).area, 16.0 + 1.0);
}
