//! The input of a visit in a session file of its own, from the visitor's first touch until the work
//! is put away: a program that is killed in between goes on with the visit.
//!
//! A visit begins with a reset to a start clay, so its file holds that clay once and the visit's
//! input alone. The file is made before the visit. If the visitor begins with the clay of another
//! exhibit or in a view of other proportions, another file is made, and the input waits for it. Of
//! everything before the visit only the layout of the desktop outlives the reset; the file begins
//! with it. Attract films are not recorded.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;

use crossbeam_channel as cc;

use crate::session::format::{Settings, append};
use crate::session::history::Handle;
use crate::session::writer::{KEPT_BYTES, WriterThread};
use crate::session::{self, Health, SessionWriter, catalog};
use crate::tick::Journal;
use sculptd_clay::brush::BrushSettings;
use sculptd_devices::Sample;
use sculptd_engine::command::{Beginning, Command};
use sculptd_engine::world::World;
use sculptd_geometry::TriMesh;

/// Name of the file of the visit in progress.
pub const VISIT_FILE: &str = "visit.sculpt";
/// Name of the note that holds the path of the work that the visit becomes, as long as the visit's
/// file exists beside the work.
pub const PUTTING_AWAY: &str = "putting-away";

/// The tick thread's end: records the visit in progress.
#[derive(Debug)]
pub struct VisitJournal {
    /// Set while a reset begins an attract film, and not a visit.
    film: Arc<AtomicBool>,
    /// The file of the visit in progress.
    now: Option<SessionWriter>,
    visiting: bool,
    /// The visit's input for as long as its file is still being made.
    early: Option<EarlyInput>,
    /// The clay that the visit began with, and the width of the view over its height.
    begins_with: Option<(Arc<TriMesh>, f32)>,
    prepared: cc::Receiver<PreparedFile>,
    /// Takes the file of each visit that ended, `None` if the visit was not recorded; and files
    /// that begin with another clay than the visit.
    ended: cc::Sender<Option<SessionWriter>>,
    desktop: Option<Command>,
}

/// A file for the next visit.
#[derive(Debug)]
struct PreparedFile {
    writer: SessionWriter,
    plain: Arc<TriMesh>,
    aspect: f32,
}

/// Encoded input of a visit that began before its file was made.
#[derive(Debug)]
struct EarlyInput {
    first: u64,
    last: u64,
    encoded: Vec<u8>,
}

impl EarlyInput {
    fn new(tick: u64) -> EarlyInput {
        EarlyInput { first: tick, last: tick, encoded: Vec::new() }
    }

    fn add(&mut self, tick: u64, samples: &[Sample], commands: &[Command]) {
        if !(samples.is_empty() && commands.is_empty()) {
            self.last = tick;
            append(&mut self.encoded, tick, samples, commands);
        }
    }
}

impl VisitJournal {
    fn end(&mut self) {
        self.take_file();
        self.early = None;
        if std::mem::take(&mut self.visiting) {
            // One visit at a time is under way, so there is room.
            let _ = self.ended.try_send(self.now.take());
        }
    }

    /// Begins a visit with a reset and the commands that follow it.
    fn begin(&mut self, tick: u64, samples: &[Sample], (begin, after): (&Beginning, &[Command])) {
        self.visiting = true;
        self.begins_with = Some((begin.clay.plain.clone(), begin.camera.aspect));
        let first: Vec<Command> = self.desktop.iter().chain(after).cloned().collect();
        let mut early = EarlyInput::new(tick);
        early.add(tick, samples, &first);
        self.early = Some(early);
        self.take_file();
    }

    /// Hands over to the visit's file, if it has been made, what came before it. A file that begins
    /// with another clay goes back.
    fn take_file(&mut self) {
        while self.early.is_some()
            && let Ok(next) = self.prepared.try_recv()
        {
            let fits = |(plain, aspect): &(Arc<TriMesh>, f32)| {
                Arc::ptr_eq(plain, &next.plain) && *aspect == next.aspect
            };
            if !self.begins_with.as_ref().is_some_and(fits) {
                // One file at a time is prepared, so there is room.
                let _ = self.ended.try_send(Some(next.writer));
                continue;
            }
            if let Some(early) = self.early.take() {
                self.now = Some(next.writer.after((early.first, early.last), early.encoded));
            }
        }
    }
}

impl Journal for VisitJournal {
    fn tick(&mut self, tick: u64, samples: &[Sample], commands: &[Command], world: &mut World) {
        self.take_file();
        let layout = commands.iter().rfind(|c| matches!(c, Command::DesktopLayout(_)));
        let reset = commands.iter().enumerate().rev().find_map(|(at, command)| match command {
            Command::Begin(begin) => Some((at, begin)),
            _ => None,
        });
        match (reset, &mut self.now, &mut self.early) {
            (None, Some(now), _) => now.tick(tick, samples, commands, world),
            (None, None, Some(early)) => {
                early.add(tick, samples, commands);
                if early.encoded.len() > KEPT_BYTES {
                    // The disk makes no file, and the fault shows it.
                    self.early = None;
                }
            }
            (None, None, None) => {}
            (Some((at, begin)), ..) => {
                self.end();
                if !self.film.load(Relaxed) {
                    self.begin(tick, samples, (begin, &commands[at + 1..]));
                }
            }
        }
        if let Some(layout) = layout {
            self.desktop = Some(layout.clone());
        }
    }

