//! Brushes against their formulas.

use glam::{Vec2, Vec3};
use sculptd_clay::brush::elastic::ElasticBrush;
use sculptd_clay::brush::{
    BrushKind, BrushSettings, GaussianBrush, PressureCurve, SmoothBrush, TopologySettings,
};
use sculptd_clay::{Clay, Reach, Workers};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::Studio;

fn dense_plane(cells: u32) -> TriMesh {
    shapes::grid(2.0, 2.0, cells, cells).triangulate().0
}

fn build(mesh: &TriMesh) -> Clay {
    Clay::build(mesh, &Job::default()).expect("builds")
}

/// Height of the bell at `d` from its middle: height * exp(-(3.5 d / radius)^2 / (2 * 0.7^2)).
fn bell(height: f64, radius: f64, d: f64) -> f64 {
    let x = 3.5 * d / radius;
    if d < radius { height * (-x * x / (2.0 * 0.49)).exp() } else { 0.0 }
}

#[test]
fn the_gaussian_is_its_formula_on_a_plane_and_on_a_sphere() {
    let plane = dense_plane(400);
    let sphere = shapes::icosphere(1.0, 100);
    for (start, centre, normal) in
        [(plane, Vec3::ZERO, Vec3::Z), (sphere, Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.0, 0.6, 0.8))]
    {
        for (radius, height) in [(0.5f32, 0.04f32), (0.3, -0.02)] {
            let mut mesh = build(&start);
            let kernel = GaussianBrush::new(centre, radius, normal, height);
            mesh.dab(&Reach::Sphere { centre, radius }, &kernel, &Workers::new(1));
            let end = mesh.to_tri();
            let mut met = [false; 6];
            for (a, b) in start.positions.iter().zip(&end.positions) {
                let d = f64::from((*a - centre).length());
                let way = *b - *a;
                let want = bell(f64::from(height), f64::from(radius), d);
                let got = f64::from(way.dot(normal));
                assert!(
                    (got - want).abs() < 1e-5 * f64::from(height.abs()) + 2.5e-7,
                    "at {d}: {got} for {want}"
                );
                assert!((way - normal * way.dot(normal)).length() < 2.5e-7, "aside at {d}");
                for (k, met) in met.iter_mut().enumerate() {
                    *met |= (d / f64::from(radius) - 0.2 * k as f64).abs() < 0.02;
                }
            }
            assert_eq!(met, [true; 6], "the centre and five radii were looked at");
        }
    }
}

/// A flat sheet whose inner vertices are strewn by a fifth of a cell, each cell cut by its Delaunay
/// diagonal.
fn irregular(cells: u32) -> TriMesh {
    let mut dice = Dice(9);
    let n = cells + 1;
    let step = 2.0 / cells as f32;
    let mut mesh = TriMesh::default();
    for j in 0..n {
        for i in 0..n {
            let inner = i > 0 && j > 0 && i < cells && j < cells;
            let mut off = || if inner { (dice.next() - 0.5) * 0.4 } else { 0.0 };
            let (x, y) = (i as f32 + off(), j as f32 + off());
            mesh.positions.push(Vec3::new(x * step - 1.0, y * step - 1.0, 0.0));
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let q = [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i];
            let p = q.map(|v| mesh.positions[v as usize]);
            let angle = |a: usize, b: usize, c: usize| (p[a] - p[b]).angle_between(p[c] - p[b]);
            // The diagonal whose opposite angles sum to less than a half turn.
            if angle(0, 1, 2) + angle(2, 3, 0) <= std::f32::consts::PI {
                mesh.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            } else {
                mesh.triangles.extend([[q[0], q[1], q[3]], [q[1], q[2], q[3]]]);
            }
        }
    }
    mesh
}

#[test]
fn smooth_leaves_a_flat_irregular_sheet_as_it_is() {
    let start = irregular(60);
    let edge = 2.0 / 60.0;
    let mut mesh = build(&start);
    let one = Workers::new(1);
    let mut dice = Dice(4);
    for _ in 0..40 {
        let centre = Vec3::new(dice.next() - 0.5, dice.next() - 0.5, 0.0);
        mesh.dab(&Reach::Sphere { centre, radius: 0.4 }, &SmoothBrush::new(centre, 0.4, 1.0), &one);
    }
    let end = mesh.to_tri();
    let (mut up, mut aside) = (0.0f32, 0.0f32);
    for (a, b) in start.positions.iter().zip(&end.positions) {
        up = up.max((b.z - a.z).abs());
        aside = aside.max((b.truncate() - a.truncate()).length());
    }
    println!("up {:.2e}, aside {:.2e} of an edge", up / edge, aside / edge);
    assert!(up <= 1e-6 * edge, "{up}");
    assert!(aside < 0.01 * edge, "{} of an edge", aside / edge);
}

