//! The page of files: opening by name, and exporting with scale and unit, never over a file that
//! nobody agreed to replace.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::panels::{State, harness};
use sculptd_window::panels::{Tab, UiRequest};

#[test]
fn files_are_opened_by_name_and_exported_with_scale_and_unit() {
    let mut h = harness(Tab::Files);
    h.state_mut().ui_state.files.open = "/some/mesh.obj".into();
    h.state_mut().ui_state.files.scale = 2.0;
    h.state_mut().ui_state.files.unit = 1;
    h.run_steps(2);
    // A ball of radius 1, twice as large, in centimetres.
    assert!(h.query_by_label_contains("0.400 x 0.400 x 0.400 cm").is_some());
    h.get_by_role_and_label(Role::Button, "Open").click();
    h.run_steps(2);
    h.get_by_role_and_label(Role::Button, "Export").click();
    h.run_steps(2);
    let asked = &h.state().asked;
    assert!(matches!(&asked[0], UiRequest::OpenMesh(p) if p.ends_with("mesh.obj")), "{asked:?}");
    assert!(matches!(&asked[1], UiRequest::Export(p) if p.ends_with("sculpture.stl")), "{asked:?}");
}

#[test]
fn an_export_asks_before_it_replaces_a_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("mine.stl");
    std::fs::File::create(&path).expect("a file");
    let mut h = harness(Tab::Files);
    h.state_mut().ui_state.files.export = path.display().to_string();
    h.run_steps(3);
    let exports = |h: &Harness<'_, State>| {
        let of = |a: &&UiRequest| matches!(a, UiRequest::Export(p) if *p == path);
        h.state().asked.iter().filter(of).count()
    };
    h.get_by_role_and_label(Role::Button, "Export").click();
    h.run_steps(4);
    assert_eq!(exports(&h), 0, "the file is there");
    h.get_by_label_contains("exists. Replace it?");
    h.get_by_label("Cancel").click();
    h.run_steps(4);
    assert_eq!(exports(&h), 0);
    assert!(h.query_by_label("Replace").is_none());
    h.get_by_role_and_label(Role::Button, "Export").click();
    h.run_steps(4);
    h.get_by_label("Replace").click();
    h.run_steps(4);
    assert_eq!(exports(&h), 1);
}
