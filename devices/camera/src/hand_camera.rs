//! Pictures in, hand samples out: models, tracks, millimetres and confidence in one place. It has
//! no clock and starts no thread, so the same pictures give the same samples.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::hand_sample::{HandFacts, hand_of, palm_of};
use crate::hand_tracks::{HandTrack, HandTracks, MAX_TRACKS};
use crate::landmarks::JOINTS;
use crate::lens::Lens;
use crate::picture::{Picture, Rotation};
use crate::spatial::{Calibration, DepthFilter, place};
use crate::steady_shape::SteadyShape;
use sculptd_devices::{Body, DeviceId, Hands, Sample};

/// Settings of a camera that watches hands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HandCameraSettings {
    /// Field of view along the longer side of the picture, degrees.
    pub fov_degrees: f32,
    /// True if the camera looks the same way as the user, from behind or above.
    pub from_behind: bool,
    /// Turn of the camera, degrees clockwise: 0, 90, 180 or 270.
    pub rotation: Rotation,
    /// Size of the hand as a share of an average adult's; `sculptd camera test --distance` finds
    /// it.
    pub hand_scale: f32,
    /// Correction added to each distance, mm; found together with the scale.
    pub depth_offset_mm: f32,
}

impl Default for HandCameraSettings {
    fn default() -> Self {
        let lens = Lens::default();
        HandCameraSettings {
            fov_degrees: lens.fov_degrees,
            from_behind: lens.from_behind,
            rotation: Rotation::None,
            hand_scale: Calibration::default().scale,
            depth_offset_mm: Calibration::default().offset_mm,
        }
    }
}

impl HandCameraSettings {
    /// Returns the lens.
    pub fn lens(&self) -> Lens {
        Lens { fov_degrees: self.fov_degrees, from_behind: self.from_behind }
    }

    /// Returns the calibration of the hand.
    pub fn calibration(&self) -> Calibration {
        Calibration { scale: self.hand_scale, offset_mm: self.depth_offset_mm }
    }
}

/// Why a hand is not recognised, and what to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CameraAdvice {
    /// Nothing to change.
    Good,
    /// No hand is in the picture.
    ShowHand,
    /// The picture is too dark.
    TooDark,
    /// The picture is too bright, or the window is behind the hand.
    TooBright,
    /// The hand fills the picture.
    TooClose,
    /// The hand is small.
    TooFar,
    /// A part of the hand is outside the picture.
    MoveIntoFrame,
    /// The hand is seen, but not well enough for a tool.
    Unsure,
}

impl CameraAdvice {
    /// Returns one sentence for people.
    pub fn text(self) -> &'static str {
        match self {
            CameraAdvice::Good => "Hands are recognised.",
            CameraAdvice::ShowHand => "No hand is in view. Show an open hand to the camera.",
            CameraAdvice::TooDark => "The picture is too dark. Turn on a lamp in front of you.",
            CameraAdvice::TooBright => {
                "The picture is too bright. Turn away from the window or the lamp."
            }
            CameraAdvice::TooClose => "The hand is too close. Move it away from the camera.",
            CameraAdvice::TooFar => "The hand is too far away. Move it nearer to the camera.",
            CameraAdvice::MoveIntoFrame => "A part of the hand is outside. Move it into the frame.",
            CameraAdvice::Unsure => "The hand is not clear. Turn the palm to the camera.",
        }
    }
}

/// Findings in the newest picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraView {
    /// Mean brightness, 0 to 1.
    pub light: f32,
    /// Score of the surest palm of the last search, 0 to 1.
    pub palm_score: f32,
    /// Advice for the person.
    pub advice: CameraAdvice,
    /// Hands of other people that were ignored.
    pub ignored: usize,
    /// Hands, as shares of the picture, for a drawing over it.
    pub joints: [Option<[glam::Vec2; JOINTS]>; MAX_TRACKS],
    /// Confidence in each of those hands, 0 to 1.
    pub confidence: [f32; MAX_TRACKS],
    /// Distance of each of those hands, mm.
    pub depth: [f32; MAX_TRACKS],
}

