//! The window's own file chooser, for a desktop that offers none.

use std::path::PathBuf;

/// Purpose of choosing a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePurpose {
    Open,
    Export,
}

/// An entry of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderEntry {
    pub name: String,
    pub folder: bool,
    /// Of a file.
    pub bytes: u64,
}

/// The contents of a folder, folders first, then mesh files, each by name; or why it cannot be
/// read.
pub type FolderListing = Result<Vec<FolderEntry>, String>;

/// An open file chooser.
#[derive(Debug)]
pub struct FileChooser {
    pub purpose: FilePurpose,
    pub folder: PathBuf,
    /// `None` until the folder has been read.
    pub listing: Option<FolderListing>,
    /// The name of the file that is chosen or written.
    pub name: String,
    /// The name has had the keyboard's focus.
    pub begun: bool,
}

/// The endings of the files that are offered.
pub const MESH_ENDINGS: [&str; 7] = ["stl", "obj", "ply", "off", "glb", "gltf", "3mf"];

impl FileChooser {
    pub fn new(purpose: FilePurpose, folder: PathBuf) -> Self {
        let name = match purpose {
            FilePurpose::Open => String::new(),
            FilePurpose::Export => "sculpture.stl".into(),
        };
        FileChooser { purpose, folder, listing: None, name, begun: false }
    }

    /// Goes to another folder, which is still to be read.
    pub fn go_to(&mut self, folder: PathBuf) {
        self.folder = folder;
        self.listing = None;
        if self.purpose == FilePurpose::Open {
            self.name.clear();
        }
    }

    /// The file that the name stands for; `None` without a name. A whole path may be typed.
    pub fn file(&self) -> Option<PathBuf> {
        let name = self.name.trim();
        (!name.is_empty()).then(|| self.folder.join(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_in_the_folder_and_a_path_is_itself() {
        let mut chooser = FileChooser::new(FilePurpose::Open, "/a".into());
        assert_eq!(chooser.file(), None);
        chooser.name = "pig.stl ".into();
        assert_eq!(chooser.file(), Some("/a/pig.stl".into()));
        chooser.name = "/b/cow.ply".into();
        assert_eq!(chooser.file(), Some("/b/cow.ply".into()));
        chooser.go_to("/c".into());
        assert_eq!((chooser.file(), chooser.listing), (None, None));
    }
}
