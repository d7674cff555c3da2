//! The plain data between the viewer and the panels: what panels see ([`View`]), what they ask for
//! ([`UiRequest`]) and what a person has set ([`UiState`]). It knows neither wgpu nor the panels.

pub mod action;
pub mod brush_panel;
pub mod brush_preferences;
pub mod check;
pub mod chooser;
pub mod earlier;
pub mod face_sets;
pub mod files;
pub mod history;
pub mod key;
pub mod key_map;
pub mod keys;
pub mod kiosk;
pub mod layers;
pub mod light;
mod mask;
pub mod messages;
pub mod operation;
pub mod outliner;
pub mod pens;
pub mod preferences;
pub mod region;
pub mod repairs;
pub mod request;
pub mod retopology;
pub mod screen_radius;
pub mod search;
pub mod sizes;
pub mod tab;
pub mod tablet_keys;
pub mod thickness;
pub mod ui;
pub mod view;
pub mod views;

pub use action::{Action, ActionEntry};
pub use brush_panel::BrushPanel;
pub use brush_preferences::BrushPreferences;
pub use check::{
    CheckChoice, CheckFound, CheckPage, CheckStop, CheckUnderWay, CheckedObject, FindingIndex,
    MarkedFinding, ObjectVersion,
};
pub use chooser::{FileChooser, FilePurpose, FolderEntry, FolderListing, MESH_ENDINGS};
pub use earlier::{EarlierWork, EarlierWorks};
pub use face_sets::FaceSetPanel;
pub use files::{FilesPage, UNITS};
pub use history::{HistoryVersions, KEPT, StepPicture, VersionRow};
pub use key::KeyCombination;
pub use key_map::{KeyMap, KeySet, KeySettings};
pub use keys::KeysPage;
pub use kiosk::KioskPad;
pub use layers::LayerPanel;
pub use light::{LightPage, Reference};
pub use messages::Message;
pub use operation::{BooleanTrial, Modal, ModalSetting, TrialStatus};
pub use outliner::{Outliner, Pairing, SnapPicks};
pub use pens::PenTrace;
pub use preferences::{Hint, HintsFollowed, Preferences, SCALE, TwoFingers, VIEWS};
pub use repairs::RepairChoice;
pub use request::UiRequest;
pub use retopology::{CREASE, Retopology};
pub use sculptd_daemon::window_link::NextSculpture;
pub use search::SearchBox;
pub use sizes::{DistanceSummary, DistanceTarget, Measured, SectionFigures, SizesPage};
pub use tab::Tab;
pub use tablet_keys::{TabletKeys, TabletKeysPage};
pub use thickness::{ThicknessSummary, ThinSpot, WallChangeSummary, WallsPage};
pub use ui::UiState;
pub use view::{FrameFigures, SessionView, View};
pub use views::{ViewKind, Views};
