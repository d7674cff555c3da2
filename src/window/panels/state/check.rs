//! What the Check page shows: the chosen process, the findings, and the clay that they belong to.
//!
//! Laws kept here:
//! * A result names the objects that it was measured on. It counts only while these are the objects
//!   of the scene, and while the chosen process, machine, material and direction are the same.
//! * A check that failed or was stopped leaves no result that passes.

use std::sync::Arc;

use glam::DVec3;
use sculptd_check::preset::{
    BuildMethod, CheckPreset, MaterialPreset, PrinterPreset, ProcessPreset,
};
use sculptd_check::settings::UnknownPreset;
use sculptd_check::{
    CheckAnswer, CheckProgress, CheckSettings, Finding, FindingKind, PresetLibrary, Severity,
};
use sculptd_daemon::Published;
use sculptd_daemon::repair_jobs::{RepairRequest, WantedRepair};
use sculptd_engine::scene::{ObjectId, ObjectTransform};
use sculptd_geometry::job::Job;

use super::repairs::RepairChoice;
use crate::look::Map;

/// The process that is chosen first.
const FIRST_PROCESS: &str = "fdm";

/// What a check compares with, and what it looks at.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckChoice {
    /// The name of the process.
    pub process: String,
    /// The name of the machine; `None`: no machine's limits are checked.
    pub printer: Option<String>,
    /// The name of the material; `None`: the one of the process.
    pub material: Option<String>,
    /// All visible objects, each by itself, instead of the active one.
    pub visible: bool,
    /// The build direction, or the pull direction of a mould, in the world; of unit length.
    pub up: DVec3,
}

impl Default for CheckChoice {
    fn default() -> Self {
        CheckChoice {
            process: FIRST_PROCESS.into(),
            printer: None,
            material: None,
            visible: false,
            up: DVec3::Y,
        }
    }
}

impl CheckChoice {
    /// The limits of this choice.
    ///
    /// # Errors
    /// Returns an error if the library has no preset of a chosen name, or they do not fit together.
    pub fn settings(&self, library: &PresetLibrary) -> Result<CheckSettings, UnknownPreset> {
        let process = library.process(&self.process)?;
        let printer = self.printer.as_deref().map(|n| library.printer(n)).transpose()?;
        let material = self.material.as_deref().map(|n| library.material(n)).transpose()?;
        CheckSettings::new(library, process, printer, material, self.up)
    }
}

/// The state of an object: another one has other findings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectVersion {
    pub id: ObjectId,
    /// Id and revision of the clay.
    pub clay: (u32, u64),
    pub transform: ObjectTransform,
}

impl ObjectVersion {
    /// The objects that a check looks at, as they are now.
    pub fn of_choice(state: &Published, visible: bool) -> Vec<ObjectVersion> {
        let active = state.scene.active().map(|o| o.id);
        let all = state.scene.each(&state.mesh);
        all.filter(|(o, _)| if visible { o.settings.visible } else { Some(o.id) == active })
            .map(|(o, clay)| ObjectVersion {
                id: o.id,
                clay: (clay.object_id(), clay.revision()),
                transform: o.settings.transform,
            })
            .collect()
    }
}

/// One object that was checked.
#[derive(Debug, Clone)]
pub struct CheckedObject {
    pub id: ObjectId,
    pub name: String,
    pub answer: CheckAnswer,
}

/// A finding in a list: the index of its object, and its index in that object's answer.
pub type FindingIndex = (usize, usize);

/// The result of a check that ran to its end.
#[derive(Debug, Clone)]
pub struct CheckFound {
    /// What was compared with.
    pub choice: CheckChoice,
    /// The objects that were measured.
    pub versions: Vec<ObjectVersion>,
    pub objects: Vec<CheckedObject>,
}

impl CheckFound {
    /// Every finding, the most severe first.
    pub fn by_severity(&self) -> Vec<FindingIndex> {
        let of = |(i, o): (usize, &CheckedObject)| {
            (0..o.answer.findings.len()).map(move |k| (i, k)).collect::<Vec<_>>()
        };
        let mut all: Vec<FindingIndex> = self.objects.iter().enumerate().flat_map(of).collect();
        all.sort_by_key(|at| self.finding(*at).map(|(_, f)| (f.severity, f.kind)));
        all
    }

    /// The finding of an index, and its object.
    pub fn finding(&self, at: FindingIndex) -> Option<(&CheckedObject, &Finding)> {
        let object = self.objects.get(at.0)?;
        Some((object, object.answer.findings.get(at.1)?))
    }

    /// The number of findings of a severity.
    pub fn count(&self, severity: Severity) -> usize {
        let findings = self.objects.iter().flat_map(|o| &o.answer.findings);
        findings.filter(|f| f.severity == severity).count()
    }

