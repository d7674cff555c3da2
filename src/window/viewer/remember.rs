//! What the window remembers from day to day: one small file of preferences, written when something
//! changed.

use std::path::PathBuf;

use crate::panels::UiState;
use crate::panels::preferences::Preferences;
use sculptd_geometry::io::write_beside;

#[derive(Debug)]
pub struct Remembered {
    path: Option<PathBuf>,
    kept: Preferences,
}

impl Remembered {
    /// A desk as the person left it.
    pub fn load() -> (Remembered, UiState) {
        let path = directories::ProjectDirs::from("", "", "sculptd")
            .map(|d| d.config_dir().join("viewer.toml"));
        let text = path.as_ref().and_then(|p| std::fs::read_to_string(p).ok()).unwrap_or_default();
        let prefs = Preferences::parse(&text);
        let desk = UiState { look: prefs.look, prefs: prefs.clone(), ..Default::default() };
        (Remembered { path, kept: prefs }, desk)
    }

    /// A desk as it comes, of which nothing will be kept.
    pub fn nothing() -> (Remembered, UiState) {
        let desk = UiState::default();
        (Remembered { path: None, kept: desk.prefs.clone() }, desk)
    }

    /// Writes what changed; a folder that cannot be written is nobody's concern here.
    pub fn keep(&mut self, desk: &UiState) {
        let mut now = desk.prefs.clone();
        now.look = desk.look;
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
