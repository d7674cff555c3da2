//! What an action does: it changes the window's own state, or it becomes a request.

use super::colours;
use super::cube;
use super::modal;
use super::state::action::{self, Action};
use super::state::region::{RegionPurpose, RegionShape};
use super::state::{
    HintsFollowed, ModalSetting, NextSculpture, SCALE, SearchBox, UiRequest, UiState, View,
};
use crate::look::{Light, MATERIALS, Map};
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;

/// Does what an action says, or hands it on.
pub fn act(
    action: Action,
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    out: &mut Vec<UiRequest>,
) {
    // Two keys in one frame: the second goes on from the first.
    let asked = out.iter().rev().find_map(|a| match a {
        UiRequest::World(Command::Brush(b)) => Some(*b),
        _ => None,
    });
    let brush = asked.unwrap_or(view.state.brush);
    if let Some(command) = action::on_brush(action, brush) {
        out.push(UiRequest::World(command));
        return;
    }
    let mut camera = view.camera;
    if let Some((yaw, pitch)) = cube::side(action, &camera) {
        (camera.yaw, camera.pitch) = (yaw, pitch);
        out.push(UiRequest::Camera(camera));
        return;
    }
    match action {
        Action::Frame => {
            let state = view.state;
            let (lo, hi) = state.transform().bounds(state.mesh.bounds());
            if lo.cmple(hi).all() {
                camera.frame(lo, hi);
                out.push(UiRequest::Camera(camera));
            }
        }
        Action::Perspective => {
            camera.orthographic = !camera.orthographic;
            out.push(UiRequest::Camera(camera));
        }
        Action::Undo => {
            ui_state.prefs.hints.undone = true;
            out.push(UiRequest::World(Command::Undo));
        }
        Action::Redo => out.push(UiRequest::World(Command::Redo)),
        Action::DragRadius => modal::begin(ctx, view, ui_state, ModalSetting::Radius),
        Action::DragStrength => modal::begin(ctx, view, ui_state, ModalSetting::Strength),
        Action::SampleColour => colours::sample_at_pointer(ctx, out),
        Action::NextMaterial => {
            ui_state.look.material = (ui_state.look.material + 1) % MATERIALS.len();
            if ui_state.look.light == Light::Matcap {
                ui_state.look.light = Light::Studio;
            }
        }
        Action::Facets => ui_state.look.flat = !ui_state.look.flat,
        Action::Shadows => {
            ui_state.look.shadow = if ui_state.look.shadow > 0.0 { 0.0 } else { 0.7 }
        }
        Action::Ssao => ui_state.look.shade = if ui_state.look.shade > 0.0 { 0.0 } else { 1.0 },
        Action::Wireframe => ui_state.look.wireframe = !ui_state.look.wireframe,
        Action::Grid => ui_state.look.grid = !ui_state.look.grid,
        Action::Thickness => toggle(&mut ui_state.look.map, Map::Thickness),
        Action::Gap => toggle(&mut ui_state.look.map, Map::Gap),
        Action::Distance => toggle(&mut ui_state.look.map, Map::Distance),
        Action::Overhang => toggle(&mut ui_state.look.map, Map::Overhang),
        Action::DraftAngle => toggle(&mut ui_state.look.map, Map::Draft),
        Action::TrimBox => ui_state.region.begin(RegionShape::Box, RegionPurpose::Trim),
        Action::TrimLine => ui_state.region.begin(RegionShape::Line, RegionPurpose::Trim),
        Action::RegionLasso => ui_state.region.begin_shape(RegionShape::Lasso),
        Action::RegionBox => ui_state.region.begin_shape(RegionShape::Box),
        Action::RegionLine => ui_state.region.begin_shape(RegionShape::Line),
        Action::RegionPolyline => ui_state.region.begin_shape(RegionShape::Polyline),
        Action::RegionMask => ui_state.region.begin_for(RegionPurpose::Mask),
        Action::RegionUnmask => ui_state.region.begin_for(RegionPurpose::Unmask),
        Action::RegionHide => ui_state.region.begin_for(RegionPurpose::Hide),
        Action::RegionIsolate => ui_state.region.begin_for(RegionPurpose::Isolate),
        Action::RegionFaceSet => ui_state.region.begin_for(RegionPurpose::FaceSet),
        Action::TryAdd => ui_state.trial.turn(MenuItem::Add),
        Action::TryCut => ui_state.trial.turn(MenuItem::Carve),
        Action::TryKeep => ui_state.trial.turn(MenuItem::Keep),
        Action::Finer => out.push(UiRequest::Level(true)),
        Action::Coarser => out.push(UiRequest::Level(false)),
        Action::Remesh if !ui_state.joining => out.push(UiRequest::Remesh(ui_state.remesh)),
        Action::Mask => toggle(&mut ui_state.look.map, Map::Mask),
        Action::Search => {
            ui_state.search = ui_state.search.take().is_none().then(SearchBox::default)
        }
        Action::Panels => ui_state.hidden = !ui_state.hidden,
        Action::LightOrDark => ui_state.prefs.light = !ui_state.prefs.light,
        Action::LargerText => ui_state.prefs.scale = (ui_state.prefs.scale + 0.1).min(SCALE.1),
        Action::SmallerText => ui_state.prefs.scale = (ui_state.prefs.scale - 0.1).max(SCALE.0),
        Action::Help => ui_state.help = !ui_state.help,
        Action::Keys => ui_state.keys.open = !ui_state.keys.open,
        Action::Page(tab) => (ui_state.tab, ui_state.hidden) = (tab, false),
        Action::Brush(kind) if kind != brush.kind => {
            let taken = view.presets.recalled(&brush, &view.state.kept_brushes, kind);
            out.push(UiRequest::World(Command::Brush(taken.clamped())));
        }
        Action::Lesson => ui_state.prefs.hints = HintsFollowed::default(),
        Action::New => out.push(UiRequest::OpenNext(NextSculpture::New)),
        Action::OpenMesh
        | Action::Export
        | Action::Screenshot
        | Action::Turntable
        | Action::FourViews => out.push(UiRequest::Do(action)),
        // Of the brush and of the six sides: done above.
        _ => {}
    }
    ctx.request_repaint();
}

fn toggle(map: &mut Map, to: Map) {
    *map = if *map == to { Map::None } else { to };
}
