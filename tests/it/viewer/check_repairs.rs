//! Repairs on the Check page: the button of a finding, a flat base, a split.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use sculptd_check::repair::holes::SealedKind;
use sculptd_daemon::repair_jobs::{RepairRequest, WantedRepair};
use sculptd_geometry::TriMesh;
use sculptd_geometry::shapes::cuboid;
use sculptd_window::panels::{Tab, UiRequest};

use super::check::{found, library, world_of};
use super::panels::{State, show, state};

/// A cube with a cavity.
fn hollow() -> TriMesh {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(40.0)).triangulate().0;
    let inner = cuboid(DVec3::splat(3.0), DVec3::splat(37.0)).triangulate().0;
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&inner.positions);
    mesh.triangles.extend(inner.triangles.iter().map(|t| [t[0], t[2], t[1]].map(|v| v + base)));
    mesh
}

fn asked(h: &Harness<'_, State>) -> Vec<RepairRequest> {
    let of = |a: &UiRequest| match a {
        UiRequest::Repair(request) => Some(request.clone()),
        _ => None,
    };
    h.state().asked.iter().filter_map(of).collect()
}

#[test]
fn a_finding_is_repaired_by_its_button_and_the_page_asks_for_a_base_and_a_split() {
    let mut world = world_of(&hollow());
    let published = super::published(&mut world);
    let mut s = state(Tab::Check);
    s.ui_state.check.library = library();
    s.ui_state.check.choose_process("sla");
    let result = found(&published, &s.ui_state.check.choice);
    s.published = published;
    s.ui_state.check.found = Some(Box::new(result));
    let mut h =
        Harness::builder().with_size([1280.0, 1800.0]).with_max_steps(64).build_ui_state(show, s);
    h.run_steps(3);
    h.get_by_label("Drain").click();
    h.run_steps(2);
    let all = asked(&h);
    let [RepairRequest { repair: WantedRepair::Holes { kind, near, .. }, up, plate }] = all[..]
    else {
        panic!("{all:?}")
    };
    assert_eq!((kind, up, plate), (SealedKind::Trapped, DVec3::Y, true));
    let near = near.expect("the place of the finding");
    assert!(near.distance(DVec3::splat(20.0)) < 0.1, "{near}");
    h.get_by_label("Repairs").click();
    h.run_steps(8);
    h.get_by_label("Flat base").click();
    h.run_steps(2);
    assert!(matches!(asked(&h)[1].repair, WantedRepair::Base(height) if height == 0.5));
    h.get_by_label("Split").click();
    h.run_steps(2);
    let WantedRepair::Split(plane, pegs) = asked(&h)[2].repair else {
        panic!("{:?}", asked(&h)[2])
    };
    assert!((plane.point.y - 20.0).abs() < 1e-3 && plane.normal == DVec3::Y && pegs.most == 4);
    h.get_by_label("Add draft").click();
    h.run_steps(2);
    assert!(matches!(asked(&h)[3].repair, WantedRepair::Draft(angle) if angle == 1.5));
    h.get_by_label("Thicken").click();
    h.run_steps(2);
    assert!(matches!(asked(&h)[4].repair, WantedRepair::Thicken(wall) if wall == 1.2));
    h.state_mut().ui_state.check.repairs.text = "No. 7".into();
    h.run_steps(2);
    h.get_by_label("Add text").click();
    h.run_steps(2);
    let all = asked(&h);
    let WantedRepair::Text(text) = &all[5].repair else { panic!("{all:?}") };
    assert!(text.text == "No. 7" && text.along.is_some() && text.relief == 0.6, "{text:?}");
    // While another change is under way nothing is asked for.
    h.state_mut().ui_state.joining = true;
    h.run_steps(2);
    h.get_by_label("Drain").click();
    h.run_steps(2);
    assert_eq!(asked(&h).len(), 6);
}
