//! The settings file of an installation on its disk, the one before it, and a file on trial.
//!
//! Each file is written beside and renamed, in an order in which a cut at any place leaves either
//! the old settings or the new ones on trial. If the program dies during a trial, its next start
//! reverts the trial.
//!
//! ```text
//! kiosk.toml             in place
//! kiosk.toml.previous    restored by a roll-back
//! kiosk.toml.before      in place before the trial
//! kiosk.toml.trial       the mark of a trial: the revision, its seconds, how often it began
//! ```

use std::path::{Path, PathBuf};

use ring::digest;
use serde::{Deserialize, Serialize};

use super::state::SettingsState;
use sculptd_geometry::io::write_beside;

/// The settings that a roll-out may change. All others belong to one installation and its owner:
/// they name its programs, folders and addresses, and a key of the fleet must not be enough to run
/// a program or to send works elsewhere.
pub const ROLLED_OUT: [&str; 13] = [
    "idle_s",
    "countdown_s",
    "max_triangles",
    "undo_bytes",
    "language",
    "languages",
    "staff_pin",
    "share_minutes",
    "interrupted",
    "attract",
    "brush",
    "radius",
    "screen",
];
/// Runs that may begin with a file on trial.
const STARTS: u32 = 1;

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrialMark {
    revision: String,
    trial_s: u32,
    starts: u32,
}

/// State found by a start.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrialStart {
    /// Settings without a trial.
    Settled,
    /// Settings on trial, for this number of seconds.
    OnTrial {
        /// Seconds.
        trial_s: u32,
    },
    /// The trial before ended in the death of the program: the file before it is in place again.
    TakenBack {
        /// The revision that was on trial.
        revision: String,
    },
}

/// The files of an installation.
#[derive(Debug, Clone)]
pub struct SettingsFiles {
    path: PathBuf,
}

/// The name of settings: the first 16 hexadecimal digits of the SHA-256 of those in [`ROLLED_OUT`],
/// as TOML without comments.
///
/// # Errors
/// The text is no TOML.
pub fn revision_of(text: &str) -> Result<String, String> {
    let mut table: toml::Table = toml::from_str(text).map_err(|e| e.to_string())?;
    table.retain(|name, _| is_rolled_out(name));
    let plain = toml::to_string(&table).map_err(|e| e.to_string())?;
    let sum = digest::digest(&digest::SHA256, plain.as_bytes());
    Ok(sum.as_ref()[..8].iter().map(|b| format!("{b:02x}")).collect())
}

fn is_rolled_out(name: &str) -> bool {
    ROLLED_OUT.contains(&name)
}

impl SettingsFiles {
    /// The files around a settings file.
    pub fn new(path: &Path) -> SettingsFiles {
        SettingsFiles { path: path.into() }
    }

