//! The boundary brush: what hangs on the border of an open surface.

use glam::Vec3;
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_geometry::shapes;

use super::Studio;

#[test]
fn the_border_near_the_pen_follows_it_and_the_rest_stays() {
    let mesh = shapes::grid(2.0, 2.0, 100, 100).triangulate().0;
    let brush = BrushSettings { radius: 0.3, ..sculptd::presets().of(BrushKind::Boundary) };
    let mut studio = Studio::new(&mesh, brush, 2);
    let camera = Camera { orthographic: true, ..*studio.world.camera() };
    studio.tell(Command::Camera(camera));
    // From a little inside the right border, and a tenth to the right.
    let drawn = Vec3::new(0.1, 0.0, 0.0);
    let at = |k: u32| Vec3::new(0.9, 0.0, 0.0) + drawn * (k as f32 / 10.0);
    let points: Vec<_> = (0..=10).map(|k| (studio.view(at(k)), 0.5 + 0.05 * k as f32)).collect();
    studio.stroke(&points);
    let (end, radius) = (studio.positions(), studio.world.brush_radius());
    let way = |p: Vec3| {
        let i = mesh.positions.iter().position(|q| q.distance(p) < 1e-4).expect("a vertex");
        end[i] - mesh.positions[i]
    };
    assert!(way(Vec3::new(1.0, 0.0, 0.0)).distance(drawn) < 2e-3, "{}", way(Vec3::X));
    // Half as far where the falloff is a half: along the border, and behind it.
    for p in [Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.8, 0.0, 0.0)] {
        let share = way(p).x / drawn.x;
        let x = 0.2 / radius;
        let wanted = (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x);
        println!("{p}: {share} for {wanted}");
        assert!((share - wanted).abs() < 0.05, "{p}: {share} for {wanted}");
    }
    // The border is bowed as the falloff is, with no waves upon that.
    let mut bow: Vec<(f32, f32)> = mesh
        .positions
        .iter()
        .zip(&end)
        .filter(|(p, _)| p.x > 0.999 && p.y.abs() < 0.3)
        .map(|(p, q)| {
            let x = p.y.abs() / radius;
            (p.y, q.x - p.x - drawn.x * (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x))
        })
        .collect();
    bow.sort_by(|a, b| a.0.total_cmp(&b.0));
    let squares: f32 = bow.windows(2).map(|w| (w[1].1 - w[0].1).powi(2) / (w[1].0 - w[0].0)).sum();
    let waviness = (squares / 0.6).sqrt().atan().to_degrees();
    println!("{waviness:.3} degrees along {} vertices of the border", bow.len());
    assert!(bow.len() > 25 && waviness <= 0.3, "{waviness} degrees");
    for (p, q) in mesh.positions.iter().zip(&end) {
        // A radius along the border, and from there another.
        let far = p.y.abs() > 2.0 * radius || 1.0 - p.x > radius;
        assert!(!far || p == q, "{p} went to {q}");
    }
    studio.tell(Command::Undo);
    assert!(studio.positions() == mesh.positions);
}

#[test]
fn far_from_any_border_nothing_moves() {
    let mesh = shapes::icosphere(1.0, 30);
    let brush = sculptd::presets().of(BrushKind::Boundary);
    let mut studio = Studio::new(&mesh, brush, 1);
    studio.stroke(&super::s_curve());
    assert!(studio.positions() == mesh.positions);
}
