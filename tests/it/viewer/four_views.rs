//! Four views: their names over the clay, and what is sent to draw them beside one.

use egui_kittest::kittest::Queryable;
use glam::Vec3;
use sculptd_engine::camera::Camera;
use sculptd_window::look::Look;
use sculptd_window::panels::state::{Action, ViewKind, Views};
use sculptd_window::panels::{Tab, UiRequest};
use sculptd_window::viewer::picture::Painter;
use sculptd_window::viewer::renderer::Scene;

use super::panels::harness;
use super::pictures::{dab, framed, painter};
use crate::clay::sphere;

/// Four views of a ball, and the camera of the one in which is worked.
fn four(camera: Camera) -> Views {
    let mut views = Views::default();
    views.show_four(&camera, Vec3::splat(-1.0), Vec3::splat(1.0));
    views
}

#[test]
fn a_press_of_a_name_shows_that_view_alone() {
    let mut h = harness(Tab::Look);
    assert!(h.query_by_label("From above").is_none(), "one view has no name");
    let camera = h.state().published.camera;
    h.state_mut().views = four(camera);
    h.run_steps(4);
    for (name, kind) in [
        ("From above", ViewKind::Top),
        ("Free", ViewKind::Free),
        ("From the front", ViewKind::Front),
        ("From the right", ViewKind::Right),
    ] {
        h.get_by_label(name).click();
        h.run_steps(4);
        let asked = std::mem::take(&mut h.state_mut().asked);
        let shows = |a: &UiRequest| matches!(a, UiRequest::ShowView(k) if *k == kind);
        assert!(asked.iter().any(shows), "{name}: {asked:?}");
    }
    // The page of the camera has the four as well.
    h.get_by_label("Four views").click();
    h.run_steps(4);
    let asked = &h.state().asked;
    assert!(asked.iter().any(|a| matches!(a, UiRequest::Do(Action::FourViews))), "{asked:?}");
}

#[test]
fn four_views_are_drawn_from_pages_that_are_sent_once() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = sphere(60_000);
    dab(&mut mesh, 0.3);
    let camera = framed(&mesh, 1.2);
    let views = four(camera);
    let snapshot = mesh.snapshot();
    let paint = |painter: &mut Painter, camera: &Camera, size: (u32, u32)| {
        let scene = Scene {
            mesh: &snapshot,
            camera,
            brush: None,
            lines: &[],
            look: Look::default(),
            values: None,
            beside: Default::default(),
        };
        let picture = painter.paint(&scene, size.0, size.1).expect("a picture");
        (picture, painter.renderer().uploaded)
    };
    let all = (480, 400);
    let half = (240, 200);
    paint(&mut painter, &camera, all);
    let mut pictures = Vec::new();
    for kind in ViewKind::ALL {
        let camera = views.camera(kind, &camera);
        let (picture, sent) = paint(&mut painter, &camera, half);
        assert_eq!(sent, 0, "the pages of {kind:?} are there already");
        assert!(!pictures.contains(&picture), "{kind:?} is like another");
        pictures.push(picture);
    }
}
