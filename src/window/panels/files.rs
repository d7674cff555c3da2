//! Opening, saving, pictures.

use std::path::PathBuf;

use super::action::Action;
use super::{UiRequest, UiState, View, theme};

/// What a number in a file stands for: the work itself is in millimetres.
pub const UNITS: [(&str, f64); 4] = [("mm", 1.0), ("cm", 0.1), ("m", 0.001), ("inch", 1.0 / 25.4)];

#[derive(Debug)]
pub struct Files {
    pub open: String,
    pub export: String,
    /// Sizes are multiplied by this before the unit.
    pub scale: f64,
    /// Index into [`UNITS`].
    pub unit: usize,
    /// Frames of a turntable.
    pub frames: u32,
}

impl Default for Files {
    fn default() -> Self {
        Files {
            open: String::new(),
            export: "sculpture.stl".into(),
            scale: 1.0,
            unit: 0,
            frames: 36,
        }
    }
}

impl Files {
    /// What coordinates are multiplied by, and the unit's name.
    pub fn factor(&self) -> (f64, &'static str) {
        let (name, factor) = UNITS[self.unit.min(UNITS.len() - 1)];
        (self.scale * factor, name)
    }
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, desk: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    let field = |ui: &mut egui::Ui, text: &mut String, name: &str| {
        let label = ui.label(name);
        ui.add(egui::TextEdit::singleline(text).desired_width(190.0)).labelled_by(label.id)
    };
    ui.strong("Open");
    ui.colored_label(quiet, "Drop a mesh on the window, or:");
    let typed = field(ui, &mut desk.files.open, "File to open");
    let enter = typed.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    ui.horizontal(|ui| {
        let named = !desk.files.open.trim().is_empty();
        if ui.add_enabled(named, egui::Button::new("Open")).clicked() || (enter && named) {
            out.push(UiRequest::WindowState(PathBuf::from(desk.files.open.trim())));
        }
        if ui.button("Browse...").on_hover_text(Action::WindowState.tip()).clicked() {
            out.push(UiRequest::Do(Action::WindowState));
        }
    });
    if !desk.prefs.recent.is_empty() {
        ui.menu_button("Recent", |ui| {
            for path in &desk.prefs.recent {
                let name =
                    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    out.push(UiRequest::WindowState(path.clone()));
                    ui.close();
                }
            }
        });
    }
    ui.add_space(8.0);
    ui.strong("Export");
    let files = &mut desk.files;
    field(ui, &mut files.export, "File to write");
    ui.horizontal(|ui| {
        let label = ui.label("Scale");
        ui.add(egui::DragValue::new(&mut files.scale).range(1e-6..=1e6).speed(0.01))
            .labelled_by(label.id);
        egui::ComboBox::from_label("Unit").selected_text(files.factor().1).width(60.0).show_ui(
            ui,
            |ui| {
                for (i, (name, _)) in UNITS.iter().enumerate() {
                    ui.selectable_value(&mut files.unit, i, *name);
                }
            },
        );
    });
    let (lo, hi) = view.state.mesh.bounds();
    let (factor, unit) = files.factor();
    let size = (hi - lo).max(glam::Vec3::ZERO).as_dvec3() * factor;
    ui.colored_label(quiet, format!("{:.3} x {:.3} x {:.3} {unit}", size.x, size.y, size.z));
    ui.horizontal(|ui| {
        let named = !files.export.trim().is_empty();
        if ui.add_enabled(named, egui::Button::new("Export")).clicked() {
            out.push(UiRequest::Export(PathBuf::from(files.export.trim())));
        }
        if ui.button("Save as...").on_hover_text(Action::Export.tip()).clicked() {
            out.push(UiRequest::Do(Action::Export));
        }
    });
    ui.colored_label(quiet, "stl, obj, ply, off, glb, 3mf");
    ui.add_space(8.0);
    ui.strong("Pictures");
    if ui.button("Screenshot").on_hover_text(Action::Screenshot.tip()).clicked() {
        out.push(UiRequest::Do(Action::Screenshot));
    }
    ui.horizontal(|ui| {
        if ui.button("Turntable").on_hover_text(Action::Turntable.tip()).clicked() {
            out.push(UiRequest::Do(Action::Turntable));
        }
        let label = ui.label("frames");
        ui.add(egui::DragValue::new(&mut desk.files.frames).range(4..=360)).labelled_by(label.id);
    });
}
