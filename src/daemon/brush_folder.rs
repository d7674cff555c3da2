//! The folder of user brushes: one TOML file per brush ([`sculptd_clay::brush::own_brush`]), with
//! its height picture beside it. The folder is read when a run begins and again when a file in it
//! changes. A file that cannot be used is reported by name and line; the other files still load.
//!
//! What a session uses is in the session: choosing a brush sends its settings and its picture as
//! commands, and neither the folder nor this module matters to a replay.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use crate::brush_pictures::{BrushPictures, Stamp, read_picture, stamp};
use sculptd_clay::brush::{Alpha, BrushSettings, OwnBrush, Presets, own_brush};
use sculptd_geometry::io::{read_regular, write_beside};

/// Brushes in a folder at most.
const MOST: usize = 1000;
/// Longest file of a brush, bytes.
const MAX_FILE: u64 = 1 << 20;
/// Bytes of all pictures together, as they are kept.
const MAX_PICTURES: usize = 512 << 20;
/// Interval at which a running program checks for changed files.
const LOOK: Duration = Duration::from_secs(1);

/// One file as it was read.
#[derive(Debug)]
struct ReadFile {
    /// Of the file, and of its picture.
    stamps: [Option<Stamp>; 2],
    picture: Option<PathBuf>,
    brush: Result<OwnBrush, String>,
}

impl ReadFile {
    fn is_current(&self, path: &Path) -> bool {
        self.stamps == [stamp(path), self.picture.as_deref().and_then(stamp)]
    }
}

/// A folder of brushes, as it was read last.
#[derive(Debug)]
pub struct BrushFolder {
    path: PathBuf,
    presets: Presets,
    files: BTreeMap<PathBuf, ReadFile>,
    pictures: BrushPictures,
}

/// The user's own folder of brushes: `brushes` in the data folder.
pub fn default_folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "sculptd").map(|d| d.data_dir().join("brushes"))
}

/// Reads one brush and its picture.
///
/// # Errors
/// Names the file, and the line where one is to blame.
pub fn read(path: &Path, presets: &Presets) -> Result<OwnBrush, String> {
    read_both(path, presets).1
}

/// The path of the picture, where the file names one, and the brush.
fn read_both(path: &Path, presets: &Presets) -> (Option<PathBuf>, Result<OwnBrush, String>) {
    let named = |e: String| format!("{}: {e}", path.display());
    let text = read_regular(path, MAX_FILE).map_err(|e| named(e.to_string()));
    let text = text.and_then(|bytes| {
        String::from_utf8(bytes).map_err(|_| named("expected text in UTF-8".into()))
    });
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let brush = text.and_then(|text| {
        OwnBrush::read(&name, &text, &|kind| presets.of(kind))
            .map_err(|e| format!("{}:{}: {}", path.display(), e.line, e.text))
    });
    let mut brush = match brush {
        Ok(brush) => brush,
        Err(e) => return (None, Err(e)),
    };
    let Some(file) = &brush.picture_file else { return (None, Ok(brush)) };
    let picture = path.with_file_name(file);
    match read_picture(&picture).map_err(named) {
        Ok(decoded) => {
            brush.picture = Some(Arc::new(decoded));
            (Some(picture), Ok(brush))
        }
        Err(e) => (Some(picture), Err(e)),
    }
}

/// Name, description and files under which the brush in hand is saved.
#[derive(Debug, Clone, Default)]
pub struct SavedBrush<'a> {
    /// Its name, one that [`own_brush::check_name`] allows.
    pub name: &'a str,
    /// One line on what it is for; may be empty.
    pub about: &'a str,
    /// Lower comes first in lists.
    pub order: i32,
    /// The extension and the bytes of its picture's file, if it has one.
    pub picture: Option<(&'a str, &'a [u8])>,
    /// True if it may replace a brush of the same name.
    pub replace: bool,
}