    /// Returns true if there is an object, and every check of every object ran without an error.
    pub fn passes(&self) -> bool {
        !self.objects.is_empty() && self.objects.iter().all(|o| o.answer.ok)
    }

    /// Returns true if the objects are still as they were measured.
    pub fn is_present(&self, state: &Published) -> bool {
        self.versions == ObjectVersion::of_choice(state, self.choice.visible)
    }
}

/// The finding that is marked in the view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkedFinding {
    pub object: ObjectId,
    pub kind: FindingKind,
    /// In the world.
    pub place: DVec3,
}

/// A check that is running.
#[derive(Debug, Clone)]
pub struct CheckUnderWay {
    pub job: Arc<Job>,
    pub progress: Arc<CheckProgress>,
}

/// Why there is no result of the present clay, and none is on its way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckStop {
    /// A person stopped it.
    Cancelled,
    /// It could not run; the reason.
    Failed(String),
}

/// The Check page.
#[derive(Debug, Default)]
pub struct CheckPage {
    pub library: PresetLibrary,
    pub choice: CheckChoice,
    /// The newest result; see [`CheckPage::shown`].
    pub found: Option<Box<CheckFound>>,
    pub under_way: Option<CheckUnderWay>,
    pub stopped: Option<CheckStop>,
    pub marked: Option<MarkedFinding>,
    /// The best direction was asked for: the next check searches for it.
    pub searches: bool,
    /// The numbers of repairs.
    pub repairs: RepairChoice,
}

impl CheckPage {
    /// Every process.
    pub fn processes(&self) -> impl Iterator<Item = &ProcessPreset> {
        self.library.checks.iter().filter_map(|p| match p {
            CheckPreset::Process(p) => Some(&**p),
            _ => None,
        })
    }

    /// The machines of the chosen process.
    pub fn printers(&self) -> impl Iterator<Item = &PrinterPreset> {
        self.library.checks.iter().filter_map(|p| match p {
            CheckPreset::Printer(p) if p.process == self.choice.process => Some(&**p),
            _ => None,
        })
    }

    /// The materials that fit the chosen process.
    pub fn materials(&self) -> impl Iterator<Item = &MaterialPreset> {
        let fits = |name: &str| {
            let choice = CheckChoice { material: Some(name.into()), ..self.choice.clone() };
            choice.settings(&self.library).is_ok()
        };
        self.library.checks.iter().filter_map(move |p| match p {
            CheckPreset::Material(m) if fits(&m.name) => Some(&**m),
            _ => None,
        })
    }

    /// The chosen process.
    pub fn process(&self) -> Option<&ProcessPreset> {
        self.processes().find(|p| p.name == self.choice.process)
    }

    /// Chooses another process; the machine and the material of the old one are dropped.
    pub fn choose_process(&mut self, name: &str) {
        if self.choice.process != name {
            let CheckChoice { visible, up, .. } = self.choice;
            let process = name.into();
            self.choice = CheckChoice { process, printer: None, material: None, visible, up };
        }
    }

    /// A repair of the active object for the chosen process and direction.
    pub fn repair(&self, repair: WantedRepair) -> RepairRequest {
        let plate = self.process().is_none_or(|p| p.method == BuildMethod::Layers);
        RepairRequest { repair, up: self.choice.up, plate }
    }

    /// The result, if it is one of the present choice.
    pub fn shown(&self) -> Option<&CheckFound> {
        self.found.as_deref().filter(|f| f.choice == self.choice)
    }

    /// The limit in degrees that a map of angles compares with, and the process that it is of: the
    /// chosen one, or else the first that has such a limit.
    pub fn angle_limit(&self, map: Map) -> Option<(f64, &ProcessPreset)> {
        let of = |p: &ProcessPreset| match map {
            Map::Overhang => p.overhang,
            Map::Draft => p.draft,
            _ => None,
        };
        let all = self.process().into_iter().chain(self.processes());
        all.filter_map(|p| Some((of(p)?, p))).next()
    }

    /// Stores a result. The mark follows its finding, and goes with it.
    pub fn take(&mut self, found: CheckFound, reach: f64) {
        self.marked = self.marked.and_then(|old| {
            let object = found.objects.iter().find(|o| o.id == old.object)?;
            let places = object.answer.findings.iter().filter(|f| f.kind == old.kind);
            let places = places.filter_map(|f| f.position.map(DVec3::from));
            let near =
                places.min_by(|a, b| a.distance(old.place).total_cmp(&b.distance(old.place)))?;
            let place = Some(near).filter(|p| p.distance(old.place) <= reach)?;
            Some(MarkedFinding { place, ..old })
        });
        self.found = Some(Box::new(found));
        (self.under_way, self.stopped) = (None, None);
    }

    /// Stores that the running check came to no result.
    pub fn stop(&mut self, why: CheckStop) {
        (self.under_way, self.stopped, self.searches) = (None, Some(why), false);
    }
}
