//! The file that keeps the preferences between runs. It is written when something changed.

use std::path::PathBuf;

use crate::panels::state::{Preferences, UiState};
use sculptd_geometry::io::write_beside;

#[derive(Debug)]
pub struct PreferencesFile {
    path: Option<PathBuf>,
    kept: Preferences,
}

impl PreferencesFile {
    /// The state of the window as the person left it.
    pub fn load() -> (PreferencesFile, UiState) {
        let path = directories::ProjectDirs::from("", "", "sculptd")
            .map(|d| d.config_dir().join("viewer.toml"));
        let text = path.as_ref().and_then(|p| std::fs::read_to_string(p).ok()).unwrap_or_default();
        let prefs = Preferences::parse(&text);
        let ui_state = UiState { look: prefs.look, prefs: prefs.clone(), ..Default::default() };
        (PreferencesFile { path, kept: prefs }, ui_state)
    }

    /// The state of a new window, of which nothing will be kept.
    pub fn nothing() -> (PreferencesFile, UiState) {
        let ui_state = UiState::default();
        (PreferencesFile { path: None, kept: ui_state.prefs.clone() }, ui_state)
    }

    /// Writes what changed; a folder that cannot be written is nobody's concern here.
    pub fn keep(&mut self, ui_state: &UiState) {
        let mut now = ui_state.prefs.clone();
        now.look = ui_state.look;
        // A map is for a moment.
        now.look.map = Default::default();
        now.look.scale = self.kept.look.scale;
        if now == self.kept {
            return;
        }
        if let (Some(path), Ok(text)) = (&self.path, toml::to_string(&now)) {
            if let Some(folder) = path.parent() {
                let _ = std::fs::create_dir_all(folder);
            }
            let _ = write_beside(path, |out| out.write_all(text.as_bytes()));
        }
        self.kept = now;
    }
}
