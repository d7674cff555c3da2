//! What the panel of layers holds between frames.

use sculptd_clay::LayerId;

/// What a person has begun in the panel of layers and not finished.
#[derive(Debug, Default)]
pub struct LayerPanel {
    /// The name that is being typed.
    pub renaming: Option<(LayerId, String)>,
    /// The intensity that is being dragged to.
    pub dragged: Option<(LayerId, f32)>,
}
