//! Every version that the session keeps, branches too: a tree with pictures. A click goes to a
//! version, a drag along the tree or the slider goes through them.

use egui::{Color32, Pos2, Rect, Sense, Stroke, pos2, vec2};

use super::rows;
use super::state::{HistoryVersions, UiRequest};
use super::theme;
use crate::language::tr;

/// Points: a row, its picture, the step from lane to lane, the tree at most.
const ROW: f32 = 40.0;
const PICTURE: egui::Vec2 = vec2(48.0, 36.0);
const LANE: f32 = 9.0;
const TALL: f32 = 5.5 * ROW;
/// Branches side by side; more than these share the last lane.
const LANES: usize = 5;

/// Minutes and seconds of the session.
fn clock(tick: u64, rate_hz: u32) -> String {
    let s = tick / u64::from(rate_hz.max(1));
    format!("{}:{:02}", s / 60, s % 60)
}

pub fn ui(ui: &mut egui::Ui, versions: &mut HistoryVersions, out: &mut Vec<UiRequest>) {
    let here = versions.rows.iter().position(|r| r.here).unwrap_or(0);
    let mut go = slider(ui, versions, here);
    let width = ui.available_width();
    let scroll = egui::ScrollArea::vertical()
        .id_salt("versions")
        .max_height(TALL)
        .auto_shrink([false, true]);
    let mut dragged = false;
    let visible = scroll.show_viewport(ui, |ui, seen| {
        let tall = versions.rows.len() as f32 * ROW;
        let (all, _) = ui.allocate_exact_size(vec2(width - 12.0, tall), Sense::hover());
        let row_at = |i: usize| {
            Rect::from_min_size(
                pos2(all.left(), all.top() + i as f32 * ROW),
                vec2(all.width(), ROW),
            )
        };
        if versions.shown != versions.rows.get(here).map(|r| r.node) {
            versions.shown = versions.rows.get(here).map(|r| r.node);
            ui.scroll_to_rect(row_at(here), None);
        }
        let first = (seen.min.y / ROW).max(0.0) as usize;
        let last = ((seen.max.y / ROW).ceil().max(0.0) as usize).min(versions.rows.len());
        let dot = |i: usize| {
            let r = row_at(i);
            pos2(r.left() + 6.0 + versions.rows[i].lane.min(LANES - 1) as f32 * LANE, r.center().y)
        };
        edges(ui, versions, first..last, &dot);
        for i in first..last.max(first) {
            let response = row(ui, versions, i, row_at(i), dot(i));
            if response.clicked() {
                go = Some(versions.rows[i].node);
            }
            // A drag that began on a row visits the rows that it passes over.
            if response.dragged() {
                dragged = true;
                let y = response.interact_pointer_pos().map_or(0.0, |p| p.y - all.top());
                let over = ((y / ROW).max(0.0) as usize).min(versions.rows.len() - 1);
                go = Some(versions.rows[over].node).filter(|n| versions.asked != Some(*n));
                versions.asked = Some(versions.rows[over].node);
                ui.scroll_to_rect(row_at(over), None);
            }
        }
        versions.rows[first.min(last)..last].iter().map(|r| r.node).collect()
    });
    versions.visible = visible.inner;
    if !dragged {
        versions.asked = None;
    }
    let is_here = |node: &u64| versions.rows.get(here).is_some_and(|r| r.node == *node);
    out.extend(go.filter(|node| dragged || !is_here(node)).map(UiRequest::Jump));
}

/// Along the present line; the version that was chosen.
fn slider(ui: &mut egui::Ui, versions: &HistoryVersions, here: usize) -> Option<u64> {
    let now = versions.line.binary_search(&here).unwrap_or(0);
    let most = versions.line.len().saturating_sub(1);
    if most == 0 {
        return None;
    }
    let mut at = now;
    let slider = egui::Slider::new(&mut at, 0..=most).show_value(false);
    let response = rows::slider(ui, slider, &tr!("history-version"));
    let response = response.on_hover_text(tr!("history-version.tip"));
    (response.changed() && at != now).then(|| versions.rows[versions.line[at]].node)
}

