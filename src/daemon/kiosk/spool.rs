//! Finished works on their way from the gallery's folder to where they are kept for good: another
//! folder, or a bucket.
//!
//! Laws kept here:
//! * A sculpture is in the local folder before it is sent, so a dead network or a restart loses
//!   nothing.
//! * Sculptures arrive in the order in which they were made: the oldest is tried until it is sent.
//!   So one number says which were sent, and every sculpture in the folder above it waits.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

pub use super::names::sent;
use super::names::{OUTGOING, SENT, number, works};
use sculptd_geometry::io::write_beside;

/// Start of the name of a note that a sent work is to be deleted.
const WITHDRAWN: &str = "withdrawn-";
/// The first wait after a refusal, and the longest.
const WAIT: Duration = Duration::from_millis(500);
const LONGEST: Duration = Duration::from_secs(60);

/// Counts of the queued sculptures.
#[derive(Debug, Default)]
pub struct Stand {
    pub sent: AtomicU64,
    pub refused: AtomicU64,
    stop: AtomicBool,
}

/// The thread that sends.
#[derive(Debug)]
pub struct Spool {
    wake: cc::Sender<()>,
    pub stand: Arc<Stand>,
    thread: Option<JoinHandle<()>>,
}

/// The names that wait, the oldest first.
pub fn waiting(folder: &Path) -> std::io::Result<Vec<String>> {
    let sent = sent(folder);
    let mut names = works(folder)?;
    names.retain(|name| number(name).is_some_and(|n| n > sent));
    Ok(names)
}

/// Destination of the sculptures.
#[derive(Debug)]
enum SpoolTarget {
    Folder(PathBuf),
    #[cfg(feature = "s3")]
    Bucket(Box<super::bucket::Bucket>),
}

impl SpoolTarget {
    fn open(place: &str) -> Result<SpoolTarget, String> {
        #[cfg(feature = "s3")]
        if place.contains("://") {
            return super::bucket::Bucket::open(place).map(|b| SpoolTarget::Bucket(Box::new(b)));
        }
        if place.contains("://") {
            return Err(format!(
                "{place}: this build sends to folders only (the feature `s3` is off)"
            ));
        }
        std::fs::create_dir_all(place).map_err(|e| format!("{place}: {e}"))?;
        Ok(SpoolTarget::Folder(place.into()))
    }

    /// Puts one file, whole or not at all.
    fn put(&self, name: &str, bytes: &[u8], stop: &AtomicBool) -> Result<(), String> {
        #[cfg(not(feature = "s3"))]
        let _ = stop; // A folder answers at once.
        match self {
            SpoolTarget::Folder(folder) => {
                // A share that is not mounted is an empty folder above it: it is not made up here.
                write_beside(&folder.join(name), |out| out.write_all(bytes))
                    .map_err(|e| e.to_string())
            }
            #[cfg(feature = "s3")]
            SpoolTarget::Bucket(bucket) => bucket.put(name, bytes, stop),
        }
    }

    /// Deletes one file, if it exists.
    fn delete(&self, name: &str, stop: &AtomicBool) -> Result<(), String> {
        #[cfg(not(feature = "s3"))]
        let _ = stop; // A folder answers at once.
        match self {
            SpoolTarget::Folder(folder) if !folder.is_dir() => {
                Err(format!("{}: there is no such folder", folder.display()))
            }
            SpoolTarget::Folder(folder) => match std::fs::remove_file(folder.join(name)) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                    Err(format!("{}: {e}", folder.display()))
                }
                _ => Ok(()),
            },
            #[cfg(feature = "s3")]
            SpoolTarget::Bucket(bucket) => bucket.delete(name, stop),
        }
    }
}

/// Deletes at the destination the works that were deleted here.
fn withdraw(to: &SpoolTarget, folder: &Path, stop: &AtomicBool) -> Result<(), String> {
    let said = |e: std::io::Error| format!("{}: {e}", folder.display());
    let notes = std::fs::read_dir(folder.join(OUTGOING)).map_err(said)?;
    for note in notes.filter_map(Result::ok) {
        let name = note.file_name().to_string_lossy().into_owned();
        let Some(work) = name.strip_prefix(WITHDRAWN) else { continue };
        to.delete(work, stop)?;
        to.delete(&work.replace(".glb", ".png"), stop)?;
        std::fs::remove_file(note.path()).map_err(said)?;
    }
    Ok(())
}

