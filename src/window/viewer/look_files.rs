//! Pictures of lit balls (matcaps) and environments that a person keeps as files, read on a
//! separate thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbaImage;

use super::environment::Environment;
use sculptd_geometry::io::{read_regular, write_beside};

/// Longest file, bytes.
const MAX_FILE: u64 = 128 << 20;
/// Most pixels along a side of a picture of surroundings.
const MAX_SIDE: u32 = 16_384;
/// Pixels along a side of a matcap on the card, and of its small picture in the panel.
const BALL: u32 = 512;
const SMALL: u32 = 52;
/// Pixels along the longer side of a reference picture.
const REFERENCE: u32 = 2_048;
/// Pictures of one kind that are offered, at most.
const MOST: usize = 64;
const BALL_ENDINGS: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
const AROUND_ENDINGS: [&str; 2] = ["hdr", "exr"];

/// Files to be read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LookFilesWanted {
    /// The matcap and the environment that are shown, by their files' names; empty: none.
    pub matcap: String,
    pub environment: String,
    /// The reference picture.
    pub reference: String,
    /// The page is open on which the others are offered.
    pub list: bool,
}

/// A person's own folders of such pictures.
#[derive(Debug, Clone)]
pub struct LookFolders {
    pub matcaps: PathBuf,
    pub environments: PathBuf,
    pub references: PathBuf,
}

impl LookFolders {
    /// In the data folder; `None` where the system has no such thing.
    pub fn usual() -> Option<LookFolders> {
        let dirs = directories::ProjectDirs::from("", "", "sculptd")?;
        Some(LookFolders::within(dirs.data_dir()))
    }

    /// In a folder of the caller's.
    pub fn within(folder: &Path) -> LookFolders {
        LookFolders {
            matcaps: folder.join("matcaps"),
            environments: folder.join("environments"),
            references: folder.join("references"),
        }
    }

    /// Returns the folder for a picture of this name; `None` if it is no picture. A square one
    /// counts as a lit ball.
    fn folder_for(&self, path: &Path) -> Option<&Path> {
        let ending = path.extension()?.to_string_lossy().to_lowercase();
        if AROUND_ENDINGS.contains(&ending.as_str()) {
            return Some(&self.environments);
        }
        if !BALL_ENDINGS.contains(&ending.as_str()) {
            return None;
        }
        let square = image::image_dimensions(path).is_ok_and(|(w, h)| w == h);
        Some(if square { &self.matcaps } else { &self.references })
    }

    /// Returns true if this is a picture that a person may drop on the window.
    pub fn takes(path: &Path) -> bool {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let all = || BALL_ENDINGS.iter().chain(&AROUND_ENDINGS);
        ending.is_some_and(|e| all().any(|a| **a == *e))
    }

    /// Copies a picture into its folder and returns where it lies now.
    ///
    /// # Errors
    /// Names the file and what is wrong with it.
    pub fn keep(&self, path: &Path) -> Result<PathBuf, String> {
        let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        // A file that cannot be read is not kept.
        decode(path)?;
        let folder = self.folder_for(path).ok_or_else(|| told(&"not a picture"))?;
        let name = path.file_name().ok_or_else(|| told(&"no name"))?;
        let bytes = read_regular(path, MAX_FILE).map_err(|e| told(&e))?;
        std::fs::create_dir_all(folder).map_err(|e| told(&e))?;
        let to = folder.join(name);
        write_beside(&to, |out| out.write_all(&bytes)).map_err(|e| told(&e))?;
        Ok(to)
    }
}

/// Files that were read.
#[derive(Debug, Default)]
pub struct LookFiles {
    /// Names and small pictures of the matcaps, where they were asked for.
    pub matcaps: Option<Vec<(String, RgbaImage)>>,
    /// Names of the environments, where they were asked for.
    pub environments: Option<Vec<String>>,
    /// Names of the reference pictures, where they were asked for.
    pub references: Option<Vec<String>>,
    pub matcap: Option<Arc<RgbaImage>>,
    pub environment: Option<Arc<Environment>>,
    pub reference: Option<Arc<RgbaImage>>,
    /// Files that could not be read, with the reasons.
    pub wrong: Vec<String>,
}

/// Names of the files of these endings in a folder, in order; none where there is no folder.
fn names(folder: &Path, endings: &[&str]) -> Vec<String> {
    let Ok(found) = std::fs::read_dir(folder) else { return Vec::new() };
    let wanted = |name: &String| {
        let ending = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase());
        !name.starts_with('.') && ending.is_some_and(|e| endings.contains(&e.as_str()))
    };
    let all = found.flatten().filter_map(|e| e.file_name().into_string().ok());
    let mut all: Vec<String> = all.filter(wanted).collect();
    all.sort_by_cached_key(|n| (n.to_lowercase(), n.clone()));
    all.truncate(MOST);
    all
}

fn decode(path: &Path) -> Result<image::DynamicImage, String> {
    let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let bytes = read_regular(path, MAX_FILE).map_err(|e| told(&e))?;
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes));
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    reader.with_guessed_format().map_err(|e| told(&e))?.decode().map_err(|e| told(&e))
}

/// A picture of a lit ball, square.
///
/// # Errors
/// Names the file and what is wrong with it.
pub fn read_matcap(path: &Path) -> Result<RgbaImage, String> {
    let picture = decode(path)?;
    let (width, height) = (picture.width(), picture.height());
    let side = width.min(height);
    let square = picture.crop_imm((width - side) / 2, (height - side) / 2, side, side);
    let side = side.min(BALL);
    Ok(square.resize_exact(side, side, image::imageops::FilterType::Triangle).into_rgba8())
}

