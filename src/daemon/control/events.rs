//! Events for a subscribed client: one line for each change, until the client disconnects.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::json;

use super::host::{Host, locked};
use super::status_reply::losses;
use sculptd_control::event::{Event, EventNotice, HistoryState, JournalState, MeshState};

/// Interval between two checks; several changes within it make one event.
const EVERY: Duration = Duration::from_millis(50);

/// Returns the current state for each kind of event.
pub(super) fn look(host: &Host) -> Vec<Event> {
    let s = host.published.load();
    let brush = serde_json::to_value(s.brush).and_then(serde_json::from_value);
    vec![
        Event::Work(MeshState {
            revision: s.mesh.revision(),
            vertices: s.mesh.vertex_count() as u64,
            triangles: s.mesh.triangle_count() as u64,
        }),
        Event::History(HistoryState {
            undo_steps: s.undo_steps as u64,
            redo_steps: s.redo_steps as u64,
        }),
        Event::Brush(Box::new(brush.unwrap_or_default())),
        Event::Losses(losses(&s)),
        Event::Journal(JournalState { fault: host.journal.as_ref().and_then(|h| h.trouble()) }),
    ]
}

/// Starts a thread that writes each state that differs from `before`. It ends once `gone` is set or
/// a write fails.
pub(super) fn start(
    host: &Host,
    mut before: Vec<Event>,
    out: Arc<Mutex<UnixStream>>,
    gone: Arc<AtomicBool>,
) -> std::io::Result<()> {
    let host = host.clone();
    std::thread::Builder::new().name("sculptd-events".into()).spawn(move || {
        let quiet = crossbeam_channel::never::<()>();
        while !gone.load(Relaxed) && !host.stop.load(Relaxed) {
            let _ = quiet.recv_timeout(EVERY);
            let now = look(&host);
            let tick = host.published.load().tick;
            for (event, _) in now.iter().zip(&before).filter(|(now, before)| now != before) {
                let params = EventNotice { tick, event: event.clone() };
                let line = json!({ "jsonrpc": "2.0", "method": "event", "params": params });
                // A client that does not read holds up nobody but itself: the write has a time
                // limit.
                if locked(&out).write_all(format!("{line}\n").as_bytes()).is_err() {
                    return;
                }
            }
            before = now;
        }
    })?;
    Ok(())
}
