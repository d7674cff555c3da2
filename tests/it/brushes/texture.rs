//! The coordinates of a stroke against the exact ones, and the relief that they carry.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use sculptd_clay::Clay;
use sculptd_clay::brush::stroke_param::{StrokeParameters, StrokePlace, StrokeSample};
use sculptd_clay::brush::{Alpha, BrushKind, BrushSettings, Picture, PressureCurve};
use sculptd_engine::command::Command;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

use super::super::clay::Dice;
use super::Studio;

/// A sheet of `nx` by `ny` cells, bent by `at`, each inner vertex strewn by a part of a cell.
fn sheet(nx: u32, ny: u32, strewn: f32, at: impl Fn(f32, f32) -> Vec3) -> TriMesh {
    let mut dice = Dice(12);
    let mut mesh = TriMesh::default();
    for j in 0..=ny {
        for i in 0..=nx {
            let inner = i > 0 && j > 0 && i < nx && j < ny;
            let mut off = || if inner { (dice.next() - 0.5) * strewn } else { 0.0 };
            let (x, y) = ((i as f32 + off()) / nx as f32, (j as f32 + off()) / ny as f32);
            mesh.positions.push(at(x, y));
        }
    }
    let v = |i, j| j * (nx + 1) + i;
    for j in 0..ny {
        for i in 0..nx {
            let q = [v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)];
            // Either diagonal, by turns: no direction is favoured.
            if (i + j) % 2 == 0 {
                mesh.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            } else {
                mesh.triangles.extend([[q[0], q[1], q[3]], [q[1], q[2], q[3]]]);
            }
        }
    }
    mesh
}

fn build(mesh: &TriMesh) -> Clay {
    Clay::build(mesh, &Job::default()).expect("builds")
}

/// Calls `visit` with each vertex that has coordinates: where it is, and they.
fn each_place(mesh: &Clay, unroll: &StrokeParameters, mut visit: impl FnMut(Vec3, Vec2)) -> usize {
    let mut count = 0;
    for p in 0..mesh.page_count() as u32 {
        for v in 0..mesh.page(p).own() {
            if let Some(place) = unroll.walk.place(p, v) {
                visit(mesh.page(p).point(v), Vec2::from(place));
                count += 1;
            }
        }
    }
    count
}

/// The greatest error over the radius, of coordinates about one point.
fn worst_about(
    mesh: &TriMesh,
    from: StrokeSample,
    radius: f32,
    exact: impl Fn(Vec3) -> Vec2,
) -> f32 {
    let mesh = build(mesh);
    let mut unroll = StrokeParameters::default();
    unroll.walk.begin(&mesh);
    unroll.spread(&mesh, &from, radius);
    let mut worst = 0.0f32;
    let n = each_place(&mesh, &unroll, |p, got| worst = worst.max((got - exact(p)).length()));
    assert!(n > 300, "only {n} vertices have coordinates");
    worst / radius
}

#[test]
fn a_cylinder_unrolls_to_its_development() {
    // The angle from a half turn to the left to one to the right; the seam is at the back.
    let tube = |x: f32, y: f32| {
        let a = (x - 0.5) * std::f32::consts::TAU;
        Vec3::new(a.sin(), y * 2.0 - 1.0, a.cos())
    };
    let from =
        StrokeSample { point: Vec3::Z, normal: Vec3::Z, along: Vec3::new(0.8, 0.6, 0.0), u: 0.3 };
    let exact = |p: Vec3| {
        let flat = Vec2::new(p.x.atan2(p.z), p.y);
        Vec2::new(0.3 + flat.dot(Vec2::new(0.8, 0.6)), flat.dot(Vec2::new(-0.6, 0.8)))
    };
    for (nx, ny, strewn) in [(200, 64, 0.0), (200, 64, 0.5), (90, 120, 0.3)] {
        let worst = worst_about(&sheet(nx, ny, strewn, tube), from, 0.5, exact);
        println!("cylinder {nx} x {ny}, strewn {strewn}: {:.2} % of the radius", worst * 100.0);
        assert!(worst < 0.02, "{worst}");
    }
}

