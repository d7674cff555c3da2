//! How the clay is shown.

use crate::viewer::look::{Look, MATERIALS};

pub fn ui(ui: &mut egui::Ui, look: &mut Look) {
    ui.strong("Display");
    egui::ComboBox::from_label("Material").selected_text(look.material().name).show_ui(ui, |ui| {
        for (i, m) in MATERIALS.iter().enumerate() {
            ui.selectable_value(&mut look.material, i, m.name);
        }
    });
    ui.checkbox(&mut look.flat, "Facets").on_hover_text("One tone a triangle");
    ui.add(egui::Slider::new(&mut look.cavity, 0.0..=2.0).text("Cavity"))
        .on_hover_text("Hollows darker, ridges lighter");
}
