//! The file that keeps the preferences between runs. It is written after a change. A failed write
//! is reported once, and an unreadable file is moved aside before it is overwritten.

use std::path::{Path, PathBuf};

use crate::language::tr;
use crate::panels::state::{Preferences, UiState};
use sculptd_geometry::io::write_beside;

/// Path of the preferences, and the values last saved there.
#[derive(Debug)]
pub struct PreferencesFile {
    path: Option<PathBuf>,
    kept: Preferences,
    /// Fault of the file, until it is reported.
    wrong: Option<PreferencesFault>,
    /// True if the last write failed, and that was reported.
    failing: bool,
}

/// Why a file of preferences was not read.
#[derive(Debug)]
enum PreferencesFault {
    /// It holds something else; and the file that it was set aside as, or why it could not be.
    Unreadable(String, Result<PathBuf, String>),
    Unread(String),
}

impl PreferencesFault {
    fn message(self, path: &Path) -> String {
        let path = path.display().to_string();
        match self {
            PreferencesFault::Unreadable(error, Ok(aside)) => {
                let aside = aside.display().to_string();
                tr!("task-preferences-unreadable", path = path, error = error, aside = aside)
            }
            PreferencesFault::Unreadable(error, Err(why)) => {
                tr!("task-preferences-stuck", path = path, error = error, why = why)
            }
            PreferencesFault::Unread(error) => {
                tr!("task-preferences-unread", path = path, error = error)
            }
        }
    }
}

impl PreferencesFile {
    /// The state of the window as the person left it.
    pub fn load() -> (PreferencesFile, UiState) {
        match directories::ProjectDirs::from("", "", "sculptd") {
            Some(d) => PreferencesFile::load_from(&d.config_dir().join("viewer.toml")),
            None => PreferencesFile::nothing(),
        }
    }

    /// The same from a file of this name, which need not be there.
    pub fn load_from(path: &Path) -> (PreferencesFile, UiState) {
        let mut wrong = None;
        let prefs = match std::fs::read_to_string(path) {
            Ok(text) => Preferences::read(&text).unwrap_or_else(|e| {
                let aside = path.with_extension("toml.unreadable");
                let kept = std::fs::rename(path, &aside).map(|()| aside);
                let kept = kept.map_err(|e| e.to_string());
                wrong = Some(PreferencesFault::Unreadable(e, kept));
                Preferences::default()
            }),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Preferences::default(),
            Err(e) => {
                wrong = Some(PreferencesFault::Unread(e.to_string()));
                Preferences::default()
            }
        };
        let ui_state = UiState { look: prefs.look, prefs: prefs.clone(), ..Default::default() };
        let file = PreferencesFile { path: Some(path.into()), kept: prefs, wrong, failing: false };
        (file, ui_state)
    }

    /// The state of a new window, of which nothing will be kept.
    pub fn nothing() -> (PreferencesFile, UiState) {
        let ui_state = UiState::default();
        let kept = ui_state.prefs.clone();
        (PreferencesFile { path: None, kept, wrong: None, failing: false }, ui_state)
    }

    /// Writes what changed. What went wrong is returned, to be shown: once, and again after a write
    /// that went well; what was not kept is tried again at the next call.
    pub fn keep(&mut self, ui_state: &UiState) -> Option<String> {
        if let Some((wrong, path)) = self.wrong.take().zip(self.path.as_deref()) {
            return Some(wrong.message(path));
        }
        let mut now = ui_state.prefs.clone();
        now.look = ui_state.look;
        // A map is for a moment.
        now.look.map = Default::default();
        now.look.scale = self.kept.look.scale;
        now.look.cut = None;
        let path = self.path.as_ref().filter(|_| now != self.kept)?;
        let text = toml::to_string(&now).map_err(std::io::Error::other);
        let done = text.and_then(|text| {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)?;
            }
            write_beside(path, |out| out.write_all(text.as_bytes()))
        });
        match done {
            Ok(()) => {
                (self.kept, self.failing) = (now, false);
                None
            }
            Err(e) => {
                let told = std::mem::replace(&mut self.failing, true);
                let (path, error) = (path.display().to_string(), e.to_string());
                let text = tr!("task-preferences-not-kept", path = path, error = error);
                (!told).then_some(text)
            }
        }
    }
}
