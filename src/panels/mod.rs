//! egui panels, a file each: functions from what was published to commands. Nothing here changes the world.

pub mod brush;
pub mod hints;
pub mod look;
pub mod theme;
pub mod timing;

use crate::command::Command;
use crate::daemon::Published;
use crate::viewer::look::Look;

/// What panels see.
#[derive(Debug)]
pub struct View<'a> {
    pub state: &'a Published,
    /// One line a device, as the adaptors describe themselves.
    pub devices: &'a [String],
    /// The session's file and whether it is well.
    pub session: Option<&'a str>,
    /// Bytes of pages sent to the card with the last frame.
    pub uploaded: u64,
    pub adapter: &'a str,
}

/// Everything on the left side.
pub fn side(ui: &mut egui::Ui, view: &View<'_>, look: &mut Look, out: &mut Vec<Command>) {
    egui::ScrollArea::vertical().show(ui, |ui| {
        ui.add_space(6.0);
        ui.heading("sculptd");
        ui.add_space(8.0);
        brush::ui(ui, view, out);
        ui.add_space(10.0);
        look::ui(ui, look);
        ui.add_space(10.0);
        timing::ui(ui, view);
    });
}
