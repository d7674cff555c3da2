//! Operations that are prepared in the window before they are sent: a Boolean that is previewed, a
//! setting that is dragged.

use egui::Pos2;
use sculptd_clay::brush::BrushSettings;
use sculptd_engine::hand::MenuItem;

/// Preview of a Boolean while the held object is carried.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BooleanTrial {
    pub choice: Option<MenuItem>,
    pub said: TrialStatus,
}

impl BooleanTrial {
    /// Tries this, or no more.
    pub fn turn(&mut self, choice: MenuItem) {
        self.choice = (self.choice != Some(choice)).then_some(choice);
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub enum TrialStatus {
    #[default]
    Nothing,
    UnderWay,
    /// Triangles that the held object has made.
    Shown(usize),
    Wrong(String),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModalSetting {
    Radius,
    Strength,
}

#[derive(Debug, Clone, Copy)]
pub struct Modal {
    pub what: ModalSetting,
    /// Position of the pointer at the start, in points; the ring stays there.
    pub from: Pos2,
    pub before: BrushSettings,
}