/// Saves the settings of the brush in hand as a user brush in `folder`.
///
/// # Errors
/// As [`write()`]; also if the brush uses a picture and none is given.
pub fn save(
    folder: &Path,
    settings: &BrushSettings,
    saved: &SavedBrush<'_>,
) -> Result<PathBuf, String> {
    own_brush::check_name(saved.name)?;
    if settings.alpha == Alpha::Picture && saved.picture.is_none() {
        return Err("the brush presses a picture, and there is none".into());
    }
    let brush = OwnBrush {
        name: saved.name.into(),
        about: saved.about.into(),
        order: saved.order,
        settings: *settings,
        picture_file: saved.picture.map(|(ending, _)| format!("{}.{ending}", saved.name)),
        picture: None,
    };
    write(folder, &brush, saved.picture.map(|p| p.1), saved.replace)
}

/// Writes a brush into `folder` as `NAME.toml`, and the bytes of its picture, if it has one,
/// beside it.
///
/// # Errors
/// Returns an error if the name is not allowed, if the file exists and may not be replaced, or if
/// the file system reports one.
pub fn write(
    folder: &Path,
    brush: &OwnBrush,
    picture: Option<&[u8]>,
    replace: bool,
) -> Result<PathBuf, String> {
    let path = folder.join(format!("{}.toml", brush.name));
    let named = |e: std::io::Error| format!("{}: {e}", path.display());
    if !replace && path.exists() {
        return Err(format!("{}: there is a brush of this name", path.display()));
    }
    let text = brush.write()?;
    std::fs::create_dir_all(folder).map_err(named)?;
    if let (Some(bytes), Some(file)) = (picture, &brush.picture_file) {
        write_beside(&folder.join(file), |out| out.write_all(bytes)).map_err(named)?;
    }
    write_beside(&path, |out| out.write_all(text.as_bytes())).map_err(named)?;
    Ok(path)
}

impl BrushFolder {
    /// The folder, not read yet. It need not exist. The brushes that are read go to `presets` and
    /// all its clones.
    pub fn new(path: PathBuf, presets: Presets) -> Self {
        BrushFolder { path, presets, files: BTreeMap::new(), pictures: BrushPictures::default() }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the files that changed since the last call. Returns true if any file changed.
    pub fn refresh(&mut self) -> bool {
        let mut found: Vec<PathBuf> = std::fs::read_dir(&self.path)
            .map(|all| all.filter_map(|e| e.ok().map(|e| e.path())).collect())
            .unwrap_or_default();
        let mut pictures = found.clone();
        pictures.retain(|p| BrushPictures::is_one(p));
        found.retain(|p| p.extension().is_some_and(|e| e == "toml"));
        found.sort();
        found.truncate(MOST);
        let before = self.files.len();
        self.files.retain(|path, _| found.binary_search(path).is_ok());
        let mut changed = self.files.len() != before;
        for path in found {
            if self.files.get(&path).is_some_and(|file| file.is_current(&path)) {
                continue;
            }
            // The stamp first: what is written while it is read is read again.
            let text_stamp = stamp(&path);
            let (picture, brush) = read_both(&path, &self.presets);
            let stamps = [text_stamp, picture.as_deref().and_then(stamp)];
            self.files.insert(path, ReadFile { stamps, picture, brush });
            changed = true;
        }
        if changed {
            self.bound_pictures();
            let brushes = self.files.values().filter_map(|f| f.brush.as_ref().ok());
            self.presets.set_own(brushes.cloned().collect());
        }
        // Those that a brush brings along are the brush's.
        let of_brushes = self.files.values().filter_map(|f| f.picture.as_deref());
        pictures.retain(|p| of_brushes.clone().all(|of_brush| of_brush != p));
        self.pictures.refresh(pictures, &self.presets) || changed
    }

    /// Brushes whose pictures are beyond what may be kept are left out, in the order of names.
    fn bound_pictures(&mut self) {
        let mut bytes = 0;
        for (path, file) in &mut self.files {
            let picture = file.brush.as_ref().ok().and_then(|b| b.picture.as_ref());
            bytes += picture.map_or(0, |p| (p.heights.len() + p.cover.len()) * 2);
            if bytes > MAX_PICTURES && picture.is_some() {
                let most = MAX_PICTURES >> 20;
                let text =
                    format!("{}: the pictures of all brushes are over {most} MiB", path.display());
                file.brush = Err(text);
            }
        }
    }

    /// Returns the error message of each file that cannot be used, with the file's name.
    pub fn problems(&self) -> Vec<String> {
        let of_brushes = self.files.values().filter_map(|f| f.brush.as_ref().err());
        of_brushes.chain(self.pictures.problems()).cloned().collect()
    }

    /// Watches the folder on a separate thread until `stop` is set: reads changed files and logs
    /// their errors.
    ///
    /// # Errors
    /// Returns an error if the thread cannot start.
    pub fn watch(mut self, stop: Arc<AtomicBool>) -> std::io::Result<()> {
        let thread = std::thread::Builder::new().name("sculptd-brushes".into());
        thread
            .spawn(move || {
                let quiet = crossbeam_channel::never::<()>();
                while !stop.load(Relaxed) {
                    let _ = quiet.recv_timeout(LOOK);
                    let known = self.problems();
                    if self.refresh() {
                        let new = self.problems().into_iter().filter(|p| !known.contains(p));
                        new.for_each(|p| tracing::warn!("brush not taken: {p}"));
                        tracing::info!("own brushes: {}", self.presets.own().len());
                    }
                }
            })
            .map(drop)
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods)] // Files as a person writes them.
mod tests {
    use super::*;
    use sculptd_clay::brush::own_brush::preset_number;
    use sculptd_clay::brush::{BrushKind, Picture};

