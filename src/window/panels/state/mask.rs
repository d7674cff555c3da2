//! What the panel of masks holds between frames.

/// Parameters of the next measured mask.
#[derive(Debug, Clone, Copy)]
pub struct MaskPanel {
    /// Thickness that counts as thin, as a share of the object's longest side.
    pub thin: f32,
}

impl Default for MaskPanel {
    fn default() -> Self {
        MaskPanel { thin: 0.03 }
    }
}