#[test]
fn smooth_evens_a_bump_and_keeps_a_border() {
    let mut start = dense_plane(80);
    for p in &mut start.positions {
        p.z = 0.05 * (p.x * 40.0).sin() * (p.y * 40.0).sin();
    }
    let mut mesh = build(&start);
    let one = Workers::new(1);
    for _ in 0..30 {
        mesh.dab(
            &Reach::Sphere { centre: Vec3::ZERO, radius: 0.8 },
            &SmoothBrush::new(Vec3::ZERO, 0.8, 1.0),
            &one,
        );
    }
    let end = mesh.to_tri();
    let rough = |m: &TriMesh| {
        m.positions
            .iter()
            .filter(|p| p.truncate().length() < 0.3)
            .map(|p| p.z.abs())
            .fold(0.0, f32::max)
    };
    assert!(rough(&end) < 0.1 * rough(&start), "{} of {}", rough(&end), rough(&start));
    assert!(end.positions.iter().all(|p| p.is_finite()));
}

/// A brush that pressure does not change, of this radius and strength.
fn even(kind: BrushKind, radius: f32, strength: f32) -> BrushSettings {
    let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
    BrushSettings {
        radius,
        strength,
        pressure_radius: firm,
        pressure_strength: firm,
        ..sculptd::presets().of(kind)
    }
}

fn across() -> Vec<(Vec2, f32)> {
    (0..=16).map(|i| (Vec2::new(0.4 + 0.0125 * i as f32, 0.5), 1.0)).collect()
}

#[test]
fn saturation_is_never_exceeded_and_is_reached_exactly() {
    let start = shapes::icosphere(1.0, 60);
    for kind in
        [BrushKind::Gaussian, BrushKind::Draw, BrushKind::Inflate, BrushKind::Clay, BrushKind::Blob]
    {
        for threshold in [1.0f32, 2.5] {
            let brush = BrushSettings { saturation: threshold, ..even(kind, 0.2, 0.1) };
            let mut studio = Studio::new(&start, brush, 1);
            let limit = threshold * 0.1 * studio.world.brush_radius();
            let back_and_forth: Vec<_> = (0..8)
                .flat_map(
                    |i| if i % 2 == 0 { across() } else { across().into_iter().rev().collect() },
                )
                .collect();
            studio.stroke(&back_and_forth);
            let first = studio.positions();
            let far = |a: &[Vec3], b: &[Vec3]| {
                a.iter().zip(b).map(|(a, b)| (*b - *a).length()).fold(0.0, f32::max)
            };
            let most = far(&start.positions, &first);
            assert!(most <= limit * (1.0 + 1e-5), "{kind}: {most} of {limit}");
            if kind == BrushKind::Gaussian {
                assert!(most >= limit * (1.0 - 1e-5), "{kind}: only {most} of {limit}");
            }
            // The next stroke has a separate budget.
            studio.stroke(&back_and_forth);
            let second = far(&first, &studio.positions());
            assert!(
                second <= limit * (1.0 + 1e-5) && second > 0.2 * limit,
                "{kind}: {second} of {limit}"
            );
        }
    }
}

/// For each vertex its image, by its place.
fn partners(mesh: &TriMesh, sign: Vec3) -> Vec<usize> {
    let key = |p: Vec3| (p * 1e5).round().as_ivec3().to_array();
    let at: std::collections::BTreeMap<_, _> =
        mesh.positions.iter().enumerate().map(|(i, p)| (key(*p), i)).collect();
    mesh.positions
        .iter()
        .map(|p| {
            let near = |d: Vec3| at.get(&key(*p * sign + d)).copied();
            let shift = |k: i32| [0.0, 1e-5, -1e-5][k as usize];
            let mut all = (0..27).map(|k| Vec3::new(shift(k % 3), shift(k / 3 % 3), shift(k / 9)));
            all.find_map(near).expect("the mesh is symmetric")
        })
        .collect()
}

