//! Opening, saving, pictures.

use std::path::{Path, PathBuf};

use super::rows;
use super::state::{Action, UNITS, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_geometry::io::states_unit;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    let field = |ui: &mut egui::Ui, text: &mut String, name: &str| {
        let label = ui.label(tr!(name));
        ui.add(egui::TextEdit::singleline(text).desired_width(190.0)).labelled_by(label.id)
    };
    ui.strong(tr!("files-open"));
    ui.colored_label(quiet, tr!("files-open.note"));
    let typed = field(ui, &mut ui_state.files.open, "files-open-name");
    let enter = typed.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    rows::flow(ui, |ui| {
        let named = !ui_state.files.open.trim().is_empty();
        if ui.add_enabled(named, egui::Button::new(tr!("open"))).clicked() || (enter && named) {
            out.push(UiRequest::OpenMesh(PathBuf::from(ui_state.files.open.trim())));
        }
        if ui.button(tr!("files-browse")).on_hover_text(view.tip(Action::OpenMesh)).clicked() {
            out.push(UiRequest::Do(Action::OpenMesh));
        }
    });
    if !ui_state.prefs.recent.is_empty() {
        ui.menu_button(tr!("files-recent"), |ui| {
            for path in &ui_state.prefs.recent {
                let name =
                    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    out.push(UiRequest::OpenMesh(path.clone()));
                    ui.close();
                }
            }
        });
    }
    if !ui_state.earlier.all.is_empty() && ui.button(tr!("files-earlier")).clicked() {
        ui_state.earlier.open = true;
    }
    ui.add_space(8.0);
    ui.strong(tr!("files-export"));
    let files = &mut ui_state.files;
    field(ui, &mut files.export, "files-export-name");
    rows::flow(ui, |ui| {
        let label = ui.label(tr!("files-scale"));
        ui.add(egui::DragValue::new(&mut files.scale).range(1e-6..=1e6).speed(0.01))
            .labelled_by(label.id);
        let choice = !states_unit(Path::new(files.export.trim()));
        ui.add_enabled_ui(choice, |ui| {
            let unit = egui::ComboBox::from_label(tr!("files-unit")).width(60.0);
            unit.selected_text(tr!(files.factor(Path::new(files.export.trim())).1)).show_ui(
                ui,
                |ui| {
                    for (i, (name, _)) in UNITS.iter().enumerate() {
                        ui.selectable_value(&mut files.unit, i, tr!(name));
                    }
                },
            );
        });
    });
    let (lo, hi) = view.state.mesh.bounds();
    let (factor, unit) = files.factor(Path::new(files.export.trim()));
    let size = (hi - lo).max(glam::Vec3::ZERO).as_dvec3() * factor;
    let [x, y, z] = size.to_array().map(|n| format!("{n:.3}"));
    ui.colored_label(quiet, tr!("scene-size", x = x, y = y, z = z, unit = tr!(unit)));
    rows::flow(ui, |ui| {
        let named = !files.export.trim().is_empty();
        if ui.add_enabled(named, egui::Button::new(tr!("export"))).clicked() {
            let path = in_documents(PathBuf::from(files.export.trim()));
            if path.exists() {
                files.replace = Some(path);
            } else {
                out.push(UiRequest::Export(path));
            }
        }
        if ui.button(tr!("files-save-as")).on_hover_text(view.tip(Action::Export)).clicked() {
            out.push(UiRequest::Do(Action::Export));
        }
    });
    ui.colored_label(quiet, "stl, obj, ply, off, glb, 3mf");
    ui.add_space(8.0);
    ui.strong(tr!("files-pictures"));
    if ui.button(tr!("files-screenshot")).on_hover_text(view.tip(Action::Screenshot)).clicked() {
        out.push(UiRequest::Do(Action::Screenshot));
    }
    rows::flow(ui, |ui| {
        if ui.button(tr!("files-turntable")).on_hover_text(view.tip(Action::Turntable)).clicked() {
            out.push(UiRequest::Do(Action::Turntable));
        }
        let label = ui.label(tr!("files-frames"));
        ui.add(egui::DragValue::new(&mut ui_state.files.frames).range(4..=360))
            .labelled_by(label.id);
    });
}

/// A name alone is one in the person's folder of documents.
fn in_documents(path: PathBuf) -> PathBuf {
    let dirs = directories::UserDirs::new();
    let folder = dirs.map(|d| d.document_dir().unwrap_or(d.home_dir()).to_owned());
    folder.filter(|f| f.is_dir()).map_or(path.clone(), |f| f.join(path))
}

/// Asks whether an export may replace a file.
pub fn replace(
    ctx: &egui::Context,
    ui_state: &mut UiState,
    free: egui::Rect,
    out: &mut Vec<UiRequest>,
) {
    let Some(path) = ui_state.files.replace.clone() else { return };
    let area = egui::Area::new(egui::Id::unique("replace"))
        .fixed_pos(free.center())
        .pivot(egui::Align2::CENTER_CENTER)
        .order(egui::Order::Foreground);
    area.show(ctx, |ui| {
        egui::Frame::window(ui.style()).show(ui, |ui| {
            ui.set_max_width((free.width() - 40.0).clamp(120.0, 420.0));
            ui.label(tr!("files-replace.question", path = path.display().to_string()));
            ui.horizontal(|ui| {
                if ui.button(tr!("files-replace")).clicked() {
                    out.push(UiRequest::Export(path.clone()));
                    ui_state.files.replace = None;
                }
                if ui.button(tr!("cancel")).clicked()
                    || ui.input(|i| i.key_pressed(egui::Key::Escape))
                {
                    ui_state.files.replace = None;
                }
            });
        });
    });
}
