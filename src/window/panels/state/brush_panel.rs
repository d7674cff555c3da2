//! What was begun in the panel of the brush.

use super::screen_radius::ScreenRadius;

/// What was begun in the panel of the brush.
#[derive(Debug, Clone, Default)]
pub struct BrushPanel {
    /// The name under which the brush in hand is to be saved.
    pub name: String,
    /// There is a folder to save brushes in.
    pub saves: bool,
    /// The next click on the clay takes its colour.
    pub samples: bool,
    /// The radius while it is told in pixels.
    pub screen: ScreenRadius,
    /// The part of the window that shows the clay, points; `None` before the first frame.
    pub free: Option<egui::Rect>,
}
