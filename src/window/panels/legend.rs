//! The scale of the map that the clay shows, with its unit.

use egui::{Rect, pos2, vec2};

use super::state::UiState;
use super::{check_values, measure};
use crate::language::tr;
use crate::look::{AngleMap, Map};

pub fn ui(ctx: &egui::Context, ui_state: &UiState, free: Rect) {
    let map = ui_state.look.map;
    if map == Map::None || free.width() < 120.0 {
        return;
    }
    let known = match map {
        Map::Thickness | Map::Gap => ui_state.walls.found.is_some(),
        Map::Distance => ui_state.sizes.distances.is_some(),
        Map::WallChange => ui_state.walls.changes.is_some(),
        Map::None | Map::Mask | Map::Overhang | Map::Draft => true,
    };
    let (low, high) = match map {
        Map::Mask => (0.0, 1.0),
        _ => ui_state.look.scale,
    };
    let area = egui::Area::new(egui::Id::unique("legend"))
        // Away from the bars at the top and what is said at the bottom.
        .fixed_pos(free.left_center() + vec2(12.0, 0.0))
        .pivot(egui::Align2::LEFT_CENTER)
        .interactable(false);
    area.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).inner_margin(8.0).show(ui, |ui| {
            ui.strong(tr!(map.title()));
            let (rect, _) = ui.allocate_exact_size(vec2(92.0, 120.0), egui::Sense::hover());
            let bar = Rect::from_min_size(rect.min + vec2(0.0, 6.0), vec2(16.0, 108.0));
            measure::bar(ui.painter(), bar, |x| ui_state.look.scale_colour(x));
            let font = egui::FontId::proportional(12.0);
            let colour = ui.visuals().text_color();
            if !known {
                let at = pos2(bar.right() + 6.0, bar.center().y);
                ui.painter().text(
                    at,
                    egui::Align2::LEFT_CENTER,
                    tr!("legend-measuring"),
                    font,
                    colour,
                );
                return;
            }
            if let Some(here) = ui_state.walls.here.filter(|_| map.is_of_walls()) {
                if map != Map::WallChange {
                    mark(ui, bar, (here - low) / (high - low).max(1e-12));
                }
                ui.label(tr!("walls-here", value = format!("{here:.3}")));
                if let Some(ball) = ui_state.walls.ball {
                    ui.label(tr!("walls-ball", value = format!("{ball:.3}")));
                }
            }
            for i in 0..=2 {
                let x = i as f32 / 2.0;
                let value = low + (high - low) * x;
                let text = match map {
                    Map::Distance | Map::WallChange if i == 1 => tr!("length-mm", value = "0"),
                    Map::Distance | Map::WallChange => {
                        tr!("length-mm", value = format!("{value:+.3}"))
                    }
                    Map::Mask => format!("{value:.2}"),
                    Map::Overhang | Map::Draft => angle_at(ui_state.look.angles, map, i),
                    _ => tr!("length-mm", value = format!("{value:.2}")),
                };
                let at = pos2(bar.right() + 6.0, bar.bottom() - x * bar.height());
                ui.painter().text(at, egui::Align2::LEFT_CENTER, text, font.clone(), colour);
            }
        });
    });
}

/// A mark beside the bar at a share of the scale.
fn mark(ui: &egui::Ui, bar: Rect, share: f32) {
    let y = bar.bottom() - share.clamp(0.0, 1.0) * bar.height();
    let points = [vec2(-1.0, 0.0), vec2(-7.0, -4.0), vec2(-7.0, 4.0)];
    let colour = ui.visuals().text_color();
    let corners = points.map(|p| pos2(bar.left(), y) + p).to_vec();
    ui.painter().add(egui::Shape::convex_polygon(corners, colour, egui::Stroke::NONE));
}

/// The text of a map of angles at the low end, the limit and the high end of its scale.
fn angle_at(angles: AngleMap, map: Map, place: i32) -> String {
    let degrees = |x: f32| check_values::short(f64::from(x));
    match place {
        0 => tr!("angle-degrees", value = "0"),
        1 => tr!("legend-limit", value = degrees(angles.limit)),
        _ => tr!("angle-degrees", value = degrees(angles.end(map))),
    }
}
