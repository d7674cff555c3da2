//! Unfinished input of the brush panel.

use super::screen_radius::ScreenRadius;

/// Unfinished input of the brush panel.
#[derive(Debug, Clone, Default)]
pub struct BrushPanel {
    /// The name under which the active brush is to be saved.
    pub name: String,
    /// There is a folder to save brushes in.
    pub saves: bool,
    /// The next click on the clay takes its colour.
    pub samples: bool,
    /// State of the radius while it is shown in pixels.
    pub screen: ScreenRadius,
    /// The part of the window that shows the clay, points; `None` before the first frame.
    pub free: Option<egui::Rect>,
}
