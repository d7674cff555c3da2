//! Work longer than a tick, on a separate thread (`sculptd-replica`): hashes, checkpoints, worlds
//! built from them, and the sessions that begin with those.

use std::path::PathBuf;

use crossbeam_channel as cc;

use crate::executor::HashView;
use crate::shared_session::SharedSession;
use sculptd_clay::Workers;
use sculptd_daemon::shared_input::SharedJournal;
use sculptd_engine::checkpoint::{Captured, Restoring};
use sculptd_engine::scene::KnownHashes;
use sculptd_engine::world::World;
use sculptd_geometry::io::write_mesh;

/// To the worker.
pub enum Job {
    Hash(HashView),
    Checkpoint(u64, Box<Captured>),
    RestorePart {
        first: bool,
        bytes: Vec<u8>,
    },
    /// All bytes have arrived; ticks a second.
    Restore(u32),
    Dump(Box<HashView>, PathBuf),
}

/// A world that came as a checkpoint; and its session, where one is written, or why it is not.
pub type RestoredWorld = (Box<World>, Result<Option<SharedJournal>, String>);

/// From the worker.
pub enum Done {
    Hash(HashView, u64),
    /// The next part of a checkpoint, and whether it is the last.
    CheckpointPart(u64, Vec<u8>, bool),
    /// The world; and its session, where one is written, or why it is not.
    Restored(Option<RestoredWorld>),
}

/// The worker's thread.
pub fn work_on(
    jobs: &cc::Receiver<Job>,
    done: &cc::Sender<Done>,
    workers: usize,
    session: Option<&SharedSession>,
) {
    let mut known = KnownHashes::default();
    let mut restoring = Ok(Restoring::default());
    for job in jobs {
        let finished = match job {
            Job::Hash(view) => {
                let hash = view.hash(&mut known);
                Done::Hash(view, hash)
            }
            Job::Checkpoint(index, captured) => {
                captured.write(|part, last| {
                    let _ = done.send(Done::CheckpointPart(index, part.to_vec(), last));
                });
                continue;
            }
            Job::RestorePart { first, bytes } => {
                if first {
                    restoring = Ok(Restoring::default());
                }
                if let Ok(some) = &mut restoring
                    && let Err(bad) = some.take(&bytes)
                {
                    restoring = Err(bad);
                }
                continue;
            }
            Job::Restore(rate_hz) => {
                let whole = std::mem::replace(&mut restoring, Ok(Restoring::default()));
                let world = whole.and_then(|some| some.finish(Workers::new(workers)));
                Done::Restored(world.ok().map(|mut world| {
                    let journal = session.map(|s| s.begin(&mut world, rate_hz));
                    (Box::new(world), journal.transpose())
                }))
            }
            Job::Dump(view, path) => {
                let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
                let written = written.map_err(|e| e.to_string()).and_then(|()| {
                    write_mesh(&path, &view.active.to_tri().to_poly()).map_err(|e| e.to_string())
                });
                if let Err(e) = written {
                    tracing::warn!("{}: {e}", path.display());
                }
                continue;
            }
        };
        if done.send(finished).is_err() {
            return;
        }
    }
}
