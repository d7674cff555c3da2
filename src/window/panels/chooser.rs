//! The window's own file chooser: folders and mesh files, a name, and where to go from here.

use std::path::PathBuf;

use super::rows;
use super::state::{FileChooser, FilePurpose, UiRequest, UiState};
use super::theme;
use crate::language::tr;

/// Folders that are offered beside the list: the message of the name, and the place.
fn places() -> Vec<(&'static str, PathBuf)> {
    let Some(dirs) = directories::UserDirs::new() else { return Vec::new() };
    let mut all = vec![("chooser-home", dirs.home_dir().to_owned())];
    let more = [
        ("chooser-documents", dirs.document_dir()),
        ("chooser-downloads", dirs.download_dir()),
        ("chooser-desktop", dirs.desktop_dir()),
    ];
    all.extend(more.into_iter().filter_map(|(name, path)| Some((name, path?.to_owned()))));
    all.retain(|(_, path)| path.is_dir());
    all
}

/// A size for people.
fn size(bytes: u64) -> String {
    match bytes {
        0..1024 => tr!("size-bytes", value = bytes),
        1024..1_048_576 => tr!("size-kilobytes", value = bytes / 1024),
        _ => tr!("size-megabytes", value = format!("{:.1}", bytes as f64 / 1_048_576.0)),
    }
}

/// Action in the chooser in this frame.
enum ChooserStep {
    Stay,
    GoTo(PathBuf),
    Choose(PathBuf),
    Close,
}

pub fn ui(ctx: &egui::Context, ui_state: &mut UiState, free: egui::Rect, out: &mut Vec<UiRequest>) {
    let Some(chooser) = &mut ui_state.chooser else { return };
    let title = match chooser.purpose {
        FilePurpose::Open => tr!("chooser-open"),
        FilePurpose::Export => tr!("chooser-export"),
    };
    let mut step = ChooserStep::Stay;
    let area = egui::Area::new(egui::Id::unique("chooser"))
        .fixed_pos(free.center())
        .pivot(egui::Align2::CENTER_CENTER)
        .order(egui::Order::Foreground);
    area.show(ctx, |ui| {
        egui::Frame::window(ui.style()).show(ui, |ui| {
            ui.set_width((free.width() - 40.0).clamp(200.0, 460.0));
            ui.strong(title);
            step = inside(ui, chooser, (free.height() - 220.0).clamp(60.0, 320.0));
        });
    });
    if ctx.input(|i| i.key_pressed(egui::Key::Escape)) {
        step = ChooserStep::Close;
    }
    match step {
        ChooserStep::Stay => {}
        ChooserStep::GoTo(folder) => {
            chooser.go_to(folder.clone());
            out.push(UiRequest::ListFolder(folder));
        }
        ChooserStep::Choose(path) => {
            match chooser.purpose {
                FilePurpose::Open => out.push(UiRequest::OpenMesh(path)),
                FilePurpose::Export if path.exists() => ui_state.files.replace = Some(path),
                FilePurpose::Export => out.push(UiRequest::Export(path)),
            }
            ui_state.chooser = None;
        }
        ChooserStep::Close => ui_state.chooser = None,
    }
}

fn inside(ui: &mut egui::Ui, chooser: &mut FileChooser, height: f32) -> ChooserStep {
    let mut step = ChooserStep::Stay;
    rows::flow(ui, |ui| {
        let up = chooser.folder.parent().map(PathBuf::from);
        if ui.add_enabled(up.is_some(), egui::Button::new(tr!("chooser-up"))).clicked()
            && let Some(up) = up
        {
            step = ChooserStep::GoTo(up);
        }
        for (name, path) in places() {
            if ui.button(tr!(name)).clicked() {
                step = ChooserStep::GoTo(path);
            }
        }
    });
    ui.colored_label(theme::quiet(ui), chooser.folder.display().to_string());
    let scroll = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
    scroll.auto_shrink([false, false]).show(ui, |ui| match &chooser.listing {
        None => drop(ui.colored_label(theme::quiet(ui), tr!("chooser-reading"))),
        Some(Err(why)) => drop(ui.colored_label(theme::alarm(ui), why)),
        Some(Ok(entries)) if entries.is_empty() => {
            ui.colored_label(theme::quiet(ui), tr!("chooser-empty"));
        }
        Some(Ok(entries)) => {
            for entry in entries {
                let chosen = !entry.folder && chooser.name == entry.name;
                let text = match entry.folder {
                    true => format!("{}/", entry.name),
                    false => format!("{}   {}", entry.name, size(entry.bytes)),
                };
                let row = ui.selectable_label(chosen, text);
                let path = chooser.folder.join(&entry.name);
                if entry.folder && row.clicked() {
                    step = ChooserStep::GoTo(path);
                } else if row.double_clicked() {
                    step = ChooserStep::Choose(path);
                } else if row.clicked() {
                    chooser.name.clone_from(&entry.name);
                }
            }
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label(tr!("chooser-name"));
        let edit = egui::TextEdit::singleline(&mut chooser.name).desired_width(f32::INFINITY);
        let typed = ui.add(edit).labelled_by(label.id);
        if !std::mem::replace(&mut chooser.begun, true) {
            typed.request_focus();
        }
        if typed.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
            // A folder that is typed is gone into.
            match chooser.file() {
                Some(path) if path.is_dir() => step = ChooserStep::GoTo(path),
                Some(path) => step = ChooserStep::Choose(path),
                None => {}
            }
        }
    });
    ui.horizontal(|ui| {
        let file = chooser.file();
        let verb = match chooser.purpose {
            FilePurpose::Open => tr!("open"),
            FilePurpose::Export => tr!("export"),
        };
        if ui.add_enabled(file.is_some(), egui::Button::new(verb)).clicked()
            && let Some(path) = file
        {
            step = ChooserStep::Choose(path);
        }
        if ui.button(tr!("cancel")).clicked() {
            step = ChooserStep::Close;
        }
    });
    step
}