#[test]
fn symmetric_strokes_mirror() {
    let start = shapes::icosphere(1.0, 40);
    for kind in BrushKind::ALL {
        for symmetry in [[true, false, false], [true, true, true]] {
            let mut brush =
                BrushSettings { symmetry, radius: 0.12, ..sculptd::presets().of(*kind) };
            // Cuts are made one image after another, and are not symmetric to the bit.
            brush.topology = TopologySettings::default();
            let mut studio = Studio::new(&start, brush, 1);
            // From the right over the mirror to the left: images overlap half of the way.
            let points: Vec<_> =
                (0..=12).map(|i| (Vec2::new(0.56 - 0.01 * i as f32, 0.46), 0.7)).collect();
            studio.stroke(&points);
            let end = studio.world.mesh().to_tri();
            for axis in 0..3 {
                if !symmetry[axis] {
                    continue;
                }
                let mut sign = Vec3::ONE;
                sign[axis] = -1.0;
                let other = partners(&start, sign);
                let worst = (0..other.len())
                    .map(|i| (end.positions[i] * sign - end.positions[other[i]]).length())
                    .fold(0.0, f32::max);
                assert!(worst <= 1e-6, "{kind}, axis {axis}: {worst}");
            }
        }
    }
}

#[test]
fn radial_copies_and_any_plane_are_where_they_should_be() {
    let start = shapes::icosphere(1.0, 60);
    let mut brush = even(BrushKind::Gaussian, 0.08, 0.2);
    brush.mirror.radial = 6;
    brush.mirror.axis = 2;
    let mut studio = Studio::new(&start, brush, 1);
    let at = studio.view(Vec3::new(0.5, 0.1, 0.86));
    studio.stroke(&[(at, 1.0)]);
    let end = studio.positions();
    // The centroid of what moved by more than half of the height, in each sixth of a turn.
    let moved: Vec<Vec3> = start
        .positions
        .iter()
        .zip(&end)
        .filter(|(a, b)| (**b - **a).length() > 0.1 * studio.world.brush_radius())
        .map(|(a, _)| *a)
        .collect();
    let first = Vec2::new(0.5, 0.1).to_angle();
    for k in 0..6 {
        let angle = first + std::f32::consts::TAU * k as f32 / 6.0;
        let want = Vec2::from_angle(angle) * Vec2::new(0.5, 0.1).length();
        let near: Vec<_> = moved.iter().filter(|p| (p.truncate() - want).length() < 0.1).collect();
        let middle = near.iter().map(|p| p.truncate()).sum::<Vec2>() / near.len() as f32;
        assert!((middle - want).length() < 0.02, "copy {k}: {middle} for {want}");
    }
    let mut brush = even(BrushKind::Gaussian, 0.08, 0.2);
    brush.mirror.plane = [1.0, 1.0, 0.0];
    let mut studio = Studio::new(&start, brush, 1);
    let at = studio.view(Vec3::new(0.5, 0.1, 0.86));
    studio.stroke(&[(at, 1.0)]);
    let end = studio.positions();
    let most_at = |x: f32, y: f32| {
        start
            .positions
            .iter()
            .zip(&end)
            .filter(|(a, _)| (a.truncate() - Vec2::new(x, y)).length() < 0.05 && a.z > 0.0)
            .map(|(a, b)| (*b - *a).length())
            .fold(0.0, f32::max)
    };
    // Over x + y = 0 (0.5, 0.1) has its image at (-0.1, -0.5).
    let (here, there) = (most_at(0.5, 0.1), most_at(-0.1, -0.5));
    assert!(here > 0.0 && (here - there).abs() < 0.05 * here, "{here} and {there}");
}

/// Returns the change of volume at `r` in the closed form of de Goes and James (2017) with three
/// scales: for one scale `-(a - 2b) (r^2 + 5/2 e^2) / r_e^5 (r . f)`, scaled so that the held point
/// moves by `by`.
fn divergence(r: Vec3, by: Vec3, size: f32, nu: f32) -> f32 {
    let e = [size, size * 1.1, size * 1.21];
    let [s1, s2, s3] = e.map(|e| e * e);
    let weights = [1.0, -(s3 - s1) / (s3 - s2), (s2 - s1) / (s3 - s2)];
    let b = 1.0 / (4.0 - 4.0 * nu);
    let (mut sum, mut middle) = (0.0, 0.0);
    for (e, w) in e.into_iter().zip(weights) {
        let re2 = r.length_squared() + e * e;
        sum += w * -(1.0 - 2.0 * b) * (r.length_squared() + 2.5 * e * e) / (re2 * re2 * re2.sqrt());
        middle += w * (1.5 - b) / e;
    }
    sum * r.dot(by) / middle
}

