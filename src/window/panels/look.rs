//! How the clay is shown.

use super::state::{Action, UiRequest, UiState, View};
use super::{cut, light, rows};
use crate::language::tr;
use crate::look::Map;

pub fn ui(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>, view: &View<'_>) {
    light::materials(ui, ui_state);
    light::lights(ui, ui_state, view);
    let look = &mut ui_state.look;
    rows::slider(ui, egui::Slider::new(&mut look.cavity, 0.0..=2.0), &tr!("look-cavity"))
        .on_hover_text(tr!("look-cavity.tip"));
    rows::slider(ui, egui::Slider::new(&mut look.shade, 0.0..=2.0), &tr!("look-occlusion"))
        .on_hover_text(tr!("look-occlusion.tip", action = view.tip(Action::Ssao)));
    rows::flow(ui, |ui| {
        for (on, name, action) in [
            (&mut look.flat, "look-facets", Action::Facets),
            (&mut look.wireframe, "look-wireframe", Action::Wireframe),
            (&mut look.grid, "look-grid", Action::Grid),
        ] {
            ui.checkbox(on, tr!(name)).on_hover_text(view.tip(action));
        }
    });
    ui.checkbox(&mut ui_state.prefs.smooth_edges, tr!("look-smooth-edges"))
        .on_hover_text(tr!("look-smooth-edges.tip"));
    rows::heading(ui, &tr!("look-map"));
    rows::flow(ui, |ui| {
        for (map, tip) in [
            (Map::None, tr!("map-none.tip")),
            (Map::Mask, view.tip(Action::Mask)),
            (Map::Thickness, view.tip(Action::Thickness)),
            (Map::Gap, view.tip(Action::Gap)),
            (Map::Distance, view.tip(Action::Distance)),
            (Map::Overhang, view.tip(Action::Overhang)),
            (Map::Draft, view.tip(Action::DraftAngle)),
        ] {
            ui.selectable_value(&mut ui_state.look.map, map, tr!(map.title())).on_hover_text(tip);
        }
    });
    cut::ui(ui, ui_state, view);
    light::reference(ui, ui_state);
    rows::heading(ui, &tr!("look-camera"));
    let mut camera = view.camera;
    ui.checkbox(&mut camera.orthographic, tr!("look-orthographic"))
        .on_hover_text(view.tip(Action::Perspective));
    let mut four = view.views.are_four();
    let box_of_four = ui.checkbox(&mut four, tr!("look-four-views"));
    if box_of_four.on_hover_text(view.tip(Action::FourViews)).changed() {
        out.push(UiRequest::Do(Action::FourViews));
    }
    let mut degrees = camera.fov_y.to_degrees();
    ui.add_enabled_ui(!camera.orthographic, |ui| {
        rows::slider(ui, egui::Slider::new(&mut degrees, 10.0..=100.0), &tr!("look-angle"))
            .on_hover_text(tr!("look-angle.tip"));
    });
    if (degrees - camera.fov_y.to_degrees()).abs() > 0.01 {
        camera.fov_y = degrees.to_radians();
    }
    if ui.button(Action::Frame.title()).on_hover_text(view.tip(Action::Frame)).clicked() {
        super::act::act(Action::Frame, &ui.ctx().clone(), view, ui_state, out);
    }
    super::kept_views::ui(ui, view, ui_state, out);
    if camera != view.camera {
        out.push(UiRequest::Camera(camera));
    }
}