    fn folder() -> (tempfile::TempDir, BrushFolder, Presets) {
        let dir = tempfile::tempdir().expect("a folder");
        let presets = Presets::default();
        (dir, BrushFolder::new(PathBuf::new(), presets.clone()), presets)
    }

    fn names(presets: &Presets) -> Vec<String> {
        presets.own().iter().map(|b| b.name.clone()).collect()
    }

    #[test]
    fn a_brush_is_saved_read_again_bit_for_bit_and_forgotten_with_its_file() {
        let (dir, mut folder, presets) = folder();
        folder.path = dir.path().into();
        assert!(!folder.refresh());
        let mut settings = BrushSettings::new(BrushKind::Texture);
        settings.preset = preset_number("bark of oak");
        settings.strength = 0.123_456_79;
        settings.alpha = Alpha::Picture;
        settings.extra[1] = 0.1;
        settings.path.jitter = 0.3;
        let png = include_bytes!("../../tests/golden/sheet/brushes.png");
        let bark = OwnBrush {
            name: "bark of oak".into(),
            about: "as it grows".into(),
            order: -3,
            settings,
            picture_file: Some("oak.png".into()),
            picture: None,
        };
        write(dir.path(), &bark, Some(png), false).expect("written");
        assert!(write(dir.path(), &bark, None, false).is_err_and(|e| e.contains("bark of oak")));
        std::fs::write(dir.path().join("a.toml"), "kind = 'clay'\n").expect("written");
        assert!(folder.refresh() && !folder.refresh());
        // By order, then by name.
        assert_eq!(names(&presets), ["bark of oak", "a"]);
        let read = presets.own_of("bark of oak").expect("there");
        assert_eq!(read.settings, settings);
        let picture = Picture::decode(png).expect("a picture");
        assert_eq!(read.picture.as_deref(), Some(&picture));
        assert_eq!(OwnBrush { picture: None, ..read }, bark);
        std::fs::remove_file(dir.path().join("a.toml")).expect("there");
        assert!(folder.refresh());
        assert_eq!(names(&presets), ["bark of oak"]);
        // A picture that no brush has is for all of them; that of a brush is not told twice.
        let told = || presets.pictures().iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        assert!(told().is_empty());
        std::fs::write(dir.path().join("rough.PNG"), png).expect("written");
        std::fs::write(dir.path().join("torn.png"), &png[..100]).expect("written");
        assert!(folder.refresh() && !folder.refresh());
        assert_eq!(told(), ["rough"]);
        assert_eq!(*presets.pictures()[0].picture, picture);
        let problems = folder.problems();
        assert!(problems.len() == 1 && problems[0].contains("torn.png"), "{problems:?}");
        std::fs::remove_file(dir.path().join("rough.PNG")).expect("there");
        assert!(folder.refresh() && told().is_empty());
    }

