//! The page that lists all: how the clay is touched and turned, and every action with its keys.

use super::state::{Action, SessionView, Tab, UiState, View};
use super::theme;
use crate::language::tr;

/// What is true only while a session keeps the work.
const KEPT: &str = "help-work";

/// Titles, and what a person does: its message, and beside it the attribute `does` of the same.
const SECTIONS: [(&str, &[&str]); 4] = [
    (
        "help-pen",
        &[
            "help-pen-press",
            "help-pen-carve",
            "help-pen-smooth",
            "help-pen-turn",
            "help-pen-slide",
            "help-pen-zoom",
            "help-pen-menu",
        ],
    ),
    (
        "help-fingers",
        &["help-fingers-one", "help-fingers-two", "help-fingers-three", "help-fingers-tap"],
    ),
    (
        "help-hands",
        &[
            "help-hands-index",
            "help-hands-pinch",
            "help-hands-flat",
            "help-hands-open",
            "help-hands-fist",
            "help-hands-both",
            "help-hands-menu",
        ],
    ),
    (KEPT, &["help-work-close", "help-work-files"]),
];

/// The window, while it is open.
pub fn ui(
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    free: egui::Rect,
) -> Option<Action> {
    if !ui_state.help {
        return None;
    }
    let (mut open, mut chosen) = (true, None);
    let size = (free.size() - egui::vec2(40.0, 80.0)).max(egui::vec2(180.0, 160.0));
    egui::Window::new(tr!("help-heading"))
        .id(egui::Id::unique("help"))
        .open(&mut open)
        .collapsible(false)
        .constrain_to(free)
        .default_pos(free.min + egui::vec2(16.0, 16.0))
        .default_size(size.min(egui::vec2(460.0, 520.0)))
        .max_size(size)
        .show(ctx, |ui| {
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    for action in [Action::Lesson, Action::Search, Action::Keys] {
                        if ui.button(action.title()).clicked() {
                            chosen = Some(action);
                        }
                    }
                });
                sections(ui, view);
                actions(ui, view);
            });
        });
    ui_state.help = open && !ctx.input(|i| i.key_pressed(egui::Key::Escape));
    if chosen.is_some() {
        ui_state.help = false;
    }
    chosen
}

fn sections(ui: &mut egui::Ui, view: &View<'_>) {
    let keeps = view.session.as_ref().is_some_and(SessionView::keeps);
    for (title, rows) in SECTIONS.into_iter().filter(|s| keeps || s.0 != KEPT) {
        ui.add_space(8.0);
        ui.strong(tr!(title));
        for row in rows {
            line(ui, &tr!(row), &tr!(&format!("{row}.does")));
        }
    }
    ui.add_space(8.0);
    ui.strong(tr!("help-pages"));
    for (tab, ..) in Tab::ALL {
        line(ui, &tab.title(), &tab.about());
    }
}

fn actions(ui: &mut egui::Ui, view: &View<'_>) {
    ui.add_space(8.0);
    ui.strong(tr!("help-keys"));
    for binding in view.keys.bindings() {
        if let Some(keys) = binding.keys {
            line(ui, &keys.shown(), &binding.action.title());
        }
    }
}

/// Shows an action at the left and its effect at the right.
fn line(ui: &mut egui::Ui, done: &str, comes: &str) {
    let width = ui.available_width();
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let left = egui::vec2(width * 0.46, 0.0);
        ui.allocate_ui_with_layout(left, egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.set_width(left.x);
            let text = egui::RichText::new(done).color(theme::quiet(ui));
            ui.add(egui::Label::new(text).wrap());
        });
        ui.add(egui::Label::new(comes).wrap());
    });
}
