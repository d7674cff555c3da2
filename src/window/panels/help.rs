//! The page that lists all: how the clay is touched and turned, and every action with its keys.

use super::state::{Action, Tab, UiState, View};
use super::theme;

/// Titles, and what a person does beside what comes of it.
const SECTIONS: [(&str, &[(&str, &str)]); 4] = [
    (
        "Pen or mouse",
        &[
            ("Press and drag on the clay", "Sculpt"),
            ("The same with Ctrl or Alt", "Carve instead of raise, for one stroke"),
            ("The same with Shift", "Smooth, for one stroke"),
            ("Drag beside the clay, or with the right button", "Turn the view"),
            ("Middle button, or right button with Shift", "Slide the view"),
            ("Wheel", "Come nearer to what is under the pointer"),
            ("Hold Space", "Menu around the pointer"),
        ],
    ),
    (
        "Fingers on a screen",
        &[
            ("One finger on the clay", "Sculpt"),
            ("Two fingers", "Turn the view; pinched they zoom"),
            ("Three fingers", "Slide the view (page More exchanges the two)"),
            ("Tap with three, with four", "Undo, redo"),
        ],
    ),
    (
        "Bare hands over a tracker",
        &[
            ("Index finger stretched", "The fingertip pushes the clay"),
            ("Thumb and index finger closed", "Hold clay, carry it, let it go"),
            ("Fingers stretched and together", "The palm presses and smooths"),
            ("Fingers stretched and apart", "Turn the view; with two hands zoom"),
            ("Fist", "Slide the view"),
            ("Pinch with both hands", "Hold the sculpture: turn, move, scale it"),
            ("A fingertip rests in a ball at the left", "Choose from the menu of the hands"),
        ],
    ),
    (
        "Work is kept",
        &[
            ("Close the window at any time", "The session goes on where it was"),
            ("Page Files", "Open, export, earlier sculptures"),
        ],
    ),
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
    egui::Window::new("Help")
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
                        if ui.button(action.entry().name.as_ref()).clicked() {
                            chosen = Some(action);
                        }
                    }
                });
                sections(ui);
                actions(ui, view);
            });
        });
    ui_state.help = open && !ctx.input(|i| i.key_pressed(egui::Key::Escape));
    if chosen.is_some() {
        ui_state.help = false;
    }
    chosen
}

fn sections(ui: &mut egui::Ui) {
    for (title, rows) in SECTIONS {
        ui.add_space(8.0);
        ui.strong(title);
        for (done, comes) in rows {
            line(ui, done, comes);
        }
    }
    ui.add_space(8.0);
    ui.strong("Pages at the right");
    for (_, name, about) in Tab::ALL {
        line(ui, name, about);
    }
}

fn actions(ui: &mut egui::Ui, view: &View<'_>) {
    ui.add_space(8.0);
    ui.strong("Keys");
    for binding in view.keys.bindings() {
        if let Some(keys) = binding.keys {
            line(ui, &keys.to_string(), &binding.action.entry().name);
        }
    }
}

/// What is done at the left, what comes of it at the right.
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
