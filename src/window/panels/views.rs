//! Over four views: the seams between them, which one is worked in, and the name of each. A press
//! of a name shows that view alone.

use egui::{Area, Context, Id, LayerId, Rect, Stroke, StrokeKind, pos2, vec2};
use glam::Vec2;

use super::state::views::{SEAM, ViewKind, Views};
use super::state::{Action, UiRequest, View};
use super::theme;
use crate::language::tr;

/// From the corner of a view to its name, points.
const INSET: f32 = 6.0;

fn name_area(kind: ViewKind) -> Id {
    Id::unique("view").with(kind)
}

/// Returns true if an area is the name of a view: the least important area over the clay.
pub fn is_name(area: Id) -> bool {
    ViewKind::ALL.into_iter().any(|kind| name_area(kind) == area)
}

/// The part of the window in which a view lies, points.
pub fn part(ctx: &Context, views: &Views, kind: ViewKind, free: Rect) -> Rect {
    if !views.are_four() {
        return free;
    }
    let scale = ctx.pixels_per_point();
    let pixels = |p: egui::Pos2| (Vec2::new(p.x, p.y) * scale).round();
    let (min, max) = (pixels(free.min), pixels(free.max));
    let (corner, size) = views.part(kind, (min, max - min));
    let (corner, size) = (corner / scale, size / scale);
    Rect::from_min_size(pos2(corner.x, corner.y), vec2(size.x, size.y))
}

/// Draws what separates and names the views, where there are four.
pub fn ui(ctx: &Context, view: &View<'_>, free: Rect, out: &mut Vec<UiRequest>) {
    let views = view.views;
    if !views.are_four() {
        return;
    }
    let painter = ctx.layer_painter(LayerId::background()).with_clip_rect(free);
    let style = ctx.global_style();
    let visuals = &style.visuals;
    let first = part(ctx, views, ViewKind::Top, free);
    let last = part(ctx, views, ViewKind::Right, free);
    let across = Rect::from_min_max(pos2(first.right(), free.top()), last.left_bottom());
    let down = Rect::from_min_max(pos2(free.left(), first.bottom()), last.right_top());
    for seam in [across, down] {
        painter.rect_filled(seam, 0.0, visuals.widgets.noninteractive.bg_stroke.color);
    }
    let active = part(ctx, views, views.active(), free);
    let mark = theme::accent_of(visuals.dark_mode);
    let mark = Stroke::new(SEAM / ctx.pixels_per_point(), mark);
    painter.rect_stroke(active, 0.0, mark, StrokeKind::Inside);
    for kind in ViewKind::ALL {
        let rect = part(ctx, views, kind, free);
        // A name has no room in a view that is hardly larger.
        if rect.width() < 90.0 || rect.height() < 50.0 {
            continue;
        }
        let area = Area::new(name_area(kind)).movable(false);
        area.fixed_pos(rect.min + vec2(INSET, INSET)).show(ctx, |ui| {
            let name = egui::RichText::new(tr!(kind.title())).small();
            let button = ui.add(egui::Button::selectable(kind == views.active(), name));
            let tip = tr!("view-alone", action = view.tip(Action::FourViews));
            if button.on_hover_text(tip).clicked() {
                out.push(UiRequest::ShowView(kind));
            }
        });
    }
}
