//! Drawings beside the clay: shaded hollows, the preview of a Boolean, the balls of the hand menu;
//! and views that follow the clay off to the side.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};
use image::RgbaImage;
use sculptd_clay::{Clay, Snapshot};
use sculptd_engine::camera::Camera;
use sculptd_engine::hand::{HeldObject, MenuItem, Similarity};
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::job::Job;
use sculptd_geometry::projection::svg;
use sculptd_geometry::{TriMesh, shapes};

use sculptd_window::look::Look;
use sculptd_window::viewer::distance_field::{DistanceField, DistanceRequest, measure};
use sculptd_window::viewer::distance_reference::DistanceReference;
use sculptd_window::viewer::overlay_mesh::Triangles;
use sculptd_window::viewer::picture::Painter;
use sculptd_window::viewer::preview;
use sculptd_window::viewer::preview::{Preview, PreviewRequest};
use sculptd_window::viewer::renderer::{Beside, Scene};
use sculptd_window::viewer::tasks::TaskReport;

use super::pictures::{dab, framed, painter};
use crate::clay::sphere;

fn drawn(
    painter: &mut Painter,
    mesh: &Snapshot,
    camera: &Camera,
    look: Look,
    beside: Beside<'_>,
) -> RgbaImage {
    let scene = Scene { mesh, camera, brush: None, lines: &[], look, values: None, beside };
    painter.paint(&scene, 200, 200).expect("a picture")
}

fn light(p: &RgbaImage, x: u32, y: u32) -> f32 {
    p.get_pixel(x, y).0[..3].iter().map(|c| f32::from(*c)).sum()
}

/// Two balls that run into each other, side by side.
fn two_balls() -> Clay {
    let one = shapes::sphere_of_about(6_000);
    let mut both = TriMesh::default();
    for x in [-0.8f32, 0.8] {
        let first = both.positions.len() as u32;
        both.positions.extend(one.positions.iter().map(|p| *p + Vec3::X * x));
        both.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    Clay::build(&both, &Job::default()).expect("two balls build")
}

#[test]
fn a_fold_is_shaded_and_an_open_form_is_not() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = two_balls();
    for orthographic in [false, true] {
        let camera = Camera { yaw: 0.0, pitch: 0.0, orthographic, ..framed(&mesh, 1.0) };
        let snapshot = mesh.snapshot();
        let look = |shade| Look { shade, cavity: 0.0, ..Look::default() };
        let plain = drawn(&mut painter, &snapshot, &camera, look(0.0), Beside::default());
        let shaded = drawn(&mut painter, &snapshot, &camera, look(1.0), Beside::default());
        let share = |x, y| light(&shaded, x, y) / light(&plain, x, y);
        // The fold in the middle; the front of the left one; the ground.
        let (fold, open, ground) = (share(100, 100), share(52, 100), share(3, 3));
        println!("orthographic {orthographic}: fold {fold:.2}, open {open:.2}, ground {ground:.2}");
        assert!(fold < 0.82, "{fold}");
        assert!(open > 0.93, "{open}");
        assert!((ground - 1.0).abs() < 0.01, "{ground}");
        assert!(share(100, 100) < share(80, 100), "it fades away from the fold");
    }
}

fn thing(at: Vec3) -> HeldObject {
    let place = Similarity { shift: at, scale: 0.5, ..Similarity::NONE };
    HeldObject { plain: Arc::new(shapes::sphere_of_about(2_000)), place }
}

fn tried(mesh: &mut Clay, at: Vec3, choice: MenuItem) -> Arc<Preview> {
    let wanted = PreviewRequest { mesh: mesh.snapshot(), thing: thing(at), choice };
    let found = preview::compute(&wanted, &Job::default()).expect("a join");
    Arc::new(found.expect("the choice joins"))
}

