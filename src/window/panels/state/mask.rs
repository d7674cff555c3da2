//! What the panel of masks holds between frames.

/// How the next mask is measured.
#[derive(Debug, Clone, Copy)]
pub struct MaskPanel {
    /// What counts as thin, as a share of the object's longest side.
    pub thin: f32,
}

impl Default for MaskPanel {
    fn default() -> Self {
        MaskPanel { thin: 0.03 }
    }
}
