//! The brush in hand, its picture, the mask, the curve that a pen has laid.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::range::{COORDINATE, Range, SHARE, STROKE_MS, VIEW};
use crate::wire::RpcError;

/// Settings of a brush, named as in the configuration's `[brush]`. As parameters, only the named
/// settings change; a reply contains all.
///
/// The daemon knows the range of each number and refuses others with the name, the value and the
/// range; the numbers here are as the configuration file documents them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct BrushSettings {
    /// The brush, by the name that `brushes` lists. A change of the brush restores that brush's
    /// settings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// Radius, as a share of the object's bounding radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Strength of one dab; for brushes that raise, its height as a share of the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<f32>,
    /// The opposite of what the brush does: carve instead of raise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub negative: Option<bool>,
    /// Distance between dabs, as a share of the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f32>,
    /// Pressure curve of the strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_strength: Option<PressureCurve>,
    /// Pressure curve of the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_radius: Option<PressureCurve>,
    /// Mirror images over the planes x = 0, y = 0, z = 0 through the object's middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<[bool; 3]>,
    /// The shape of a dab between its middle and its rim.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub falloff: Option<String>,
    /// RGBA, sRGB, for brushes that paint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<[u8; 4]>,
    /// The picture of heights, by name, for brushes that press one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<String>,
    /// Every other setting of `[brush]`: plane, tilt, stamp, automasks, path, topology, mirror, and
    /// the brush's own numbers (`extra`). An unknown name is refused.
    #[serde(flatten)]
    pub others: Map<String, Value>,
}

/// A factor from pressure: `at_zero + (1 - at_zero) * pressure^gamma`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PressureCurve {
    /// The factor without pressure. 1: pressure does not matter.
    #[cfg_attr(test, schemars(range(min = SHARE.min, max = SHARE.max)))]
    #[serde(default)]
    pub at_zero: f32,
    /// Above 1 a light touch is finer, below 1 bolder.
    #[cfg_attr(test, schemars(range(min = 0.1, max = 10.0)))]
    #[serde(default = "one")]
    pub gamma: f32,
}

fn one() -> f32 {
    1.0
}

/// Reply of `brushes`: every brush in the order of its list.
pub type BrushesReply = Vec<BrushInfo>;

/// A brush as `brushes` describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BrushInfo {
    /// Its name, for [`BrushSettings::kind`].
    pub name: String,
    /// Description of the brush, one sentence.
    pub about: String,
    /// The settings that it comes with.
    pub settings: BrushSettings,
    /// Its own numbers, in the order of the setting `extra`: each with name, range and value.
    pub extra: Vec<Map<String, Value>>,
    /// It is a person's own, from the folder of brushes. Its name serves as
    /// [`BrushSettings::kind`] too: the brush then comes with its picture of heights.
    #[serde(default)]
    pub own: bool,
}

/// Parameters of a method that reads or writes one file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PathParams {
    /// An absolute path without `..`, not a symbolic link; to be read, a regular file.
    #[cfg_attr(test, schemars(extend("minLength" = 1, "maxLength" = 4096)))]
    pub path: PathBuf,
}

/// Reply of `picture`: the size of the picture, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PictureReply {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// Parameters of `mask`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MaskParams {
    /// Change of the whole object's mask.
    pub action: MaskAction,
}

/// Change of the whole object's mask.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MaskAction {
    /// Nothing is protected.
    Clear,
    /// Everything is protected.
    Fill,
    /// Swaps free and protected.
    Invert,
    /// Each vertex takes the mean of its neighbours.
    Blur,
    /// The border between free and protected becomes steeper.
    Sharpen,
    /// The protected part grows by one ring of vertices.
    Grow,
    /// The protected part shrinks by one ring of vertices.
    Shrink,
    /// Protects what is hollow by at least so much: mean curvature, times a tenth of the object's
    /// bounding radius.
    Cavity(#[cfg_attr(test, schemars(range(min = SHARE.min, max = SHARE.max)))] f32),
}

/// Parameters of `mask-measured`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MaskMeasuredParams {
    /// Measure to mask by.
    pub by: MaskMeasure,
}

/// Measure of the whole object that decides the mask.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MaskMeasure {
    /// Masks walls up to this thickness, in the unit of the scene; more than 0.
    Thin(f64),
    /// Masks places where the object blocks at least this share of an even sky's light: ambient
    /// occlusion. More than 0.
    Occlusion(#[cfg_attr(test, schemars(range(min = SHARE.min, max = SHARE.max)))] f32),
}

/// Result of `mask-measured`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MaskMeasuredReply {
    /// Vertices that were measured to be protected by half or more.
    pub protected: u64,
}

/// Parameters of `mask-region`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MaskRegionParams {
    /// Region to mask, all the way through.
    pub region: ViewRegion,
    /// The mask there: 1 protects, 0 frees.
    #[cfg_attr(test, schemars(range(min = SHARE.min, max = SHARE.max)))]
    #[serde(default = "one")]
    pub mask: f32,
    /// Only what faces the eye.
    #[serde(default)]
    pub front_faces: bool,
}

