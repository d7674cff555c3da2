//! Unfinished input of the brush panel.

use super::screen_radius::ScreenRadius;

/// Unfinished input of the brush panel.
#[derive(Clone, Default)]
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
    /// Pictures of the brushes on their buttons; `None` before the first frame.
    pub pictures: Option<egui::TextureHandle>,
}

impl std::fmt::Debug for BrushPanel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // A texture has nothing to tell.
        f.debug_struct("BrushPanel").field("name", &self.name).finish_non_exhaustive()
    }
}
