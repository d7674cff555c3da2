//! The layers of the active object: displacements of its surface that can be weakened,
//! strengthened, hidden, merged and removed after they were sculpted.

use serde::{Deserialize, Serialize};

/// Reply of `layers.list`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LayersReply {
    /// The active object.
    pub object: u32,
    /// Its layers, from the lowest up.
    pub layers: Vec<LayerInfo>,
    /// The layer that strokes change; `null`: the base.
    pub active: Option<u32>,
    /// True if strokes can change the active part: not a hidden layer, nor one with an intensity
    /// nearer to 0 than 0.01.
    pub takes_strokes: bool,
}

/// A layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LayerInfo {
    /// Its name for programs: no other layer of the object ever has it.
    pub id: u32,
    /// Its name for people.
    pub name: String,
    /// Factor of its offsets, -2 to 2.
    pub intensity: f32,
    /// A layer that is not visible changes nothing.
    pub visible: bool,
}

/// Parameters of `layers.add`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LayerAddParams {
    /// Its name; without it `layer` and a number.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: Option<String>,
}

/// Parameters of a method about one layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LayerParams {
    /// The layer, as `layers.list` names it.
    pub layer: u32,
}

/// Parameters of `layers.rename`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LayerRenameParams {
    /// The layer.
    pub layer: u32,
    /// Its new name; several layers may have the same.
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: String,
}

/// Parameters of `layers.move`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LayerMoveParams {
    /// The layer.
    pub layer: u32,
    /// Its new place, 0 the lowest; beyond the highest it is the highest.
    pub to: u32,
}

/// Parameters of `layers.set`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LayerSetParams {
    /// The layer.
    pub layer: u32,
    /// New factor of its offsets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = -2.0, max = 2.0)))]
    pub intensity: Option<f32>,
    /// New visibility.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible: Option<bool>,
    /// More changes of this layer follow, as while a slider is dragged. Together with the first one
    /// that is not live they are one step of undo; anything else that is asked for ends it, too.
    #[serde(default)]
    pub live: bool,
}

/// Parameters of `layers.activate`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LayerActivateParams {
    /// The layer that strokes change from now on; without it the base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<u32>,
}

/// Reply of a method that makes a layer or changes one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LayerReply {
    /// The layer that was made, or that it was about; of `layers.merge` the one below. `null`: the
    /// base.
    pub layer: Option<u32>,
}
