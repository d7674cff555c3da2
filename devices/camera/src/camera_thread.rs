//! The threads of a camera: one reads pictures, one looks at them. The tick thread waits for
//! neither; a picture that comes while another is looked at replaces the one that waits.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crossbeam_channel as cc;

use crate::drawn::DrawnScene;
use crate::hand_camera::{CameraAdvice, CameraView, HandCamera, HandCameraSettings};
use crate::hand_tracks::HandTracks;
use crate::performance::performance;
use crate::picture::Picture;
use crate::source::drawn_script::DrawnScript;
use crate::source::{self, CameraError, PictureSource};
use sculptd_devices::device_thread::{self, DeviceThread, StopToken};
use sculptd_devices::queue::Sender;
use sculptd_devices::{Clock, DeviceId};

/// Wait before another attempt to open a camera that is not there.
const RETRY: Duration = Duration::from_millis(1500);
/// Silence of a camera after which its hands are taken to have left, microseconds.
const SILENCE_US: u64 = 300_000;
/// Interval at which the stop flag and silence are checked.
const SLICE: Duration = Duration::from_millis(40);
/// Side of the preview's pictures along their width, pixels.
const PREVIEW_WIDTH: usize = 320;

/// A camera or a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum CameraChoice {
    /// The number of `/dev/videoN`, or a device node.
    Device(String),
    /// A folder of pictures, Motion JPEG, or Y4M.
    File(std::path::PathBuf),
    /// Drawn hands that perform the demo.
    Drawn,
}

impl CameraChoice {
    /// Reads the value of `--camera`: a number, a device node, or a file.
    pub fn from_text(text: &str) -> Self {
        let is_device = text.is_empty() || text.parse::<u32>().is_ok() || text.starts_with("/dev/");
        if is_device {
            CameraChoice::Device(if text.is_empty() { "0".into() } else { text.into() })
        } else {
            CameraChoice::File(text.into())
        }
    }

    /// Returns true if its pictures have times of their own.
    pub fn is_recorded(&self) -> bool {
        !matches!(self, CameraChoice::Device(_))
    }

    /// Opens it.
    ///
    /// # Errors
    /// Returns an error if it is absent, busy, forbidden, or of a kind that is not read.
    pub fn open(&self, clock: &Clock) -> Result<Box<dyn PictureSource>, CameraError> {
        match self {
            #[cfg(target_os = "linux")]
            CameraChoice::Device(which) => {
                Ok(Box::new(source::device::CameraDevice::open(which, clock.clone())?))
            }
            #[cfg(not(target_os = "linux"))]
            CameraChoice::Device(which) => {
                let _ = clock;
                Err(CameraError::Absent(which.clone()))
            }
            CameraChoice::File(path) => source::open_file(path),
            CameraChoice::Drawn => {
                Ok(Box::new(DrawnScript::new(performance(), DrawnScene::default())))
            }
        }
    }
}

/// Configuration of a running camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraConfig {
    /// The camera or file.
    pub choice: CameraChoice,
    /// Lens and turn.
    pub settings: HandCameraSettings,
    /// Under which id its samples go out.
    pub device: DeviceId,
}

/// State of a camera.
#[derive(Debug, Clone, Default)]
pub struct CameraStatus {
    /// Pictures come.
    pub connected: bool,
    /// Name, format and size.
    pub description: String,
    /// Pictures looked at.
    pub pictures: u64,
    /// Pictures that came while another was looked at.
    pub skipped: u64,
    /// Pictures that could not be decoded.
    pub damaged: u64,
    /// Pictures a second, smoothed over about a second.
    pub rate: f32,
    /// From a picture to its sample, microseconds, smoothed.
    pub delay_us: u64,
    /// Findings in the newest picture.
    pub view: Option<CameraView>,
    /// Why there are no pictures, or what was wrong last.
    pub last_error: Option<String>,
    /// A file has come to its end.
    pub ended: bool,
}

impl CameraStatus {
    /// Returns what to change, in one sentence.
    pub fn advice(&self) -> &'static str {
        self.view.as_ref().map_or(CameraAdvice::ShowHand, |v| v.advice).text()
    }
}

/// A small picture of what the camera sees, for the window. It is overwritten by the next one and
/// never leaves the process.
#[derive(Debug, Clone)]
pub struct CameraPreview {
    /// At most 320 pixels wide.
    pub picture: Picture,
    /// Hands in it.
    pub view: CameraView,
}

