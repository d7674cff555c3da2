//! Where pictures come from: a camera, a folder, a Motion JPEG or a Y4M file.

#[cfg(target_os = "linux")]
pub mod device;
pub mod drawn_script;
mod folder;
mod jpeg;
mod motion_jpeg;
mod y4m;
mod yuv;

use std::path::{Path, PathBuf};

use crate::picture::Picture;

/// Rate of files that do not state one, pictures a second.
pub const USUAL_RATE: f64 = 30.0;

/// Why there are no pictures.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// There is no such camera.
    #[error("there is no camera {0}. Plug it in, or choose another: sculptd camera test")]
    Absent(String),
    /// The system does not allow it.
    #[error(
        "{0}: permission denied. Add yourself to the group `video` and log in again: \
         sudo usermod -aG video \"$(id -un)\""
    )]
    Denied(String),
    /// Another program uses it.
    #[error("{0} is in use by another program. Close that program, or choose another camera")]
    Busy(String),
    /// It has none of the formats that are read.
    #[error("{name}: it offers {found}, and none of MJPG, YUYV and GREY is among them")]
    Format {
        /// The camera.
        name: String,
        /// The formats that it offers.
        found: String,
    },
    /// A picture is damaged.
    #[error("{name}: picture {number} is damaged: {why}")]
    Damaged {
        /// The camera or file.
        name: String,
        /// From 1.
        number: u64,
        /// The fault.
        why: String,
    },
    /// The file is of another kind.
    #[error(
        "{}: {why}. Expected a folder of PNG or JPEG pictures, Motion JPEG, or Y4M",
        path.display()
    )]
    Unknown {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// The system's reason.
    #[error("{name}: {source}")]
    Io {
        /// The camera or file.
        name: String,
        /// Why.
        source: std::io::Error,
    },
}

impl CameraError {
    /// The system's error about `name` as one of ours.
    pub fn of_system(name: &str, source: std::io::Error) -> Self {
        match source.kind() {
            std::io::ErrorKind::NotFound => CameraError::Absent(name.into()),
            std::io::ErrorKind::PermissionDenied => CameraError::Denied(name.into()),
            std::io::ErrorKind::ResourceBusy => CameraError::Busy(name.into()),
            // The device is gone: unplugged.
            _ if source.raw_os_error() == Some(19) => CameraError::Absent(name.into()),
            _ => CameraError::Io { name: name.into(), source },
        }
    }
}

/// Pictures in order.
pub trait PictureSource: Send + std::fmt::Debug {
    /// Returns the next picture and its time in microseconds since the first one; `None` at the
    /// end. A damaged picture is an error, and the next call goes on after it.
    ///
    /// # Errors
    /// Returns an error if the picture is damaged, or if there is no source any more.
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError>;

    /// Returns the name and format for people.
    fn describe(&self) -> String;
}

/// Opens recorded pictures.
///
/// # Errors
/// Returns an error if the file cannot be read or is of no known kind.
pub fn open_file(path: &Path) -> Result<Box<dyn PictureSource>, CameraError> {
    if path.is_dir() {
        return Ok(Box::new(folder::PictureFolder::open(path)?));
    }
    let name = path.display().to_string();
    let mut file = std::fs::File::open(path)
        .map_err(|source| CameraError::Io { name: name.clone(), source })?;
    let mut head = [0; 10];
    let got = std::io::Read::read(&mut file, &mut head)
        .map_err(|source| CameraError::Io { name: name.clone(), source })?;
    std::io::Seek::rewind(&mut file)
        .map_err(|source| CameraError::Io { name: name.clone(), source })?;
    if head.starts_with(b"YUV4MPEG2 ") {
        return Ok(Box::new(y4m::Y4mFile::open(name, file)?));
    }
    if head.starts_with(&[0xff, 0xd8]) {
        return Ok(Box::new(motion_jpeg::MotionJpegFile::new(name, file)));
    }
    let why = if got == 0 { "the file is empty" } else { "unknown kind of file" };
    Err(CameraError::Unknown { path: path.into(), why: why.into() })
}
