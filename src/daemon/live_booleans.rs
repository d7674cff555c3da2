//! Results of Booleans that follow their operands, see [`LiveBoolean`]: a thread that looks at what
//! is published and computes a result again where an operand is another than it was computed from.
//!
//! An operand under a stroke changes all the time: a result is computed once its clay has rested
//! for a look. One that is only moved is followed while it moves, as fast as the Boolean goes. What
//! cannot be computed stays as it is until an operand changes again, and that is said.
//!
//! [`LiveBoolean`]: sculptd_engine::scene::LiveBoolean

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use crate::Published;
use crate::command_queue::{CommandSender, QueuedCommand};
use crate::scene_jobs;
use sculptd_engine::command::Command;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{ObjectId, Operand, SceneCommand};
use sculptd_geometry::job::Job;

/// Between two looks.
const EVERY: Duration = Duration::from_millis(50);
/// The same while no object is live.
const EVERY_WITHOUT: Duration = Duration::from_millis(250);

/// Stale results seen, and results already tried.
#[derive(Debug, Default)]
pub struct Follower {
    /// The operands of each result at the last look.
    seen: BTreeMap<ObjectId, [Operand; 2]>,
    /// The operands for which each was computed, with or without success.
    tried: BTreeMap<ObjectId, [Operand; 2]>,
}

impl Follower {
    /// Looks once; what is to be sent, one command a result that rests.
    pub fn look(&mut self, shown: &Published, job: &Job) -> Vec<QueuedCommand> {
        let stale = scene_jobs::stale(shown);
        self.tried.retain(|id, _| stale.iter().any(|s| s.0 == *id));
        let before = std::mem::replace(&mut self.seen, stale.iter().copied().collect());
        let mut out = Vec::new();
        for (id, operands) in stale {
            let form = |all: &[Operand; 2]| all.map(|o| (o.id, o.clay, o.revision));
            let moved = stale_of(shown, id).is_some_and(|was| form(&was) == form(&operands));
            let rests = moved || before.get(&id).map(form) == Some(form(&operands));
            if !rests || self.tried.get(&id) == Some(&operands) {
                continue;
            }
            self.tried.insert(id, operands);
            match scene_jobs::recompute(shown, id, job) {
                Ok((again, clay)) => {
                    let command = Command::Scene(SceneCommand::Recomputed(Box::new(again)));
                    out.push(QueuedCommand::with_payload(command, Payload::Clay(Box::new(clay))));
                }
                Err(e) => tracing::warn!("object {id} does not follow its operands: {e}"),
            }
        }
        out
    }
}

/// The operands that a result is of.
fn stale_of(shown: &Published, id: ObjectId) -> Option<[Operand; 2]> {
    shown.scene.object(id)?.settings.live.as_ref().map(|live| live.operands)
}

/// Follows the published state until `stop` is set.
///
/// # Errors
/// Returns an error if the thread cannot start.
pub fn start(
    commands: CommandSender,
    published: Arc<ArcSwap<Published>>,
    stop: Arc<AtomicBool>,
) -> std::io::Result<()> {
    std::thread::Builder::new().name("sculptd-follow".into()).spawn(move || {
        let (mut follower, quiet) = (Follower::default(), cc::never::<()>());
        while !stop.load(Relaxed) {
            let shown = published.load_full();
            let any = shown.scene.objects.iter().any(|o| o.settings.live.is_some());
            let commands_now = if any { follower.look(&shown, &Job::default()) } else { vec![] };
            for command in commands_now {
                if commands.try_send(command).is_err() {
                    follower.tried.clear();
                }
            }
            drop(shown);
            let _ = quiet.recv_timeout(if any { EVERY } else { EVERY_WITHOUT });
        }
    })?;
    Ok(())
}
