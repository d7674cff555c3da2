//! The work as a file that a guest takes home: written when a page asks for it, served by a link
//! that nobody can guess, and removed after a while.

use std::path::PathBuf;
use std::sync::{Mutex, TryLockError};
use std::time::Duration;

use hyper::StatusCode;
use serde::Deserialize;

use super::locked;
use crate::Published;
use crate::http::{Answer, Refusal};
use crate::random_token::random_token;
use crate::scene_jobs::{Selection, selected};
use sculptd_geometry::io::write_scene;
use sculptd_geometry::job::Job;

/// Time for which a file can be fetched.
const LASTS: Duration = Duration::from_secs(600);
/// Files at a time; the oldest goes first.
const MOST: usize = 8;
/// First part of the path of a file.
pub const PLACE: &str = "/take-home/";

/// A format that a guest may ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorkFormat {
    /// For viewers and other programs, with colours.
    Glb,
    /// For printers.
    Stl,
}

impl WorkFormat {
    fn file_name(self) -> &'static str {
        match self {
            WorkFormat::Glb => "sculpture.glb",
            WorkFormat::Stl => "sculpture.stl",
        }
    }

    fn media_type(self) -> &'static str {
        match self {
            WorkFormat::Glb => "model/gltf-binary",
            WorkFormat::Stl => "model/stl",
        }
    }
}

#[derive(Debug)]
struct WorkFile {
    /// Path in the address.
    path: String,
    format: WorkFormat,
    folder: PathBuf,
    until_us: u64,
}

impl Drop for WorkFile {
    fn drop(&mut self) {
        if let Err(e) = std::fs::remove_dir_all(&self.folder) {
            tracing::warn!("web: {}: {e}", self.folder.display());
        }
    }
}

/// The files that can be fetched now.
#[derive(Debug, Default)]
pub struct Downloads {
    files: Mutex<Vec<WorkFile>>,
    /// Held while a file is written: one at a time, however many guests ask.
    writing: Mutex<()>,
}

impl Downloads {
    /// Writes the visible objects to a file, and returns its path in the address.
    ///
    /// # Errors
    /// Returns the reason in words: nothing is visible, another file is being written, or this one
    /// cannot be.
    pub fn write(
        &self,
        state: &Published,
        format: WorkFormat,
        now_us: u64,
    ) -> Result<String, String> {
        let busy = "another guest's file is being written, ask again in a moment";
        let _writing = match self.writing.try_lock() {
            Ok(held) => held,
            // It holds nothing that a panic could have left half done.
            Err(TryLockError::Poisoned(held)) => held.into_inner(),
            Err(TryLockError::WouldBlock) => return Err(busy.into()),
        };
        let meshes = selected(&state.scene, &state.mesh, Selection::Visible);
        let meshes = meshes.map_err(|e| e.to_string())?;
        // The folder's name is seen by every user of this machine, so it is not the link's secret.
        let random = || random_token().map_err(|e| e.to_string());
        let (token, folder) = (random()?, format!("sculptd-{}", random()?));
        let folder = std::env::temp_dir().join(folder);
        let mut only_ours = std::fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut only_ours, 0o700);
        only_ours.create(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let path = format!("{PLACE}{token}/{}", format.file_name());
        let until_us = now_us + LASTS.as_micros() as u64;
        // From here on it is removed, whatever happens.
        let file = WorkFile { path: path.clone(), format, folder, until_us };
        let to = file.folder.join(format.file_name());
        write_scene(&to, &meshes, &Job::default()).map_err(|e| e.to_string())?;
        let mut files = locked(&self.files);
        files.retain(|f| f.until_us > now_us);
        if files.len() >= MOST {
            files.remove(0);
        }
        files.push(file);
        Ok(path)
    }

    /// Removes the files whose time is over.
    pub fn expire(&self, now_us: u64) {
        locked(&self.files).retain(|f| f.until_us > now_us);
    }

    /// Answers a request for a file.
    ///
    /// # Errors
    /// Returns that there is nothing at this path, or no longer.
    pub fn answer(&self, path: &str, now_us: u64) -> Result<Answer, Refusal> {
        const GONE: Refusal = (StatusCode::NOT_FOUND, "there is nothing here, or no longer");
        let files = locked(&self.files);
        let file = files.iter().find(|f| f.path == path && f.until_us > now_us).ok_or(GONE)?;
        let at = file.folder.join(file.format.file_name());
        Answer::file(file.format.media_type(), &at).map_err(|_| GONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::PublishedFigures;
    use sculptd_clay::brush::BrushSettings;
    use sculptd_clay::{Clay, Workers};
    use sculptd_engine::camera::Camera;
    use sculptd_engine::world::{World, WorldOptions};
    use sculptd_geometry::shapes;

    fn folders(files: &Downloads) -> Vec<PathBuf> {
        locked(&files.files).iter().map(|f| f.folder.clone()).collect()
    }

    #[test]
    fn a_file_is_there_for_a_while_and_leaves_nothing() {
        let mesh = shapes::icosphere(1.0, 8);
        let clay = Clay::build(&mesh, &Job::default()).expect("clay");
        let options =
            WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 20, hands: Default::default() };
        let (camera, brush) = (Camera::default(), BrushSettings::default());
        let mut world = World::new(clay, camera, brush, Workers::new(1), options);
        let state = Published::of(&mut world, PublishedFigures::default());
        let files = Downloads::default();
        let path = files.write(&state, WorkFormat::Stl, 5).expect("written");
        let [folder] = folders(&files).try_into().expect("one");
        let read = sculptd_geometry::io::read_mesh(&folder.join("sculpture.stl"), &Job::default())
            .expect("read");
        assert_eq!(read.mesh.faces().count(), mesh.triangles.len());
        assert!(files.answer(&path, 6).is_ok());
        assert!(!folder.to_string_lossy().contains(path.split('/').nth(2).expect("a secret")));
        let busy = files.writing.lock().expect("free");
        assert!(files.write(&state, WorkFormat::Stl, 6).is_err(), "one at a time");
        drop(busy);
        assert!(files.answer(&path.replace("stl", "glb"), 6).is_err());
        assert!(files.answer(PLACE, 6).is_err());
        let end = 5 + LASTS.as_micros() as u64;
        assert!(files.answer(&path, end).is_err());
        for _ in 0..MOST {
            files.write(&state, WorkFormat::Glb, 6).expect("written");
        }
        assert!(!folder.exists() && folders(&files).len() == MOST);
        let rest = folders(&files);
        files.expire(end + 1);
        assert!(folders(&files).is_empty() && !rest.iter().any(|f| f.exists()));
    }
}