#[derive(Debug, Default)]
struct Shared {
    status: Mutex<CameraStatus>,
    preview: Mutex<Option<Arc<CameraPreview>>>,
    /// A preview was asked for since the last one was made.
    wanted: AtomicBool,
}

impl Shared {
    fn note(&self, change: impl FnOnce(&mut CameraStatus)) {
        change(&mut self.status.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// A running camera; dropping it ends its threads.
#[derive(Debug)]
pub struct CameraHandle {
    shared: Arc<Shared>,
    _thread: DeviceThread,
}

impl CameraHandle {
    /// A copy of the present state.
    pub fn status(&self) -> CameraStatus {
        self.shared.status.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the newest preview and asks for another. Without this call none is made.
    pub fn preview(&self) -> Option<Arc<CameraPreview>> {
        self.shared.wanted.store(true, Relaxed);
        self.shared.preview.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Starts a camera. It goes on trying to open a device for as long as the handle lives.
///
/// # Errors
/// Only if no thread can be started.
pub fn start(
    config: CameraConfig,
    tracks: HandTracks,
    clock: Clock,
    sender: Sender,
) -> std::io::Result<CameraHandle> {
    let shared = Arc::new(Shared::default());
    let own = shared.clone();
    let thread = device_thread::spawn("sculptd-camera", move |stop| {
        let mut sender = sender;
        sender.stop_when(stop.flag());
        let hands = HandCamera::new(tracks, config.settings, config.device);
        Looker {
            config,
            hands,
            clock,
            sender,
            shared: own,
            last_us: 0,
            shown: false,
            warned: String::new(),
        }
        .run(&stop);
    })?;
    Ok(CameraHandle { shared, _thread: thread })
}

/// A message of the reading thread.
enum Read {
    Picture(u64, Picture),
    Damaged(String),
    Ended,
    Lost(String),
}

struct Looker {
    config: CameraConfig,
    hands: HandCamera,
    clock: Clock,
    sender: Sender,
    shared: Arc<Shared>,
    last_us: u64,
    /// The last sample had hands in it.
    shown: bool,
    /// The last reason that was logged.
    warned: String,
}

impl Looker {
    fn run(&mut self, stop: &StopToken) {
        while !stop.stopped() {
            match self.config.choice.open(&self.clock) {
                Ok(source) => {
                    let description = source.describe();
                    self.shared.note(|s| {
                        (s.connected, s.description, s.last_error) = (true, description, None);
                    });
                    let why = self.follow(source, stop);
                    self.release();
                    if let Some(why) = &why {
                        self.warn(why);
                    }
                    self.shared.note(|s| {
                        s.connected = false;
                        s.last_error = why.clone().or(s.last_error.take());
                        s.ended = why.is_none();
                    });
                    if why.is_none() {
                        return;
                    }
                }
                Err(e) => {
                    let text = e.to_string();
                    self.warn(&text);
                    self.shared.note(|s| {
                        (s.connected, s.last_error) = (false, Some(text));
                    });
                    if self.config.choice.is_recorded() {
                        return;
                    }
                }
            }
            if stop.wait(RETRY) {
                return;
            }
        }
    }

    /// Reads until the source ends (`None`) or is lost (why).
    fn follow(&mut self, source: Box<dyn PictureSource>, stop: &StopToken) -> Option<String> {
        // One picture waits; a newer one takes its place.
        let (put, get) = cc::bounded::<Read>(1);
        let replace = get.clone();
        let paced = self.config.choice.is_recorded();
        let (clock, flag, shared) = (self.clock.clone(), stop.flag(), self.shared.clone());
        // It is not waited for: a camera that has stopped sending may block it for ever.
        let reader = std::thread::Builder::new().name("sculptd-camera-reader".into());
        let started = reader.spawn(move || {
            read_pictures(source, paced, &clock, &flag, &put, &replace, &shared);
        });
        if let Err(e) = started {
            return Some(format!("no thread for the camera: {e}"));
        }
        let mut heard_us = self.clock.now_us();
        loop {
            if stop.stopped() {
                return None;
            }
            match get.recv_timeout(SLICE) {
                Ok(Read::Picture(t_us, picture)) => {
                    heard_us = self.clock.now_us();
                    self.look(picture, t_us);
                }
                Ok(Read::Damaged(why)) => {
                    heard_us = self.clock.now_us();
                    self.shared.note(|s| {
                        s.damaged += 1;
                        s.last_error = Some(why);
                    });
                }
                Ok(Read::Ended) => return None,
                Ok(Read::Lost(why)) => return Some(why),
                Err(cc::RecvTimeoutError::Timeout) => {
                    if self.clock.now_us().saturating_sub(heard_us) > SILENCE_US {
                        self.release();
                    }
                }
                Err(cc::RecvTimeoutError::Disconnected) => {
                    return Some("the camera's thread has ended".into());
                }
            }
        }
    }

    fn look(&mut self, picture: Picture, t_us: u64) {
        let preview = self.shared.wanted.swap(false, Relaxed).then(|| {
            let picture = picture.clone().turned(self.config.settings.rotation);
            smaller(&picture, PREVIEW_WIDTH)
        });
        let t_us = t_us.max(self.last_us + 1);
        let sample = self.hands.look(picture, t_us);
        self.shown = matches!(sample.body, sculptd_devices::Body::Hands(h) if h.count > 0);
        self.sender.push(sample);
        self.sender.flush();
        let (view, before) = (*self.hands.view(), self.last_us);
        let delay = self.clock.now_us().saturating_sub(t_us);
        self.last_us = t_us;
        if let Some(picture) = preview {
            let preview = Arc::new(CameraPreview { picture, view });
            *self.shared.preview.lock().unwrap_or_else(PoisonError::into_inner) = Some(preview);
        }
        self.shared.note(|s| {
            s.pictures += 1;
            s.view = Some(view);
            s.delay_us = if s.pictures < 2 { delay } else { (s.delay_us * 15 + delay) / 16 };
            if before > 0 {
                let now = 1e6 / (t_us - before).max(1) as f32;
                s.rate = if s.pictures < 5 { now } else { s.rate + (now - s.rate) * 0.1 };
            }
        });
    }

    /// Logs why there are no pictures, once for each reason.
    fn warn(&mut self, why: &str) {
        if self.warned != why {
            tracing::warn!("camera: {why}");
            self.warned = why.to_owned();
        }
    }

    /// Says that no hand is seen, once.
    fn release(&mut self) {
        if std::mem::take(&mut self.shown) {
            self.last_us = self.clock.now_us().max(self.last_us + 1);
            let sample = self.hands.gone(self.last_us);
            self.sender.push(sample);
            self.sender.flush();
        }
    }
}

/// The reading thread: stamps pictures with the time at which they were read, or, of a file, at
/// which they are due.
fn read_pictures(
    mut source: Box<dyn PictureSource>,
    paced: bool,
    clock: &Clock,
    stop: &AtomicBool,
    put: &cc::Sender<Read>,
    replace: &cc::Receiver<Read>,
    shared: &Shared,
) {
    let begun = clock.now_us();
    let quiet = cc::never::<()>();
    while !stop.load(Relaxed) {
        let read = match source.next_picture() {
            Ok(Some((t_us, picture))) if paced => {
                let due = begun + t_us;
                while !stop.load(Relaxed) && clock.now_us() < due {
                    let left = Duration::from_micros(due - clock.now_us().min(due));
                    let _ = quiet.recv_timeout(left.min(SLICE));
                }
                Read::Picture(clock.now_us(), picture)
            }
            Ok(Some((_, picture))) => Read::Picture(clock.now_us(), picture),
            Ok(None) => Read::Ended,
            Err(e @ CameraError::Damaged { .. }) => Read::Damaged(e.to_string()),
            Err(e) => Read::Lost(e.to_string()),
        };
        let last = matches!(read, Read::Ended | Read::Lost(_));
        let mut read = read;
        loop {
            match put.try_send(read) {
                Ok(()) => break,
                Err(cc::TrySendError::Disconnected(_)) => return,
                Err(cc::TrySendError::Full(again)) => {
                    // The last word waits behind the picture; a picture takes its place.
                    if last {
                        if put.send(again).is_err() {
                            return;
                        }
                        break;
                    }
                    if replace.try_recv().is_ok() {
                        shared.note(|s| s.skipped += 1);
                    }
                    read = again;
                }
            }
        }
        if last {
            return;
        }
    }
}

/// Every n-th pixel of every n-th row.
fn smaller(picture: &Picture, width: usize) -> Picture {
    let step = picture.width.div_ceil(width).max(1);
    let mut rgb = Vec::new();
    for y in (0..picture.height).step_by(step) {
        for x in (0..picture.width).step_by(step) {
            rgb.extend(picture.pixel(x, y));
        }
    }
    Picture { width: picture.width.div_ceil(step), height: picture.height.div_ceil(step), rgb }
}
