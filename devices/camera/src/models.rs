//! The model files: where they are, whether they are the ones that were tested, and how they get
//! there.
//!
//! The models are Google's, under the Apache License 2.0. The program does not contain them; they
//! come from the `mediapipe` package of the Python Package Index, which the person's own `pip`
//! downloads. Nothing of it runs.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::hand_tracks::HandTracks;
use crate::inference::ModelError;
use crate::sha256::sha256_hex;

/// The package that contains the models. Versions from 1.2 on contain none.
pub const PACKAGE: &str = "mediapipe==0.10.14";
/// The command that a person types to get them.
pub const SETUP_COMMAND: &str = "sculptd camera setup";
/// Largest model file that is read, bytes.
const MAX_MODEL: u64 = 16 << 20;

/// A model file and its hash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelFile {
    /// Name in the folder of models.
    pub name: &'static str,
    /// Path in the package.
    path: &'static str,
    sha256: &'static str,
}

/// Every file that the camera needs.
pub const MODEL_FILES: [ModelFile; 2] = [
    ModelFile {
        name: "palm_detection_lite.tflite",
        path: "mediapipe/modules/palm_detection/palm_detection_lite.tflite",
        sha256: "e9a4aaddf90dda56a87235303cf00e4c2d3fb28725f68fd88772997dac905c18",
    },
    ModelFile {
        name: "hand_landmark_full.tflite",
        path: "mediapipe/modules/hand_landmark/hand_landmark_full.tflite",
        sha256: "11c272b891e1a99ab034208e23937a8008388cf11ed2a9d776ed3d01d0ba00e3",
    },
];

/// Why the models cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ModelsError {
    /// No folder has them.
    #[error(
        "the hand models are not installed: {} is not in {}. Install them with: {SETUP_COMMAND}",
        name,
        folders(looked)
    )]
    Missing {
        /// The first file that is missing.
        name: &'static str,
        /// Folders in which it was looked for.
        looked: Vec<PathBuf>,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file is not the one that was tested.
    #[error(
        "{}: this is not the tested model (SHA-256 {found}). Replace it with: {SETUP_COMMAND}",
        path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
        /// Its hash.
        found: String,
    },
    /// The package is not the expected one.
    #[error("{}: {why}. Download {PACKAGE} again", path.display())]
    Package {
        /// The package's file.
        path: PathBuf,
        /// The fault.
        why: String,
    },
    /// A tested file could not be loaded.
    #[error("{name}: {source}")]
    Load {
        /// The file.
        name: &'static str,
        /// Why.
        source: ModelError,
    },
}

fn folders(all: &[PathBuf]) -> String {
    let all: Vec<String> = all.iter().map(|p| p.display().to_string()).collect();
    all.join(" or ")
}

fn read(path: &Path) -> Result<Vec<u8>, ModelsError> {
    let failed = |source| ModelsError::Io { path: path.into(), source };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(MAX_MODEL).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

/// Returns the first folder that has all files.
///
/// # Errors
/// Returns an error that names the command to run if there is none.
pub fn find(looked: &[PathBuf]) -> Result<PathBuf, ModelsError> {
    let whole = |folder: &&PathBuf| MODEL_FILES.iter().all(|m| folder.join(m.name).is_file());
    looked.iter().find(whole).cloned().ok_or_else(|| {
        let missing = |m: &&ModelFile| !looked.iter().any(|f| f.join(m.name).is_file());
        let first = MODEL_FILES.iter().find(missing).unwrap_or(&MODEL_FILES[0]);
        ModelsError::Missing { name: first.name, looked: looked.to_vec() }
    })
}

/// Reads and checks the models of a folder.
///
/// # Errors
/// Returns an error if a file cannot be read or is not the tested one.
pub fn load(folder: &Path) -> Result<HandTracks, ModelsError> {
    let mut files = Vec::new();
    for model in MODEL_FILES {
        let path = folder.join(model.name);
        let bytes = read(&path)?;
        let found = sha256_hex(&bytes);
        if found != model.sha256 {
            return Err(ModelsError::Changed { path, found });
        }
        files.push(bytes);
    }
    let name = MODEL_FILES[1].name;
    match files.as_slice() {
        [palm, hand] => {
            HandTracks::new(palm, hand).map_err(|source| ModelsError::Load { name, source })
        }
        _ => Err(ModelsError::Missing { name, looked: vec![folder.into()] }),
    }
}

/// Takes the models out of a downloaded package, checks them, and writes them into a folder.
///
/// # Errors
/// Returns an error if the package lacks a model or has another one, or if the folder cannot be
/// written. Then no file of the folder has changed.
pub fn install(package: &Path, folder: &Path) -> Result<(), ModelsError> {
    let failed = |source| ModelsError::Io { path: package.into(), source };
    let broken = |why: String| ModelsError::Package { path: package.into(), why };
    let file = std::fs::File::open(package).map_err(failed)?;
    let mut archive = zip::ZipArchive::new(file).map_err(|e| broken(e.to_string()))?;
    let mut files = Vec::new();
    for model in MODEL_FILES {
        let entry =
            archive.by_name(model.path).map_err(|e| broken(format!("{}: {e}", model.path)))?;
        let mut bytes = Vec::new();
        entry.take(MAX_MODEL).read_to_end(&mut bytes).map_err(failed)?;
        if sha256_hex(&bytes) != model.sha256 {
            return Err(broken(format!("{} is not the tested model", model.path)));
        }
        files.push((folder.join(model.name), bytes));
    }
    for (path, bytes) in files {
        write_whole(&path, &bytes).map_err(|source| ModelsError::Io { path, source })?;
    }
    Ok(())
}

/// Writes a file under a temporary name and renames it.
fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    use std::io::Write;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let beside = path.with_extension("part");
    let mut file = std::fs::File::create(&beside)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    std::fs::rename(&beside, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_and_changed_models_name_the_command() {
        let dir = tempfile::tempdir().expect("a folder");
        let e = find(&[dir.path().join("none"), dir.path().into()]).expect_err("empty");
        assert!(e.to_string().contains(SETUP_COMMAND), "{e}");
        for model in MODEL_FILES {
            std::fs::File::create(dir.path().join(model.name)).expect("a file");
        }
        assert_eq!(find(&[dir.path().into()]).expect("all there"), dir.path());
        let e = load(dir.path()).expect_err("empty files");
        assert!(e.to_string().contains(SETUP_COMMAND), "{e}");
    }

    #[test]
    fn a_package_without_models_changes_nothing() {
        let dir = tempfile::tempdir().expect("a folder");
        let package = dir.path().join("mediapipe.whl");
        std::io::Write::write_all(
            &mut std::fs::File::create(&package).expect("a file"),
            b"not a package",
        )
        .expect("written");
        let e = install(&package, &dir.path().join("models")).expect_err("broken");
        assert!(e.to_string().contains(PACKAGE), "{e}");
        assert!(!dir.path().join("models").exists());
    }
}
