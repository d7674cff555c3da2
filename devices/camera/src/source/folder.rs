//! A folder of pictures, in the order of their names.

use std::path::{Path, PathBuf};

use super::{CameraError, PictureSource, USUAL_RATE, jpeg};
use crate::picture::{MAX_PIXELS, Picture};

/// A folder of PNG and JPEG files.
#[derive(Debug)]
pub(super) struct PictureFolder {
    folder: PathBuf,
    files: Vec<PathBuf>,
    next: usize,
}

impl PictureFolder {
    pub(super) fn open(folder: &Path) -> Result<Self, CameraError> {
        let failed = |source| CameraError::Io { name: folder.display().to_string(), source };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
            if matches!(kind.as_deref(), Some("png" | "jpg" | "jpeg")) {
                files.push(path);
            }
        }
        files.sort();
        if files.is_empty() {
            let why = "it has no PNG and no JPEG pictures".into();
            return Err(CameraError::Unknown { path: folder.into(), why });
        }
        Ok(PictureFolder { folder: folder.into(), files, next: 0 })
    }
}

impl PictureSource for PictureFolder {
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError> {
        let Some(path) = self.files.get(self.next) else { return Ok(None) };
        self.next += 1;
        let name = path.display().to_string();
        let bytes =
            std::fs::read(path).map_err(|source| CameraError::Io { name: name.clone(), source })?;
        let picture =
            if bytes.starts_with(&[0xff, 0xd8]) { jpeg::decode(&bytes) } else { png(&bytes) };
        let t_us = ((self.next - 1) as f64 * 1e6 / USUAL_RATE) as u64;
        match picture {
            Ok(picture) => Ok(Some((t_us, picture))),
            Err(why) => Err(CameraError::Damaged { name, number: self.next as u64, why }),
        }
    }

    fn describe(&self) -> String {
        let n = self.files.len();
        format!("{}: {n} pictures, {USUAL_RATE} a second", self.folder.display())
    }
}

fn png(bytes: &[u8]) -> Result<Picture, String> {
    let mut reader =
        image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_PIXELS as u64 * 8);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| e.to_string())?.into_rgb8();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if width < 2 || height < 2 {
        return Err(format!("{width} by {height} pixels"));
    }
    Ok(Picture { width, height, rgb: picture.into_raw() })
}
