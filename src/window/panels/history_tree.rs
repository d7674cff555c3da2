//! Every place that the work was at, as the session keeps them, branches too: a tree with pictures.
//! A click goes to a place, a drag along the tree or the slider goes through them.

use std::collections::{BTreeMap, BTreeSet};

use egui::{Color32, Pos2, Rect, Sense, Stroke, pos2, vec2};

use super::{UiRequest, theme};
use sculptd_daemon::session::history::Tree;
use sculptd_engine::world::HistoryEvent;

/// Points: a row, its picture, the step from lane to lane, the tree at most.
const ROW: f32 = 40.0;
const PICTURE: egui::Vec2 = vec2(48.0, 36.0);
const LANE: f32 = 9.0;
const TALL: f32 = 5.5 * ROW;
/// Branches side by side; more than these share the last lane.
const LANES: usize = 5;

/// One place, as it is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    pub node: u64,
    /// The row of the place before.
    pub parent: Option<usize>,
    /// 0: the line that the work is on, with what redo leads to.
    pub lane: usize,
    pub tick: u64,
    /// Another work took the place of the one before.
    pub replaced: bool,
    pub here: bool,
}

/// The tree, and how it was last shown.
#[derive(Default)]
pub struct Places {
    pub rows: Vec<Row>,
    /// Rows of the present line, the first place first.
    line: Vec<usize>,
    /// Ticks a second.
    pub rate_hz: u32,
    /// Pictures that have come.
    pub pictures: BTreeMap<u64, egui::TextureHandle>,
    /// Places whose pictures are on the screen.
    pub visible: Vec<u64>,
    /// Where a drag asked to go last.
    asked: Option<u64>,
    /// The place that was last scrolled to.
    shown: Option<u64>,
}

impl std::fmt::Debug for Places {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Places").field("rows", &self.rows.len()).finish_non_exhaustive()
    }
}

impl Places {
    /// Lays the tree out: a row a place in the order in which they were made, branches beside the
    /// present line.
    pub fn set(&mut self, tree: &Tree) {
        let mut present: BTreeSet<u64> = tree.line(tree.cursor).map(|n| n.id).collect();
        let mut at = tree.cursor;
        while let Some(next) = tree.latest(at).filter(|next| present.insert(*next)) {
            at = next;
        }
        let row_of: BTreeMap<u64, usize> =
            tree.nodes().enumerate().map(|(i, n)| (n.id, i)).collect();
        // The last row of each lane that is taken.
        let mut ends = vec![usize::MAX];
        let mut rows: Vec<Row> = Vec::with_capacity(tree.len());
        for (i, n) in tree.nodes().enumerate() {
            let parent = n.parent.and_then(|p| row_of.get(&p).copied());
            let lane = if present.contains(&n.id) {
                0
            } else {
                let goes_on = parent.filter(|p| {
                    rows[*p].lane > 0
                        && n.parent.is_some_and(|p| tree.children(p).first() == Some(&n.id))
                });
                goes_on.map_or_else(
                    || lane(tree, n.id, parent.unwrap_or(i), &mut ends, &row_of),
                    |p| rows[p].lane,
                )
            };
            let (tick, here) = (n.tick, n.id == tree.cursor);
            rows.push(Row {
                node: n.id,
                parent,
                lane,
                tick,
                replaced: n.deed == HistoryEvent::Replace,
                here,
            });
        }
        self.line = (0..rows.len()).filter(|i| rows[*i].lane == 0).collect();
        self.rows = rows;
    }
}

impl Places {
    /// Whether there is a place before where the work is, and one that redo leads to.
    pub fn ends(&self) -> (bool, bool) {
        let Some(here) = self.rows.iter().position(|r| r.here) else { return (false, false) };
        (self.rows[here].parent.is_some(), self.line.last().is_some_and(|last| *last > here))
    }
}

/// A free lane for the branch that begins at `id`.
fn lane(
    tree: &Tree,
    id: u64,
    from: usize,
    ends: &mut Vec<usize>,
    row_of: &BTreeMap<u64, usize>,
) -> usize {
    let mut end = id;
    while let Some(next) = tree.children(end).first() {
        end = *next;
    }
    let end = row_of.get(&end).copied().unwrap_or(from);
    let free = (1..ends.len()).find(|l| ends[*l] < from);
    let lane = free.unwrap_or_else(|| {
        ends.push(0);
        ends.len() - 1
    });
    ends[lane] = end;
    lane
}

/// Minutes and seconds of the session.
fn clock(tick: u64, rate_hz: u32) -> String {
    let s = tick / u64::from(rate_hz.max(1));
    format!("{}:{:02}", s / 60, s % 60)
}

