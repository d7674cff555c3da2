//! What visitors start from.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crossbeam_channel as cc;

use super::KioskConfig;
use super::exhibit::{self, Exhibit};
use super::visit_door::VisitDoor;
use super::visit_journal::VisitNews;
use crate::command_queue::QueuedCommand;
use crate::session::Health;
use sculptd_clay::brush::{BrushSettings, Presets};
use sculptd_clay::{BuildError, Clay};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Beginning, Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// Distance of the camera, of its usual one: the screen's panels lie around the form, not over it.
const ROOM: f32 = 1.2;

/// A form that visitors start from.
#[derive(Debug, Clone)]
pub struct StartForm {
    pub plain: Arc<TriMesh>,
    pub brush: BrushSettings,
    /// `None`: free sculpting.
    pub exhibit: Option<Arc<Exhibit>>,
}

/// Initial state for every visitor.
#[derive(Debug, Clone)]
pub struct Start {
    /// One for each exhibit, or one for free sculpting; never empty.
    pub forms: Vec<StartForm>,
    pub camera: Camera,
    /// Set while a reset begins an attract film, which no session records; cleared for a visit.
    pub film: Arc<AtomicBool>,
    /// Holds a visitor's first stroke until the visit begins.
    pub door: Arc<VisitDoor>,
    /// A visit that the last run did not end; its work is in the world.
    pub interrupted: Option<InterruptedVisit>,
    /// See [`VisitRecording::news`]; `None`: visits are not recorded one by one.
    ///
    /// [`VisitRecording::news`]: super::visit_journal::VisitRecording::news
    pub news: Option<cc::Sender<VisitNews>>,
    /// The note that names the work of the visit that is being put away; see [`recovery`].
    ///
    /// [`recovery`]: super::recovery
    pub putting_away: Option<PathBuf>,
    /// State of the visits' files.
    pub health: Option<Health>,
}

/// A visit that the last run did not end.
#[derive(Debug, Clone, Copy)]
pub struct InterruptedVisit {
    /// Index of the form that it began with; `None`: that form is not there any more.
    pub form: Option<usize>,
}

impl Start {
    /// Returns the start of the exhibits of `kiosk`, or else that of free sculpting on `plain`.
    ///
    /// # Errors
    /// Returns a message if an exhibit cannot be opened or has too many triangles.
    pub fn new(
        kiosk: &KioskConfig,
        (presets, brush, camera): (&Presets, BrushSettings, Camera),
        plain: impl FnOnce() -> TriMesh,
    ) -> Result<Start, String> {
        let brush = first_brush(kiosk, presets, brush);
        let camera = Camera { distance: camera.distance * ROOM, ..camera };
        let mut forms = Vec::new();
        for place in &kiosk.exhibits {
            let exhibit = exhibit::open(place, &Job::default())?;
            let (found, most) = (exhibit.start.triangles.len(), kiosk.max_triangles);
            if found > most {
                let place = place.display();
                return Err(format!("{place}: {found} triangles, at most {most} (max_triangles)"));
            }
            forms.push(StartForm {
                plain: exhibit.start.clone(),
                brush: exhibit.first_brush(presets, &brush),
                exhibit: Some(Arc::new(exhibit)),
            });
        }
        Ok(match forms.first() {
            None => Start::free(Arc::new(plain()), camera, brush),
            Some(first) => {
                let free = Start::free(first.plain.clone(), camera, brush);
                Start { forms, ..free }
            }
        })
    }

    /// Returns a start with one form, for free sculpting.
    pub fn free(plain: Arc<TriMesh>, camera: Camera, brush: BrushSettings) -> Start {
        let forms = vec![StartForm { plain, brush, exhibit: None }];
        Start {
            forms,
            camera,
            film: Arc::default(),
            door: Arc::default(),
            interrupted: None,
            news: None,
            putting_away: None,
            health: None,
        }
    }
}

/// Returns the brush that visitors start with: that of the installation's settings, or `now`.
fn first_brush(kiosk: &KioskConfig, presets: &Presets, now: BrushSettings) -> BrushSettings {
    let mut brush = match kiosk.brush_kind() {
        Ok(Some(kind)) => presets.switched(&now, kind),
        _ => now,
    };
    if kiosk.radius > 0.0 {
        brush.radius = kiosk.radius;
    }
    brush.clamped()
}

/// The forms with their clay, built once.
#[derive(Debug)]
pub(super) struct BuiltForms {
    forms: Vec<(StartForm, Clay)>,
}

impl BuiltForms {
    pub(super) fn build(start: &Start) -> Result<BuiltForms, BuildError> {
        let build =
            |form: &StartForm| Ok((form.clone(), Clay::build(&form.plain, &Job::default())?));
        let forms = start.forms.iter().map(build).collect::<Result<_, BuildError>>()?;
        Ok(BuiltForms { forms })
    }

    pub(super) fn len(&self) -> usize {
        self.forms.len()
    }

    /// Panics if there is no form of this index.
    pub(super) fn get(&self, index: usize) -> &StartForm {
        &self.forms[index].0
    }

    /// Returns the command that resets everything, with a copy of the form's clay: a reset costs by
    /// the number of pages, so a visitor's first stroke is not lost.
    pub(super) fn reset(&self, index: usize, camera: Camera) -> QueuedCommand {
        let (form, built) = &self.forms[index];
        let clay = NewClay::new(form.plain.clone(), false);
        let beginning = Beginning { clay, camera, brush: form.brush };
        let command = Command::Begin(Box::new(beginning));
        let copy = built.duplicate(built.object_id());
        QueuedCommand::with_payload(command, Payload::Clay(Box::new(copy)))
    }
}
