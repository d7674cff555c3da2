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
    /// What its offsets are multiplied by, -[`MAX_INTENSITY`] to [`MAX_INTENSITY`].
    pub intensity: f32,
    /// A layer that is not visible counts as one of intensity 0.
    pub visible: bool,
}

impl Layer {
    /// What its offsets are multiplied by.
    pub fn weight(&self) -> f64 {
        if self.visible { f64::from(self.intensity) } else { 0.0 }
    }

    /// Whether a stroke can change it.
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

    /// Whether strokes can change what is active.
    pub fn takes_strokes(&self) -> bool {
        self.active().is_none_or(Layer::takes_strokes)
    }

    /// Whether the list is in order: numbers once, intensities in their range, the active layer
    /// there.
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
    /// Whether it is visible.
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
    /// Layers with offsets are added above the others. What is active stays.
    Import(Arc<Vec<LayerOffsets>>),
    /// A layer is removed with what it does. Where it was active, the one below it is, or the base.
    Remove(LayerId),
    /// A layer gets another name.
    Rename(LayerId, String),
    /// A layer goes to this place, 0 the lowest.
    Move(LayerId, u32),
    /// A layer gets another intensity, is shown or hidden.
    Set {
        /// The layer.
        id: LayerId,
        /// Its intensity from now on; brought into range.
        intensity: Option<f32>,
        /// Whether it is visible from now on.
        visible: Option<bool>,
        /// More changes of this layer follow, as while a slider is dragged: they become one step
        /// of undo.
        live: bool,
    },
    /// Strokes change this layer from now on, or the base.
    Activate(Option<LayerId>),
    /// A layer is added to the one below it, or to the base, as both are seen. The result has
    /// intensity 1.
    MergeDown(LayerId),
    /// A hidden twin of a layer is added right above it and made active.
    Duplicate(LayerId),
    /// What a layer does is taken away; the layer stays.
    Clear(LayerId),
    /// The surface becomes the base; there are no layers any more.
    Bake,
}

/// Why an edit of layers was not carried out. Nothing was changed.
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
