//! The thread that checks objects for a process, on immutable snapshots.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use glam::DVec3;
use sculptd_check::preset::BuildMethod;
use sculptd_check::{CheckProgress, CheckRequest, CheckSettings, check_count, check_part};
use sculptd_clay::Snapshot;
use sculptd_daemon::Published;
use sculptd_daemon::scene_jobs::{Selection, selected};
use sculptd_devices::Clock;
use sculptd_engine::scene::{ObjectTransform, SceneView};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::{Cancelled, Job};

use crate::panels::state::{CheckChoice, CheckFound, CheckedObject, ObjectVersion};

/// What one check is about: a result of another request is not of the present clay.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckKey {
    pub versions: Vec<ObjectVersion>,
    pub choice: CheckChoice,
    /// True to search for the best direction first, and to check along it.
    pub search: bool,
}

/// What came of a check: its result, or why it has none.
pub type CheckReport = (CheckKey, Result<CheckFound, String>);

/// A request to the check thread.
#[derive(Debug)]
pub struct CheckWork {
    pub key: CheckKey,
    settings: CheckSettings,
    scene: Arc<SceneView>,
    mesh: Snapshot,
    clock: Clock,
    pub progress: Arc<CheckProgress>,
}

impl CheckWork {
    /// A check of the objects of `state`; `settings` are those of the key's choice.
    pub fn new(key: CheckKey, settings: CheckSettings, state: &Published, clock: Clock) -> Self {
        let orient = orients(&settings, key.search);
        let search = if key.search { check_count(&settings, orient) } else { 0 };
        let all = search + check_count(&settings, false) * key.versions.len();
        let progress = Arc::new(CheckProgress::new(all));
        let (scene, mesh) = (state.scene.clone(), state.mesh.clone());
        CheckWork { key, settings, scene, mesh, clock, progress }
    }

    /// Runs the check. `None`: it was cancelled.
    ///
    /// # Errors
    /// Returns the reason if a check could not run to its end.
    pub fn run(&self, job: &Job) -> Option<Result<CheckFound, String>> {
        let checked = catch_unwind(AssertUnwindSafe(|| self.checked(job)));
        match checked {
            Ok(Ok(found)) => Some(found),
            Ok(Err(Cancelled)) => None,
            Err(panic) => {
                let text = panic.downcast_ref::<String>().cloned();
                let text = text.or_else(|| panic.downcast_ref::<&str>().map(|t| (*t).to_owned()));
                Some(Err(text.unwrap_or_default()))
            }
        }
    }

    fn checked(&self, job: &Job) -> Result<Result<CheckFound, String>, Cancelled> {
        let mut meshes = Vec::new();
        for version in &self.key.versions {
            job.check()?;
            match selected(&self.scene, &self.mesh, Selection::One(version.id)) {
                Ok(found) => meshes.extend(found.into_iter().map(|m| {
                    let transform =
                        ObjectTransform { shift: m.shift, turn: m.turn, scale: m.scale };
                    (version.id, m.name, placed(m.mesh, &transform))
                })),
                Err(e) => return Ok(Err(e.to_string())),
            }
        }
        let mut choice = self.key.choice.clone();
        let active = self.scene.active().map(|o| o.id);
        let searched = meshes.iter().find(|m| Some(m.0) == active).or(meshes.first());
        if let Some((_, name, mesh)) = searched.filter(|_| self.key.search)
            && let Some(best) = self.best(name, mesh, job)?
        {
            choice.up = best;
        }
        let settings = CheckSettings { up: choice.up, ..self.settings.clone() };
        let mut objects = Vec::new();
        for (id, name, mesh) in meshes {
            let answer = self.one(&name, &mesh, &settings, false, job)?;
            objects.push(CheckedObject { id, name, answer });
        }
        Ok(Ok(CheckFound { choice, versions: self.key.versions.clone(), objects }))
    }

    fn one(
        &self,
        name: &str,
        mesh: &PolyMesh,
        settings: &CheckSettings,
        orient: bool,
        job: &Job,
    ) -> Result<sculptd_check::CheckAnswer, Cancelled> {
        let seconds = || self.clock.now_us() as f64 * 1e-6;
        let request = CheckRequest { orient, progress: Some(&*self.progress) };
        // The scene's unit is the millimetre.
        check_part(name, mesh, 1.0, settings, request, job, seconds).map(|solid| solid.answer)
    }

    /// The best direction for an object: the one with the least support, or with the least
    /// undercut in a mould.
    fn best(&self, name: &str, mesh: &PolyMesh, job: &Job) -> Result<Option<DVec3>, Cancelled> {
        let orient = orients(&self.settings, true);
        let answer = self.one(name, mesh, &self.settings, orient, job)?;
        let found = match orient {
            true => answer.orientations.first().map(|o| o.direction),
            false => answer.facts.parting_direction,
        };
        Ok(found.and_then(|d| DVec3::from(d).try_normalize()))
    }
}

/// Returns true if a search runs beside the checks. Those of a mould find its direction anyway.
fn orients(settings: &CheckSettings, search: bool) -> bool {
    search && settings.process.method != BuildMethod::Mould
}

/// A mesh in the world.
fn placed(mut mesh: PolyMesh, transform: &ObjectTransform) -> PolyMesh {
    if !transform.is_none() {
        mesh.positions.iter_mut().for_each(|p| *p = transform.apply(*p));
    }
    mesh
}
