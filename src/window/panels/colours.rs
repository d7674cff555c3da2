//! The colour of the brush: chosen, taken from the surface, or one that was kept.

use egui::{Color32, Id, Key, PointerButton, Rect, Sense, vec2};

use super::rows;
use super::state::{Action, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::BrushSettings;

/// Side of a colour that was kept, points.
const SIDE: f32 = 20.0;

/// Shows the active colour and the saved ones.
pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, brush: &mut BrushSettings) {
    let likes = &mut ui_state.prefs.brushes;
    rows::flow(ui, |ui| {
        let button = ui.color_edit_button_srgba_unmultiplied(&mut brush.colour);
        let label = ui.label(tr!("dab-colour"));
        button.labelled_by(label.id);
        let sample = egui::Button::selectable(ui_state.brush_panel.samples, tr!("colour-sample"));
        let tip = tr!("colour-sample.tip", action = view.tip(Action::SampleColour));
        if ui.add(sample).on_hover_text(tip).clicked() {
            ui_state.brush_panel.samples ^= true;
        }
        if ui.button(tr!("colour-keep")).on_hover_text(tr!("colour-keep.tip")).clicked() {
            likes.keep(brush.colour);
        }
    });
    if likes.colours.is_empty() {
        return;
    }
    let mut forgotten = None;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        for (i, colour) in likes.colours.iter().enumerate() {
            let response = swatch(ui, *colour, *colour == brush.colour);
            if response.clicked() {
                brush.colour = *colour;
            }
            if response.secondary_clicked() {
                forgotten = Some(i);
            }
        }
    });
    if let Some(i) = forgotten {
        likes.colours.remove(i);
    }
}

/// A colour that was kept, as a button.
fn swatch(ui: &mut egui::Ui, [r, g, b, a]: [u8; 4], chosen: bool) -> egui::Response {
    let code = format!("#{r:02x}{g:02x}{b:02x}");
    let name = tr!("colour-swatch", code = code.as_str());
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), chosen, &name)
    });
    let fill = Color32::from_rgba_unmultiplied(r, g, b, a);
    let line = match chosen || response.hovered() || response.has_focus() {
        true => egui::Stroke::new(2.0, theme::accent(ui)),
        false => ui.visuals().widgets.inactive.bg_stroke,
    };
    ui.painter().rect(rect, 3.0, fill, line, egui::StrokeKind::Inside);
    response.on_hover_text(tr!("colour-swatch.tip", code = code))
}

/// Takes the colour where the pointer is.
pub fn sample_at_pointer(ctx: &egui::Context, out: &mut Vec<UiRequest>) {
    if let Some(at) = ctx.input(|i| i.pointer.latest_pos()) {
        out.push(UiRequest::SampleColour(at));
    }
}

/// While the next click is to take a colour, it is no stroke: it is taken here. Escape and the
/// other button leave the colour as it is.
pub fn sampler(ctx: &egui::Context, ui_state: &mut UiState, free: Rect, out: &mut Vec<UiRequest>) {
    let panel = &mut ui_state.brush_panel;
    if !panel.samples {
        return;
    }
    let area = egui::Area::new(Id::unique("colour sampler")).fixed_pos(free.min);
    let response = area
        .order(egui::Order::Middle)
        .show(ctx, |ui| {
            let (_, response) = ui.allocate_exact_size(free.size(), Sense::click());
            response.on_hover_cursor(egui::CursorIcon::Crosshair)
        })
        .inner;
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Canvas, true, tr!("colour-sample-here"))
    });
    if response.clicked_by(PointerButton::Primary)
        && let Some(at) = response.interact_pointer_pos()
    {
        out.push(UiRequest::SampleColour(at));
        panel.samples = false;
    }
    let escape = !ctx.text_edit_focused() && ctx.input(|i| i.key_pressed(Key::Escape));
    if escape || response.secondary_clicked() {
        panel.samples = false;
    }
}
