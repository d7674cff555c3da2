//! Reading a folder for the window's own file chooser.

use std::path::Path;

use crate::panels::state::{FolderEntry, FolderListing, MESH_ENDINGS};

/// Reads a folder: its folders and its mesh files, without those whose names begin with a dot.
///
/// # Errors
/// The error of the system.
pub fn list_folder(folder: &Path) -> FolderListing {
    let found = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mesh = |name: &str| {
        let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase());
        ending.is_some_and(|e| MESH_ENDINGS.contains(&e.as_str()))
    };
    let mut all: Vec<FolderEntry> = found
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            // Links are followed: a folder behind one is a folder.
            let about = std::fs::metadata(entry.path()).ok()?;
            let entry = FolderEntry { folder: about.is_dir(), bytes: about.len(), name };
            let offered = entry.folder || (about.is_file() && mesh(&entry.name));
            (offered && !entry.name.starts_with('.')).then_some(entry)
        })
        .collect();
    all.sort_by_cached_key(|e| (!e.folder, e.name.to_lowercase(), e.name.clone()));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_listed_with_its_folders_and_meshes() {
        let dir = tempfile::tempdir().expect("a folder");
        for name in ["b.STL", "a.ply", "notes.txt", ".hidden.stl"] {
            std::fs::File::create(dir.path().join(name)).expect("a file");
        }
        std::fs::create_dir(dir.path().join("zebra")).expect("a folder");
        let listed = list_folder(dir.path()).expect("readable");
        let names: Vec<&str> = listed.iter().map(|e| e.name.as_str()).collect();
        assert_eq!(names, ["zebra", "a.ply", "b.STL"]);
        assert!(list_folder(&dir.path().join("none")).is_err_and(|e| e.contains("none")));
    }
}
