//! Keeps what lights the clay level with what the person chose: asks for files when the choice or
//! the page changes, and takes what was read onto the card.

use super::look_choice::LookChoice;
use super::look_files::{LookFiles, LookFilesWanted};
use super::state::WindowState;
use crate::look::Light;
use crate::panels::state::Tab;

impl WindowState {
    /// Returns the opacity of the reference picture behind the clay.
    pub(super) fn backdrop(&self) -> f32 {
        let reference = &self.ui_state.prefs.reference;
        let behind = reference.behind && !reference.file.is_empty();
        if behind && self.ui_state.light.reference.is_some() { reference.opacity } else { 0.0 }
    }

    /// Asks for pictures that were not asked for yet; `true` where the clay looks otherwise now.
    pub(super) fn follow_look(&mut self) -> bool {
        let Some(folders) = &self.look_folders else { return false };
        let (look, prefs) = (&self.ui_state.look, &self.ui_state.prefs);
        let chosen = |wanted, name: &String| match wanted {
            true => name.clone(),
            false => String::new(),
        };
        let wanted = LookFilesWanted {
            matcap: chosen(look.light == Light::Matcap, &prefs.matcap),
            environment: chosen(look.light == Light::Environment, &prefs.environment),
            reference: prefs.reference.file.clone(),
            list: self.ui_state.tab == Tab::Look && !self.ui_state.hidden,
        };
        if wanted != self.look_choice.asked {
            self.look_choice.asked = wanted.clone();
            self.tasks.look(wanted, folders.clone());
        }
        let shown = (look.light, self.backdrop().to_bits());
        if self.look_choice.shown == shown {
            return false;
        }
        if shown.0 == Light::Room {
            self.renderer.surroundings.set_room(&self.gpu);
        }
        self.look_choice.shown = shown;
        self.map_changes += 1;
        true
    }

    /// Asks again: files came, or the renderer is new.
    pub(super) fn look_again(&mut self) {
        self.look_choice = LookChoice::default();
    }

    /// Takes what was read.
    pub(super) fn look_read(&mut self, found: LookFiles) {
        for wrong in &found.wrong {
            self.ui_state.say(wrong, true);
        }
        let surroundings = &mut self.renderer.surroundings;
        if let Some(picture) = &found.matcap {
            surroundings.set_matcap(&self.gpu, picture);
        }
        if let Some(environment) = &found.environment {
            surroundings.set_environment(&self.gpu, environment);
        }
        let context = self.egui.egui_ctx().clone();
        let texture = |name: &str, picture: &image::RgbaImage| {
            let size = [picture.width() as usize, picture.height() as usize];
            let image = egui::ColorImage::from_rgba_unmultiplied(size, picture.as_raw());
            context.load_texture(name, image, egui::TextureOptions::LINEAR)
        };
        if let Some(picture) = &found.reference {
            surroundings.set_reference(&self.gpu, picture);
            self.ui_state.light.reference = Some(texture("reference", picture));
        }
        if let Some(all) = found.matcaps {
            let all = all.into_iter().map(|(name, p)| (name.clone(), texture(&name, &p)));
            self.ui_state.light.matcaps = all.collect();
        }
        let light = &mut self.ui_state.light;
        light.environments = found.environments.unwrap_or(std::mem::take(&mut light.environments));
        light.references = found.references.unwrap_or(std::mem::take(&mut light.references));
    }
}