impl Spool {
    /// Begins to send what waits in `folder`.
    ///
    /// # Errors
    /// In words, where `place` is nothing that can be sent to.
    pub fn start(folder: &Path, place: &str) -> Result<Spool, String> {
        let to = SpoolTarget::open(place)?;
        std::fs::create_dir_all(folder.join(OUTGOING))
            .map_err(|e| format!("{}: {e}", folder.display()))?;
        let (wake, calls) = cc::bounded::<()>(1);
        let stand = Arc::new(Stand::default());
        let (shown, from) = (stand.clone(), folder.to_path_buf());
        let name = place.to_owned();
        let thread = std::thread::Builder::new()
            .name("sculptd-gallery".into())
            .spawn(move || {
                let mut wait = WAIT;
                let mut page = Vec::new();
                while !shown.stop.load(Relaxed) {
                    match send_next(&to, &from, &mut page, &shown.stop) {
                        Ok(true) => {
                            shown.sent.fetch_add(1, Relaxed);
                            wait = WAIT;
                        }
                        // Nothing waits.
                        Ok(false) => {
                            if calls.recv().is_err() {
                                return;
                            }
                        }
                        Err(e) => {
                            if shown.refused.fetch_add(1, Relaxed) == 0 || wait == LONGEST {
                                tracing::warn!("gallery: {name}: {e}; kept here and tried again");
                            }
                            if matches!(
                                calls.recv_timeout(wait),
                                Err(cc::RecvTimeoutError::Disconnected)
                            ) {
                                return;
                            }
                            wait = (wait * 2).min(LONGEST);
                        }
                    }
                }
            })
            .map_err(|e| e.to_string())?;
        Ok(Spool { wake, stand, thread: Some(thread) })
    }

    /// Says that the folder has a new sculpture and its page.
    pub fn wake(&self) {
        let _ = self.wake.try_send(());
    }

    /// Returns a function that has a work deleted where it was sent to. It works after a restart
    /// and a dead network too.
    pub fn withdrawer(
        &self,
        folder: &Path,
    ) -> impl Fn(&Path) -> std::io::Result<()> + Send + Sync + use<> {
        let (wake, folder) = (self.wake.clone(), folder.join(OUTGOING));
        move |work| {
            let Some(name) = work.file_name() else { return Ok(()) };
            let note = folder.join(format!("{WITHDRAWN}{}", name.to_string_lossy()));
            write_beside(&note, |_| Ok(()))?;
            let _ = wake.try_send(());
            Ok(())
        }
    }
}

impl Drop for Spool {
    /// Waiting sculptures remain on the disk.
    fn drop(&mut self) {
        self.stand.stop.store(true, Relaxed);
        // Others may hold the channel: it does not close. A full one wakes the thread too.
        let _ = self.wake.try_send(());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Sends the oldest sculpture that waits. If none does, it sends the page if it is not `page`, the
/// one that was sent last, and returns false.
fn send_next(
    to: &SpoolTarget,
    folder: &Path,
    page: &mut Vec<u8>,
    stop: &AtomicBool,
) -> Result<bool, String> {
    withdraw(to, folder, stop)?;
    let all = waiting(folder).map_err(|e| e.to_string())?;
    let Some(name) = all.first() else {
        let Some(now) = read(&folder.join("index.html"))?.filter(|now| now != page) else {
            return Ok(false);
        };
        to.put("index.html", &now, stop)?;
        *page = now;
        return Ok(false);
    };
    // Staff may have removed it since it was listed: then the next list does not have it.
    let bytes = read(&folder.join(name))?.ok_or_else(|| format!("{name} is not there any more"))?;
    to.put(name, &bytes, stop)?;
    // The picture was written before the sculpture, if it could be.
    let picture = name.replace(".glb", ".png");
    if let Some(bytes) = read(&folder.join(&picture))? {
        to.put(&picture, &bytes, stop)?;
    }
    let number = number(name).unwrap_or(0).max(sent(folder));
    write_beside(&folder.join(OUTGOING).join(SENT), |out| writeln!(out, "{number}"))
        .map_err(|e| e.to_string())?;
    Ok(true)
}

/// A file's bytes; none if there is no such file.
fn read(file: &Path) -> Result<Option<Vec<u8>>, String> {
    match std::fs::read(file) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(format!("{}: {e}", file.display())),
    }
}
