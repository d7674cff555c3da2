//! Events for a client that subscribed: what changed since the last look, a line each, until the
//! client has gone.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::{Value, json};

use super::server::Host;

/// Between two looks: what changes in between is one event.
const EVERY: Duration = Duration::from_millis(50);

/// What is compared between two looks, by the event's name.
pub const EVENTS: [&str; 5] = ["work", "history", "brush", "losses", "journal"];

/// How things stand, by the order of [`EVENTS`].
pub(super) type Standing = [Value; EVENTS.len()];

pub(super) fn look(host: &Host) -> Standing {
    let s = host.published.load();
    let work = json!({
        "revision": s.mesh.revision(), "vertices": s.mesh.vertex_count(), "triangles": s.mesh.triangle_count(),
    });
    let history = json!({ "undo_steps": s.undo_steps, "redo_steps": s.redo_steps });
    let journal = json!({ "fault": host.journal.as_ref().and_then(|h| h.trouble()) });
    [work, history, json!(s.brush), json!(s.figures.losses), journal]
}

/// Writes what is no longer as `before`, on a thread of its own; it ends with `gone`, or when
/// nobody reads.
pub(super) fn start(
    host: &Host,
    mut before: Standing,
    out: Arc<Mutex<UnixStream>>,
    gone: Arc<AtomicBool>,
) -> std::io::Result<()> {
    let host = host.clone();
    std::thread::Builder::new().name("sculptd-events".into()).spawn(move || {
        let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
        while !gone.load(Relaxed) && !host.stop.load(Relaxed) {
            let _ = quiet.recv_timeout(EVERY);
            let now = look(&host);
            let tick = host.published.load().tick;
            for (i, name) in EVENTS.iter().enumerate().filter(|(i, _)| now[*i] != before[*i]) {
                let params = json!({ "event": name, "tick": tick, "now": now[i] });
                let line = json!({ "jsonrpc": "2.0", "method": "event", "params": params });
                let Ok(mut out) = out.lock() else { return };
                // A client that does not read holds up nobody but itself: the write has a time
                // limit.
                if out.write_all(format!("{line}\n").as_bytes()).is_err() {
                    return;
                }
            }
            before = now;
        }
    })?;
    Ok(())
}
