//! The start of an installation: a visit that the last run did not end is opened to go on.

use std::path::Path;
use std::sync::Arc;

use super::keeper::Start;
use super::visit_journal::{VISIT_FILE, VisitRecording, VisitStart, set_aside, start};
use crate::config::Config;
use crate::session::format::Settings;
use crate::session::{self, CreateError, catalog};
use crate::startup::{self, BeginError, Begun, session_settings};
use sculptd_clay::Clay;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// Opens the visit in `folder` that the last run did not end, in place of `fresh`, and starts to
/// record visits. An installation whose visits cannot be recorded runs without; `notices` says so.
pub fn begin(
    folder: &Path,
    first: &mut Start,
    fresh: Begun,
    config: &Config,
    notices: &mut Vec<String>,
) -> (Begun, Option<VisitRecording>) {
    let (mut begun, recorded) = match recover(folder, &first.plain, config, notices) {
        Ok(Some(visit)) => {
            first.interrupted = true;
            notices.push("the last visit was interrupted: its work is here again".into());
            (visit, true)
        }
        Ok(None) => (fresh, true),
        Err(why) => {
            notices.push(format!("visits are not recorded: {why}"));
            (fresh, false)
        }
    };
    if !recorded {
        return (begun, None);
    }
    let settings =
        Settings { camera: first.camera, brush: first.brush, ..session_settings(config) };
    let (plain, film) = (first.plain.clone(), first.film.clone());
    match start(folder, VisitStart { plain, settings, film }, begun.journal.take()) {
        Ok(recording) => {
            first.put_away = Some(recording.put_away.clone());
            (begun, Some(recording))
        }
        Err(e) => {
            notices.push(format!("visits are not recorded: {e}"));
            (begun, None)
        }
    }
}

/// Returns the world of the interrupted visit and its session, or `None` if there is no visit in
/// which somebody sculpted.
fn recover(
    folder: &Path,
    plain: &Arc<TriMesh>,
    config: &Config,
    notices: &mut Vec<String>,
) -> Result<Option<Begun>, String> {
    let file = folder.join(VISIT_FILE);
    let failed = |e: std::io::Error| format!("{}: {e}", file.display());
    std::fs::create_dir_all(folder).map_err(failed)?;
    if !file.exists() {
        return Ok(None);
    }
    if session::is_half_made(&file) {
        catalog::remove(&file).map_err(failed)?;
        return Ok(None);
    }
    let job = Job::default();
    let mut begun = match startup::begin(None, Some(&file), config, &job) {
        Ok(begun) => begun,
        Err(e @ BeginError::Create(CreateError::Busy { .. })) => return Err(e.to_string()),
        Err(e) => {
            let to = set_aside(&file, "visit-damaged").map_err(failed)?;
            let to = to.display();
            notices.push(format!("the last visit cannot be opened ({e}); its file is now {to}"));
            return Ok(None);
        }
    };
    notices.extend(begun.warnings.iter().cloned());
    let Some((writer, thread)) = begun.journal else { return Ok(None) };
    let path = thread.path.get();
    if path != file {
        // Opening saved what is readable into another file.
        set_aside(&file, "visit-damaged").map_err(failed)?;
    }
    let start = Clay::build(plain, &job).map(|mut clay| clay.snapshot().hash());
    if start.is_ok_and(|start| start == begun.world.snapshot().hash()) {
        drop(writer);
        thread.finish();
        catalog::remove(&path).map_err(failed)?;
        return Ok(None);
    }
    Ok(Some(Begun { journal: Some((writer, thread)), ..begun }))
}
