//! The offer at the start to continue an earlier sculpture. The first press on the clay is an
//! answer too.

use std::path::Path;

use super::state::{NextSculpture, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;

/// Sessions offered.
const OFFERED: usize = 4;

/// The date and the object, from a session's name: `2026-11-22_0308_ball`.
pub fn title(path: &Path) -> String {
    let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let mut parts = stem.splitn(3, '_');
    match (parts.next(), parts.next(), parts.next()) {
        (Some(date), Some(time), Some(object)) if time.len() == 4 && time.is_ascii() => {
            let time = format!("{}:{}", &time[..2], &time[2..]);
            tr!("start-session", object = object, date = date, time = time)
        }
        _ => stem,
    }
}

pub fn ui(
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    free: egui::Rect,
    out: &mut Vec<UiRequest>,
) {
    let begun = view.state.undo_steps > 0 || view.state.redo_steps > 0;
    if view.recent.is_empty() || ui_state.start_answered || begun || view.demo_runs {
        return;
    }
    let area = egui::Area::new(egui::Id::unique("start"))
        .fixed_pos(free.left_bottom() + egui::vec2(12.0, -12.0))
        .pivot(egui::Align2::LEFT_BOTTOM);
    area.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.strong(tr!("start-heading"));
            for path in view.recent.iter().take(OFFERED) {
                let button = ui.button(title(path)).on_hover_text(path.display().to_string());
                if button.clicked() {
                    out.push(UiRequest::OpenNext(NextSculpture::Session(path.clone())));
                }
            }
            ui.colored_label(theme::quiet(ui), tr!("start-note"));
            if ui.button(tr!("start-stay")).clicked() {
                ui_state.start_answered = true;
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language;

    #[test]
    fn a_session_is_told_by_its_object_and_date() {
        language::set_current(language::tests::of_config("").english());
        let path = Path::new("/a/2026-11-22_0308_my_head.sculpt");
        assert_eq!(title(path), "my_head, 2026-11-22 03:08");
        assert_eq!(title(Path::new("/a/mine.sculpt")), "mine");
    }
}
