//! What the staff page of an installation shows, and what staff ask for.

use std::path::{Path, PathBuf};

use super::names::works;
use super::wall::written_since;
use sculptd_geometry::io::write_beside;

/// Errors that are kept for the page.
const ERRORS: usize = 5;

/// A request of the staff page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StaffRequest {
    /// Close the page; the visit goes on.
    Leave,
    /// Close for cleaning, or open again.
    Cleaning(bool),
    /// Show this exhibit next.
    Exhibit(usize),
    /// Pack the works of today into one file.
    Export,
    /// End the program and start it again with the same arguments.
    Restart,
    /// End the program for good.
    End,
}

/// Content of the staff page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StaffFacts {
    /// Visits that ended today and since the start, and works that were kept today. Of those before
    /// the start only visits that left a work are counted.
    pub visits_today: u64,
    pub visits: u64,
    pub kept_today: u64,
    /// Mean length of the visits since the start, seconds.
    pub mean_s: u64,
    /// Time since the start, seconds.
    pub up_s: u64,
    /// The newest errors, the newest first.
    pub errors: Vec<String>,
    /// Free bytes where works are kept; `None`: not known, or no works are kept.
    pub free_bytes: Option<u64>,
    /// The hottest sensor of this machine, degrees Celsius; `None`: it has none.
    pub celsius: Option<f32>,
    pub cleaning: bool,
    /// Result of the last export: its file, or why there is none.
    pub exported: Option<Result<PathBuf, String>>,
}

/// The figures of the visits.
#[derive(Debug, Default)]
pub struct VisitFigures {
    day: Option<i64>,
    today: u64,
    kept_today: u64,
    all: u64,
    seconds: u64,
    errors: Vec<String>,
}

impl VisitFigures {
    /// Goes on after a restart on the date `day`, which began at `since` (seconds since 1970): each
    /// work in the gallery that is of that day ended a visit.
    pub fn resumed(day: i64, gallery: &Path, since: u64) -> VisitFigures {
        let of_today = |name: &&String| written_since(&gallery.join(name.as_str()), since);
        let kept = works(gallery).map_or(0, |all| all.iter().filter(of_today).count() as u64);
        VisitFigures { day: Some(day), today: kept, kept_today: kept, ..VisitFigures::default() }
    }

    /// Counts a visit that ended on the date `day`.
    pub fn ended(&mut self, day: Option<i64>, seconds: u64, kept: bool) {
        self.turn(day);
        self.today += 1;
        self.kept_today += u64::from(kept);
        self.all += 1;
        self.seconds += seconds;
    }

    fn turn(&mut self, day: Option<i64>) {
        if self.day != day {
            (self.day, self.today, self.kept_today) = (day, 0, 0);
        }
    }

    /// Logs an error and keeps it for the page.
    pub fn error(&mut self, text: String) {
        tracing::error!("kiosk: {text}");
        self.errors.insert(0, text);
        self.errors.truncate(ERRORS);
    }

    /// Fills in the figures of the visits.
    pub fn show(&mut self, day: Option<i64>, facts: &mut StaffFacts) {
        self.turn(day);
        facts.visits_today = self.today;
        facts.kept_today = self.kept_today;
        facts.visits = self.all;
        facts.mean_s = self.seconds.checked_div(self.all).unwrap_or(0);
        facts.errors.clone_from(&self.errors);
    }
}

/// Returns the temperature of the hottest sensor, degrees Celsius; `None`: the system shows none.
pub fn hottest_celsius() -> Option<f32> {
    let zones = std::fs::read_dir("/sys/class/thermal").ok()?;
    let read = |zone: std::fs::DirEntry| {
        let text = std::fs::read_to_string(zone.path().join("temp")).ok()?;
        Some(text.trim().parse::<f32>().ok()? / 1000.0)
    };
    let all = zones.filter_map(Result::ok).filter_map(read);
    // A sensor that is not connected shows nonsense.
    all.filter(|t| (1.0..=150.0).contains(t)).max_by(f32::total_cmp)
}

