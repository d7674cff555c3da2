//! Finished works on their way from the gallery's folder to where they are kept for good: another
//! folder, or a bucket.
//!
//! Laws kept here:
//! * A work is in the local folder before it is offered, and what is offered is a name in
//!   `outgoing/`: nothing is lost by a dead network, nor by a restart.
//! * Works arrive in the order in which they were made: the oldest that waits is tried until it is
//!   there. So one number says which were sent; a work above it without a mark (the program was
//!   killed between the two) gets its mark at the start.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

pub use super::names::{OUTGOING, sent};
use super::names::{SENT, number, works};
use sculptd_geometry::io::write_beside;

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
    folder: PathBuf,
    wake: cc::Sender<()>,
    pub stand: Arc<Stand>,
    thread: Option<JoinHandle<()>>,
}

/// Marks a work as waiting to be sent. It need not be running for that.
pub fn offer(folder: &Path, name: &str) -> std::io::Result<()> {
    let outgoing = folder.join(OUTGOING);
    std::fs::create_dir_all(&outgoing)?;
    write_beside(&outgoing.join(name), |_| Ok(()))
}

/// The names that wait, the oldest first.
pub fn waiting(folder: &Path) -> Vec<String> {
    works(&folder.join(OUTGOING)).unwrap_or_default()
}

/// Marks the works that have none and were never sent: a kill or a bad disk came between a work and
/// its mark, or nothing was sent so far.
fn catch_up(folder: &Path) -> std::io::Result<()> {
    let (sent, marked) = (sent(folder), waiting(folder));
    for name in works(folder).unwrap_or_default() {
        if number(&name).is_some_and(|n| n > sent) && !marked.contains(&name) {
            offer(folder, &name)?;
        }
    }
    Ok(())
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
}

impl Spool {
    /// Begins to send what waits in `folder`.
    ///
    /// # Errors
    /// In words, where `place` is nothing that can be sent to.
    pub fn start(folder: &Path, place: &str) -> Result<Spool, String> {
        let to = SpoolTarget::open(place)?;
        catch_up(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let (wake, calls) = cc::bounded::<()>(1);
        let stand = Arc::new(Stand::default());
        let (shown, from) = (stand.clone(), folder.to_path_buf());
        let name = place.to_owned();
        let thread = std::thread::Builder::new()
            .name("sculptd-gallery".into())
            .spawn(move || {
                let mut wait = WAIT;
                while !shown.stop.load(Relaxed) {
                    match send_next(&to, &from, &shown.stop) {
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
        Ok(Spool { folder: folder.to_path_buf(), wake, stand, thread: Some(thread) })
    }

    /// Offers a sculpture in the folder. If it cannot be marked, the sending thread still finds it
    /// as long as the folder lists it.
    ///
    /// # Errors
    /// Returns the system's error for the mark.
    pub fn offer(&self, name: &str) -> std::io::Result<()> {
        let marked = offer(&self.folder, name);
        let _ = self.wake.try_send(());
        marked
    }
}

impl Drop for Spool {
    /// Waiting sculptures remain on the disk.
    fn drop(&mut self) {
        self.stand.stop.store(true, Relaxed);
        let (closed, _) = cc::bounded(1);
        drop(std::mem::replace(&mut self.wake, closed));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Sends the oldest work that waits, and the page after it. False: none waits.
fn send_next(to: &SpoolTarget, folder: &Path, stop: &AtomicBool) -> Result<bool, String> {
    // A sculpture whose mark could not be made must not be passed over: the number of what was
    // sent would then say that it was.
    catch_up(folder).map_err(|e| e.to_string())?;
    let all = waiting(folder);
    let Some(name) = all.first() else { return Ok(false) };
    let mark = folder.join(OUTGOING).join(name);
    let bytes = match std::fs::read(folder.join(name)) {
        Ok(bytes) => bytes,
        // Staff has taken the work out of the gallery: there is nothing to send.
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            std::fs::remove_file(&mark).map_err(|e| e.to_string())?;
            return Ok(true);
        }
        Err(e) => return Err(e.to_string()),
    };
    to.put(name, &bytes, stop)?;
    // Its picture and the page are there if they could be written.
    for beside in [name.replace(".glb", ".png"), "index.html".into()] {
        if let Ok(bytes) = std::fs::read(folder.join(&beside)) {
            to.put(&beside, &bytes, stop)?;
        }
    }
    let number = number(name).unwrap_or(0).max(sent(folder));
    let noted = write_beside(&folder.join(OUTGOING).join(SENT), |out| writeln!(out, "{number}"));
    noted.map_err(|e| e.to_string())?;
    std::fs::remove_file(&mark).map_err(|e| e.to_string())?;
    Ok(true)
}
