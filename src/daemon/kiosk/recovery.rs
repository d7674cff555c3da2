//! The start of an installation: a visit that the last run did not end is opened to go on.

use std::path::Path;
use std::time::Duration;

use super::gallery::{self, VisitLine};
use super::start::{InterruptedVisit, Start, StartForm};
use super::visit_journal::{
    PUTTING_AWAY, VISIT_FILE, VisitRecording, VisitStart, remove_note, set_aside, start,
};
use crate::config::Config;
use crate::session::format::Settings;
use crate::session::{self, CreateError, catalog};
use crate::startup::{self, BeginError, Begun, session_settings};
use sculptd_clay::Clay;
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;

/// Longest that a start waits for the run before it to close the visit's file.
const CLOSING: Duration = Duration::from_secs(10);

/// Opens the visit in `folder` that the last run did not end, in place of `fresh`, and starts to
/// record visits. A visit whose work the last run still put into the gallery is over; `audit` gets
/// its line, if the last run wrote none. An installation whose visits cannot be recorded runs
/// without; `notices` has a line about it.
pub fn begin(
    (folder, audit): (&Path, &Path),
    first: &mut Start,
    fresh: Begun,
    config: &Config,
    notices: &mut Vec<String>,
) -> (Begun, Option<VisitRecording>) {
    if let Err(e) = finish_putting_away(folder, audit, notices) {
        notices.push(format!("the last visit's work may come to the gallery twice: {e}"));
    }
    let (mut begun, recorded) = match recover(folder, &first.forms, config, notices) {
        Ok(Some((visit, interrupted))) => {
            first.interrupted = Some(interrupted);
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
    // The first visitor probably begins with the first form.
    let StartForm { plain, brush, .. } = first.forms[0].clone();
    let settings = Settings { camera: first.camera, brush, ..session_settings(config) };
    let film = first.film.clone();
    match start(folder, VisitStart { plain, settings, film }, begun.journal.take()) {
        Ok(recording) => {
            first.putting_away = Some(folder.join(PUTTING_AWAY));
            first.news = Some(recording.news.clone());
            first.health = Some(recording.health.clone());
            (begun, Some(recording))
        }
        Err(e) => {
            notices.push(format!("visits are not recorded: {e}"));
            (begun, None)
        }
    }
}

/// Removes the file of a visit whose work is in the gallery: the last run was killed in between.
fn finish_putting_away(
    folder: &Path,
    audit: &Path,
    notices: &mut Vec<String>,
) -> std::io::Result<()> {
    let visit = folder.join(VISIT_FILE);
    let work = match std::fs::read_to_string(folder.join(PUTTING_AWAY)) {
        Ok(work) => work,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(e),
    };
    let work = Path::new(&work);
    if visit.exists() && work.is_file() {
        let name = work.file_name().unwrap_or_default().to_string_lossy().into_owned();
        notices.push(format!("the last visit is over: its work is {name} in the gallery"));
        catalog::remove(&visit)?;
        let lines = std::fs::read_to_string(audit).unwrap_or_default();
        if !audit.as_os_str().is_empty() && !lines.contains(&format!("\"{name}\"")) {
            let line = VisitLine {
                visit: 0,
                seconds: 0,
                dabs: 0,
                kept: true,
                work: Some(name),
                interrupted: true,
                exhibit: None,
                percent: None,
            };
            gallery::audit(audit, &line)?;
        }
    }
    remove_note(&visit)
}

/// Opens the file of the last visit. A run before this one that lost its screen may still be
/// closing it.
fn opened(file: &Path, config: &Config, job: &Job) -> Result<Begun, BeginError> {
    let clock = Clock::monotonic();
    let until = clock.now_us() + CLOSING.as_micros() as u64;
    loop {
        match startup::begin(None, Some(file), config, job) {
            Err(BeginError::Create(CreateError::Busy { .. })) if clock.now_us() < until => {
                let _ = crossbeam_channel::never::<()>().recv_timeout(Duration::from_millis(50));
            }
            done => return done,
        }
    }
}

/// Returns the world of the interrupted visit and its session, or `None` if there is no visit in
/// which somebody sculpted.
fn recover(
    folder: &Path,
    forms: &[StartForm],
    config: &Config,
    notices: &mut Vec<String>,
) -> Result<Option<(Begun, InterruptedVisit)>, String> {
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
    let mut begun = match opened(&file, config, &job) {
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
    let began_with = begun.started_with.as_ref();
    let form = forms.iter().position(|form| match form.exhibit {
        Some(_) => Some(&*form.plain) == began_with,
        None => true,
    });
    let plain = form.map(|form| &forms[form].plain);
    let start = plain.and_then(|plain| Clay::build(plain, &job).ok());
    let start = start.map(|mut clay| clay.snapshot().hash());
    if start == Some(begun.world.snapshot().hash()) {
        drop(writer);
        thread.finish();
        catalog::remove(&path).map_err(failed)?;
        return Ok(None);
    }
    let begun = Begun { journal: Some((writer, thread)), ..begun };
    Ok(Some((begun, InterruptedVisit { form })))
}
