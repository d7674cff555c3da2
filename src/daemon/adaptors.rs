//! Starts the devices named in the configuration: one thread per device, each with its sender.

use crate::camera_hands;
use crate::config::DevicesConfig;
use sculptd_camera::camera_thread::CameraHandle;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::hid;
use sculptd_devices::hid::{HidConfig, HidHandle};
use sculptd_devices::queue::SenderFactory;
use sculptd_devices::tablet::TabletError;
use sculptd_devices::{Clock, DeviceId, leap, serial};

/// Ids by kind, so that a device keeps its id while others come and go: HID tablets from 0, serial
/// ports from 100, the tracker 200, the demo's devices from 201, the camera 210, attract films from
/// 230, the window's own pointer 246, the pen of the control socket's strokes 247, browsers that
/// serve as a tablet from 248. All are below 256: the upper byte of an id is the number of the
/// person whose device it is. Played recordings take the ids of tablets.
pub const SERIAL_IDS: u16 = 100;
pub const TRACKER_ID: DeviceId = DeviceId(200);
/// Ids of tablets and serial pens, which a desktop may move its pointer by.
pub const TABLET_IDS: std::ops::Range<u16> = 0..TRACKER_ID.0;
pub const DEMO_IDS: [DeviceId; 3] = [DeviceId(201), DeviceId(202), DeviceId(203)];
pub const ATTRACT_IDS: std::ops::Range<u16> = 230..246;
pub const POINTER_ID: DeviceId = DeviceId(246);
pub const CONTROL_PEN_ID: DeviceId = DeviceId(247);
pub const BROWSER_TABLET_IDS: std::ops::Range<u16> = 248..256;

/// Running adaptors; they stop when this is dropped.
#[derive(Debug, Default)]
pub struct Adaptors {
    hid: Option<HidHandle>,
    serial: Vec<(String, serial::SerialHandle)>,
    leap: Option<leap::LeapHandle>,
    camera: Option<CameraHandle>,
    failed: Vec<DeviceStanding>,
}

/// The kinds of devices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandingKind {
    Tablet,
    SerialPen,
    Tracker,
    Camera,
}

/// State of one device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceStanding {
    pub kind: StandingKind,
    /// Description of the device, its state and any fault.
    pub text: String,
    /// True if samples can come from the device.
    pub connected: bool,
}

impl DeviceStanding {
    fn new(kind: StandingKind, connected: bool, text: String) -> Self {
        DeviceStanding { kind, text, connected }
    }
}

/// Starts the adaptors. An adaptor that cannot start does not delay the others;
/// [`Adaptors::describe`] reports it.
pub fn start(
    config: &DevicesConfig,
    catalogue: Catalogue,
    clock: &Clock,
    factory: &SenderFactory,
) -> Adaptors {
    let mut all = Adaptors::default();
    let failed = |kind, text| DeviceStanding::new(kind, false, text);
    if config.hid {
        let settings = HidConfig {
            models: config.models.clone(),
            ignore: config.ignore.clone(),
            calibration: config.calibration.clone(),
            first_device: DeviceId(0),
        };
        match hid::start(settings, catalogue, clock.clone(), factory.clone()) {
            Ok(handle) => all.hid = Some(handle),
            Err(e) => {
                all.failed.push(failed(StandingKind::Tablet, format!("pen tablets: {e}")));
            }
        }
    }
    for (i, port) in config.serial.iter().enumerate() {
        let port = port.display().to_string();
        let settings = serial::SerialConfig {
            port: Some(port.clone()),
            calibration: config.calibration.get(&port).copied().unwrap_or_default(),
            device: DeviceId(SERIAL_IDS + i as u16),
            ..Default::default()
        };
        match serial::start(settings, clock.clone(), factory.sender()) {
            Ok(handle) => all.serial.push((port, handle)),
            Err(e) => {
                let text = format!("serial pen on {port}: {e}");
                all.failed.push(failed(StandingKind::SerialPen, text));
            }
        }
    }
    if !config.leap.is_empty() {
        let settings =
            leap::LeapConfig { url: config.leap.clone(), device: TRACKER_ID, ..Default::default() };
        match leap::start(settings, clock.clone(), factory.sender()) {
            Ok(handle) => all.leap = Some(handle),
            Err(e) => {
                let text = format!("hand tracking at {}: {e}", config.leap);
                all.failed.push(failed(StandingKind::Tracker, text));
            }
        }
    }
    if !config.camera.is_empty() {
        match camera_hands::start(config, clock, factory.sender()) {
            Ok(handle) => all.camera = Some(handle),
            Err(e) => all.failed.push(failed(StandingKind::Camera, format!("camera: {e}"))),
        }
    }
    all
}

/// Every model known: the built-in ones, and those in the folders that the configuration names.
pub fn tablets(config: &DevicesConfig) -> Result<Catalogue, TabletError> {
    config.tablets.iter().try_fold(Catalogue::builtin()?, |all, dir| all.with_dir(dir))
}

impl Adaptors {
    /// The model of a tablet; `None` where it is not known, or not without waiting.
    pub fn model_of(&self, device: DeviceId) -> Option<String> {
        self.hid.as_ref()?.model_of(device)
    }

    /// The camera that watches hands, if there is one.
    pub fn camera(&self) -> Option<&CameraHandle> {
        self.camera.as_ref()
    }

    /// One line a device: what it is, how it stands, what is wrong.
    pub fn describe(&self) -> Vec<String> {
        self.standing().into_iter().map(|device| device.text).collect()
    }

    /// Returns the state of each device.
    pub fn standing(&self) -> Vec<DeviceStanding> {
        let mut all = self.failed.clone();
        let mut put = |kind, connected, text| all.push(DeviceStanding::new(kind, connected, text));
        let tablets = self.hid.as_ref().map_or_else(Vec::new, HidHandle::status);
        for t in tablets.iter().filter(|t| t.usable || t.model.is_some()) {
            let name = t.model.as_ref().unwrap_or(&t.name);
            let state = t.reason.as_deref().unwrap_or(if t.usable {
                "connected"
            } else {
                "looking for it"
            });
            put(StandingKind::Tablet, t.usable, format!("{name} on {}: {state}", t.path));
        }
        for (port, handle) in &self.serial {
            let s = handle.status();
            let state = match (&s.model, s.connected) {
                (Some(model), true) => model.clone(),
                (None, true) => "connected".into(),
                _ => s.last_error.unwrap_or_else(|| "looking for it".into()),
            };
            put(StandingKind::SerialPen, s.connected, format!("serial pen on {port}: {state}"));
        }
        if let Some(handle) = &self.leap {
            let s = handle.status();
            let state = if s.connected {
                format!("connected, {:.0} frames a second", s.rate)
            } else {
                s.last_error.unwrap_or_else(|| "looking for it".into())
            };
            put(StandingKind::Tracker, s.connected, format!("hand tracking: {state}"));
        }
        if let Some(handle) = &self.camera {
            let s = handle.status();
            let state = match (s.connected, &s.last_error) {
                (true, _) => format!("{:.0} pictures a second. {}", s.rate, s.advice()),
                (false, Some(why)) => why.clone(),
                (false, None) if s.ended => "the recording has ended".into(),
                (false, None) => "looking for it".into(),
            };
            put(StandingKind::Camera, s.connected, format!("camera: {state}"));
        }
        all
    }
}
