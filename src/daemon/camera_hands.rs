//! Bare hands by webcam: the models' folders, the camera's thread for a live run, and its pictures
//! step by step for a simulated one.

use std::path::PathBuf;

use sculptd_camera::camera_thread::{CameraChoice, CameraConfig, CameraHandle};
use sculptd_camera::hand_camera::{HandCamera, HandCameraSettings};
use sculptd_camera::hand_tracks::HandTracks;
use sculptd_camera::models::{self, ModelsError};
use sculptd_camera::picture::Picture;
use sculptd_camera::source::{CameraError, PictureSource};
use sculptd_devices::queue::Sender;
use sculptd_devices::{Clock, DeviceId};

use crate::config::DevicesConfig;
use crate::simulated_loop::Feed;

/// Id of the camera that watches hands, beside those of the other adaptors.
pub const CAMERA_ID: DeviceId = DeviceId(210);
/// The environment variable that names another folder of models.
pub const MODELS_VARIABLE: &str = "SCULPTD_CAMERA_MODELS";

/// Why a camera could not be started.
#[derive(Debug, thiserror::Error)]
pub enum CameraStartError {
    #[error(transparent)]
    Models(#[from] ModelsError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error("no thread for the camera: {0}")]
    Thread(std::io::Error),
}

/// The user's folder of models, into which `sculptd camera setup` writes.
pub fn own_models_folder() -> Option<PathBuf> {
    let dirs = directories::ProjectDirs::from("", "", "sculptd")?;
    Some(dirs.data_dir().join("hand-models"))
}

/// Every folder in which models are looked for, in that order.
pub fn model_folders() -> Vec<PathBuf> {
    let named = std::env::var_os(MODELS_VARIABLE).map(PathBuf::from);
    let packaged = PathBuf::from("/usr/share/sculptd/hand-models");
    named.into_iter().chain(own_models_folder()).chain([packaged]).collect()
}

/// Finds, checks and loads the models.
///
/// # Errors
/// Returns an error that names the command to run if they are absent or changed.
pub fn load_models() -> Result<HandTracks, ModelsError> {
    models::load(&models::find(&model_folders())?)
}

/// Starts the configured camera.
///
/// # Errors
/// Returns an error if the models are absent or no thread can be started. A camera that is absent
/// is no error: its status reports it.
pub fn start(
    config: &DevicesConfig,
    clock: &Clock,
    sender: Sender,
) -> Result<CameraHandle, CameraStartError> {
    start_choice(CameraChoice::from_text(&config.camera), config.camera_settings, clock, sender)
}

/// Starts a camera.
///
/// # Errors
/// As [`start`].
pub fn start_choice(
    choice: CameraChoice,
    settings: HandCameraSettings,
    clock: &Clock,
    sender: Sender,
) -> Result<CameraHandle, CameraStartError> {
    let config = CameraConfig { choice, settings, device: CAMERA_ID };
    sculptd_camera::camera_thread::start(config, load_models()?, clock.clone(), sender)
        .map_err(CameraStartError::Thread)
}

/// Recorded or drawn pictures, stepped.
#[derive(Debug)]
pub struct CameraFeed {
    source: Box<dyn PictureSource>,
    hands: HandCamera,
    sender: Sender,
    /// The next picture and when it is due.
    waiting: Option<(u64, Picture)>,
    sent: u64,
    last_us: u64,
    ended: bool,
    /// Pictures that could not be decoded.
    damaged: u64,
}

impl CameraFeed {
    /// Opens recorded pictures.
    ///
    /// # Errors
    /// Returns an error if the models are absent or the file is of no known kind.
    pub fn open(
        choice: &CameraChoice,
        settings: HandCameraSettings,
        sender: Sender,
    ) -> Result<Self, CameraStartError> {
        let hands = HandCamera::new(load_models()?, settings, CAMERA_ID);
        let source = choice.open(&Clock::manual())?;
        Ok(CameraFeed {
            source,
            hands,
            sender,
            waiting: None,
            sent: 0,
            last_us: 0,
            ended: false,
            damaged: 0,
        })
    }

    /// Returns the number of pictures that could not be decoded.
    pub fn damaged(&self) -> u64 {
        self.damaged
    }

    fn next(&mut self) {
        while self.waiting.is_none() && !self.ended {
            match self.source.next_picture() {
                Ok(Some(next)) => self.waiting = Some(next),
                Ok(None) => self.ended = true,
                Err(e @ CameraError::Damaged { .. }) => {
                    self.damaged += 1;
                    tracing::warn!("{e}");
                }
                Err(e) => {
                    self.ended = true;
                    tracing::warn!("{e}");
                }
            }
        }
    }
}

impl Feed for CameraFeed {
    fn advance(&mut self, until_us: u64) -> u64 {
        self.next();
        while let Some((t_us, picture)) = self.waiting.take_if(|(t_us, _)| *t_us <= until_us) {
            let t_us = t_us.max(self.last_us + 1);
            let sample = self.hands.look(picture, t_us);
            self.sender.push(sample);
            (self.last_us, self.sent) = (t_us, self.sent + 1);
            self.next();
        }
        if self.ended && self.waiting.is_none() && self.last_us > 0 && until_us > self.last_us {
            // The camera is gone, and so are its hands.
            let sample = self.hands.gone(self.last_us + 1);
            self.sender.push(sample);
            (self.last_us, self.sent) = (0, self.sent + 1);
        }
        self.sender.flush();
        self.sent
    }

    fn finished(&self) -> bool {
        self.ended && self.waiting.is_none() && self.last_us == 0
    }
}
