//! A region of the view, as it is asked for and as the engine takes it.

use std::sync::Arc;

use glam::Vec2;
use sculptd_control::RpcError;
use sculptd_control::brush as asked;
use sculptd_engine::mask_region::{MaskRegion, ViewRegion};

/// The engine's form of a request.
///
/// # Errors
/// Where the region is none: a line without a length, a polygon of too few or too many corners.
pub(super) fn mask_region(params: asked::MaskRegionParams) -> Result<MaskRegion, RpcError> {
    let ends = |[x, y, u, v]: [f32; 4]| [Vec2::new(x, y), Vec2::new(u, v)];
    let region = MaskRegion {
        region: match params.region {
            asked::ViewRegion::Box(corners) => ViewRegion::Box(ends(corners)),
            asked::ViewRegion::Line(points) => ViewRegion::Line(ends(points)),
            asked::ViewRegion::Polygon(corners) => {
                let corners = corners.into_iter().map(Vec2::from).collect();
                ViewRegion::Polygon(Arc::new(corners))
            }
        },
        mask: params.mask,
        front_faces: params.front_faces,
    };
    if region.is_sane() {
        return Ok(region);
    }
    let text = "region: expected a line of two places, or a polygon of 3 to 1000 corners";
    Err(RpcError::bad_params(text))
}