pub fn ui(ui: &mut egui::Ui, places: &mut Places, out: &mut Vec<UiRequest>) {
    let here = places.rows.iter().position(|r| r.here).unwrap_or(0);
    let mut go = slider(ui, places, here);
    let width = ui.available_width();
    let scroll =
        egui::ScrollArea::vertical().id_salt("places").max_height(TALL).auto_shrink([false, true]);
    let mut dragged = false;
    let visible = scroll.show_viewport(ui, |ui, seen| {
        let tall = places.rows.len() as f32 * ROW;
        let (all, _) = ui.allocate_exact_size(vec2(width - 12.0, tall), Sense::hover());
        let row_at = |i: usize| {
            Rect::from_min_size(
                pos2(all.left(), all.top() + i as f32 * ROW),
                vec2(all.width(), ROW),
            )
        };
        if places.shown != places.rows.get(here).map(|r| r.node) {
            places.shown = places.rows.get(here).map(|r| r.node);
            ui.scroll_to_rect(row_at(here), None);
        }
        let first = (seen.min.y / ROW).max(0.0) as usize;
        let last = ((seen.max.y / ROW).ceil().max(0.0) as usize).min(places.rows.len());
        let dot = |i: usize| {
            let r = row_at(i);
            pos2(r.left() + 6.0 + places.rows[i].lane.min(LANES - 1) as f32 * LANE, r.center().y)
        };
        edges(ui, places, first..last, &dot);
        for i in first..last.max(first) {
            let response = row(ui, places, i, row_at(i), dot(i));
            if response.clicked() {
                go = Some(places.rows[i].node);
            }
            // A drag that began on a row goes through those that it comes over.
            if response.dragged() {
                dragged = true;
                let y = response.interact_pointer_pos().map_or(0.0, |p| p.y - all.top());
                let over = ((y / ROW).max(0.0) as usize).min(places.rows.len() - 1);
                go = Some(places.rows[over].node).filter(|n| places.asked != Some(*n));
                places.asked = Some(places.rows[over].node);
                ui.scroll_to_rect(row_at(over), None);
            }
        }
        places.rows[first.min(last)..last].iter().map(|r| r.node).collect()
    });
    places.visible = visible.inner;
    if !dragged {
        places.asked = None;
    }
    let is_here = |node: &u64| places.rows.get(here).is_some_and(|r| r.node == *node);
    out.extend(go.filter(|node| dragged || !is_here(node)).map(UiRequest::Jump));
}

/// Along the present line; the place that was chosen.
fn slider(ui: &mut egui::Ui, places: &Places, here: usize) -> Option<u64> {
    let now = places.line.binary_search(&here).unwrap_or(0);
    let most = places.line.len().saturating_sub(1);
    if most == 0 {
        return None;
    }
    let mut at = now;
    let slider = egui::Slider::new(&mut at, 0..=most).show_value(false).text("Place");
    let response = ui.add(slider).on_hover_text("Drag to go through the places of this line");
    (response.changed() && at != now).then(|| places.rows[places.line[at]].node)
}

/// The lines from places to those before them, as far as they are seen.
fn edges(
    ui: &egui::Ui,
    places: &Places,
    seen: std::ops::Range<usize>,
    dot: &dyn Fn(usize) -> Pos2,
) {
    let quiet = theme::quiet(ui);
    for (i, row) in places.rows.iter().enumerate() {
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

fn row(ui: &mut egui::Ui, places: &Places, i: usize, rect: Rect, dot: Pos2) -> egui::Response {
    let r = &places.rows[i];
    let response =
        ui.interact(rect, ui.scope_id().with(("place", r.node)), Sense::click_and_drag());
    let time = clock(r.tick, places.rate_hz);
    let branch = if r.lane > 0 { ", on a branch" } else { "" };
    let name = format!("Place {}, at {time}{branch}", r.node);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, r.here, &name));
    let accent = theme::accent(ui);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 3.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let colour = if r.lane == 0 { accent } else { theme::quiet(ui) };
    ui.painter().circle_filled(dot, if r.here { 5.0 } else { 3.0 }, colour);
    let lanes = places.rows.iter().map(|r| r.lane).max().unwrap_or(0).min(LANES - 1);
    let left = rect.left() + 16.0 + lanes as f32 * LANE;
    let picture = Rect::from_min_size(pos2(left, rect.center().y - PICTURE.y / 2.0), PICTURE);
    match places.pictures.get(&r.node) {
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
    let shown = if r.replaced { format!("{time}  new work") } else { time };
    let ink = if r.here { ui.visuals().strong_text_color() } else { theme::quiet(ui) };
    ui.painter().text(text, egui::Align2::LEFT_CENTER, shown, font, ink);
    response.on_hover_text(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use sculptd_daemon::session::history::Node;

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
        let mut places = Places { rate_hz: 120, ..Places::default() };
        places.set(&tree);
        let lanes: Vec<usize> = places.rows.iter().map(|r| r.lane).collect();
        // What redo leads to (7) is on the line; 2 and 4 are branches of which the first had ended
        // when the second began.
        assert_eq!(lanes, [0, 0, 1, 0, 1, 0, 0, 0]);
        assert_eq!(places.rows[4].parent, Some(3));
        assert_eq!(places.rows.iter().filter(|r| r.here).map(|r| r.node).collect::<Vec<_>>(), [6]);
        assert_eq!(places.line, [0, 1, 3, 5, 6, 7]);
        assert_eq!(clock(places.rows[7].tick * 10, 120), "1:10");
    }
}
