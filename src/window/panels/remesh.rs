//! Voxel remeshing: how fine, and the button.

use super::state::{UiRequest, UiState, View};
use super::theme;
use sculptd_daemon::remesh_job::SIDE;

/// What a first voxel is when a person wants one of their own: so many along the longest side.
const FIRST: f32 = 200.0;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.strong("Remesh");
    let (lo, hi) = view.state.mesh.bounds();
    let longest = (hi - lo).max_element().max(f32::MIN_POSITIVE);
    let wanted = &mut ui_state.remesh;
    let mut own = wanted.voxel.is_some();
    ui.checkbox(&mut own, "Voxel of my own").on_hover_text(
        "Otherwise the new triangles are about as large as those that are there now",
    );
    if own {
        let voxel = wanted.voxel.get_or_insert(longest / FIRST);
        let range = longest / SIDE.1 as f32..=longest / SIDE.0 as f32;
        ui.add(egui::Slider::new(voxel, range).logarithmic(true).text("voxel"));
        let along = (longest / *voxel).round();
        ui.colored_label(theme::quiet(ui), format!("{along:.0} along the longest side"));
    } else {
        wanted.voxel = None;
    }
    ui.checkbox(&mut wanted.sharp, "Keep sharp edges");
    let wanted = *wanted;
    let button = ui.add_enabled(!ui_state.joining, egui::Button::new("Remesh"));
    let tip = "One surface of even triangles; overlapping parts become one. Ctrl+R";
    if button.on_hover_text(tip).clicked() {
        out.push(UiRequest::Remesh(wanted));
    }
}
