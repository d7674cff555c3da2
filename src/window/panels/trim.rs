//! Trimming: a box or a line drawn over the view, and what lies in it or to its left is cut off,
//! all the way through.

use egui::{Color32, Key, Pos2, Rect, Sense, Stroke, vec2};

use super::rows;
use super::state::{Trim, TrimShape, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_daemon::trim::Part;

/// Points below which a drag was a slip of the hand.
const SLIP: f32 = 4.0;

/// The buttons.
pub fn buttons(ui: &mut egui::Ui, ui_state: &mut UiState) {
    ui.strong(tr!("trim-heading"));
    rows::flow(ui, |ui| {
        for (shape, name, tip) in [
            (TrimShape::Box, tr!("trim-box"), tr!("trim-box.tip")),
            (TrimShape::Line, tr!("trim-line"), tr!("trim-line.tip")),
        ] {
            let on = ui_state.trim.is_some_and(|t| t.shape == shape);
            if ui
                .add_enabled(!ui_state.joining, egui::Button::selectable(on, name))
                .on_hover_text(tip)
                .clicked()
            {
                ui_state.trim = (!on).then_some(Trim { shape, from: None });
            }
        }
    });
    if ui_state.trim.is_some() {
        ui.colored_label(theme::quiet(ui), tr!("trim-note"));
    }
}

/// The part of the view that a drag means; the view fills the free part of the window.
pub fn part(shape: TrimShape, free: Rect, from: Pos2, to: Pos2) -> Option<Part> {
    let share = |p: Pos2| {
        let d = (p - free.min) / free.size();
        [d.x.clamp(0.0, 1.0), d.y.clamp(0.0, 1.0)]
    };
    let way = to - from;
    let enough = match shape {
        TrimShape::Box => way.x.abs().min(way.y.abs()) > SLIP,
        TrimShape::Line => way.length() > SLIP,
    };
    let ([x0, y0], [x1, y1]) = (share(from), share(to));
    enough.then_some(match shape {
        TrimShape::Box => Part::Box([x0, y0, x1, y1]),
        TrimShape::Line => Part::Line([x0, y0, x1, y1]),
    })
}

/// The drag itself: the clay does not feel it.
pub fn ui(ctx: &egui::Context, ui_state: &mut UiState, free: Rect, out: &mut Vec<UiRequest>) {
    let Some(mut trim) = ui_state.trim else { return };
    if ctx.input(|i| i.key_pressed(Key::Escape)) {
        ui_state.trim = None;
        return;
    }
    let area =
        egui::Area::new(egui::Id::unique("trim")).fixed_pos(free.min).order(egui::Order::Middle);
    area.show(ctx, |ui| {
        let (_, response) = ui.allocate_exact_size(free.size(), Sense::drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Canvas, true, tr!("trim-heading"))
        });
        if response.drag_started() {
            trim.from = ctx.input(|i| i.pointer.press_origin());
        }
        let at = ctx.input(|i| i.pointer.latest_pos());
        let painter = ui.painter().clone().with_clip_rect(free);
        let stroke = Stroke::new(1.5, Color32::from_rgb(255, 150, 120));
        let cut = Color32::from_rgba_unmultiplied(255, 110, 80, 40);
        if let (Some(from), Some(to)) = (trim.from, at) {
            match trim.shape {
                TrimShape::Box => {
                    let rect = Rect::from_two_pos(from, to);
                    painter.rect(rect, 0.0, cut, stroke, egui::StrokeKind::Middle);
                }
                TrimShape::Line => {
                    let along = (to - from).normalized();
                    // y runs down: to the left as one goes.
                    let left = vec2(along.y, -along.x) * 60.0;
                    let (a, b) = (from - along * 9000.0, to + along * 9000.0);
                    let side = vec![a, b, b + left, a + left];
                    painter.add(egui::Shape::convex_polygon(side, cut, Stroke::NONE));
                    painter.line_segment([a, b], stroke);
                }
            }
            if response.drag_stopped() {
                match part(trim.shape, free, from, to) {
                    Some(part) => {
                        out.push(UiRequest::Trim(part));
                        ui_state.trim = None;
                        return;
                    }
                    None => trim.from = None,
                }
            }
        }
        ui_state.trim = Some(trim);
    });
}

/// The levels of detail: coarser to shape, finer for detail.
pub fn levels(ui: &mut egui::Ui, view: &View<'_>, ui_state: &UiState, out: &mut Vec<UiRequest>) {
    ui.strong(tr!("levels-heading"));
    let (at, of) = view.state.mesh.levels().map_or((0, 1), |l| l.at());
    let n = view.state.mesh.triangle_count();
    ui.colored_label(theme::quiet(ui), tr!("levels-at", at = at + 1, all = of, count = n));
    rows::flow(ui, |ui| {
        let button = egui::Button::new(tr!("levels-coarser"));
        let coarser = ui.add_enabled(at > 0 && !ui_state.joining, button);
        if coarser.on_hover_text(tr!("levels-coarser.tip")).clicked() {
            out.push(UiRequest::Level(false));
        }
        let finer = ui.add_enabled(!ui_state.joining, egui::Button::new(tr!("levels-finer")));
        let tip = if at + 1 < of { tr!("levels-finer.back") } else { tr!("levels-finer.tip") };
        if finer.on_hover_text(tip).clicked() {
            out.push(UiRequest::Level(true));
        }
    });
}