/// An environment from a Radiance HDR file, or from another picture, whose values are sRGB.
///
/// # Errors
/// Names the file and what is wrong with it.
pub fn read_environment(path: &Path) -> Result<Environment, String> {
    let picture = decode(path)?;
    let linear = matches!(
        picture,
        image::DynamicImage::ImageRgb32F(_) | image::DynamicImage::ImageRgba32F(_)
    );
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let mut pixels = picture.into_rgb32f().into_raw();
    if !linear {
        let light = |v: f32| {
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        pixels.iter_mut().for_each(|v| *v = light(*v));
    }
    Environment::of_picture(width, height, &pixels)
        .ok_or_else(|| format!("{}: the picture is empty", path.display()))
}

/// A reference as large as a screen needs it.
fn reference(picture: &image::DynamicImage) -> RgbaImage {
    if picture.width().max(picture.height()) <= REFERENCE {
        return picture.to_rgba8();
    }
    picture.resize(REFERENCE, REFERENCE, image::imageops::FilterType::Triangle).into_rgba8()
}

impl LookFiles {
    /// Reads what is wanted from a person's folders.
    pub fn read(wanted: &LookFilesWanted, from: &LookFolders) -> LookFiles {
        let LookFolders { matcaps, environments, references } = from;
        let mut found = LookFiles::default();
        let mut keep = |read: Result<(), String>| found.wrong.extend(read.err());
        if !wanted.matcap.is_empty() {
            let read = read_matcap(&matcaps.join(&wanted.matcap));
            keep(read.map(|p| found.matcap = Some(Arc::new(p))));
        }
        if !wanted.environment.is_empty() {
            let read = read_environment(&environments.join(&wanted.environment));
            keep(read.map(|e| found.environment = Some(Arc::new(e))));
        }
        if !wanted.reference.is_empty() {
            let read = decode(&references.join(&wanted.reference));
            keep(read.map(|p| found.reference = Some(Arc::new(reference(&p)))));
        }
        if wanted.list {
            let small = |name: String| {
                let picture = read_matcap(&matcaps.join(&name)).ok()?;
                let filter = image::imageops::FilterType::Triangle;
                Some((name, image::imageops::resize(&picture, SMALL, SMALL, filter)))
            };
            let all = names(matcaps, &BALL_ENDINGS);
            found.matcaps = Some(all.into_iter().filter_map(small).collect());
            found.environments = Some(names(environments, &AROUND_ENDINGS));
            found.references = Some(names(references, &BALL_ENDINGS));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_kept_offered_and_read_and_what_is_broken_is_named() {
        let dir = tempfile::tempdir().expect("a folder");
        let (at, folders) = (dir.path(), LookFolders::within(&dir.path().join("own")));
        let red = |w, h| RgbaImage::from_pixel(w, h, image::Rgba([200, 10, 10, 255]));
        red(40, 40).save(at.join("b red.png")).expect("written");
        red(4_000, 40).save(at.join("side.jpg.png")).expect("written");
        let light = [image::Rgb([2.0f32, 1.0, 0.5]); 32];
        let file = std::fs::File::create(at.join("sky.hdr")).expect("a file");
        let encoder = image::codecs::hdr::HdrEncoder::new(std::io::BufWriter::new(file));
        encoder.encode(&light, 8, 4).expect("written");
        #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
        std::fs::write(at.join("a broken.png"), b"no picture").expect("written");
        for (name, folder) in
            [("b red.png", "matcaps"), ("side.jpg.png", "references"), ("sky.hdr", "environments")]
        {
            assert!(LookFolders::takes(&at.join(name)));
            let kept = folders.keep(&at.join(name)).expect("kept");
            assert_eq!(kept, at.join("own").join(folder).join(name));
        }
        assert!(!LookFolders::takes(&at.join("part.stl")));
        let wrong = folders.keep(&at.join("a broken.png")).expect_err("no picture");
        assert!(wrong.contains("a broken.png"), "{wrong}");
        let mut wanted = LookFilesWanted {
            matcap: "b red.png".into(),
            environment: "sky.hdr".into(),
            reference: "side.jpg.png".into(),
            list: true,
        };
        let found = LookFiles::read(&wanted, &folders);
        let names: Vec<&str> = found.matcaps.iter().flatten().map(|m| m.0.as_str()).collect();
        assert_eq!(names, ["b red.png"]);
        assert_eq!(found.environments, Some(vec!["sky.hdr".to_owned()]));
        assert_eq!(found.references, Some(vec!["side.jpg.png".to_owned()]));
        assert_eq!(found.matcap.expect("read").dimensions(), (40, 40));
        assert_eq!(found.reference.expect("read").width(), REFERENCE);
        assert!(found.environment.is_some() && found.wrong.is_empty(), "{:?}", found.wrong);
        // Both are gone, and the errors give their names.
        (wanted.matcap, wanted.environment) = ("gone.png".into(), "none.hdr".into());
        let found = LookFiles::read(&wanted, &folders);
        assert_eq!(found.wrong.len(), 2);
        assert!(found.wrong[0].contains("gone.png") && found.wrong[1].contains("none.hdr"));
        let nowhere = LookFolders::within(&at.join("nowhere"));
        let found = LookFiles::read(&LookFilesWanted { list: true, ..wanted }, &nowhere);
        assert_eq!(found.references, Some(Vec::new()));
    }
}
