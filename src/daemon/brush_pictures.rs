//! The pictures of heights in the folder of a person's own brushes that belong to none of them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use sculptd_clay::brush::own_brush::AlphaPicture;
use sculptd_clay::brush::{Picture, Presets};
use sculptd_geometry::io::read_regular;

/// Endings of files that are pictures.
const ENDINGS: [&str; 7] = ["png", "jpg", "jpeg", "webp", "tif", "tiff", "exr"];
/// Pictures in a folder at most, and bytes of all together, as they are kept.
const MOST: usize = 200;
const MAX_BYTES: usize = 256 << 20;

/// Longest file of a picture, bytes.
const MAX_PICTURE_FILE: u64 = 64 << 20;

/// Identity of one version of a file: its length and modification time.
pub type Stamp = (u64, Option<SystemTime>);

pub fn stamp(path: &Path) -> Option<Stamp> {
    let meta = std::fs::metadata(path).ok()?;
    Some((meta.len(), meta.modified().ok()))
}

/// Reads a picture of heights.
///
/// # Errors
/// Names the file, and says what is wrong with it.
pub fn read_picture(path: &Path) -> Result<Picture, String> {
    let bytes = read_regular(path, MAX_PICTURE_FILE).map_err(|e| e.to_string());
    let picture = bytes.and_then(|bytes| Picture::decode(&bytes));
    picture.map_err(|e| format!("picture {}: {e}", path.display()))
}

/// A file as it was read: which version of it, and the picture, or what is wrong with it.
type PictureFile = (Option<Stamp>, Result<Arc<Picture>, String>);

/// The pictures as they were read last.
#[derive(Debug, Default)]
pub struct BrushPictures {
    files: BTreeMap<PathBuf, PictureFile>,
}

impl BrushPictures {
    /// Returns true if the file name has the extension of a picture.
    pub fn is_one(path: &Path) -> bool {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        ending.is_some_and(|e| ENDINGS.contains(&e.as_str()))
    }

    /// Reads the files of `found` that changed since the last call, and passes them to the presets.
    /// Returns true if any file changed.
    pub fn refresh(&mut self, mut found: Vec<PathBuf>, presets: &Presets) -> bool {
        found.sort();
        found.truncate(MOST);
        let before = self.files.len();
        self.files.retain(|path, _| found.binary_search(path).is_ok());
        let mut changed = self.files.len() != before;
        for path in found {
            let now = stamp(&path);
            if self.files.get(&path).is_none_or(|file| file.0 != now) {
                let read = read_picture(&path).map(Arc::new);
                self.files.insert(path, (now, read));
                changed = true;
            }
        }
        if changed {
            let mut bytes = 0;
            let read = self.files.iter().filter_map(|(path, (_, read))| {
                let picture = read.as_ref().ok()?.clone();
                bytes += (picture.heights.len() + picture.cover.len()) * 2;
                let name = path.file_stem()?.to_string_lossy().into_owned();
                (bytes <= MAX_BYTES).then_some(AlphaPicture { name, picture })
            });
            presets.set_pictures(read.collect());
        }
        changed
    }

    /// Returns the error message of each file that cannot be read, with the file's name.
    pub fn problems(&self) -> impl Iterator<Item = &String> {
        self.files.values().filter_map(|file| file.1.as_ref().err())
    }
}