#[test]
fn what_a_join_would_make_is_drawn_where_it_is_and_nowhere_else() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = sphere(20_000);
    let camera = Camera { yaw: 0.0, pitch: 0.0, ..framed(&mesh, 1.0) };
    let look = Look { shade: 0.0, ..Look::default() };
    let clay = drawn(&mut painter, &mesh.snapshot(), &camera, look, Beside::default());
    for (choice, local) in [(MenuItem::Add, true), (MenuItem::Carve, true), (MenuItem::Keep, false)]
    {
        let preview = tried(&mut mesh, Vec3::Z, choice);
        assert_eq!(preview.hidden.is_some(), local, "{choice:?}");
        assert!(preview.made > 100, "{choice:?}: {} triangles of the thing", preview.made);
        let beside = Beside { preview: Some(&preview), ..Beside::default() };
        let shown = drawn(&mut painter, &mesh.snapshot(), &camera, look, beside);
        let (before, now) = (clay.get_pixel(100, 100).0, shown.get_pixel(100, 100).0);
        // For an intersection, the clay's surface is in front.
        assert_eq!(
            before == now,
            choice == MenuItem::Keep,
            "{choice:?}: the thing's own surface, in another tone"
        );
        // Up at the rim: the clay as it was, or nothing of it where only what both have stays.
        let rim = (100, 60);
        let (was, is) = (light(&clay, rim.0, rim.1), light(&shown, rim.0, rim.1));
        assert_eq!((was - is).abs() < 12.0, local, "{choice:?}: {was} and {is}");
    }
    // Off again: the clay, to the bit.
    let again = drawn(&mut painter, &mesh.snapshot(), &camera, look, Beside::default());
    assert!(again == clay);
}

#[test]
fn a_preview_that_is_no_longer_wanted_ends() {
    let mut mesh = sphere(20_000);
    let job = Job::default();
    job.cancel();
    let wanted =
        PreviewRequest { mesh: mesh.snapshot(), thing: thing(Vec3::Z), choice: MenuItem::Keep };
    let ended = preview::compute(&wanted, &job);
    assert!(
        matches!(ended, Err(sculptd_geometry::boolean::BooleanError::Cancelled(_))),
        "{ended:?}"
    );
}

#[test]
fn balls_are_seen_through_and_the_one_in_use_stands_out() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = sphere(8_000);
    let camera = Camera { yaw: 0.0, pitch: 0.0, ..framed(&mesh, 1.0) };
    let look = Look { shade: 0.0, ..Look::default() };
    let clay = drawn(&mut painter, &mesh.snapshot(), &camera, look, Beside::default());
    let mut balls = Triangles::default();
    balls.ball(Vec3::new(0.0, 0.4, 1.2), 0.15, [120, 165, 225, 120]);
    balls.ball(Vec3::new(0.0, -0.4, 1.2), 0.15, [255, 190, 70, 225]);
    // Behind the work: not seen.
    balls.ball(Vec3::new(0.0, 0.0, -1.2), 0.15, [255, 0, 0, 255]);
    let beside = Beside { overlay: Some(&balls), ..Beside::default() };
    let shown = drawn(&mut painter, &mesh.snapshot(), &camera, look, beside);
    let change = |x, y| (light(&clay, x, y) - light(&shown, x, y)).abs();
    let rows: Vec<u32> = (0..200).filter(|y| change(100, *y) > 8.0).collect();
    assert!(rows.iter().any(|y| *y < 90) && rows.iter().any(|y| *y > 110), "{rows:?}");
    assert!(change(100, 100) < 3.0, "what is behind the work is hidden by it");
}