/// Presence at which a hand is sure, and at which it can do nothing.
const SURE: f32 = 0.85;
const UNSURE: f32 = 0.5;
/// Misfit of the palm, as a share of its length, from which on confidence falls, and at which
/// nothing is left of it. Drawn hands have 0.03 to 0.09.
const MISFIT: (f32, f32) = (0.14, 0.3);
/// Confidence of a hand that was lost one, two and three pictures ago: its tools are released
/// gently.
const FADING: [f32; 3] = [0.35, 0.2, 0.08];
/// Longest time for which a lost hand is continued, microseconds.
const FADES_US: u64 = 150_000;
/// Mean brightness below which models fail, and above which.
const DARK: f32 = 0.08;
const BRIGHT: f32 = 0.93;
/// Palm over the picture's shorter side: too close above, too far below.
const CLOSE: f32 = 0.55;
const FAR: f32 = 0.06;

/// Memory of a hand from picture to picture.
#[derive(Debug, Clone, Copy)]
struct HandMemory {
    id: i32,
    joints: [Vec3; JOINTS],
    left: bool,
    confidence: f32,
    depth: DepthFilter,
    shape: SteadyShape,
    velocity: Vec3,
    since_us: u64,
    t_us: u64,
    /// Pictures since it was seen.
    lost: usize,
}

/// A camera that watches hands.
#[derive(Debug)]
pub struct HandCamera {
    tracks: HandTracks,
    settings: HandCameraSettings,
    device: DeviceId,
    memory: Vec<HandMemory>,
    frame: i64,
    view: CameraView,
}

impl HandCamera {
    /// Puts the parts together.
    pub fn new(tracks: HandTracks, settings: HandCameraSettings, device: DeviceId) -> Self {
        let view = CameraView {
            light: 0.0,
            palm_score: 0.0,
            advice: CameraAdvice::ShowHand,
            ignored: 0,
            joints: [None; MAX_TRACKS],
            confidence: [0.0; MAX_TRACKS],
            depth: [0.0; MAX_TRACKS],
        };
        HandCamera { tracks, settings, device, memory: Vec::new(), frame: 0, view }
    }

    /// Looks at one picture that was taken at `t_us`. Returns every hand, also when there is none.
    pub fn look(&mut self, picture: Picture, t_us: u64) -> Sample {
        let picture = picture.turned(self.settings.rotation);
        let size = picture.size();
        let lens = self.settings.lens();
        let calibration = self.settings.calibration();
        let (light, _) = picture.light();
        self.view.light = light;
        self.view.joints = [None; MAX_TRACKS];
        let mut advice = CameraAdvice::Good;
        let mut seen = Vec::new();
        for (slot, track) in self.tracks.look(&picture).iter().take(MAX_TRACKS).enumerate() {
            let before = self.memory.iter().find(|m| m.id == track.id);
            let mut shape = before.map_or(SteadyShape::new(&track.seen, t_us), |m| m.shape);
            let steady = shape.apply(&track.seen, t_us);
            let Some(placed) = place(&steady, track.is_left(), size, &lens, &calibration) else {
                continue;
            };
            let mut depth = before.map_or(DepthFilter::new(placed.depth, t_us), |m| m.depth);
            let steady = depth.take(placed.depth, t_us);
            let placed = placed.at_depth(steady).with_tips_joined();
            let (confidence, outside) = confidence(track, size, placed.misfit);
            let joints = placed.joints.map(|p| lens.to_tracker(p));
            let velocity = before.map_or(Vec3::ZERO, |m| {
                let dt = t_us.saturating_sub(m.t_us) as f32 * 1e-6;
                let by = palm_of(&joints) - palm_of(&m.joints);
                if dt > 0.0 { m.velocity.lerp(by / dt, 0.5) } else { m.velocity }
            });
            self.view.joints[slot] = Some(track.seen.joints.map(|p| p / size));
            self.view.confidence[slot] = confidence;
            self.view.depth[slot] = steady;
            advice = worse(advice, advice_for(track, size, confidence, outside));
            seen.push(HandMemory {
                id: track.id,
                joints,
                left: track.is_left(),
                confidence,
                depth,
                shape,
                velocity,
                since_us: before.map_or(t_us, |m| m.since_us),
                t_us,
                lost: 0,
            });
        }
        if seen.is_empty() {
            advice = match light {
                l if l < DARK => CameraAdvice::TooDark,
                l if l > BRIGHT => CameraAdvice::TooBright,
                _ => CameraAdvice::ShowHand,
            };
        }
        self.view.advice = advice;
        (self.view.palm_score, self.view.ignored) = (self.tracks.best_score, self.tracks.ignored);
        self.remember(seen, t_us);
        self.sample(t_us)
    }