    fn has_waiting(&self) -> bool {
        self.early.is_some() || self.now.as_ref().is_some_and(Journal::has_waiting)
    }
}

/// Start of every visit's file.
#[derive(Debug, Clone)]
pub struct VisitStart {
    /// The clay that the next visit probably begins with.
    pub plain: Arc<TriMesh>,
    /// The camera and the brush are those of a reset.
    pub settings: Settings,
    /// See [`super::start::Start::film`].
    pub film: Arc<AtomicBool>,
}

/// News of a visit, for the thread that makes the files.
#[derive(Debug)]
pub enum VisitNews {
    /// A visit begins with this clay and this brush, in a view of this width over its height.
    Begins(Arc<TriMesh>, Box<BrushSettings>, f32),
    /// A visit has ended.
    PutAway(PutAway),
}

/// Fate of a visit's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PutAway {
    /// The file of the visit is of no use any more.
    Done,
    /// The gallery could not take the work: the file is renamed and stays.
    Refused,
}

/// The recording of visits.
#[derive(Debug)]
pub struct VisitRecording {
    /// The tick thread's end.
    pub journal: VisitJournal,
    /// Takes a message with each visit's reset, and one after each visit; then the next visit's
    /// file is made.
    pub news: cc::Sender<VisitNews>,
    /// The state of the file of the visit in progress.
    pub health: Health,
    /// The history of a resumed visit, for undo beyond the resumption.
    pub history: Option<Handle>,
    /// Ends after the loop and every sender of `news` have gone.
    pub thread: JoinHandle<()>,
}

/// Starts to record visits into `folder`. `resumed`: the file of a visit that goes on.
///
/// # Errors
/// Returns an error if the thread cannot be started.
pub fn start(
    folder: &Path,
    start: VisitStart,
    resumed: Option<(SessionWriter, WriterThread)>,
) -> std::io::Result<VisitRecording> {
    let (prepare, prepared) = cc::bounded(1);
    let (end, ended) = cc::bounded(2);
    let (news, calls) = cc::unbounded();
    let (now, open) = resumed.unzip();
    let history = open.as_ref().and_then(|t| Some(t.history.as_ref()?.handle.clone()));
    let health = open.as_ref().map(|t| t.health.clone()).unwrap_or_default();
    let (visiting, film, desktop) = (now.is_some(), start.film.clone(), None);
    let path = folder.join(VISIT_FILE);
    let prepare = Some(prepare);
    let mut files = VisitFolder { path, start, health: health.clone(), prepare, ended, open };
    let thread = std::thread::Builder::new()
        .name("sculptd-visits".into())
        .spawn(move || files.run(&calls))?;
    let journal = VisitJournal {
        film,
        now,
        visiting,
        early: None,
        begins_with: None,
        prepared,
        ended: end,
        desktop,
    };
    Ok(VisitRecording { journal, news, health, history, thread })
}

/// Renames a visit's file to `NAME-1.sculpt` or the next free number, and returns its new path.
///
/// # Errors
/// Returns the system's error.
pub fn set_aside(file: &Path, name: &str) -> std::io::Result<PathBuf> {
    let mut names = (1..).map(|n| file.with_file_name(format!("{name}-{n}.sculpt")));
    let to = names.find(|p| !p.exists()).unwrap_or_default();
    std::fs::rename(file, &to)?;
    Ok(to)
}

