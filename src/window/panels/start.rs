//! The wall of earlier sculptures, each with its picture: offered at the start, and opened from the
//! page of files. The first press on the clay answers the offer too.

use std::path::Path;

use egui::{Rect, Sense, vec2};

use super::icons::{self, Icon};
use super::state::{Action, EarlierWork, NextSculpture, SessionView, UiRequest, UiState, View};
use super::{act, theme};
use crate::language::tr;

/// Points of a card: the picture, and two lines below.
const PICTURE: egui::Vec2 = vec2(120.0, 80.0);
const LINES: f32 = 36.0;
/// Points between cards.
const GAP: f32 = 8.0;
/// Rows of the offer at the start; the wall that was asked for shows all.
const OFFERED_ROWS: usize = 1;

/// The object and the time, from a session's name: `2026-11-22_0308_ball`.
pub fn title(path: &Path) -> (String, String) {
    let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let mut parts = stem.splitn(3, '_');
    match (parts.next(), parts.next(), parts.next()) {
        (Some(date), Some(time), Some(object)) if time.len() == 4 && time.is_ascii() => {
            (object.to_owned(), format!("{date} {}:{}", &time[..2], &time[2..]))
        }
        _ => (stem, String::new()),
    }
}

/// Returns true while the offer of the start is shown.
pub fn offers(view: &View<'_>, ui_state: &UiState) -> bool {
    let begun = view.state.undo_steps > 0 || view.state.redo_steps > 0;
    !(ui_state.earlier.all.is_empty() || ui_state.earlier.answered || begun || view.demo_runs)
}

pub fn ui(
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    free: Rect,
    out: &mut Vec<UiRequest>,
) {
    let asked = ui_state.earlier.open;
    if !asked && !offers(view, ui_state) {
        return;
    }
    let columns = (((free.width() - 56.0) / (PICTURE.x + GAP)) as usize).clamp(1, 4);
    let columns = columns.min(ui_state.earlier.all.len().max(2));
    let wide = columns as f32 * (PICTURE.x + GAP) - GAP;
    let (pivot, at) = match asked {
        true => (egui::Align2::CENTER_CENTER, free.center()),
        false => (egui::Align2::LEFT_BOTTOM, free.left_bottom() + vec2(12.0, -12.0)),
    };
    let area = egui::Area::new(egui::Id::unique("start")).fixed_pos(at).pivot(pivot);
    area.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).inner_margin(12.0).show(ui, |ui| {
            ui.set_width(wide);
            ui.horizontal(|ui| {
                ui.heading(tr!("start-heading"));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    let close = icons::button(ui, Icon::X, &tr!("start-stay")).clicked();
                    if close || ui.input(|i| i.key_pressed(egui::Key::Escape)) {
                        (ui_state.earlier.open, ui_state.earlier.answered) = (false, true);
                    }
                });
            });
            let rows = if asked { usize::MAX } else { OFFERED_ROWS };
            let works = ui_state.earlier.all.iter().take(columns.saturating_mul(rows));
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(GAP, GAP);
                for work in works {
                    if card(ui, work).clicked() {
                        let next = NextSculpture::Session(work.path.clone());
                        out.push(UiRequest::OpenNext(next));
                    }
                }
            });
            if asked {
                let name = icons::text(Icon::FilePlus, &Action::New.title());
                if ui.button(name).clicked() {
                    act(Action::New, ctx, view, ui_state, out);
                }
            } else if view.session.as_ref().is_some_and(SessionView::keeps) {
                ui.colored_label(theme::quiet(ui), tr!("start-note"));
            }
        });
    });
}

/// A sculpture as a button: its picture, its object and when it was begun.
fn card(ui: &mut egui::Ui, work: &EarlierWork) -> egui::Response {
    let size = PICTURE + vec2(0.0, LINES);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let (object, begun) = title(&work.path);
    response.widget_info(|| {
        let name = tr!("start-session", object = object.as_str(), begun = begun.as_str());
        egui::WidgetInfo::labeled(egui::Role::Button, true, name)
    });
    let style = ui.style().interact(&response);
    ui.painter().rect_filled(rect, 4.0, style.weak_bg_fill);
    let place = Rect::from_min_size(rect.min, PICTURE);
    let ground = ui.visuals().extreme_bg_color;
    ui.painter().rect_filled(place.shrink(2.0), 3.0, ground);
    match &work.picture {
        Some(picture) => {
            let natural = picture.size_vec2();
            let share = ((PICTURE.x - 4.0) / natural.x).min((PICTURE.y - 4.0) / natural.y);
            let shown = Rect::from_center_size(place.center(), natural * share);
            egui::Image::new(picture).paint_at(ui, shown);
        }
        None => icons::paint(ui.painter(), place, Icon::Image, 20.0, theme::quiet(ui)),
    }
    if work.told.is_some() {
        let corner = Rect::from_min_size(place.right_top() - vec2(22.0, -2.0), vec2(20.0, 20.0));
        icons::paint(ui.painter(), corner, Icon::TriangleAlert, 14.0, theme::alarm(ui));
    }
    let line = |text: String, y: f32, colour| {
        let mut job = egui::text::LayoutJob::simple_singleline(
            text,
            egui::FontId::proportional(12.0),
            colour,
        );
        job.wrap.max_width = PICTURE.x - 12.0;
        job.wrap.max_rows = 1;
        job.wrap.break_anywhere = true;
        let drawn = ui.painter().layout_job(job);
        ui.painter().galley(rect.left_top() + vec2(6.0, y), drawn, colour);
    };
    line(object, PICTURE.y + 1.0, style.text_color());
    line(begun, PICTURE.y + 17.0, theme::quiet(ui));
    let path = work.path.display().to_string();
    let tip = work.told.as_ref().map_or(path.clone(), |told| format!("{path}\n{told}"));
    response.on_hover_text(tip)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_told_by_its_object_and_date() {
        let path = Path::new("/a/2026-11-22_0308_my_head.sculpt");
        assert_eq!(title(path), ("my_head".into(), "2026-11-22 03:08".into()));
        assert_eq!(title(Path::new("/a/mine.sculpt")), ("mine".into(), String::new()));
    }
}
