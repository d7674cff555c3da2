//! The doors that bytes from outside come in by, one function each: for the fuzzer's targets and
//! for the tests that feed the same doors with seeded mutations. Each must return, whatever it is
//! given.

use std::path::Path;

use sculptd_clay::Clay;
use sculptd_geometry::job::Job;

/// A mesh file of the kind that its name's ending (`obj`, `stl`, `ply`, `glb`, `3mf`) says: read,
/// made into triangles, built.
pub fn mesh_bytes(kind: &str, data: &[u8]) {
    let name = format!("input.{kind}");
    if let Ok(loaded) = sculptd_geometry::io::parse(data, Path::new(&name), &Job::default()) {
        let (plain, _) = loaded.mesh.triangulate();
        let _ = Clay::build(&plain, &Job::default());
    }
}

/// A page of a work and what stands still in it, as a session's history keeps them: four bytes that
/// say how long the latter is, then it, then the page.
pub fn page_bytes(data: &[u8]) {
    let Some((length, rest)) = data.split_first_chunk::<4>() else { return };
    let (shape, points) = rest.split_at(u32::from_le_bytes(*length) as usize % (rest.len() + 1));
    if let Ok(topology) = sculptd_clay::page::PageTopology::from_bytes(shape) {
        let _ = sculptd_clay::Page::from_bytes(points, std::sync::Arc::new(topology), 1);
    }
}

/// One line for the control socket.
#[cfg(unix)]
pub fn rpc_bytes(data: &[u8]) {
    if let Ok(line) = sculptd_control::wire::parse(data) {
        // The settings that a method merges with those in force.
        let _ = serde_json::from_value::<sculptd_clay::brush::BrushSettings>(line.params.clone())
            .map(|b| b.clamped());
        let _ = serde_json::from_value::<sculptd_engine::camera::Camera>(line.params.clone())
            .map(|c| c.is_sane());
        if let Ok(sculptd_control::Request::Stroke(stroke)) =
            sculptd_control::Request::read(&line.method, line.params)
        {
            let _ = stroke.check();
        }
    }
}

/// A settings file.
pub fn config_bytes(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        let _ = sculptd_daemon::config::Resolved::of_text(text, "input", crate::presets());
    }
}

/// A session file, put into `folder` (which must be empty): its history listed; opened, or else
/// salvaged; replayed; opened at its newest checkpoint.
pub fn session_bytes(folder: &Path, data: &[u8]) {
    use sculptd_daemon::session;
    let path = folder.join("input.sculpt");
    let written = sculptd_geometry::io::write_beside(&path, |out| out.write_all(data));
    if written.is_err() {
        return;
    }
    let _ = session::history::listing::read(&path);
    let opened = session::open(&path).or_else(|e| {
        session::salvage(&path).map_err(|_| e).and_then(|saved| session::open(&saved.path))
    });
    if let Ok(opened) = opened {
        let workers = sculptd_clay::Workers::new(1);
        let _ = session::replay::replay(&opened, Some(400), workers, &Job::default());
        let _ = session::reopen(&opened.path, &opened, Some(400), 1, &Job::default());
    }
}
