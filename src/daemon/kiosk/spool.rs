//! Finished works on their way from the gallery's folder to where they are kept for good: another folder, or a bucket.
//!
//! Laws kept here:
//! * A work is in the local folder before it is offered, and what is offered is a name in `outgoing/`: nothing is lost by a dead
//!   network, nor by a restart.
//! * Works arrive in the order in which they were made: the oldest that waits is tried until it is there.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;
use object_store::path::Path as StorePath;
use object_store::{ObjectStore, ObjectStoreExt, PutPayload};

use crate::mesh::io::write_beside;

/// The folder of names that wait, within the gallery.
pub const OUTGOING: &str = "outgoing";
/// The first wait after a refusal, and the longest.
const WAIT: Duration = Duration::from_millis(500);
const LONGEST: Duration = Duration::from_secs(60);

/// How the works that wait stand.
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
    super::gallery::works(&folder.join(OUTGOING)).unwrap_or_default()
}

/// Opens where works go to: a folder, `file:///folder`, or another place that this build knows.
///
/// # Errors
/// In words, where nothing of that kind is known.
pub fn open(place: &str) -> Result<(Arc<dyn ObjectStore>, StorePath), String> {
    let said = |e: object_store::Error| format!("{place}: {e}");
    if place.contains("://") {
        let url = url::Url::parse(place).map_err(|e| format!("{place}: {e}"))?;
        if url.scheme() == "s3" && !cfg!(feature = "s3") {
            return Err(format!("{place}: this build sends to no bucket (the feature `s3` is off)"));
        }
        // Keys of a bucket come from the environment, as everywhere: no secret stands in a settings file.
        let keys = std::env::vars().filter(|(k, _)| k.starts_with("AWS_"));
        let (store, path) =
            object_store::parse_url_opts(&url, keys.map(|(k, v)| (k.to_ascii_lowercase(), v)))
                .map_err(said)?;
        return Ok((Arc::from(store), path));
    }
    std::fs::create_dir_all(place).map_err(|e| format!("{place}: {e}"))?;
    let store = object_store::local::LocalFileSystem::new_with_prefix(place).map_err(said)?;
    Ok((Arc::new(store), StorePath::default()))
}

impl Spool {
    /// Begins to send what waits in `folder`.
    ///
    /// # Errors
    /// In words, where `place` is nothing that can be sent to.
    pub fn start(folder: &Path, place: &str) -> Result<Spool, String> {
        let (store, prefix) = open(place)?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| format!("{place}: {e}"))?;
        let (wake, calls) = cc::bounded::<()>(1);
        let stand = Arc::new(Stand::default());
        let (shown, from) = (stand.clone(), folder.to_path_buf());
        let name = place.to_owned();
        let thread = std::thread::Builder::new()
            .name("sculptd-gallery".into())
            .spawn(move || {
                let mut wait = WAIT;
                while !shown.stop.load(Relaxed) {
                    match send_next(&runtime, store.as_ref(), &prefix, &from) {
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
                            if matches!(calls.recv_timeout(wait), Err(cc::RecvTimeoutError::Disconnected)) {
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

    /// Offers a work that lies in the folder.
    pub fn offer(&self, name: &str) -> std::io::Result<()> {
        offer(&self.folder, name)?;
        let _ = self.wake.try_send(());
        Ok(())
    }
}

impl Drop for Spool {
    /// What waits goes on waiting on the disk.
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
fn send_next(
    runtime: &tokio::runtime::Runtime,
    store: &dyn ObjectStore,
    prefix: &StorePath,
    folder: &Path,
) -> Result<bool, String> {
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
    let put = |name: &str, bytes: Vec<u8>| {
        let to = prefix.clone().join(name);
        runtime.block_on(store.put(&to, PutPayload::from(bytes))).map_err(|e| e.to_string())
    };
    put(name, bytes)?;
    if let Ok(page) = std::fs::read(folder.join("index.html")) {
        put("index.html", page)?;
    }
    std::fs::remove_file(&mark).map_err(|e| e.to_string())?;
    Ok(true)
}
