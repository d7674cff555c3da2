//! How the clay is shown.

use super::state::{Action, UiRequest, UiState, View};
use crate::look::{MATERIALS, Map};

pub fn ui(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>, view: &View<'_>) {
    let look = &mut ui_state.look;
    ui.strong("Material");
    ui.horizontal_wrapped(|ui| {
        for (i, m) in MATERIALS.iter().enumerate() {
            let [r, g, b] = m.base.map(|c| (c.powf(1.0 / 2.2) * 255.0) as u8);
            let (rect, response) =
                ui.allocate_exact_size(egui::vec2(26.0, 26.0), egui::Sense::click());
            response.widget_info(|| {
                egui::WidgetInfo::selected(
                    egui::Role::RadioButton,
                    true,
                    look.material == i,
                    m.name,
                )
            });
            let colour = egui::Color32::from_rgb(r, g, b);
            ui.painter().circle_filled(rect.center(), 11.0, colour);
            ui.painter().circle_filled(
                rect.center() - egui::vec2(4.0, 4.0),
                2.5,
                egui::Color32::from_white_alpha(110),
            );
            if look.material == i || response.hovered() || response.has_focus() {
                let stroke = egui::Stroke::new(2.0, ui.visuals().text_color());
                ui.painter().circle_stroke(rect.center(), 12.0, stroke);
            }
            if response.on_hover_text(m.name).clicked() {
                look.material = i;
            }
        }
    });
    ui.add_space(4.0);
    ui.checkbox(&mut look.flat, "Facets").on_hover_text(view.tip(Action::Facets));
    ui.add(egui::Slider::new(&mut look.cavity, 0.0..=2.0).text("Cavity"))
        .on_hover_text("Hollows darker, ridges lighter");
    ui.add(egui::Slider::new(&mut look.shade, 0.0..=2.0).text("Occlusion"))
        .on_hover_text(view.tip(Action::Ssao) + ": ambient occlusion in screen space");
    ui.checkbox(&mut look.wireframe, "Wireframe").on_hover_text(view.tip(Action::Wireframe));
    ui.checkbox(&mut look.grid, "Grid").on_hover_text(view.tip(Action::Grid));
    ui.checkbox(&mut ui_state.prefs.smooth_edges, "Smooth edges")
        .on_hover_text("Four samples a pixel; costs time where no graphics card draws");
    ui.add_space(8.0);
    ui.strong("Map");
    ui.horizontal_wrapped(|ui| {
        for (map, name, tip) in [
            (Map::None, "None", "The clay itself".to_owned()),
            (Map::Mask, "Mask", view.tip(Action::Mask)),
            (Map::Thickness, "Thickness", view.tip(Action::Thickness)),
            (Map::Distance, "Distance", view.tip(Action::Distance)),
        ] {
            ui.selectable_value(&mut ui_state.look.map, map, name).on_hover_text(tip);
        }
    });
    ui.add_space(8.0);
    ui.strong("Camera");
    let mut camera = view.camera;
    ui.checkbox(&mut camera.orthographic, "Orthographic")
        .on_hover_text(view.tip(Action::Perspective));
    let mut degrees = camera.fov_y.to_degrees();
    ui.add_enabled(
        !camera.orthographic,
        egui::Slider::new(&mut degrees, 10.0..=100.0).text("Angle"),
    )
    .on_hover_text("Field of view, degrees");
    if (degrees - camera.fov_y.to_degrees()).abs() > 0.01 {
        camera.fov_y = degrees.to_radians();
    }
    if ui.button("Frame the sculpture").on_hover_text(view.tip(Action::Frame)).clicked() {
        super::act::act(Action::Frame, &ui.ctx().clone(), view, ui_state, out);
    }
    if camera != view.camera {
        out.push(UiRequest::Camera(camera));
    }
}
