//! The reply of `status`.

use std::sync::atomic::Ordering::Relaxed;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::host::{Host, failed};
use super::people_reply;
use crate::Published;
use crate::window_link::WindowStanding;
use sculptd_control::RpcError;
use sculptd_control::status::{self, Versions};
use sculptd_control::wire::Code;
use sculptd_devices::DeviceId;
use sculptd_engine::desktop_layout::{DesktopLayout, PenPlace};

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

/// The tablets as the window has told the loop of them, in pixels of the desktop.
fn tablets(desktop: &DesktopLayout, view: Option<[glam::DVec2; 2]>) -> Vec<status::TabletStatus> {
    let of = |(id, place): &(DeviceId, PenPlace)| {
        let (known, area) = match *place {
            PenPlace::Area => (status::TabletPlace::Area, None),
            PenPlace::Unknown => (status::TabletPlace::Unknown, None),
            PenPlace::Off => (status::TabletPlace::Cut, None),
            PenPlace::Mapped { origin, across, down } => {
                let area = view.map(|[corner, size]| {
                    let edges = [across, down].map(|edge| size * edge.as_dvec2());
                    [corner + size * origin.as_dvec2(), edges[0], edges[1]].map(|v| v.to_array())
                });
                (status::TabletPlace::Learned, area)
            }
        };
        status::TabletStatus { device: id.0, place: known, area }
    };
    desktop.tablets.iter().flatten().map(of).collect()
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
        shared: people_reply::link(&shown),
        journal: host.journal.as_ref().map(|h| status::JournalStatus {
            written: h.written.load(Relaxed),
            lost: h.lost.load(Relaxed),
            fault: h.trouble(),
        }),
        pens: pens(&shown, host.window.view_on_desktop()),
        tablets: tablets(&host.window.claims().desktop, host.window.view_on_desktop()),
        frames: host.window.present_latency().frames(),
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

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec2};

    use super::*;

    #[test]
    fn a_learned_tablet_is_told_in_pixels_of_the_desktop() {
        let mapped = PenPlace::Mapped {
            origin: Vec2::new(-0.5, 0.25),
            across: Vec2::new(2.0, 0.0),
            down: Vec2::new(0.0, 1.5),
        };
        let mut desktop = DesktopLayout::default();
        desktop.tablets[0] = Some((DeviceId(3), mapped));
        desktop.tablets[1] = Some((DeviceId(4), PenPlace::Unknown));
        let view = Some([DVec2::new(100.0, 50.0), DVec2::new(600.0, 400.0)]);
        let told = tablets(&desktop, view);
        assert_eq!(told.len(), 2);
        assert_eq!((told[0].device, told[0].place), (3, status::TabletPlace::Learned));
        assert_eq!(told[0].area, Some([[-200.0, 150.0], [1200.0, 0.0], [0.0, 600.0]]));
        assert_eq!((told[1].place, told[1].area), (status::TabletPlace::Unknown, None));
        assert_eq!(tablets(&desktop, None)[0].area, None);
    }
}
