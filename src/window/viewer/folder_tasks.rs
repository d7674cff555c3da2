//! Tasks over a person's folders: listing one, reading and keeping pictures for the look of the
//! clay.

use std::path::PathBuf;

use super::folder_listing::list_folder;
use super::look_files::{LookFiles, LookFilesWanted, LookFolders};
use super::tasks::{TaskReport, Tasks, thread};

impl Tasks {
    /// Reads a folder for the window's own file chooser.
    pub fn list(&self, folder: PathBuf) {
        let say = self.reporter();
        thread("sculptd-folder", move || {
            let listing = list_folder(&folder);
            let _ = say.send(TaskReport::Listed(folder, listing));
        });
    }

    /// Reads pictures for the look.
    pub fn look(&self, wanted: LookFilesWanted, folders: LookFolders) {
        let say = self.reporter();
        thread("sculptd-look", move || {
            let found = LookFiles::read(&wanted, &folders);
            let _ = say.send(TaskReport::Look(Box::new(found)));
        });
    }

    /// Keeps a picture that was dropped on the window.
    pub fn keep_picture(&self, path: PathBuf, folders: LookFolders) {
        let say = self.reporter();
        thread("sculptd-look", move || {
            let _ = say.send(match folders.keep(&path) {
                Ok(kept) => TaskReport::KeptPicture(kept.display().to_string()),
                Err(e) => TaskReport::Message(e, true),
            });
        });
    }
}
