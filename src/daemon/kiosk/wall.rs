//! The gallery wall: works that turn slowly while nobody is here. A thread reads the next one, so
//! that neither the loop nor a visitor's first touch waits for a file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam_channel as cc;

use super::KioskConfig;
use super::names::{number, works};
use crate::command_queue::QueuedCommand;
use sculptd_clay::Clay;
use sculptd_clay::brush::BrushSettings;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Beginning, Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;

/// Files of a folder that are looked at.
const MOST_FILES: usize = 10_000;

/// A work that is ready to be shown.
#[derive(Debug)]
pub struct WallWork {
    path: PathBuf,
    plain: Arc<TriMesh>,
    clay: Box<Clay>,
}

impl WallWork {
    /// The number of a work of the gallery; 0 for any other mesh.
    pub fn number(&self) -> u64 {
        self.path.file_name().and_then(|name| number(name.to_str()?)).unwrap_or(0)
    }

    /// Returns the command that shows the work, and the camera that frames it.
    pub fn show(self, camera: Camera, brush: BrushSettings) -> (QueuedCommand, Camera) {
        let positions = &self.plain.positions;
        let lo = positions.iter().copied().reduce(|a, b| a.min(b));
        let hi = positions.iter().copied().reduce(|a, b| a.max(b));
        let mut camera = camera;
        if let Some((lo, hi)) = lo.zip(hi) {
            camera.frame(lo, hi);
            // A form that turns needs its diagonal.
            camera.distance *= 1.25;
        }
        let clay = NewClay::new(self.plain, false);
        let command = Command::Begin(Box::new(Beginning { clay, camera, brush }));
        (QueuedCommand::with_payload(command, Payload::Clay(self.clay)), camera)
    }
}

/// Reads the works one after another.
#[derive(Debug)]
pub struct Wall {
    /// Asks for the next work; the value is the last midnight, in seconds since 1970.
    calls: cc::Sender<u64>,
    works: cc::Receiver<Option<WallWork>>,
    /// A work was asked for and has not come yet.
    waits: bool,
    /// The work that was taken last.
    shown: PathBuf,
}

impl Wall {
    /// Starts the thread; `None`: the settings show no works. It ends when this is dropped.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn start(config: &KioskConfig) -> std::io::Result<Option<Wall>> {
        let has_gallery = !config.gallery.as_os_str().is_empty();
        if config.wall_s <= 0.0 || !has_gallery && config.curated.is_empty() {
            return Ok(None);
        }
        let (calls, asked) = cc::bounded(1);
        let (ready, works) = cc::bounded(1);
        let mut shelf = Shelf {
            gallery: config.gallery.clone(),
            curated: config.curated.clone(),
            most: config.max_triangles,
            last: None,
            refused: BTreeSet::new(),
        };
        let read = move || {
            for since in asked {
                if ready.send(shelf.next(since)).is_err() {
                    return;
                }
            }
        };
        std::thread::Builder::new().name("sculptd-wall".into()).spawn(read)?;
        let shown = PathBuf::new();
        Ok(Some(Wall { calls, works, waits: false, shown }))
    }

    /// Has the next work read, unless one is being read.
    pub fn ask(&mut self, since: u64) {
        if !self.waits {
            self.waits = self.calls.try_send(since).is_ok();
        }
    }

    /// Returns the work that was asked for, once it is ready.
    pub fn take(&mut self) -> Option<WallWork> {
        let work = self.works.try_recv().ok()?;
        self.waits = false;
        let work = work.filter(|work| work.path.exists())?;
        self.shown.clone_from(&work.path);
        Some(work)
    }

    /// Returns true if the work that was taken last still exists.
    pub fn shown_exists(&self) -> bool {
        self.shown.exists()
    }
}

/// The works in their order.
struct Shelf {
    gallery: PathBuf,
    curated: Vec<PathBuf>,
    /// Triangles of a work at most.
    most: usize,
    last: Option<PathBuf>,
    /// Works that cannot be shown; each is logged once.
    refused: BTreeSet<PathBuf>,
}

