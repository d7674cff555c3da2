//! The messages between the daemon and a page, but for pens and pages of clay: JSON, one object a
//! message.

use serde::{Deserialize, Serialize};

use super::delivery::ShownObject;
use super::downloads::WorkFormat;
use super::walls::WallScale;
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};
use sculptd_engine::camera::Camera;

/// First message of a page.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    /// Secret of the key in the link.
    pub key: String,
    /// Name of the guest.
    #[serde(default)]
    pub name: String,
    /// Ticket of the connection that was cut.
    #[serde(default)]
    pub ticket: Option<String>,
    /// The last message with a page of clay that arrived then.
    #[serde(default)]
    pub received: u32,
}

/// Every later message of a page. A time is in microseconds on the page's clock; it orders the
/// request among the samples of its pen.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum GuestRequest {
    /// The view that the guest has now.
    Camera { camera: Camera, at: f64 },
    /// Settings of the brush; those left out stay.
    Brush {
        #[serde(default)]
        kind: Option<BrushKind>,
        #[serde(default)]
        radius: Option<f32>,
        #[serde(default)]
        strength: Option<f32>,
        #[serde(default)]
        negative: Option<bool>,
        #[serde(default)]
        colour: Option<[u8; 3]>,
        #[serde(default)]
        symmetry: Option<[bool; 3]>,
        at: f64,
    },
    /// The guest wants to be called so.
    Name { name: String },
    /// The guest wants the work as a file.
    File { format: WorkFormat },
    /// The guest wants to see the walls' thickness, or not any more.
    Walls { on: bool },
    /// Undoes the guest's last step.
    Undo { at: f64 },
    /// Redoes the guest's step that was undone last.
    Redo { at: f64 },
}

/// Brush of the guest, as the page shows it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BrushShown {
    pub kind: BrushKind,
    pub radius: f32,
    pub strength: f32,
    pub negative: bool,
    pub colour: [u8; 3],
    pub symmetry: [bool; 3],
}

impl From<&BrushSettings> for BrushShown {
    fn from(brush: &BrushSettings) -> BrushShown {
        let [r, g, b, _] = brush.colour;
        BrushShown {
            kind: brush.kind,
            radius: brush.radius,
            strength: brush.strength,
            negative: brush.negative,
            colour: [r, g, b],
            symmetry: brush.symmetry,
        }
    }
}

/// Another person's pen on the clay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PenShown {
    pub person: u8,
    pub position: [f32; 3],
    pub radius: f32,
    pub down: bool,
}

/// A person who is connected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PersonShown {
    /// Number of the guest, also of those who are no person of the world.
    pub guest: u64,
    pub person: u8,
    pub name: String,
    pub role: &'static str,
    pub colour: [u8; 3],
}

/// Messages to a page.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum Tell {
    /// The answer to [`Hello`].
    Welcome {
        role: &'static str,
        guest: u64,
        person: u8,
        ticket: String,
        /// True if the page goes on where it was.
        resumed: bool,
        camera: Camera,
        brush: BrushShown,
        brushes: Vec<BrushKind>,
        /// Radius of the work, world units.
        extent: f32,
        /// Longest batch of pen records.
        records: usize,
    },
    /// Nothing follows: the reason, for the guest.
    Refused { why: String },
    /// The visible objects.
    Objects { objects: Vec<ShownObject> },
    /// The view of the person at the machine.
    Host { camera: Camera },
    /// Who is here.
    People { people: Vec<PersonShown> },
    /// Pens of the others over the clay.
    Pens { pens: Vec<PenShown> },
    /// What the guest's brush is set to now.
    Brush { brush: BrushShown },
    /// Every pen batch up to this one was taken.
    Taken { batch: u32 },
    /// The page shows the newest state of the clay.
    Complete { bytes: u64 },
    /// The file that the guest asked for can be fetched at this path for ten minutes.
    File { path: String },
    /// The scale of the map of walls; `None`: no map is shown.
    Walls { scale: Option<WallScale> },
    /// Something for the guest to read.
    Note { text: String },
}

/// Applies the changes of a [`GuestRequest::Brush`] to the settings.
pub fn changed_brush(now: &BrushSettings, ask: &GuestRequest, presets: &Presets) -> BrushSettings {
    let GuestRequest::Brush { kind, radius, strength, negative, colour, symmetry, .. } = ask else {
        return *now;
    };
    let mut brush = match kind.filter(|k| *k != now.kind) {
        Some(kind) => BrushSettings { colour: now.colour, ..presets.switched(now, kind) },
        None => *now,
    };
    let finite = |value: &Option<f32>| value.filter(|v| v.is_finite());
    brush.radius = finite(radius).unwrap_or(brush.radius);
    brush.strength = finite(strength).unwrap_or(brush.strength);
    brush.negative = negative.unwrap_or(brush.negative);
    brush.symmetry = symmetry.unwrap_or(brush.symmetry);
    if let Some([r, g, b]) = *colour {
        brush.colour = [r, g, b, 255];
    }
    brush.clamped()
}