    #[test]
    fn a_brush_in_hand_is_saved_under_a_name_once_and_with_its_picture() {
        let (dir, mut folder, presets) = folder();
        folder.path = dir.path().into();
        let mut settings = BrushSettings::new(BrushKind::Texture);
        (settings.alpha, settings.strength) = (Alpha::Picture, 0.31);
        let picture =
            Picture { width: 2, height: 1, heights: vec![9_000, 65_535], cover: Vec::new() };
        let png = picture.encode().expect("a PNG");
        let mut saved = SavedBrush { name: "oak", ..SavedBrush::default() };
        assert!(save(dir.path(), &settings, &saved).is_err_and(|e| e.contains("picture")));
        saved.picture = Some(("png", &png));
        save(dir.path(), &settings, &saved).expect("saved");
        assert!(save(dir.path(), &settings, &saved).is_err_and(|e| e.contains("of this name")));
        saved.replace = true;
        save(dir.path(), &settings, &saved).expect("replaced");
        let bad = SavedBrush { name: "../oak", ..saved };
        assert!(save(dir.path(), &settings, &bad).is_err());
        assert!(folder.refresh());
        let read = presets.own_of("oak").expect("there");
        assert_eq!((read.settings.strength, read.picture.as_deref()), (0.31, Some(&picture)));
    }

    #[test]
    fn a_broken_file_is_told_by_its_line_and_the_others_stay() {
        let (dir, mut folder, presets) = folder();
        folder.path = dir.path().into();
        let broken = dir.path().join("broken.toml");
        std::fs::write(dir.path().join("good.toml"), "kind = 'draw'\n").expect("written");
        for (text, line, word) in [
            ("kind = 'draw'\n[settings]\nstrengh = 0.5\n", 3, "strengh"),
            ("kind = 'draw'\n[settings]\n\nstrength = 5.0\n", 4, "0 to 1"),
            ("about = 'x'\nkind = 'drawn'\n", 2, "drawn"),
            // Keys with one ending.
            (
                "kind = 'draw'\n[settings.pressure_strength]\ngamma = 1.0\n\n\
                 [settings.pressure_radius]\ngamma = 90.0\n",
                6,
                "gamma",
            ),
            (
                "kind = 'draw'\n[settings]\npressure_strength = { gamma = 1.0 }\n\
                 pressure_radius = { at_zero = 1.0, gamma = 90.0 }\n",
                4,
                "gamma",
            ),
            ("kind = 'texture'\n[settings]\nnormal_radius = 0.4\nradius = 9.0\n", 4, "radius"),
            ("kind = 'draw'\nabout = \n", 2, ""),
            ("kind = 'texture'\n[extra]\nfloor = 9.0\n", 3, "0 to 1"),
            ("kind = 'texture'\n[extra]\nflor = 0.5\n", 3, "floor"),
            ("kind = 'texture'\npicture = '../x.png'\n", 2, "beside"),
        ] {
            // Of a different length each time: the file system's clock may be coarse.
            std::fs::write(&broken, text).expect("written");
            folder.files.remove(&broken);
            assert!(folder.refresh(), "{text}");
            let problems = folder.problems();
            assert_eq!(problems.len(), 1, "{text}");
            let place = format!("broken.toml:{line}: ");
            assert!(problems[0].contains(&place) && problems[0].contains(word), "{problems:?}");
            assert_eq!(names(&presets), ["good"]);
        }
        std::fs::write(&broken, "kind = 'draw'\n[settings]\nstrength = 0.25\n").expect("written");
        assert!(folder.refresh() && folder.problems().is_empty());
        assert_eq!(presets.own_of("broken").map(|b| b.settings.strength), Some(0.25));
        std::fs::write(dir.path().join("clay.toml"), "kind = 'draw'\n").expect("written");
        assert!(folder.refresh() && folder.problems()[0].contains("'clay'"));
    }
}