#[test]
fn a_cone_unrolls_to_its_development() {
    // Half angle 30 degrees: the development is half a disc. Slant 0.6 to 2, apex at the origin.
    let half = 30f32.to_radians();
    let cone = move |x: f32, y: f32| {
        let (a, s) = ((x - 0.5) * std::f32::consts::TAU, 2.0 - 1.4 * y);
        Vec3::new(s * half.sin() * a.sin(), -s * half.cos(), s * half.sin() * a.cos())
    };
    let point = cone(0.5, 0.5);
    let normal = Vec3::new(0.0, half.sin(), half.cos());
    let along = Vec3::X;
    let flat = move |p: Vec3| {
        let (s, a) = (p.length(), p.x.atan2(p.z) * half.sin());
        Vec2::new(s * a.sin(), -s * a.cos())
    };
    let exact = move |p: Vec3| flat(p) - flat(point);
    for strewn in [0.0, 0.4] {
        let worst = worst_about(
            &sheet(160, 70, strewn, cone),
            StrokeSample { point, normal, along, u: 0.0 },
            0.4,
            exact,
        );
        println!("cone, strewn {strewn}: {:.2} % of the radius", worst * 100.0);
        assert!(worst < 0.02, "{worst}");
    }
}

#[test]
fn a_sphere_gets_its_exponential_map() {
    let mesh = sculptd_geometry::shapes::icosphere(1.0, 90);
    let normal = Vec3::new(0.36, 0.48, 0.8);
    let along = normal.any_orthonormal_vector();
    let across = normal.cross(along);
    let exact = |p: Vec3| {
        let flat = p - normal * p.dot(normal);
        Vec2::new(flat.dot(along), flat.dot(across)).normalize_or_zero()
            * p.normalize().dot(normal).clamp(-1.0, 1.0).acos()
    };
    for radius in [0.25, 0.5] {
        let worst = worst_about(
            &mesh,
            StrokeSample { point: normal, normal, along, u: 0.0 },
            radius,
            exact,
        );
        println!("sphere, radius {radius}: {:.2} % of the radius", worst * 100.0);
        assert!(worst < 0.02, "{worst}");
    }
}

#[test]
fn a_stroke_round_a_cylinder_unrolls_along_its_arc_length() {
    let tube = |x: f32, y: f32| {
        let a = (x - 0.5) * std::f32::consts::TAU;
        Vec3::new(a.sin(), y * 2.0 - 1.0, a.cos())
    };
    let mesh = build(&sheet(200, 64, 0.3, tube));
    let radius = 0.3;
    let mut unroll = StrokeParameters::default();
    // A helix: a straight line in the development, from (-1, -0.4), rising by 0.4 a unit.
    let direction = Vec2::new(1.0, 0.4).normalize();
    let (start, step, steps) = (Vec2::new(-1.0, -0.4), 0.2 * radius, 34);
    for i in 0..=steps {
        let at = start + direction * (i as f32 * step);
        let n = Vec3::new(at.x.sin(), 0.0, at.x.cos());
        unroll.step(&mesh, 7, StrokePlace::Now(n + Vec3::Y * at.y, n), radius);
    }
    let end = start + direction * (steps as f32 * step);
    let (mut worst, mut met) = (0.0f32, 0);
    each_place(&mesh, &unroll, |p, got| {
        let flat = Vec2::new(p.x.atan2(p.z), p.y);
        let want = Vec2::new((flat - start).dot(direction), direction.perp_dot(flat - start));
        // Beside the stroke; its ends are round.
        if want.x > 0.0 && want.x < (end - start).length() && want.y.abs() < 0.8 * radius {
            worst = worst.max((got - want).length() / radius);
            met += 1;
        }
    });
    println!("a stroke on a cylinder: {:.2} % of the radius over {met} vertices", worst * 100.0);
    assert!(met > 500 && worst < 0.02, "{worst} over {met}");
}