/// The lines from versions to those before them, as far as they are seen.
fn edges(
    ui: &egui::Ui,
    versions: &HistoryVersions,
    seen: std::ops::Range<usize>,
    dot: &dyn Fn(usize) -> Pos2,
) {
    let quiet = theme::quiet(ui);
    for (i, row) in versions.rows.iter().enumerate() {
        let Some(parent) = row.parent.filter(|p| *p < seen.end && i >= seen.start) else {
            continue;
        };
        let (from, to) = (dot(parent), dot(i));
        let colour = if row.lane == 0 { theme::accent(ui) } else { quiet };
        let stroke = Stroke::new(1.5, colour);
        // Aside at once, then down: lanes do not cross what lies between.
        let bend = pos2(to.x, from.y + (to.x - from.x).abs());
        ui.painter().line_segment([from, bend], stroke);
        ui.painter().line_segment([bend, to], stroke);
    }
}

fn row(
    ui: &mut egui::Ui,
    versions: &HistoryVersions,
    i: usize,
    rect: Rect,
    dot: Pos2,
) -> egui::Response {
    let r = &versions.rows[i];
    let response =
        ui.interact(rect, ui.scope_id().with(("version", r.node)), Sense::click_and_drag());
    let time = clock(r.tick, versions.rate_hz);
    let id = if r.lane > 0 { "history-row-branch" } else { "history-row" };
    let name = tr!(id, node = r.node.to_string(), time = time.as_str());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, r.here, &name));
    let accent = theme::accent(ui);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 3.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let colour = if r.lane == 0 { accent } else { theme::quiet(ui) };
    ui.painter().circle_filled(dot, if r.here { 5.0 } else { 3.0 }, colour);
    let lanes = versions.rows.iter().map(|r| r.lane).max().unwrap_or(0).min(LANES - 1);
    let left = rect.left() + 16.0 + lanes as f32 * LANE;
    let picture = Rect::from_min_size(pos2(left, rect.center().y - PICTURE.y / 2.0), PICTURE);
    match versions.pictures.get(&r.node) {
        Some(texture) => {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), picture, whole, Color32::WHITE);
        }
        None => {
            ui.painter().rect_filled(picture, 2.0, ui.visuals().extreme_bg_color);
        }
    }
    if r.here {
        ui.painter().rect_stroke(picture, 2.0, Stroke::new(2.0, accent), egui::StrokeKind::Inside);
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = pos2(picture.right() + 8.0, rect.center().y);
    let shown = match r.operation {
        Some(what) => format!("{time}  {}", tr!(what)),
        None => time,
    };
    let ink = if r.here { ui.visuals().strong_text_color() } else { theme::quiet(ui) };
    let mut job = egui::text::LayoutJob::simple_singleline(shown, font, ink);
    job.wrap = egui::text::TextWrapping::truncate_at_width((rect.right() - text.x).max(24.0));
    let galley = ui.painter().layout_job(job);
    ui.painter().galley(text - vec2(0.0, galley.size().y * 0.5), galley, ink);
    response.on_hover_text(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use sculptd_daemon::session::history::{Node, Tree};
    use sculptd_engine::world::HistoryEvent;

    #[test]
    fn branches_lie_beside_the_present_line_and_lanes_are_used_again() {
        let mut tree = Tree::default();
        let mut add = |id: u64, parent: Option<u64>| {
            tree.add(Node {
                id,
                parent,
                tick: id * 120,
                deed: HistoryEvent::Step,
                object_id: 0,
                changes: vec![],
                pages: 1,
                middle: Vec3::ZERO,
                extent: 1.0,
                next: [0, 0],
                levels: None,
                scene: None,
            });
            tree.go(id);
        };
        // 0-1-2, back to 1: 3-4, back to 4's beginning 3: 5-6, and 7 after 6.
        for (id, parent) in
            [(0, None), (1, Some(0)), (2, Some(1)), (3, Some(1)), (4, Some(3)), (5, Some(3))]
        {
            add(id, parent);
        }
        for (id, parent) in [(6, Some(5)), (7, Some(6))] {
            add(id, parent);
        }
        tree.go(6);
        let mut versions = HistoryVersions { rate_hz: 120, ..HistoryVersions::default() };
        versions.set(&tree);
        let lanes: Vec<usize> = versions.rows.iter().map(|r| r.lane).collect();
        // The version that redo leads to (7) is on the line; 2 and 4 are branches, and the first
        // ended before the second began.
        assert_eq!(lanes, [0, 0, 1, 0, 1, 0, 0, 0]);
        assert_eq!(versions.rows[4].parent, Some(3));
        assert_eq!(
            versions.rows.iter().filter(|r| r.here).map(|r| r.node).collect::<Vec<_>>(),
            [6]
        );
        assert_eq!(versions.line, [0, 1, 3, 5, 6, 7]);
        assert_eq!(clock(versions.rows[7].tick * 10, 120), "1:10");
    }
}