/// Removes the note [`PUTTING_AWAY`] beside a visit's file, if it exists.
///
/// # Errors
/// Returns the system's error.
pub fn remove_note(visit: &Path) -> std::io::Result<()> {
    match std::fs::remove_file(visit.with_file_name(PUTTING_AWAY)) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

fn stale_note(e: &std::io::Error) -> String {
    format!("a note of the visit before it cannot be removed ({PUTTING_AWAY}: {e})")
}

/// The thread that makes and removes the files, for those who must not wait for a disk.
struct VisitFolder {
    path: PathBuf,
    start: VisitStart,
    health: Health,
    /// `None` once the loop has ended. A channel keeps what nobody took for as long as this lives.
    prepare: Option<cc::Sender<PreparedFile>>,
    ended: cc::Receiver<Option<SessionWriter>>,
    /// The file of the visit in progress or of the next one.
    open: Option<WriterThread>,
}

impl VisitFolder {
    fn run(&mut self, calls: &cc::Receiver<VisitNews>) {
        if self.open.is_none() {
            self.make();
        }
        while let Ok(news) = calls.recv() {
            let work = match news {
                VisitNews::PutAway(work) => work,
                VisitNews::Begins(plain, _, aspect)
                    if Arc::ptr_eq(&plain, &self.start.plain)
                        && aspect == self.start.settings.camera.aspect =>
                {
                    continue;
                }
                VisitNews::Begins(plain, brush, aspect) => {
                    self.start.plain = plain;
                    self.start.settings.camera.aspect = aspect;
                    self.start.settings.brush = *brush;
                    // The tick thread hands the file back: unused, or with a visit that began
                    // with another clay a moment ago. What was not recorded comes as `None`.
                    if self.open.is_some() && !self.ended.iter().any(|writer| writer.is_some()) {
                        break;
                    }
                    self.close(Some(PutAway::Done));
                    self.make();
                    continue;
                }
            };
            // The tick thread hands the file over with the reset that follows the visit. It is
            // dropped here: its threads end only then.
            let recorded = self.ended.recv().map(|writer| writer.is_some());
            match recorded {
                // The visit was not recorded: the file is the next one's, the note is not.
                Ok(false) if self.open.is_some() => {
                    if let Err(e) = remove_note(&self.path) {
                        tracing::error!("kiosk: {}: {e}", self.path.display());
                        self.show(Some(stale_note(&e)));
                    }
                }
                Ok(_) => {
                    self.close(Some(work));
                    self.make();
                }
                // The loop has ended with the visit.
                Err(_) => {
                    self.prepare = None;
                    return self.close(Some(work));
                }
            }
        }
        self.prepare = None;
        self.close(None);
    }

    /// Makes the next visit's file. A note of an earlier visit would end this one at a restart.
    fn make(&mut self) {
        let (start, health) = (&self.start, self.health.clone());
        let noted = if self.path.exists() { Ok(()) } else { remove_note(&self.path) };
        let made = noted.map_err(|e| stale_note(&e)).and_then(|()| {
            session::create_with(&self.path, &*start.plain, &start.settings, health)
                .map_err(|e| e.to_string())
        });
        match made {
            Ok((writer, thread)) => {
                // The tick thread takes one at a time, so there is room.
                let (plain, aspect) = (start.plain.clone(), start.settings.camera.aspect);
                if let Some(prepare) = &self.prepare {
                    let _ = prepare.try_send(PreparedFile { writer, plain, aspect });
                }
                self.open = Some(thread);
                self.show(None);
            }
            Err(e) => {
                let text = format!("the next visit is not recorded: {e}");
                tracing::error!("kiosk: {text}");
                self.show(Some(text));
            }
        }
    }

    /// Closes the file; `None`: it stays, for the visit to go on at the next start, unless it has
    /// no input.
    fn close(&mut self, work: Option<PutAway>) {
        let Some(thread) = self.open.take() else { return };
        let path = thread.path.get();
        let trouble = thread.finish();
        if let Some(why) = &trouble {
            tracing::error!("kiosk: {}: {why}", path.display());
        }
        // Known only now: the last input is written as the file is closed.
        let empty = trouble.is_none() && self.health.written.load(Relaxed) == 0;
        let done = match work {
            None if !empty => Ok(()),
            None | Some(PutAway::Done) => catalog::remove(&path),
            Some(PutAway::Refused) => set_aside(&path, "visit-not-kept").map(|to| {
                tracing::error!("kiosk: the gallery took no work: it is in {}", to.display());
            }),
        };
        // While the file exists, the note says that its work is in the gallery.
        let noted = || if work.is_some() { remove_note(&self.path) } else { Ok(()) };
        if let Err(e) = done.and_then(|()| noted()) {
            tracing::error!("kiosk: {}: {e}", path.display());
        }
        self.show(trouble);
    }

    fn show(&self, text: Option<String>) {
        if let Ok(mut fault) = self.health.fault.lock() {
            *fault = text;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Resolved;
    use crate::startup::session_settings;
    use sculptd_clay::brush::Presets;

    /// The next visit must not be taken for one whose work is in the gallery.
    #[test]
    fn no_file_is_made_beside_a_note_that_cannot_be_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        // A folder of that name, which is removed like no file.
        let note = folder.path().join(PUTTING_AWAY);
        std::fs::create_dir(&note).expect("made");
        let config = Resolved::defaults(&Presets::default()).config;
        let plain = Arc::new(sculptd_geometry::shapes::sphere_of_about(1_000));
        let start = || VisitStart {
            plain: plain.clone(),
            settings: session_settings(&config),
            film: Arc::default(),
        };
        let run = || {
            let VisitRecording { news, health, thread, journal, .. } =
                super::start(folder.path(), start(), None).expect("starts");
            drop((news, journal));
            thread.join().expect("no panic");
            health.trouble()
        };
        let told = run().expect("a fault");
        assert!(told.contains("the next visit is not recorded: a note"), "{told}");
        std::fs::remove_dir(&note).expect("removed");
        assert_eq!(run(), None);
    }
}
