//! The reply of `status`.

use std::sync::atomic::Ordering::Relaxed;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::host::{Host, failed};
use crate::Published;
use crate::window_link::WindowStanding;
use sculptd_control::RpcError;
use sculptd_control::status::{self, Versions};
use sculptd_control::wire::Code;

/// The pens whose rings are shown, and where: `view` is the view's corner and size on the desktop.
fn pens(shown: &Published, view: Option<[glam::DVec2; 2]>) -> Vec<status::PenStatus> {
    let all = shown.pens.iter().flatten();
    all.map(|(id, pen)| status::PenStatus {
        device: id.0,
        view: pen.view.to_array(),
        pixel: view.map(|[corner, size]| (corner + size * pen.view.as_dvec2()).to_array()),
    })
    .collect()
}

pub(super) fn status(
    host: &Host,
    params: &status::StatusParams,
) -> Result<status::StatusReply, RpcError> {
    if let Some(v) = params.version {
        let theirs = Versions { min: v, max: v };
        Versions::OURS.newest_in_common(theirs).ok_or_else(|| other_version(theirs))?;
    }
    let shown = host.published.load_full();
    let f = &shown.figures;
    Ok(status::StatusReply {
        protocol: Versions::OURS.max,
        versions: Some(Versions::OURS),
        version: env!("CARGO_PKG_VERSION").into(),
        tick: shown.tick,
        heard: f.newest_tick,
        samples: f.samples,
        dabs: f.dabs,
        vertices_moved: f.vertices_moved,
        overruns: f.overruns,
        losses: losses(&shown),
        tick_ms: convert(f.tick_ms)?,
        vertices: shown.mesh.vertex_count() as u64,
        triangles: shown.mesh.triangle_count() as u64,
        undo_steps: shown.undo_steps as u64,
        redo_steps: shown.redo_steps as u64,
        brush: convert(shown.brush)?,
        curve_points: shown.draft.points().len() as u64,
        journal: host.journal.as_ref().map(|h| status::JournalStatus {
            written: h.written.load(Relaxed),
            lost: h.lost.load(Relaxed),
            fault: h.trouble(),
        }),
        pens: pens(&shown, host.window.view_on_desktop()),
        window: match host.window.standing() {
            WindowStanding::Headless => status::WindowStatus::Headless,
            WindowStanding::Opening => status::WindowStatus::Opening,
            WindowStanding::Open => status::WindowStatus::Open,
            WindowStanding::Lost => status::WindowStatus::Lost,
        },
        session: host.window.session().map(|p| p.display().to_string()),
    })
}

/// The same data in another type of the same JSON form.
pub(super) fn convert<T: DeserializeOwned>(value: impl Serialize) -> Result<T, RpcError> {
    serde_json::to_value(value).and_then(serde_json::from_value).map_err(failed)
}

pub(super) fn losses(shown: &Published) -> status::Losses {
    let l = shown.figures.losses;
    status::Losses { motion: l.motion, transition: l.transition }
}

pub(super) fn other_version(theirs: Versions) -> RpcError {
    let ours = Versions::OURS;
    let text = format!(
        "this daemon speaks versions {} to {}, the client {} to {}",
        ours.min, ours.max, theirs.min, theirs.max
    );
    RpcError::new(Code::Version, text)
}