    /// The settings file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn beside(&self, ending: &str) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        name.push(ending);
        name.into()
    }

    /// The revision that is in place; `None`: there is no file, or it is no TOML.
    pub fn revision(&self) -> Option<String> {
        revision_of(&read(&self.path)?).ok()
    }

    /// The revision that [`SettingsFiles::take_back`] brings.
    pub fn previous(&self) -> Option<String> {
        let before = self.mark().map_or(".previous", |_| ".before");
        revision_of(&read(&self.beside(before))?).ok()
    }

    /// Returns true if the settings in place are on trial.
    pub fn is_on_trial(&self) -> bool {
        self.mark().is_some()
    }

    /// As an installation publishes it.
    pub fn state(&self) -> SettingsState {
        SettingsState {
            revision: self.revision().unwrap_or_default(),
            trial: self.is_on_trial(),
            previous: self.previous(),
        }
    }

    fn mark(&self) -> Option<TrialMark> {
        let mark: TrialMark = toml::from_str(&read(&self.beside(".trial"))?).ok()?;
        // A cut before the file was in place leaves a mark of what never was.
        (self.revision().as_ref() == Some(&mark.revision)).then_some(mark)
    }

    fn write_mark(&self, mark: &TrialMark) -> Result<(), String> {
        write(&self.beside(".trial"), &toml::to_string(mark).unwrap_or_default())
    }

    fn remove_mark(&self) -> Result<(), String> {
        remove(&self.beside(".trial"))
    }

    /// To be called once by each start of the program, before the settings are read.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn begin(&self) -> Result<TrialStart, String> {
        let Some(mut mark) = self.mark() else {
            self.remove_mark()?;
            return Ok(TrialStart::Settled);
        };
        if mark.starts >= STARTS {
            let revision = mark.revision;
            self.take_back(None)?;
            return Ok(TrialStart::TakenBack { revision });
        }
        mark.starts += 1;
        self.write_mark(&mark)?;
        Ok(TrialStart::OnTrial { trial_s: mark.trial_s })
    }

    /// Puts settings in place, on trial. `Ok(false)`: they are in place already.
    ///
    /// # Errors
    /// The text is no TOML or has a setting beyond [`ROLLED_OUT`], or a file cannot be written;
    /// nothing has changed.
    pub fn try_settings(&self, text: &str, trial_s: u32) -> Result<bool, String> {
        let table: toml::Table = toml::from_str(text).map_err(|e| e.to_string())?;
        if let Some(own) = table.keys().find(|name| !is_rolled_out(name)) {
            return Err(format!("`{own}` is each installation's own: leave it out"));
        }
        let revision = revision_of(text)?;
        let old = read(&self.path).ok_or_else(|| format!("{}: not read", self.path.display()))?;
        if revision_of(&old).as_ref() == Ok(&revision) {
            return Ok(false);
        }
        if self.is_on_trial() {
            return Err("other settings are on trial".into());
        }
        let table: toml::Table = toml::from_str(&old).map_err(|e| e.to_string())?;
        let own = table.into_iter().filter(|(name, _)| !is_rolled_out(name));
        // Keys must come before tables.
        let (tables, keys): (toml::Table, toml::Table) = own.partition(|(_, v)| v.is_table());
        let of = |table: &toml::Table| toml::to_string(table).map_err(|e| e.to_string());
        let new = format!("{}{}\n\n{}", of(&keys)?, text.trim_end(), of(&tables)?);
        write(&self.beside(".before"), &old)?;
        self.write_mark(&TrialMark { revision, trial_s, starts: 0 })?;
        write(&self.path, &new)?;
        Ok(true)
    }

    /// Ends a trial: the settings stay, and those before them are what a roll-back brings.
    ///
    /// # Errors
    /// Another revision is in place, or a file cannot be renamed.
    pub fn keep(&self, revision: &str) -> Result<(), String> {
        let now = self.revision().unwrap_or_default();
        if now != revision {
            return Err(format!("{now} is in place, not {revision}"));
        }
        if self.is_on_trial() {
            rename(&self.beside(".before"), &self.beside(".previous"))?;
            self.remove_mark()?;
        }
        Ok(())
    }

    /// Restores the earlier settings: those before the trial, or those before the last that were
    /// kept. With a `revision`, only if it is in place. Returns true if anything was restored.
    ///
    /// # Errors
    /// No earlier settings exist, or a file cannot be renamed.
    pub fn take_back(&self, revision: Option<&str>) -> Result<bool, String> {
        if revision.is_some_and(|r| self.revision().as_deref() != Some(r)) {
            return Ok(false);
        }
        if self.is_on_trial() {
            rename(&self.beside(".before"), &self.path)?;
            self.remove_mark()?;
            return Ok(true);
        }
        let previous = self.beside(".previous");
        let old = read(&previous).ok_or("there are no settings before these")?;
        let now = read(&self.path).unwrap_or_default();
        write(&self.path, &old)?;
        write(&previous, &now)?;
        Ok(true)
    }
}

fn read(path: &Path) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let written = write_beside(path, |out| out.write_all(text.as_bytes()));
    written.map_err(|e| format!("{}: {e}", path.display()))
}

fn rename(from: &Path, to: &Path) -> Result<(), String> {
    std::fs::rename(from, to).map_err(|e| format!("{}: {e}", from.display()))
}

