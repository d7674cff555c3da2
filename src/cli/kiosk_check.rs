//! `sculptd kiosk check`: whether an installation can open with its settings.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::kiosk_settings::{self, KioskArgs};
use super::{Fail, Outcome, answer};
use crate::settings::LANGUAGES;
use sculptd_daemon::kiosk::film::AttractRecording;
use sculptd_daemon::kiosk::hours::Hours;
use sculptd_daemon::kiosk::{KioskConfig, exhibit, gallery};
use sculptd_daemon::local_time::LocalClock;
use sculptd_devices::DeviceId;
use sculptd_devices::catalogue::Catalogue;
use sculptd_geometry::job::Job;

/// Result of a check of an installation.
#[derive(Debug, Serialize)]
struct CheckedInstallation {
    settings: PathBuf,
    /// One line for each thing that was looked at.
    found: Vec<String>,
    /// One line for each thing that is wrong.
    faults: Vec<String>,
}

/// Looks at the settings in a file and at all that they name.
pub fn run(file: &Path, json: bool) -> Outcome {
    let named = KioskArgs { kiosk: true, file: Some(file), exhibits: &[] };
    #[cfg(not(feature = "network"))]
    let config = kiosk_settings::read(&named)?;
    #[cfg(feature = "network")]
    let config = kiosk_settings::read(&named)?.map(|(config, _)| config);
    let config = config.unwrap_or_default();
    let (mut found, mut faults) = (Vec::new(), Vec::new());
    for line in looked_at(&config) {
        match line {
            Ok(text) => found.push(text),
            Err(text) => faults.push(text),
        }
    }
    let count = faults.len();
    let checked = CheckedInstallation { settings: file.to_path_buf(), found, faults };
    answer(json, &checked, |out| {
        for text in &checked.found {
            writeln!(out, "{text}")?;
        }
        for text in &checked.faults {
            writeln!(out, "WRONG: {text}")?;
        }
        Ok(())
    });
    match count {
        0 => Ok(()),
        n => Err(Fail::Check(format!("{}: faults: {n}", file.display()))),
    }
}

/// A line for each thing: what visitors will find, or what is wrong.
fn looked_at(config: &KioskConfig) -> Vec<Result<String, String>> {
    let at = |path: &Path, e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let mut lines = vec![hours(config)];
    let words = config.every_language(LANGUAGES);
    let names = words.map(|all| all.into_iter().map(|l| l.name).collect::<Vec<_>>().join(", "));
    lines.push(names.map(|names| format!("languages: {names}, where the system has their fonts")));
    for place in &config.exhibits {
        let opened = exhibit::open(place, &Job::default());
        lines.push(opened.and_then(|exhibit| {
            let (triangles, most) = (exhibit.start.triangles.len(), config.max_triangles);
            let title = exhibit.manifest.title.get(&config.language);
            match triangles > most {
                true => Err(format!(
                    "{}: {triangles} triangles, at most {most} (max_triangles)",
                    place.display()
                )),
                false => Ok(format!("exhibit: {title} ({})", place.display())),
            }
        }));
    }
    if config.exhibits.is_empty() {
        lines.push(Ok("exhibits: none, visitors sculpt freely".into()));
    }
    for film in &config.attract {
        let opened = Catalogue::builtin().map_err(|e| e.to_string()).and_then(|all| {
            let film = AttractRecording::open(film, DeviceId(0), 1.6, &all);
            film.map_err(|e| e.to_string())
        });
        lines.push(match opened {
            Ok(read) if read.is_empty() => Err(at(film, &"nothing in it touches the work")),
            Ok(_) => Ok(format!("recording: {}", film.display())),
            Err(e) => Err(at(film, &e)),
        });
    }
    for place in &config.curated {
        let seen = std::fs::metadata(place);
        lines.push(match seen {
            Ok(_) => Ok(format!("curated works: {}", place.display())),
            Err(e) => Err(at(place, &e)),
        });
    }
    lines.push(match config.gallery.as_os_str().is_empty() {
        true => Ok("gallery: none".into()),
        false => gallery::takes_files(&config.gallery)
            .map(|()| format!("gallery: {}", config.gallery.display()))
            .map_err(|e| {
                format!("gallery: {}: no work can be kept: {e}", config.gallery.display())
            }),
    });
    if let Some(folder) = config.audit.parent().filter(|_| !config.audit.as_os_str().is_empty()) {
        lines.push(
            gallery::takes_files(folder)
                .map(|()| format!("audit: {}", config.audit.display()))
                .map_err(|e| format!("audit: {}: {e}", config.audit.display())),
        );
    }
    lines.push(Ok(match config.staff_pin.is_empty() {
        true => "staff page: none, a signal ends the installation".into(),
        false => "staff page: behind its PIN".into(),
    }));
    lines
}

/// The opening hours, and whether it is open now.
fn hours(config: &KioskConfig) -> Result<String, String> {
    let spans = &config.hours.open;
    if spans.is_empty() {
        return Ok("open: always".into());
    }
    let hours = Hours::parse(spans)?;
    let clock = LocalClock::new().map_err(|e| format!("no calendar, so no opening hours: {e}"))?;
    let now = clock.now().ok_or("no local time, so no opening hours")?;
    let words = config.words(LANGUAGES)?;
    let state = match hours.is_open(now) {
        true => "now it is open".to_owned(),
        false => {
            let next = hours.opens_next(now).map(|next| words.opens_text(next));
            format!("now it is closed; the screen says \"{}\"", next.unwrap_or_default())
        }
    };
    Ok(format!("open: {}; {state}", spans.join(", ")))
}
