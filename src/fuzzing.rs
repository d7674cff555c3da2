//! The entry points for external bytes, one function each, for the fuzzer's targets and for tests
//! with seeded mutations. Each must return for any input.

use std::path::Path;

use sculptd_clay::Clay;
use sculptd_geometry::job::Job;

/// Reads a mesh file, converts it to triangles and builds clay. The extension of its name (`obj`,
/// `stl`, `ply`, `glb`, `3mf`) selects the format.
pub fn mesh_bytes(kind: &str, data: &[u8]) {
    let name = format!("input.{kind}");
    if let Ok(loaded) = sculptd_geometry::io::parse(data, Path::new(&name), &Job::default()) {
        let (plain, _) = loaded.mesh.triangulate();
        let _ = Clay::build(&plain, &Job::default());
    }
}

/// Decodes a page of a sculpture and its topology, as stored in a session's history: four bytes
/// with the length of the topology, the topology, the page.
pub fn page_bytes(data: &[u8]) {
    let Some((length, rest)) = data.split_first_chunk::<4>() else { return };
    let (shape, points) = rest.split_at(u32::from_le_bytes(*length) as usize % (rest.len() + 1));
    if let Ok(topology) = sculptd_clay::page::PageTopology::from_bytes(shape) {
        let _ = sculptd_clay::Page::from_bytes(points, std::sync::Arc::new(topology), 1);
    }
}

/// Parses one line of the control socket.
#[cfg(unix)]
pub fn rpc_bytes(data: &[u8]) {
    if let Ok(line) = sculptd_control::wire::parse(data) {
        // The settings that a method merges with the current ones.
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

/// Parses a settings file.
pub fn config_bytes(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        let _ = sculptd_daemon::config::Resolved::from_text(text, "input", crate::presets());
    }
}

/// Reads a session file, written into `folder` (which must be empty): lists its history, opens or
/// salvages it, replays it, and opens it at its newest checkpoint.
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