/// Packs the works of `gallery` that were written at `since` (seconds since 1970) or later, with
/// their pictures, into a new `.zip` file in the same folder, and returns its path.
///
/// # Errors
/// Returns the system's error. Without such a work there is no file.
pub fn export(gallery: &Path, since: u64) -> std::io::Result<PathBuf> {
    let new_enough = |name: &&String| written_since(&gallery.join(name.as_str()), since);
    let all = works(gallery)?;
    let names: Vec<&String> = all.iter().filter(new_enough).collect();
    let (Some(first), Some(last)) = (names.first(), names.last()) else {
        return Err(std::io::Error::new(std::io::ErrorKind::NotFound, "no work was kept today"));
    };
    let stem = |name: &str| name.trim_end_matches(".glb").to_owned();
    let name = format!("{}-to-{}.zip", stem(first), stem(last).trim_start_matches("work-"));
    let path = gallery.join(name);
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Stored)
        .large_file(true);
    write_beside(&path, |out| {
        let mut zip = zip::ZipWriter::new_stream(out);
        for name in names {
            for file in [name.clone(), format!("{}.png", stem(name))] {
                let Ok(mut from) = std::fs::File::open(gallery.join(&file)) else { continue };
                zip.start_file(file, options).map_err(std::io::Error::other)?;
                std::io::copy(&mut from, &mut zip)?;
            }
        }
        zip.finish().map(drop).map_err(std::io::Error::other)
    })?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_day_begins_at_nought() {
        let mut figures = VisitFigures::default();
        figures.ended(Some(1), 60, true);
        figures.ended(Some(1), 30, false);
        let mut facts = StaffFacts::default();
        figures.show(Some(1), &mut facts);
        assert_eq!((facts.visits_today, facts.kept_today, facts.mean_s), (2, 1, 45));
        figures.show(Some(2), &mut facts);
        assert_eq!((facts.visits_today, facts.kept_today, facts.visits), (0, 0, 2));
        (0..9).for_each(|i| figures.error(format!("error {i}")));
        figures.show(Some(2), &mut facts);
        assert_eq!(facts.errors.len(), ERRORS);
        assert_eq!(facts.errors[0], "error 8");
    }

    #[test]
    fn the_works_of_today_are_packed_and_those_of_yesterday_not() {
        let dir = tempfile::tempdir().expect("a folder");
        let said = export(dir.path(), 0).expect_err("there is none");
        assert!(said.to_string().contains("no work"), "{said}");
        let ball = sculptd_geometry::shapes::uv_sphere(1.0, 6, 8);
        for _ in 0..3 {
            super::super::gallery::keep(dir.path(), &ball).expect("kept");
        }
        let old = std::fs::File::options()
            .write(true)
            .open(dir.path().join("work-000001.glb"))
            .expect("a work");
        let before = std::time::UNIX_EPOCH + std::time::Duration::from_secs(1_000_000);
        old.set_modified(before).expect("an old work");
        let path = export(dir.path(), 2_000_000).expect("packed");
        assert!(path.ends_with("work-000002-to-000003.zip"), "{path:?}");
        let file = std::fs::File::open(&path).expect("a file");
        let mut zip = zip::ZipArchive::new(file).expect("a zip");
        let names: Vec<String> = (0..zip.len())
            .map(|i| zip.by_index(i).expect("an entry").name().expect("a name").to_string())
            .collect();
        assert_eq!(names.len(), 4, "{names:?}");
        let mut packed = Vec::new();
        let mut entry = zip.by_name("work-000003.glb").expect("the third");
        std::io::copy(&mut entry, &mut packed).expect("read");
        let kept = std::fs::read(dir.path().join("work-000003.glb")).expect("read");
        assert_eq!(packed, kept);
        assert_eq!(works(dir.path()).expect("listed").len(), 3);
        // A program that starts on that day knows of both.
        let mut facts = StaffFacts::default();
        VisitFigures::resumed(7, dir.path(), 2_000_000).show(Some(7), &mut facts);
        assert_eq!((facts.visits_today, facts.kept_today, facts.visits), (2, 2, 0));
    }
}
