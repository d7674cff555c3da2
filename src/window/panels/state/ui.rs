//! What a person has set in the window. Nothing of it belongs to the world.

use super::brush_panel::BrushPanel;
use super::check::CheckPage;
use super::chooser::FileChooser;
use super::earlier::EarlierWorks;
use super::face_sets::FaceSetPanel;
use super::files::FilesPage;
use super::history::{HistoryVersions, StepPicture};
use super::keys::KeysPage;
use super::kiosk::KioskPad;
use super::layers::LayerPanel;
use super::light::LightPage;
use super::mask::MaskPanel;
use super::messages::Message;
use super::operation::{BooleanTrial, Modal};
use super::outliner::Outliner;
use super::pens::PenTrace;
use super::preferences::Hint;
use super::preferences::Preferences;
use super::region::RegionTool;
use super::retopology::Retopology;
use super::search::SearchBox;
use super::sizes::SizesPage;
use super::tab::Tab;
use super::tablet_keys::TabletKeysPage;
use super::thickness::WallsPage;
use crate::look::Look;
use sculptd_daemon::remesh_job::Wanted;

/// Settings of the window; no part of the world.
#[derive(Debug, Default)]
pub struct UiState {
    pub look: Look,
    /// Shorter side of the window over 1080 points, for screens that nobody sets up by hand; 0: not
    /// known.
    pub screen_scale: f32,
    pub prefs: Preferences,
    pub tab: Tab,
    pub hidden: bool,
    pub search: Option<SearchBox>,
    pub radial: Option<egui::Pos2>,
    pub modal: Option<Modal>,
    pub brush_panel: BrushPanel,
    pub keys: KeysPage,
    pub tablet_keys: TabletKeysPage,
    pub lesson: LessonHand,
    /// The page that lists all is open.
    pub help: bool,
    pub files: FilesPage,
    /// The file that is being loaded, and how much of it is done, 0 to 1.
    pub loading: Option<(String, f32)>,
    /// The window's own file chooser, while it is open.
    pub chooser: Option<FileChooser>,
    pub messages: Vec<Message>,
    pub walls: WallsPage,
    pub check: CheckPage,
    pub devices: PenTrace,
    pub earlier: EarlierWorks,
    /// A Boolean is under way.
    pub joining: bool,
    pub trial: BooleanTrial,
    /// Unfinished input of the outliner.
    pub outliner: Outliner,
    /// Unfinished input of the layer panel.
    pub layers: LayerPanel,
    /// The face sets as they were last counted, and what the next ones are made with.
    pub face_sets: FaceSetPanel,
    pub mask: MaskPanel,
    /// A person's own pictures for the look of the clay.
    pub light: LightPage,
    /// Resolution of the next remesh.
    pub remesh: Wanted,
    /// Quads and decimation.
    pub retopology: Retopology,
    pub region: RegionTool,
    /// The handle of a curve that was held last.
    pub handle: Option<usize>,
    pub sizes: SizesPage,
    /// Pictures of steps, by step.
    pub history: Vec<StepPicture>,
    /// Every version that the session keeps; empty without a session.
    pub versions: HistoryVersions,
    /// The screen of an installation.
    pub pad: KioskPad,
    /// The language that is shown.
    pub shown_language: ShownLanguage,
    /// A theme and scale that are in force, so that they are set once.
    pub applied: Option<(bool, u32)>,
}

/// The language that is shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ShownLanguage {
    /// The code of the one that was last chosen.
    pub(in crate::panels) chosen: Option<String>,
    /// True if the computer has no font for it, and English replaces it.
    pub fontless: bool,
}

/// The hand that shows a hint over the clay.
#[derive(Debug, Clone, Copy, Default)]
pub struct LessonHand {
    /// Hint that it shows, and since when, in seconds of the context's time.
    pub shows: Option<(Hint, f64)>,
}

/// Kept at most.
const MOST: usize = 50;

impl UiState {
    pub fn say(&mut self, text: impl Into<String>, wrong: bool) {
        self.messages.push(Message { text: text.into(), wrong, since: None });
        if self.messages.len() > MOST {
            self.messages.remove(0);
        }
    }
}
