//! The menu round the pen: hold space, move, let go.

use egui::{Align2, FontId, Key, Pos2, Stroke, vec2};

use super::state::{Action, UiState};
use crate::language::tr;

/// Clockwise from the top, each with the message of its name.
const RING: [(Action, &str); 8] = [
    (Action::Undo, "undo"),
    (Action::Redo, "redo"),
    (Action::DragRadius, "radial-radius"),
    (Action::MirrorX, "radial-mirror"),
    (Action::Thickness, "radial-thickness"),
    (Action::Frame, "radial-frame"),
    (Action::DragStrength, "radial-strength"),
    (Action::Carve, "radial-carve"),
];
const INNER: f32 = 26.0;
const OUTER: f32 = 92.0;

/// Returns the index of the item under the pointer.
fn over(centre: Pos2, at: Pos2) -> Option<usize> {
    let d = at - centre;
    if d.length() < INNER {
        return None;
    }
    let turn = d.x.atan2(-d.y).rem_euclid(std::f32::consts::TAU) / std::f32::consts::TAU;
    Some((turn * RING.len() as f32).round() as usize % RING.len())
}

/// Shows the ring while space is held; what it was let go over.
pub fn ui(ctx: &egui::Context, ui_state: &mut UiState) -> Option<Action> {
    let held = ctx.input(|i| i.key_down(Key::Space) && i.modifiers.is_none());
    let at = ctx.input(|i| i.pointer.latest_pos()).unwrap_or(ctx.content_rect().center());
    if held && ui_state.radial.is_none() && !ctx.egui_wants_keyboard_input() {
        // Wholly on the screen.
        let room = ctx.content_rect().shrink(OUTER + 36.0);
        ui_state.radial = Some(if room.is_positive() { room.clamp(at) } else { at });
    }
    let centre = ui_state.radial?;
    let chosen = over(centre, at);
    if !held {
        ui_state.radial = None;
        return chosen.map(|i| RING[i].0);
    }
    let size = vec2(OUTER + 40.0, OUTER + 40.0);
    let area = egui::Area::new(egui::Id::unique("radial"))
        .fixed_pos(centre - size)
        .order(egui::Order::Foreground)
        .interactable(false);
    area.show(ctx, |ui| {
        ui.allocate_exact_size(size * 2.0, egui::Sense::hover());
        let visuals = ui.visuals().clone();
        let painter = ui.painter();
        painter.circle(
            centre,
            OUTER + 34.0,
            visuals.window_fill.gamma_multiply(0.97),
            Stroke::NONE,
        );
        painter.circle_stroke(centre, INNER, Stroke::new(1.5, visuals.weak_text_color()));
        for (i, (_, name)) in RING.iter().enumerate() {
            let turn = i as f32 / RING.len() as f32 * std::f32::consts::TAU;
            let place = centre + vec2(turn.sin(), -turn.cos()) * OUTER;
            let on = chosen == Some(i);
            let colour = if on { visuals.selection.stroke.color } else { visuals.text_color() };
            let font = FontId::proportional(13.0);
            let galley = painter.layout_no_wrap(tr!(name), font, colour);
            let rect = Align2::CENTER_CENTER.anchor_size(place, galley.size());
            if on {
                painter.rect_filled(rect.expand(6.0), 6.0, visuals.selection.bg_fill);
            }
            painter.galley(rect.min, galley, colour);
        }
    });
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ring_starts_at_the_top_and_goes_clockwise() {
        let c = Pos2::new(100.0, 100.0);
        assert_eq!(over(c, c), None);
        assert_eq!(over(c, c + vec2(0.0, -60.0)), Some(0));
        assert_eq!(over(c, c + vec2(60.0, 0.0)), Some(2));
        assert_eq!(over(c, c + vec2(0.0, 60.0)), Some(4));
        assert_eq!(over(c, c + vec2(-60.0, -60.0)), Some(7));
    }
}