/// A region of the view, (0, 0) top left to (1, 1) bottom right; [`crate::range::VIEW`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ViewRegion {
    /// Two opposite corners: x, y, x, y.
    Box(#[cfg_attr(test, schemars(inner(range(min = VIEW.min, max = VIEW.max))))] [f32; 4]),
    /// Everything to the left of the line from the first point to the second: x, y, x, y.
    Line(#[cfg_attr(test, schemars(inner(range(min = VIEW.min, max = VIEW.max))))] [f32; 4]),
    /// The corners of a closed polygon, as a lasso draws it freely or a polyline sets it point by
    /// point: x, y of each, 3 to 1000. Where it crosses itself, what lies inside an odd number of
    /// times.
    Polygon(#[cfg_attr(test, schemars(length(min = 3, max = 1000)))] Vec<[f32; 2]>),
}

/// Parameters of `curve`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CurveParams {
    /// Action on the curve.
    pub act: CurveAction,
}

/// Action on the curve that a pen has laid with the method `curve`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum CurveAction {
    /// Draws the brush along it, as one stroke.
    Apply,
    /// It is discarded.
    Cancel,
    /// The handle of this number is removed; the first is 0.
    Delete(#[cfg_attr(test, schemars(range(min = 0, max = 65535)))] u32),
}

/// Reply of `curve`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CurveReply {
    /// Always true.
    pub sent: bool,
    /// Handles that the curve had before.
    pub points: u64,
}

/// Parameters of `stroke`: a stroke of a pen, as a request.
///
/// The points become samples of a virtual pen and take the same way as those of a tablet: they are
/// recorded in the session, and a replay gives the same surface. One stroke is made at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StrokeParams {
    /// The points, 1 to 1000: `[x, y, pressure, t_ms]` in view coordinates, `[x, y, z, pressure,
    /// t_ms]` in world coordinates. Pressure is 0 to 1 (0 still touches); `t_ms` counts from the
    /// start of the stroke, 0 to 60,000, and rises by at least 1 from point to point.
    #[cfg_attr(test, schemars(length(min = 1, max = 1000)))]
    pub points: Vec<StrokePoint>,
    /// Space of the points' coordinates.
    pub space: StrokeSpace,
    /// Settings for this stroke alone; the brush in hand comes back afterwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub brush: Option<BrushSettings>,
}

/// The most points of a stroke.
pub const MAX_STROKE_POINTS: usize = 1000;

impl StrokeParams {
    /// The range of each number, the fields of each point for its space, and that time rises.
    ///
    /// # Errors
    /// Names the point, the value and what was expected.
    ///
    /// ```
    /// use sculptd_control::brush::{StrokeParams, StrokePoint, StrokeSpace};
    /// let at = |ms| StrokePoint::View([0.5, 0.5, 1.0, ms]);
    /// let space = StrokeSpace::View;
    /// let stroke = |points| StrokeParams { points, space, brush: None };
    /// assert!(stroke(vec![at(0.0), at(5.0)]).check().is_ok());
    /// assert!(stroke(vec![at(0.0), at(0.5)]).check().is_err());
    /// ```
    pub fn check(&self) -> Result<(), RpcError> {
        if !(1..=MAX_STROKE_POINTS).contains(&self.points.len()) {
            let (found, most) = (self.points.len(), MAX_STROKE_POINTS);
            let text = format!("points has {found} items: expected 1 to {most} of them");
            return Err(RpcError::bad_params(text));
        }
        let mut earliest = STROKE_MS.min;
        for (i, point) in self.points.iter().enumerate() {
            let wrong = |text: String| Err(RpcError::bad_params(format!("points[{i}]{text}")));
            let (place, range, pressure, ms): (&[f64], Range, f64, f64) = match (point, self.space)
            {
                (StrokePoint::View([at @ .., p, t]), StrokeSpace::View) => (at, VIEW, *p, *t),
                (StrokePoint::World([at @ .., p, t]), StrokeSpace::World) => {
                    (at, COORDINATE, *p, *t)
                }
                (_, StrokeSpace::View) => return wrong(": expected [x, y, pressure, t_ms]".into()),
                (_, StrokeSpace::World) => {
                    return wrong(": expected [x, y, z, pressure, t_ms]".into());
                }
            };
            let numbers = place
                .iter()
                .map(|v| (*v, range))
                .chain([(pressure, SHARE), (ms, Range { min: earliest, max: STROKE_MS.max })]);
            for (k, (value, Range { min, max })) in numbers.enumerate() {
                if !(Range { min, max }).contains(value) {
                    return wrong(format!(
                        "[{k}] = {value}: expected a number from {min} to {max}"
                    ));
                }
            }
            earliest = ms + MIN_STROKE_STEP_MS;
        }
        Ok(())
    }
}

/// The least time from point to point, milliseconds: a stroke has at most 1000 points a second.
pub const MIN_STROKE_STEP_MS: f64 = 1.0;

/// One point of a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum StrokePoint {
    /// x, y of the view ([`crate::range::VIEW`]), pressure, milliseconds.
    View(#[cfg_attr(test, schemars(inner(range(min = -1e6, max = 1e6))))] [f64; 4]),
    /// x, y, z of space ([`crate::range::COORDINATE`]), pressure, milliseconds.
    World(#[cfg_attr(test, schemars(inner(range(min = -1e6, max = 1e6))))] [f64; 5]),
}

/// Space of the coordinates of a stroke's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StrokeSpace {
    /// Of the view: (0, 0) top left to (1, 1) bottom right.
    View,
    /// Of space, in the mesh's unit. Every point must be seen from the camera as it stands.
    World,
}

/// Reply of `stroke`, sent when the loop has taken the last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StrokeReply {
    /// Samples that were sent: the points, and the lift.
    pub samples: u64,
    /// The tick after which the whole stroke was taken.
    pub tick: u64,
}
