//! How a run ends: by a signal, with a mesh that is written, with a session that is closed.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::Fail;
use sculptd_daemon::scene_jobs::{Selection, selected};
use sculptd_daemon::session::writer::WriterThread;
use sculptd_engine::world::World;
use sculptd_geometry::io::write_scene;
use sculptd_geometry::job::Job;

/// Set once by SIGINT or SIGTERM.
pub fn stop_signal() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        // A second signal ends the process at once, as a person who presses twice expects.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, stop.clone());
        let _ = signal_hook::flag::register(signal, stop.clone());
    }
    stop
}

/// Writes the visible objects.
pub fn export(path: Option<&Path>, world: &mut World) -> Result<Option<String>, Fail> {
    let Some(path) = path else { return Ok(None) };
    let (scene, active) = (world.scene_view(), world.snapshot());
    let meshes = selected(&scene, &active, Selection::Visible);
    let meshes = meshes.map_err(|e| Fail::Input(format!("{}: {e}", path.display())))?;
    for lost in write_scene(path, &meshes, &Job::default()).map_err(Fail::from)? {
        eprintln!("sculptd: warning: {}: {lost}", path.display());
    }
    Ok(Some(path.display().to_string()))
}

/// Waits for the session's last group, and warns if it could not be written.
pub fn close_journal(thread: Option<WriterThread>) {
    warn_of_fault(thread.and_then(WriterThread::finish));
}

/// Prints a warning about the input that could not be written.
pub fn warn_of_fault(fault: Option<String>) {
    if let Some(fault) = fault {
        eprintln!("sculptd: warning: {fault}");
    }
}

/// Restarts the program with the arguments of this run. It returns only on failure.
pub fn begin_again() -> Fail {
    let failed = |e: std::io::Error| Fail::Check(format!("the program cannot begin anew: {e}"));
    let program = match std::env::current_exe() {
        Ok(program) => program,
        Err(e) => return failed(e),
    };
    let mut next = std::process::Command::new(program);
    next.args(std::env::args_os().skip(1));
    #[cfg(unix)]
    return failed(std::os::unix::process::CommandExt::exec(&mut next));
    // Whoever watches over the installation starts it again where this cannot be done in place.
    #[cfg(not(unix))]
    match next.spawn() {
        Ok(_) => Fail::Check("the program goes on in another process".into()),
        Err(e) => failed(e),
    }
}
