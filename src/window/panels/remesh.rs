//! Remeshing, of the whole object by voxels and of a part of it in place: how fine, and the
//! buttons.

use super::state::Action;
use super::state::region::RegionPurpose;
use super::state::{UiRequest, UiState, View};
use super::theme;
use super::{region, rows};
use crate::language::tr;
use sculptd_daemon::remesh_job::SIDE;
use sculptd_engine::local_remesh::{LocalRemesh, WantedEdge};

/// First custom voxel size, as the number of voxels along the longest side.
const FIRST: f32 = 200.0;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.strong(tr!("remesh-heading"));
    let (lo, hi) = view.state.mesh.bounds();
    let longest = (hi - lo).max_element().max(f32::MIN_POSITIVE);
    let wanted = &mut ui_state.remesh;
    let mut own = wanted.voxel.is_some();
    ui.checkbox(&mut own, tr!("remesh-own")).on_hover_text(tr!("remesh-own.tip"));
    if own {
        let voxel = wanted.voxel.get_or_insert(longest / FIRST);
        let range = longest / SIDE.1 as f32..=longest / SIDE.0 as f32;
        let slider = egui::Slider::new(voxel, range).logarithmic(true);
        rows::slider(ui, slider, &tr!("remesh-voxel"));
        let along = (longest / *voxel).round();
        ui.colored_label(theme::quiet(ui), tr!("remesh-along", count = along));
    } else {
        wanted.voxel = None;
    }
    ui.checkbox(&mut wanted.sharp, tr!("remesh-sharp"));
    let wanted = *wanted;
    let button = ui.add_enabled(!ui_state.joining, egui::Button::new(tr!("remesh-button")));
    let tip = tr!("remesh-button.tip", keys = view.keys.text(Action::Remesh));
    if button.on_hover_text(tip).clicked() {
        out.push(UiRequest::Remesh(wanted));
    }
    ui.add_space(8.0);
    local(ui, view, ui_state, out);
}

/// Triangles of one size where the surface was stretched, or in a region.
fn local(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.strong(tr!("remesh-local-heading"));
    let slider = egui::Slider::new(&mut ui_state.region.edge, 0.25..=4.0).logarithmic(true);
    rows::slider(ui, slider.suffix("×"), &tr!("remesh-local-edge"))
        .on_hover_text(tr!("remesh-local-edge.tip"));
    let button = ui.add_enabled(!ui_state.joining, egui::Button::new(tr!("remesh-stretched")));
    if button.on_hover_text(tr!("remesh-stretched.tip")).clicked() {
        let edge = WantedEdge::OfUsual(ui_state.region.edge);
        let asked = LocalRemesh { edge, stretched_only: true, region: None };
        out.push(UiRequest::RemeshLocal(asked));
    }
    let tip = tr!("remesh-local-undo", keys = view.keys.text(Action::Undo));
    ui.colored_label(theme::quiet(ui), tip);
    region::buttons(ui, &mut ui_state.region, RegionPurpose::Remesh);
}