fn remove(path: &Path) -> Result<(), String> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(format!("{}: {e}", path.display()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = "idle_s = 30.0\n[fleet]\nname = \"museum\"\n";
    const NEW: &str = "idle_s = 50.0 # longer\n[screen]\ntext = 2.0\n";

    fn files() -> (tempfile::TempDir, SettingsFiles) {
        let folder = tempfile::tempdir().expect("a folder");
        let files = SettingsFiles::new(&folder.path().join("kiosk.toml"));
        write(files.path(), OLD).expect("written");
        (folder, files)
    }

    #[test]
    fn a_revision_knows_settings_and_neither_comments_nor_whose_they_are() {
        let of = |text| revision_of(text).expect("TOML");
        assert_eq!(of("radius = 1 # one\n[fleet]\nname = \"x\""), of("radius=1"));
        assert_eq!(of("radius = 1\nspeak = [\"say\"]\n"), of("radius=1"));
        assert_ne!(of("radius = 1"), of("radius = 2"));
        assert!(revision_of("a = ").is_err());
        // Named in a document: it must not change.
        assert_eq!(of("idle_s = 50.0"), of("idle_s = 50.0 "));
        assert_eq!(of("").len(), 16);
    }

    #[test]
    fn settings_on_trial_keep_the_own_table_and_are_kept_or_taken_back() {
        let (_folder, files) = files();
        let old = files.revision();
        assert!(files.try_settings("[fleet]\nname = \"other\"\n", 9).is_err());
        assert!(files.try_settings("idle_s = ", 9).is_err());
        assert_eq!(files.try_settings(NEW, 9), Ok(true));
        assert_eq!(files.try_settings(NEW, 9), Ok(false), "the same again");
        assert!(files.try_settings("idle_s = 9.0", 9).is_err(), "one trial at a time");
        let text = read(files.path()).expect("in place");
        assert!(text.contains("longer") && text.contains("museum"), "{text}");
        assert_eq!(files.revision(), revision_of(NEW).ok());
        assert_eq!((files.previous(), files.is_on_trial()), (old.clone(), true));
        assert_eq!(files.begin(), Ok(TrialStart::OnTrial { trial_s: 9 }));
        assert_eq!(files.take_back(Some("another")), Ok(false));
        assert_eq!(files.take_back(None), Ok(true));
        assert_eq!(read(files.path()).as_deref(), Some(OLD));
        assert!(files.take_back(None).is_err(), "nothing was before");
        // Kept, then rolled back and restored again.
        files.try_settings(NEW, 9).expect("on trial");
        assert!(files.keep("another").is_err());
        files.keep(&revision_of(NEW).expect("TOML")).expect("kept");
        assert_eq!((files.begin(), files.is_on_trial()), (Ok(TrialStart::Settled), false));
        assert_eq!(files.previous(), old);
        assert_eq!(files.take_back(None), Ok(true));
        assert_eq!(read(files.path()).as_deref(), Some(OLD));
        assert_eq!(files.take_back(None), Ok(true));
        assert_eq!(files.revision(), revision_of(NEW).ok());
    }

    #[test]
    fn nothing_that_names_programs_or_places_comes_over_the_network() {
        let (_folder, files) = files();
        let own = "speak = [\"espeak-ng\"]\ngallery = \"works\"\n";
        write(files.path(), &format!("{own}{OLD}")).expect("written");
        let refused =
            ["speak = [\"sh\", \"-c\"]", "gallery_store = \"/elsewhere\"", "audit = \"x\""];
        for text in refused.iter().chain(&["share = \"80\"", "unknown = 1"]) {
            let why = files.try_settings(&format!("idle_s = 9.0\n{text}\n"), 9);
            assert!(why.is_err_and(|why| why.contains("own")), "{text}");
        }
        assert_eq!(files.try_settings(NEW, 9), Ok(true));
        let text = read(files.path()).expect("in place");
        let table: toml::Table = toml::from_str(&text).expect("TOML");
        assert_eq!(table["speak"].as_array().map(Vec::len), Some(1), "{text}");
        assert_eq!(table["gallery"].as_str(), Some("works"));
        assert_eq!(table["fleet"]["name"].as_str(), Some("museum"));
        assert_eq!(table["idle_s"].as_float(), Some(50.0));
    }

    #[test]
    fn a_trial_that_kills_the_program_is_taken_back_by_the_next_start() {
        let (_folder, files) = files();
        files.try_settings(NEW, 9).expect("on trial");
        assert_eq!(files.begin(), Ok(TrialStart::OnTrial { trial_s: 9 }));
        let revision = revision_of(NEW).expect("TOML");
        assert_eq!(files.begin(), Ok(TrialStart::TakenBack { revision }));
        assert_eq!(read(files.path()).as_deref(), Some(OLD));
        assert_eq!(files.begin(), Ok(TrialStart::Settled));
    }

    #[test]
    fn a_cut_between_any_two_writes_leaves_the_old_settings_or_the_trial() {
        let (_folder, files) = files();
        // The mark exists, the new file does not.
        let revision = revision_of(NEW).expect("TOML");
        files.write_mark(&TrialMark { revision, trial_s: 9, starts: 0 }).expect("written");
        assert!(!files.is_on_trial());
        assert_eq!(files.begin(), Ok(TrialStart::Settled));
        assert_eq!(read(files.path()).as_deref(), Some(OLD));
        // The old file is back, the mark still there.
        files.try_settings(NEW, 9).expect("on trial");
        rename(&files.beside(".before"), files.path()).expect("renamed");
        assert!(!files.is_on_trial());
        assert_eq!(files.begin(), Ok(TrialStart::Settled));
        assert!(read(&files.beside(".trial")).is_none());
    }
}
