//! One thread beside the loop that answers to the service manager: the watchdog, and SIGHUP for new
//! settings.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

use crate::command_queue::CommandSender;
use crate::config::{Config, Resolved};
use crate::systemd::{Notifier, Watchdog, Watched, watchdog_us};
use sculptd_devices::Clock;
use sculptd_engine::command::Command;

/// Interval of the checks.
const LOOK: Duration = Duration::from_millis(250);

/// Settings that can be read again while the loop runs.
#[derive(Debug)]
pub struct Reload {
    /// The file of `--config`.
    pub extra: Option<PathBuf>,
    /// The settings in force.
    pub now: Config,
    pub commands: CommandSender,
}

impl Reload {
    /// Reads the files again. What a running loop can take is taken; the rest is named. Bad files
    /// change nothing.
    pub fn again(&mut self) {
        let new = match Resolved::load(self.extra.as_deref(), &self.now.presets) {
            Ok(resolved) => resolved.config,
            Err(e) => {
                tracing::error!("settings not taken, the old ones stay: {e}");
                return;
            }
        };
        if new.brush != self.now.brush {
            if self.commands.try_send(Command::Brush(new.brush)).is_err() {
                tracing::error!("settings not taken, the loop is busy: send the signal again");
                return;
            }
            tracing::info!("settings: the brush is changed");
        }
        let later = later(&self.now, &new);
        if !later.is_empty() {
            tracing::warn!("settings: {} take effect at the next start", later.join(", "));
        }
        if new == self.now {
            tracing::info!("settings: nothing has changed");
        }
        self.now = new;
    }
}

/// The sections that changed and that a running loop does not take.
fn later(old: &Config, new: &Config) -> Vec<String> {
    let (old, new) = (old.table(), new.table());
    new.iter()
        .filter(|(k, v)| *k != "brush" && old.get(*k) != Some(v))
        .map(|(k, _)| format!("[{k}]"))
        .collect()
}

/// Runs until dropped.
#[derive(Debug)]
pub struct Service {
    stop: Option<cc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Service {
    /// Tells the manager that the daemon is ready, and watches from now on.
    pub fn start(watched: Watched, reload: Reload) -> std::io::Result<Self> {
        let hangup = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(signal_hook::consts::SIGHUP, hangup.clone())?;
        let (stop, stopped) = cc::bounded(0);
        let thread =
            std::thread::Builder::new().name("sculptd-service".into()).spawn(move || {
                watch(&watched, reload, &hangup, &stopped);
            })?;
        Ok(Service { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Service {
    /// Waits until the thread has ended.
    fn drop(&mut self) {
        self.stop = None;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn watch(watched: &Watched, mut reload: Reload, hangup: &AtomicBool, stopped: &cc::Receiver<()>) {
    let (notifier, clock) = (Notifier::from_env(), Clock::monotonic());
    let mut dog = watchdog_us().map(|us| Watchdog::new(us, clock.now_us()));
    notifier.send("READY=1\nSTATUS=sculpting");
    let mut trouble = None;
    while matches!(stopped.recv_timeout(LOOK), Err(cc::RecvTimeoutError::Timeout)) {
        if hangup.swap(false, Relaxed) {
            reload.again();
        }
        let (tick, turns) = watched.progress();
        if dog.as_mut().is_some_and(|d| d.look(clock.now_us(), tick, turns)) {
            notifier.send("WATCHDOG=1");
        }
        let now = watched.journal.as_ref().and_then(super::session::Health::trouble);
        if now != trouble {
            notifier.send(&format!(
                "STATUS={}",
                now.as_deref().unwrap_or("sculpting").replace('\n', " ")
            ));
            trouble = now;
        }
    }
}
