//! The thread that scores the newest clay during a visit.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::score::{Goal, Score};
use crate::Published;
use sculptd_geometry::job::Job;

/// Time between two looks at the clay.
const LOOK: Duration = Duration::from_millis(300);

/// A goal that the newest clay is scored against.
#[derive(Debug)]
pub struct WantedScore {
    pub goal: Arc<Goal>,
    /// Number of a clay that is not scored: it is about to be replaced.
    pub not: Option<u32>,
}

/// The newest score.
pub type SharedScore = Arc<Mutex<Option<Score>>>;

/// Starts the thread. It scores against the goal that was sent last; `None`: nobody is here. It
/// ends when the sender is gone.
///
/// # Errors
/// Returns the system's error.
pub fn start(
    published: Arc<ArcSwap<Published>>,
    shown: SharedScore,
) -> std::io::Result<cc::Sender<Option<WantedScore>>> {
    let (send, goals) = cc::unbounded();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(std::io::Error::other)?;
    let run = move || pool.install(|| follow(&goals, &published, &shown));
    std::thread::Builder::new().name("sculptd-score".into()).spawn(run)?;
    Ok(send)
}

fn follow(
    goals: &cc::Receiver<Option<WantedScore>>,
    published: &ArcSwap<Published>,
    shown: &SharedScore,
) {
    let show = |score: Option<Score>| {
        if let Ok(mut shown) = shown.lock() {
            *shown = score;
        }
    };
    let job = Job::default();
    let (mut wanted, mut scored): (Option<WantedScore>, _) = (None, None);
    loop {
        // Without a goal the thread sleeps.
        let next = match &wanted {
            None => goals.recv().map_err(|_| cc::RecvTimeoutError::Disconnected),
            Some(_) => goals.recv_timeout(LOOK),
        };
        match next {
            Ok(next) => {
                (wanted, scored) = (next, None);
                // The last score was of another goal.
                show(None);
            }
            Err(cc::RecvTimeoutError::Timeout) => {}
            Err(cc::RecvTimeoutError::Disconnected) => return,
        }
        let Some(WantedScore { goal, not }) = &wanted else { continue };
        let clay = published.load().mesh.clone();
        let revision = (clay.object_id(), clay.revision());
        if scored != Some(revision)
            && *not != Some(clay.object_id())
            && let Ok(score) = goal.score(&clay.to_tri(), &job)
        {
            show(Some(score));
            scored = Some(revision);
        }
    }
}
