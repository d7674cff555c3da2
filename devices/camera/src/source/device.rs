//! A camera of this machine, by Video4Linux.

use std::path::Path;

use super::{CameraError, PictureSource, jpeg, yuv};
use crate::picture::Picture;
use sculptd_devices::Clock;

/// Sizes that are asked for, the best first: enough for a hand at arm's length, and no more.
const SIZES: [(u32, u32); 4] = [(640, 480), (640, 360), (800, 600), (1280, 720)];
/// Formats that are read, the best first.
const FORMATS: [&[u8; 4]; 3] = [b"MJPG", b"YUYV", b"GREY"];
/// Pictures a second that are asked for.
const RATES: [u32; 5] = [30, 25, 20, 15, 10];
/// Formats that are looked at; a driver may list them without end.
const MAX_FORMATS: usize = 64;
/// Buffers of the driver: one is filled, one waits, one is read.
const BUFFERS: u32 = 3;

/// A camera that streams.
pub struct CameraDevice {
    camera: rscam::Camera,
    name: String,
    format: [u8; 4],
    size: (u32, u32),
    rate: u32,
    clock: Clock,
    number: u64,
    first_us: Option<u64>,
}

impl std::fmt::Debug for CameraDevice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CameraDevice").field("name", &self.name).finish_non_exhaustive()
    }
}

/// A camera as `sculptd camera test` lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundCamera {
    /// Number in `--camera`.
    pub index: u32,
    /// Device node.
    pub path: String,
    /// The driver's name of it.
    pub name: String,
}

/// Returns the cameras of this machine. Nodes that carry no pictures are left out.
pub fn list() -> Vec<FoundCamera> {
    list_in(Path::new("/sys/class/video4linux"))
}

fn list_in(class: &Path) -> Vec<FoundCamera> {
    let Ok(entries) = std::fs::read_dir(class) else { return Vec::new() };
    let mut found: Vec<FoundCamera> = entries
        .flatten()
        .filter_map(|entry| {
            let node = entry.file_name().to_string_lossy().into_owned();
            let index = node.strip_prefix("video")?.parse().ok()?;
            let fact = |name: &str| std::fs::read_to_string(entry.path().join(name)).ok();
            // The second node of a webcam carries descriptions and no pictures.
            let order = fact("index").and_then(|i| i.trim().parse::<u32>().ok()).unwrap_or(0);
            let name = fact("name").unwrap_or_default().trim().to_owned();
            (order == 0).then(|| FoundCamera { index, path: format!("/dev/{node}"), name })
        })
        .collect();
    found.sort_by_key(|c| c.index);
    found
}

impl CameraDevice {
    /// Opens `/dev/videoN`, or another node by its path.
    ///
    /// # Errors
    /// Returns an error if there is no such camera, if it may not be used, if another program uses
    /// it, or if it has no format that is read.
    pub fn open(which: &str, clock: Clock) -> Result<Self, CameraError> {
        let path = match which.parse::<u32>() {
            Ok(index) => format!("/dev/video{index}"),
            Err(_) => which.to_owned(),
        };
        let failed = |e| CameraError::of_system(&path, e);
        let mut camera = rscam::new(&path).map_err(failed)?;
        let found: Vec<[u8; 4]> =
            camera.formats().map_while(Result::ok).take(MAX_FORMATS).map(|f| f.format).collect();
        let named = |f: &[u8; 4]| String::from_utf8_lossy(f).into_owned();
        let mut busy = false;
        for format in FORMATS.iter().filter(|f| found.contains(f)) {
            for size in SIZES {
                for rate in RATES {
                    let config = rscam::Config {
                        interval: (1, rate),
                        resolution: size,
                        format: *format,
                        nbuffers: BUFFERS,
                        ..rscam::Config::default()
                    };
                    match camera.start(&config) {
                        Ok(()) => {
                            return Ok(CameraDevice {
                                camera,
                                name: path,
                                format: **format,
                                size,
                                rate,
                                clock,
                                number: 0,
                                first_us: None,
                            });
                        }
                        Err(rscam::Error::Io(e)) if e.raw_os_error() == Some(16) => busy = true,
                        Err(_) => {}
                    }
                }
            }
        }
        if busy {
            return Err(CameraError::Busy(path));
        }
        let offered: Vec<String> = found.iter().map(named).collect();
        let offered = if offered.is_empty() { "no format".into() } else { offered.join(", ") };
        Err(CameraError::Format { name: path, found: offered })
    }

    /// Returns the exposure time in units of 100 microseconds, where the camera states it.
    pub fn exposure(&self) -> Option<i32> {
        match self.camera.get_control(rscam::CID_EXPOSURE_ABSOLUTE).ok()?.data {
            rscam::CtrlData::Integer { value, .. } => Some(value),
            _ => None,
        }
    }
}

impl PictureSource for CameraDevice {
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError> {
        let frame = self.camera.capture().map_err(|e| CameraError::of_system(&self.name, e))?;
        let now = self.clock.now_us();
        let first = *self.first_us.get_or_insert(now);
        self.number += 1;
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let picture = match &self.format {
            b"MJPG" => jpeg::decode(&frame),
            b"YUYV" => yuv::of_yuyv(&frame, width, height),
            _ => yuv::of_grey(&frame, width, height),
        };
        match picture {
            Ok(picture) => Ok(Some((now - first, picture))),
            Err(why) => {
                Err(CameraError::Damaged { name: self.name.clone(), number: self.number, why })
            }
        }
    }

    fn describe(&self) -> String {
        let format = String::from_utf8_lossy(&self.format);
        let (w, h) = self.size;
        format!("{}: {format}, {w} by {h} pixels, {} a second", self.name, self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_absent_camera_is_named_with_what_to_do() {
        let e = CameraDevice::open("/dev/video-that-is-not", Clock::manual()).expect_err("absent");
        assert!(matches!(e, CameraError::Absent(_)), "{e:?}");
        assert!(e.to_string().contains("sculptd camera test"), "{e}");
    }

    #[test]
    fn a_node_that_is_no_camera_is_an_error() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("video9");
        std::fs::File::create(&path).expect("a file");
        let e = CameraDevice::open(&path.display().to_string(), Clock::manual());
        assert!(e.is_err());
    }

    #[test]
    fn only_first_nodes_are_cameras() {
        let dir = tempfile::tempdir().expect("a folder");
        for (node, index, name) in [("video0", "0", "Cam"), ("video1", "1", "Cam"), ("v", "0", "")]
        {
            let at = dir.path().join(node);
            std::fs::create_dir(&at).expect("a folder");
            for (file, text) in [("index", index), ("name", name)] {
                let mut file = std::fs::File::create(at.join(file)).expect("a file");
                std::io::Write::write_all(&mut file, text.as_bytes()).expect("written");
            }
        }
        let all = list_in(dir.path());
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].index, all[0].name.as_str()), (0, "Cam"));
    }
}