#[test]
fn measures_and_the_shadow_of_a_box_are_exact() {
    let solid = shapes::cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 4.0));
    let mut mesh = Clay::build(&solid.triangulate().0, &Job::default()).expect("a box builds");
    let mut sizes = |transform| {
        let request = (mesh.snapshot(), transform, DVec3::NEG_Y);
        measure(&request, &Job::default()).expect("not cancelled")
    };
    let found = sizes(ObjectTransform::NONE);
    assert!((found.volume - 24.0).abs() < 1e-9 && (found.area - 52.0).abs() < 1e-9, "{found:?}");
    assert_eq!(found.dimensions, [2.0, 3.0, 4.0]);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert!(
        found.projected.iter().zip([12.0, 8.0, 6.0]).all(|(a, b)| near(*a, b)),
        "{:?}",
        found.projected
    );
    assert!(near(found.shadow, 8.0), "{}", found.shadow);
    let drawing = svg(&found.outline);
    assert!(drawing.starts_with("<svg") && drawing.matches("<path").count() == 1, "{drawing}");
    // The object stands far away, turned by a quarter about x, and is half as large again.
    let turn = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let placed = sizes(ObjectTransform { shift: DVec3::splat(1e6), turn, scale: 1.5 });
    assert!((placed.volume - 81.0).abs() < 1e-4, "{placed:?}");
    let wanted = [3.0, 6.0, 4.5];
    assert!(placed.dimensions.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{placed:?}");
    assert!((placed.shadow - 13.5).abs() < 1e-4, "{placed:?}");
}

#[test]
fn distances_follow_where_the_clay_changed_and_a_thing_where_it_goes() {
    let mut mesh = sphere(20_000);
    let before = mesh.snapshot();
    let (say, said) = crossbeam_channel::unbounded();
    let mut field = DistanceField::default();
    let mut measured = |mesh: &Snapshot, transform, to: DistanceReference| {
        let request = DistanceRequest { mesh: mesh.clone(), transform, to };
        assert!(field.follow(request, &Job::default(), &say));
        match said.try_iter().last() {
            Some(TaskReport::Distances(values, about)) => (values, about),
            other => panic!("{other:?}"),
        }
    };
    let at = |shift, scale| ObjectTransform { shift, scale, ..ObjectTransform::NONE };
    let mut last = |mesh: &Snapshot, to| measured(mesh, ObjectTransform::NONE, to);
    let (first, about) = last(&before, DistanceReference::Before(before.clone()));
    assert_eq!(about.known, (before.vertex_count(), before.vertex_count()));
    assert!(about.max.abs() < 1e-6 && about.min.abs() < 1e-6, "{about:?}");
    dab(&mut mesh, 0.3);
    let after = mesh.snapshot();
    let (second, about) = last(&after, DistanceReference::Before(before.clone()));
    // The dab raises by a fifth of its radius at most.
    assert!((0.04..0.0601).contains(&about.max), "{about:?}");
    assert!(about.min > -1e-4, "{about:?}");
    let mut changed = Vec::new();
    after.each_changed(&before, |i, _| changed.push(i as usize));
    assert!(!changed.is_empty() && changed.len() < after.page_count());
    for i in 0..after.page_count() {
        let same = Arc::ptr_eq(&first.pages[i], &second.pages[i]);
        assert_eq!(same, !changed.contains(&i), "page {i}");
    }
    // A ball of half the size in the middle: as far everywhere, but for what was raised.
    let (_, about) = last(&after, DistanceReference::HeldObject(thing(Vec3::ZERO)));
    assert!((about.min - 0.5).abs() < 2e-3 && (about.rms - 0.5).abs() < 0.02, "{about:?}");
    let (_, about) = last(&after, DistanceReference::HeldObject(thing(Vec3::X * 0.5)));
    assert!(about.min.abs() < 5e-3 && (about.max - 1.0).abs() < 0.02, "{about:?}");
    // Moving the object and doubling its size scales its distances too; a held object stays at its
    // place in the world.
    let placed = at(DVec3::X * 0.5, 2.0);
    let (_, about) = measured(&after, placed, DistanceReference::Before(before.clone()));
    assert!((0.08..0.1202).contains(&about.max), "{about:?}");
    let held = DistanceReference::HeldObject(thing(Vec3::X * 0.5));
    let (_, about) = measured(&after, placed, held);
    assert!((about.min - 1.5).abs() < 5e-3, "{about:?}");
}
