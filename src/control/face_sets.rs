//! Face sets of the active object: groups of its surface, which part of it is hidden, and parts of
//! it as objects of their own.

use serde::{Deserialize, Serialize};

use crate::brush::ViewRegion;

/// Reply of `sets.list`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FaceSetsReply {
    /// The active object.
    pub object: u32,
    /// Its face sets, ascending. Set 0 is what is in no set; it is there while anything is.
    pub sets: Vec<FaceSetInfo>,
    /// Vertices that are hidden, in whatever set.
    pub hidden: u64,
}

/// A face set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FaceSetInfo {
    /// Its number.
    pub set: u16,
    /// Number of vertices in it.
    pub vertices: u64,
    /// Number of hidden vertices in it.
    pub hidden: u64,
    /// Its name; `null`: it has none.
    #[serde(default)]
    pub name: Option<String>,
}

/// Parameters of `sets.rename`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FaceSetNameParams {
    /// Its number.
    #[cfg_attr(test, schemars(range(min = 1, max = 32767)))]
    pub set: u16,
    /// Its name from now on; without it it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: Option<String>,
}

/// Source of a face set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FaceSetSource {
    /// The vertices masked by half or more become a new set.
    Mask,
    /// All that is shown becomes a new set.
    Visible,
    /// Each part that hangs together becomes a set.
    Loose,
    /// Sets grow over what turns from their first triangle by at most `degrees`.
    Normals,
    /// Sets meet where the surface bends by more than `degrees` over an edge.
    Crease,
    /// Sets meet where the thickness of the wall changes; at most `levels` thicknesses are told
    /// apart.
    Walls,
}

/// Parameters of `sets.make`. Hidden vertices stay in their sets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FaceSetMakeParams {
    /// Source of the sets.
    pub from: FaceSetSource,
    /// Of `normals` and `crease`; 0 to 180, without it 40.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = 180.0)))]
    pub degrees: Option<f32>,
    /// Of `walls`; 1 to 16, without it as few as the walls need.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1, max = 16)))]
    pub levels: Option<u8>,
}

/// Names a face set: by its number, by a place of the view, or as what is masked. Only one of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FaceSetParams {
    /// Its number.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(max = 32767)))]
    pub set: Option<u16>,
    /// The set that is seen at this place, x and y from 0 to 1, from the view's left upper corner.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(inner(range(min = 0.0, max = 1.0))))]
    pub at: Option<[f32; 2]>,
    /// Acts on the vertices masked by half or more, instead of a set.
    pub masked: bool,
}

/// Parameters of `sets.show`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FaceSetShowParams {
    /// The set that is shown; without it everything is.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(max = 32767)))]
    pub set: Option<u16>,
}

/// Parameters of `sets.extract`: a set as [`FaceSetParams`] names one, and how thick the solid is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FaceSetExtractParams {
    /// Laid on along the normals, in the unit of the scene: outwards, or negative inwards; not 0.
    #[cfg_attr(test, schemars(range(min = -1e6, max = 1e6)))]
    pub thickness: f64,
    /// The number of the set; without it what is masked by half or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(max = 32767)))]
    pub set: Option<u16>,
    /// The name of the new object; without one `extract`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: Option<String>,
}

/// Action on the faces seen in a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FaceSetRegionAction {
    /// Its visible part becomes a new face set.
    Make,
    /// It is hidden.
    Hide,
    /// All but it is hidden.
    Isolate,
}

/// Parameters of `sets.region`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FaceSetRegionParams {
    /// Where, all the way through.
    pub region: ViewRegion,
    /// Action on the region.
    pub action: FaceSetRegionAction,
    /// Only what faces the eye.
    #[serde(default)]
    pub front_faces: bool,
}

/// Reply of a method that changes face sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FaceSetReply {
    /// The set that was made or that it was about; `null`: several, or none.
    pub set: Option<u16>,
    /// Number of sets made.
    pub made: u64,
}