#[test]
fn an_alpha_becomes_relief_of_its_height_and_carves_the_other_way_round() {
    let flat = sheet(300, 300, 0.3, |x, y| Vec3::new(x * 2.0 - 1.0, y * 2.0 - 1.0, 0.0));
    let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
    for negative in [false, true] {
        let brush = BrushSettings {
            radius: 0.15,
            strength: 0.2,
            negative,
            alpha: Alpha::Waves,
            pressure_strength: firm,
            ..sculptd::presets().of(BrushKind::Texture)
        };
        let mut studio = Studio::new(&flat, brush, 2);
        let (a, b) =
            (studio.view(Vec3::new(-0.6, 0.0, 0.0)), studio.view(Vec3::new(0.6, 0.0, 0.0)));
        let points: Vec<_> = (0..=20).map(|i| (a.lerp(b, i as f32 / 20.0), 1.0)).collect();
        studio.stroke(&points);
        studio.stroke(&[(Vec2::new(0.02, 0.02), 1.0)]);
        let radius = studio.world.brush_radius();
        let sign = if negative { -1.0 } else { 1.0 };
        let (mut worst, mut top) = (0.0f32, 0.0f32);
        for p in studio.positions() {
            // On the axis, away from the ends, the relief is the alpha: two waves a brush's width,
            // from the first dab on.
            if p.y.abs() < 0.1 * radius && p.x.abs() < 0.4 {
                let s = (p.x + 0.6) / (2.0 * radius);
                let want =
                    sign * 0.2 * radius * (0.5 - 0.5 * (s * 2.0 * std::f32::consts::TAU).cos());
                worst = worst.max((p.z - want).abs());
                top = top.max(p.z * sign);
            }
        }
        assert!((top / (0.2 * radius) - 1.0).abs() < 0.03, "{top}");
        // A phase error of 2 % of the radius moves the flank of a wave by this much.
        assert!(
            worst < 0.2 * radius * 0.02 * 4.0 * std::f32::consts::PI * 0.5 * 2.0,
            "{worst} of {}",
            0.2 * radius
        );
    }
}

#[test]
fn a_picture_with_a_transparent_rim_leaves_no_rim_in_the_clay() {
    // White and opaque in the middle, white and transparent about it.
    let side = 64u32;
    let inside = |k: u32| (16..48).contains(&(k % side)) && (16..48).contains(&(k / side));
    let cover: Vec<u16> = (0..side * side).map(|k| if inside(k) { u16::MAX } else { 0 }).collect();
    let picture = Picture { width: side, height: side, heights: cover.clone(), cover };
    let flat = sheet(200, 200, 0.3, |x, y| Vec3::new(x * 2.0 - 1.0, y * 2.0 - 1.0, 0.0));
    let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
    for floor in [0.0, 0.3] {
        let mut brush = BrushSettings {
            radius: 0.15,
            strength: 0.2,
            alpha: Alpha::Picture,
            pressure_strength: firm,
            ..sculptd::presets().of(BrushKind::Texture)
        };
        brush.extra[1] = floor;
        let mut studio = Studio::new(&flat, brush, 2);
        studio.tell(Command::Picture(Arc::new(picture.clone())));
        let points: Vec<_> = (0..=20)
            .map(|i| (studio.view(Vec3::new(-0.6 + 0.06 * i as f32, 0.0, 0.0)), 1.0))
            .collect();
        studio.stroke(&points);
        let radius = studio.world.brush_radius();
        let end = studio.positions();
        // A pixel beyond the middle half nothing has moved; within it the relief stands.
        let beyond = 0.5 + 2.0 / side as f32;
        let rim = end.iter().filter(|p| p.y.abs() > beyond * radius);
        let rim = rim.map(|p| p.z.abs()).fold(0.0, f32::max);
        let top = end.iter().map(|p| p.z).fold(0.0, f32::max);
        println!("floor {floor}: {top} high, {rim} at the rim");
        assert!(top > 0.9 * (1.0 - floor) * 0.2 * radius, "{top}");
        assert!(rim < 1e-3 * top, "{rim} of {top}");
        assert!(end.iter().all(|p| p.z > -1e-3 * top), "pressed in where it is transparent");
    }
}
