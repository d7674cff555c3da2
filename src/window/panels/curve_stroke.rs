//! A curve that is laid by its points: shown over the clay with its handles, and what can be done
//! with it. The pen or pointer itself lays, drags and adds them; see
//! [`sculptd_engine::stroke::curve_stroke`].

use egui::{Color32, Key, Pos2, Rect, Stroke};
use glam::Vec2;

use super::rows;
use super::state::{UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::{Grip, Method};
use sculptd_engine::command::Command;
use sculptd_engine::stroke::CurveAction;

/// Radius of a handle, points.
const HANDLE: f32 = 5.0;

/// The place on the screen of a point of the view, which fills the free part of the window.
pub fn place(free: Rect, view: Vec2) -> Pos2 {
    free.min + free.size() * egui::vec2(view.x, view.y)
}

/// The curve, its keys and its buttons.
pub fn ui(
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    free: Rect,
    out: &mut Vec<UiRequest>,
) {
    let (draft, brush) = (&view.state.draft, &view.state.brush);
    let lays = brush.kind.grip() == Grip::Surface && brush.path.method == Method::Curve;
    if draft.is_empty() {
        ui_state.handle = None;
        if lays {
            bar(ctx, free, |ui| {
                ui.colored_label(theme::quiet(ui), tr!("curve-note"));
            });
        }
        return;
    }
    ui_state.handle = draft.held().or(ui_state.handle).filter(|i| *i < draft.points().len());
    let aspect = view.camera.aspect;
    let layer = egui::LayerId::new(egui::Order::Background, egui::Id::unique("draft"));
    let painter = ctx.layer_painter(layer).with_clip_rect(free);
    let line: Vec<Pos2> =
        (0..=draft.pieces()).map(|k| place(free, draft.at(k, aspect).view)).collect();
    painter.add(egui::Shape::line(line.clone(), Stroke::new(4.0, Color32::from_black_alpha(110))));
    painter.add(egui::Shape::line(line, Stroke::new(1.8, Color32::from_rgb(255, 214, 120))));
    for (i, point) in draft.points().iter().enumerate() {
        let fill = match ui_state.handle {
            Some(h) if h == i => Color32::from_rgb(255, 150, 80),
            _ => Color32::from_rgb(255, 236, 190),
        };
        painter.circle(
            place(free, point.view),
            HANDLE,
            fill,
            Stroke::new(1.5, Color32::from_black_alpha(200)),
        );
    }
    let mut act = None;
    if !ctx.text_edit_focused() && ui_state.search.is_none() && ui_state.modal.is_none() {
        ctx.input(|i| {
            act = match () {
                () if i.key_pressed(Key::Enter) => Some(CurveAction::Apply),
                () if i.key_pressed(Key::Escape) => Some(CurveAction::Cancel),
                () if i.key_pressed(Key::Delete) || i.key_pressed(Key::Backspace) => {
                    ui_state.handle.map(CurveAction::Delete)
                }
                () => None,
            }
        });
    }
    bar(ctx, free, |ui| {
        ui.label(tr!("curve-points", count = draft.points().len()));
        if ui.button(tr!("curve-draw")).on_hover_text(tr!("curve-draw.tip")).clicked() {
            act = Some(CurveAction::Apply);
        }
        let button = egui::Button::new(tr!("curve-remove"));
        let gone = ui.add_enabled(ui_state.handle.is_some(), button);
        if gone.on_hover_text(tr!("curve-remove.tip")).clicked() {
            act = ui_state.handle.map(CurveAction::Delete);
        }
        if ui.button(tr!("curve-discard")).on_hover_text(tr!("curve-discard.tip")).clicked() {
            act = Some(CurveAction::Cancel);
        }
    });
    if let Some(act) = act {
        if matches!(act, CurveAction::Delete(_)) {
            ui_state.handle = None;
        }
        out.push(UiRequest::World(Command::CurveStroke(act)));
    }
}

fn bar(ctx: &egui::Context, free: Rect, what: impl FnOnce(&mut egui::Ui)) {
    let at = free.center_top() + egui::vec2(0.0, 8.0);
    let area =
        egui::Area::new(egui::Id::unique("curve")).pivot(egui::Align2::CENTER_TOP).fixed_pos(at);
    area.order(egui::Order::Middle).show(ctx, |ui| {
        ui.set_max_width((free.width() - 24.0).max(120.0));
        egui::Frame::popup(ui.style()).show(ui, |ui| rows::flow(ui, what));
    });
}