#[test]
fn kelvinlets_hold_the_point_and_keep_the_volume_as_the_paper_says() {
    let by = Vec3::new(0.01, 0.003, -0.004);
    for nu in [0.0, 0.25, 0.5] {
        let e = ElasticBrush::new(by, 0.3, nu);
        assert!((e.at(Vec3::ZERO) - by).length() < 1e-6, "the held point goes with the pen");
        // The divergence, by central differences, against what the formula gives: for one scale it
        // is -(a - 2b) (r^2 + 5/2 e^2) / r_e^5 (r . f), which is zero for nu = 1/2, where a = 2b.
        let h = 1e-2;
        let r = Vec3::new(0.2, -0.15, 0.1);
        let div: f32 = [Vec3::X, Vec3::Y, Vec3::Z]
            .iter()
            .map(|d| (e.at(r + *d * h) - e.at(r - *d * h)).dot(*d) / (2.0 * h))
            .sum();
        let slope = by.length() / 0.3;
        let exact = divergence(r, by, 0.3, nu);
        assert!((div - exact).abs() < 0.01 * slope, "nu {nu}: {div}, the paper's is {exact}");
        if nu == 0.5 {
            assert!(div.abs() < 2e-3 * slope, "{div} against {slope}");
        } else {
            assert!(div.abs() > 1e-2 * slope, "compressible clay changes: {div} against {slope}");
        }
        // Far away nothing is left: the three scales cancel to 1 / r^5.
        assert!(e.at(Vec3::X * 3.0).length() < 2e-4 * by.length());
    }
    let volume = |positions: &[Vec3], mesh: &TriMesh| -> f64 {
        let c = |v: u32| positions[v as usize].as_dvec3();
        mesh.triangles.iter().map(|t| c(t[0]).dot(c(t[1]).cross(c(t[2])))).sum::<f64>() / 6.0
    };
    let start = shapes::icosphere(1.0, 80);
    let change = |nu: f32| {
        let mut brush = BrushSettings { radius: 0.2, ..sculptd::presets().of(BrushKind::Elastic) };
        brush.extra[0] = nu;
        let mut studio = Studio::new(&start, brush, 1);
        let from = studio.view(Vec3::new(0.8, 0.0, 0.6));
        studio.stroke(&[(from, 1.0), (from + Vec2::new(0.004, 0.0), 1.0)]);
        let end = studio.positions();
        let swept =
            start.positions.iter().zip(&end).map(|(a, b)| (*b - *a).length()).fold(0.0, f32::max);
        // Against the volume that the same motion of a disc of the brush would sweep.
        let radius = studio.world.brush_radius();
        let disc = std::f64::consts::PI * f64::from(radius * radius * swept);
        ((volume(&end, &start) - volume(&start.positions, &start)) / disc).abs()
    };
    let (stiff, soft) = (change(0.5), change(0.0));
    println!(
        "volume: {:.2} % of the swept disc for nu = 1/2, {:.2} % for nu = 0",
        stiff * 100.0,
        soft * 100.0
    );
    assert!(stiff < 0.02 && soft > 3.0 * stiff, "{stiff} and {soft}");
}

#[test]
fn strength_does_not_depend_on_the_spacing_when_it_is_compensated() {
    let start = shapes::icosphere(1.0, 60);
    let height = |spacing: f32| {
        let mut brush = even(BrushKind::Gaussian, 0.15, 0.05);
        brush.spacing = spacing;
        brush.path.compensate = true;
        let mut studio = Studio::new(&start, brush, 1);
        studio.stroke(&across());
        let end = studio.positions();
        let middle = start
            .positions
            .iter()
            .zip(&end)
            .filter(|(a, _)| a.truncate().length() < 0.05 && a.z > 0.0);
        middle.map(|(a, b)| (*b - *a).length()).fold(0.0, f32::max)
    };
    let (wide, usual, close) = (height(0.25), height(0.2), height(0.05));
    assert!(
        (wide / usual - 1.0).abs() < 0.08 && (close / usual - 1.0).abs() < 0.08,
        "{wide} {usual} {close}"
    );
}
