//! The list of an object's layers, and what can be done to it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// Layers of an object, at most.
pub const MAX_LAYERS: usize = 32;
/// Intensities lie between this and its negative.
pub const MAX_INTENSITY: f32 = 2.0;
/// A layer whose intensity is nearer to 0 takes no strokes: what they do could not be seen.
pub const LEAST_INTENSITY: f32 = 0.01;

/// Names a layer of an object, for as long as the object lives.
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct LayerId(pub u32);

impl std::fmt::Display for LayerId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// A layer, without its offsets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Its name for programs.
    pub id: LayerId,
    /// Its name for people; several layers may have the same.
    pub name: String,
    /// The factor of its offsets, -[`MAX_INTENSITY`] to [`MAX_INTENSITY`].
    pub intensity: f32,
    /// True if the layer is visible. An invisible layer counts as one of intensity 0.
    pub visible: bool,
}

impl Layer {
    /// Returns the factor of its offsets, 0 for an invisible layer.
    pub fn weight(&self) -> f64 {
        if self.visible { f64::from(self.intensity) } else { 0.0 }
    }

    /// Returns true if a stroke can change it.
    pub fn takes_strokes(&self) -> bool {
        self.visible && self.intensity.abs() >= LEAST_INTENSITY
    }
}

/// The layers of an object from the lowest up, and which of them strokes change.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerStack {
    /// From the lowest up.
    pub layers: Vec<Layer>,
    /// The layer that strokes change; `None`: the base.
    pub active: Option<LayerId>,
    /// The next layer's number.
    pub next: u32,
}

impl LayerStack {
    /// A layer by its number.
    pub fn layer(&self, id: LayerId) -> Option<&Layer> {
        self.layers.iter().find(|l| l.id == id)
    }

    /// The place of a layer, 0 the lowest.
    pub fn index_of(&self, id: LayerId) -> Option<usize> {
        self.layers.iter().position(|l| l.id == id)
    }

    /// The layer that strokes change; `None`: the base.
    pub fn active(&self) -> Option<&Layer> {
        self.layer(self.active?)
    }

    /// Returns true if strokes can change the active layer.
    pub fn takes_strokes(&self) -> bool {
        self.active().is_none_or(Layer::takes_strokes)
    }

    /// Returns true if the list is valid: unique numbers, intensities in range, and an active layer
    /// that exists.
    pub fn is_sane(&self) -> bool {
        self.layers.len() <= MAX_LAYERS
            && self.active.is_none_or(|id| self.layer(id).is_some())
            && self.layers.iter().enumerate().all(|(i, l)| {
                l.id.0 < self.next
                    && l.intensity.abs() <= MAX_INTENSITY
                    && self.layers[..i].iter().all(|other| other.id != l.id)
            })
    }
}

/// Offsets of a layer that comes from elsewhere.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerOffsets {
    /// The layer's name.
    pub name: String,
    /// Its intensity.
    pub intensity: f32,
    /// True if it is visible.
    pub visible: bool,
    /// Numbers of vertices in the mesh that the clay was built from, ascending, each with its
    /// offset, object frame.
    pub offsets: Vec<(u32, [f32; 3])>,
}

/// Something to be done to the layers of an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LayerEdit {
    /// A layer without offsets is added above the others and made active.
    Add(String),
    /// Adds layers with offsets above the others. The active layer stays active.
    Import(Arc<Vec<LayerOffsets>>),
    /// Removes a layer and its effect. If it was active, the one below becomes active, or the base.
    Remove(LayerId),
    /// Renames a layer.
    Rename(LayerId, String),
    /// Moves a layer to this place, 0 the lowest.
    Move(LayerId, u32),
    /// Changes the intensity or visibility of a layer.
    Set {
        /// The layer.
        id: LayerId,
        /// Its intensity from now on; brought into range.
        intensity: Option<f32>,
        /// The new visibility; `None` keeps the current one.
        visible: Option<bool>,
        /// True while more changes of this layer follow, as during the drag of a slider: they
        /// become one undo step.
        live: bool,
    },
    /// Makes this layer, or the base, the target of strokes.
    Activate(Option<LayerId>),
    /// Merges a layer into the one below it, or into the base, as both are seen. The result has
    /// intensity 1.
    MergeDown(LayerId),
    /// A hidden twin of a layer is added right above it and made active.
    Duplicate(LayerId),
    /// Removes the effect of a layer; the layer stays.
    Clear(LayerId),
    /// Makes the surface the base and removes all layers.
    Bake,
}

/// The reason why an edit of layers was rejected. Nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LayerError {
    /// A number that no layer has.
    #[error("there is no layer {0}")]
    NoLayer(LayerId),
    /// There are as many as there may be.
    #[error("an object has at most {MAX_LAYERS} layers")]
    Full,
    /// A layer that is merged, or the one that it is merged with, is hidden.
    #[error("layer {0} is hidden: a merge would lose what it does")]
    Hidden(LayerId),
    /// An intensity that is no number.
    #[error("expected an intensity from -2 to 2")]
    Intensity,
    /// There are no layers.
    #[error("the object has no layers")]
    None,
}
