//! Dragging the radius or the strength with the pointer alone: F, move, click. Escape or the other
//! button: as it was.

use egui::{Key, PointerButton};

use super::brush_size;
use super::state::{Modal, ModalSetting, UiRequest, UiState, View};
use crate::language::tr;
use sculptd_engine::command::Command;

/// The pointer's way, points, that doubles the radius or moves the strength from 0 to 1.
const WAY: [f32; 2] = [120.0, 300.0];

pub fn begin(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState, what: ModalSetting) {
    let middle = ctx.content_rect().center();
    let from = ctx.input(|i| i.pointer.latest_pos()).unwrap_or(middle);
    ui_state.modal = Some(Modal { what, from, before: view.state.brush });
}

pub fn ui(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let Some(modal) = ui_state.modal else { return };
    let (to, done, cancelled) = ctx.input(|i| {
        let click = |b| i.pointer.button_pressed(b);
        (
            i.pointer.latest_pos().unwrap_or(modal.from),
            click(PointerButton::Primary) || i.key_pressed(Key::Enter),
            click(PointerButton::Secondary) || i.key_pressed(Key::Escape),
        )
    });
    let way = to.x - modal.from.x;
    let mut brush = view.state.brush;
    match modal.what {
        ModalSetting::Radius => brush.radius = modal.before.radius * 2f32.powf(way / WAY[0]),
        ModalSetting::Strength => brush.strength = modal.before.strength + way / WAY[1],
    }
    brush = brush.clamped();
    if cancelled {
        brush = modal.before;
    }
    if done || cancelled {
        ui_state.modal = None;
    }
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush)));
    }
    let text = match modal.what {
        ModalSetting::Radius => {
            tr!("modal-radius", value = brush_size::radius_text(ctx, view, ui_state, brush.radius))
        }
        ModalSetting::Strength => tr!("modal-strength", value = format!("{:.2}", brush.strength)),
    };
    let area = egui::Area::new(egui::Id::unique("modal"))
        .fixed_pos(modal.from + egui::vec2(0.0, 46.0))
        .pivot(egui::Align2::CENTER_TOP)
        .interactable(false);
    area.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.label(text);
        });
    });
}