    /// Returns what the newest picture showed.
    pub fn view(&self) -> &CameraView {
        &self.view
    }

    /// Returns a sample without hands, for a camera that is gone.
    pub fn gone(&mut self, t_us: u64) -> Sample {
        self.memory.clear();
        self.tracks.clear();
        self.view.joints = [None; MAX_TRACKS];
        self.sample(t_us)
    }

    /// Keeps the hands that were seen, and those that were lost a moment ago.
    fn remember(&mut self, mut seen: Vec<HandMemory>, t_us: u64) {
        for old in &self.memory {
            let found = |m: &HandMemory| {
                // The same hand under a new number.
                m.id == old.id
                    || m.since_us == t_us
                        && palm_of(&m.joints).distance(palm_of(&old.joints)) < 120.0
            };
            if seen.iter().any(found) || t_us.saturating_sub(old.t_us) > FADES_US {
                continue;
            }
            if old.lost < FADING.len() && seen.len() < MAX_TRACKS {
                let confidence = FADING[old.lost].min(old.confidence);
                seen.push(HandMemory { lost: old.lost + 1, confidence, ..*old });
            }
        }
        seen.sort_by_key(|m| m.id);
        self.memory = seen;
    }

    fn sample(&mut self, t_us: u64) -> Sample {
        self.frame += 1;
        let mut hands = Hands { frame: self.frame, ..Hands::default() };
        for memory in self.memory.iter().take(MAX_TRACKS) {
            let facts = HandFacts {
                id: memory.id,
                left: memory.left,
                confidence: memory.confidence,
                velocity: if memory.lost > 0 { Vec3::ZERO } else { memory.velocity },
                visible_s: t_us.saturating_sub(memory.since_us) as f32 * 1e-6,
            };
            hands.hands[usize::from(hands.count)] = hand_of(&memory.joints, &facts);
            hands.count += 1;
        }
        let body = Body::Hands(hands);
        Sample { device: self.device, t_us, device_t_us: None, body }
    }
}

/// Confidence in a hand, and how many of its joints lie outside the picture.
fn confidence(track: &HandTrack, size: glam::Vec2, misfit: f32) -> (f32, usize) {
    let presence = ((track.seen.presence - UNSURE) / (SURE - UNSURE)).clamp(0.0, 1.0);
    let inside = |p: &glam::Vec2| p.clamp(glam::Vec2::ZERO, size) == *p;
    let outside = track.seen.joints.iter().filter(|p| !inside(p)).count();
    let cut = 1.0 - (outside as f32 / 8.0).min(1.0);
    let shape = 1.0 - ((misfit - MISFIT.0) / (MISFIT.1 - MISFIT.0)).clamp(0.0, 1.0);
    // The first pictures of a hand may be wrong about everything.
    let age = (track.pictures as f32 / 3.0).min(1.0);
    (presence * cut * shape * age, outside)
}

fn advice_for(
    track: &HandTrack,
    size: glam::Vec2,
    confidence: f32,
    outside: usize,
) -> CameraAdvice {
    let share = track.seen.palm_px() / size.min_element().max(1.0);
    if share > CLOSE {
        CameraAdvice::TooClose
    } else if share < FAR {
        CameraAdvice::TooFar
    } else if outside > 0 {
        CameraAdvice::MoveIntoFrame
    } else if confidence < 0.4 && track.pictures > 3 {
        CameraAdvice::Unsure
    } else {
        CameraAdvice::Good
    }
}

fn worse(a: CameraAdvice, b: CameraAdvice) -> CameraAdvice {
    if a == CameraAdvice::Good { b } else { a }
}