impl Shelf {
    /// Returns the curated works, and then those of the gallery since `since`.
    fn all(&self, since: u64) -> Vec<PathBuf> {
        let mut all = Vec::new();
        for place in &self.curated {
            match std::fs::read_dir(place) {
                Ok(entries) => {
                    let entries = entries.filter_map(Result::ok).take(MOST_FILES);
                    let mut files: Vec<PathBuf> = entries.map(|e| e.path()).collect();
                    files.retain(|file| is_mesh(file));
                    files.sort();
                    all.extend(files);
                }
                Err(_) => all.push(place.clone()),
            }
        }
        let names = works(&self.gallery).unwrap_or_default();
        let paths = names.into_iter().map(|name| self.gallery.join(name));
        all.extend(paths.filter(|path| written_since(path, since)));
        all
    }

    /// Reads the work after the last one; `None`: there is none.
    fn next(&mut self, since: u64) -> Option<WallWork> {
        let all = self.all(since);
        self.refused.retain(|path| all.contains(path));
        let after = self.last.as_ref().and_then(|last| all.iter().position(|path| path == last));
        let first = after.map_or(0, |at| at + 1);
        for path in all.iter().cycle().skip(first).take(all.len()) {
            if self.refused.contains(path) {
                continue;
            }
            match read(path, self.most) {
                Ok(work) => {
                    self.last = Some(path.clone());
                    return Some(work);
                }
                Err(why) => {
                    tracing::warn!("kiosk: {} is not shown on the wall: {why}", path.display());
                    self.refused.insert(path.clone());
                }
            }
        }
        None
    }
}

/// Returns true for the formats in which a folder's works are read.
fn is_mesh(file: &Path) -> bool {
    let extension = file.extension().map(|e| e.to_string_lossy().to_lowercase());
    extension.is_some_and(|e| matches!(e.as_str(), "glb" | "stl" | "ply" | "obj"))
}

/// Returns true if a file was written at `since` (seconds since 1970) or later.
pub(super) fn written_since(path: &Path, since: u64) -> bool {
    let written = std::fs::metadata(path).and_then(|m| m.modified());
    let age = written.ok().and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok());
    age.is_some_and(|t| t.as_secs() >= since)
}

fn read(path: &Path, most: usize) -> Result<WallWork, String> {
    let job = Job::default();
    let loaded = read_mesh(path, &job).map_err(|e| e.to_string())?;
    let plain = loaded.mesh.triangulate().0;
    let found = plain.triangles.len();
    if found > most {
        return Err(format!("it has {found} triangles, at most {most} (max_triangles)"));
    }
    let clay = Clay::build(&plain, &job).map_err(|e| e.to_string())?;
    Ok(WallWork { path: path.into(), plain: Arc::new(plain), clay: Box::new(clay) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes;

    #[test]
    fn curated_works_and_those_of_today_take_turns_and_too_large_ones_are_left_out() {
        let dir = tempfile::tempdir().expect("a folder");
        let (gallery, curated) = (dir.path().join("works"), dir.path().join("curated"));
        std::fs::create_dir(&curated).expect("made");
        let write = |name: &str, rings: u32| {
            let ball = shapes::uv_sphere(1.0, rings, 8);
            sculptd_geometry::io::write_mesh(&curated.join(name), &ball).expect("written");
        };
        write("a bear.stl", 6);
        write("b large.stl", 200);
        for _ in 0..3 {
            super::super::gallery::keep(&gallery, &shapes::uv_sphere(1.0, 6, 8)).expect("kept");
        }
        let old = std::fs::File::options().write(true).open(gallery.join("work-000001.glb"));
        let before = std::time::UNIX_EPOCH + std::time::Duration::from_secs(1_000_000);
        old.and_then(|file| file.set_modified(before)).expect("an old work");
        let config = KioskConfig {
            gallery: gallery.clone(),
            curated: vec![curated],
            max_triangles: 1000,
            ..KioskConfig::default()
        };
        let mut wall = Wall::start(&config).expect("a thread").expect("a wall");
        let mut next = || {
            wall.ask(2_000_000);
            let work = wall.works.recv().expect("the thread runs");
            wall.waits = false;
            work.map(|work| work.number())
        };
        let shown: Vec<_> = (0..6).map(|_| next()).collect();
        assert_eq!(shown, [0, 2, 3, 0, 2, 3].map(Some));
        // A work that somebody deleted comes no more.
        std::fs::remove_file(gallery.join("work-000002.glb")).expect("removed");
        assert_eq!((0..3).map(|_| next()).collect::<Vec<_>>(), [0, 3, 0].map(Some));
        let none = KioskConfig { wall_s: 0.0, ..config };
        assert!(Wall::start(&none).expect("no thread").is_none());
    }
}
