//! Slide-relax: the triangles move along the surface, the form stays.

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_clay::{Clay, Ray};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::{Studio, form};

fn drawn(start: &TriMesh, negative: bool, times: usize) -> TriMesh {
    let mut studio = Studio::new(
        start,
        BrushSettings { radius: 0.25, negative, ..sculptd::presets().of(BrushKind::SlideRelax) },
        1,
    );
    for _ in 0..times {
        studio.stroke(&[(Vec2::new(0.42, 0.5), 1.0), (Vec2::new(0.58, 0.5), 1.0)]);
    }
    studio.world.verify_invariants().expect("in order");
    studio.world.mesh().to_tri()
}

/// Returns the distance of the vertices from a surface about the middle, measured outwards.
fn off(surface: &TriMesh, mesh: &TriMesh) -> f32 {
    let surface = Clay::build(surface, &Job::default()).expect("builds");
    let off = |p: &Vec3| {
        let out = p.normalize();
        let hit = surface.pick(Ray { origin: out * 3.0, dir: -out }).expect("a closed form");
        (hit.position - *p).length()
    };
    mesh.positions.iter().map(off).fold(0.0, f32::max)
}

fn edges(mesh: &TriMesh) -> Vec<f32> {
    let at = |v: u32| mesh.positions[v as usize];
    mesh.triangles
        .iter()
        .flat_map(|t| [0, 1, 2].map(|i| (at(t[i]) - at(t[(i + 1) % 3])).length()))
        .collect()
}

fn turned(a: &TriMesh, b: &TriMesh) -> usize {
    let normal = |m: &TriMesh, t: usize| {
        let [p, q, r] = m.corners(t);
        (q - p).cross(r - p)
    };
    (0..a.triangles.len()).filter(|t| normal(a, *t).dot(normal(b, *t)) <= 0.0).count()
}

#[test]
fn triangles_slide_with_the_stroke_and_the_form_stays() {
    let start = form(20_000);
    let end = drawn(&start, false, 1);
    let edge = edges(&start).iter().sum::<f32>() / (start.triangles.len() * 3) as f32;
    let ways: Vec<Vec3> = start
        .positions
        .iter()
        .zip(&end.positions)
        .map(|(p, q)| *q - *p)
        .filter(|w| *w != Vec3::ZERO)
        .collect();
    let furthest = ways.iter().map(|w| w.length()).fold(0.0, f32::max) / edge;
    let along =
        ways.iter().map(|w| w.x).sum::<f32>() / ways.iter().map(|w| w.length()).sum::<f32>();
    let off = off(&start, &end) / edge;
    println!(
        "slid up to {furthest:.2} edges, {along:.2} of it along the stroke; {off:.4} edges off the \
            form"
    );
    assert!(furthest > 1.0 && along > 0.8 && off < 0.12 && turned(&start, &end) == 0);
}

#[test]
fn turned_round_it_relaxes_and_the_form_stays() {
    // A ball whose vertices were strewn about on it.
    let (mut start, mut dice) = (shapes::sphere_of_about(10_000), Dice(9));
    start.positions.iter_mut().for_each(|p| *p = (*p + dice.unit().cross(*p) * 0.01).normalize());
    let end = drawn(&start, true, 4);
    let spread = |m: &TriMesh| {
        let near: Vec<f32> = (0..m.triangles.len())
            .filter(|t| m.corners(*t).iter().all(|p| p.z > 0.9))
            .flat_map(|t| {
                let [a, b, c] = m.corners(t);
                [(a - b).length(), (b - c).length(), (c - a).length()]
            })
            .collect();
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        (near.iter().map(|e| (e - mean).powi(2)).sum::<f32>() / near.len() as f32).sqrt() / mean
    };
    let (before, after) = (spread(&start), spread(&end));
    println!("edges differ by {:.1} % before, {:.1} % after", before * 100.0, after * 100.0);
    assert!(after < 0.7 * before && turned(&start, &end) == 0);
    assert!(end.positions.iter().all(|p| (p.length() - 1.0).abs() < 2e-3), "it stays a ball");
}
