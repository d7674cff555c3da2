//! A region of the view, as it is asked for and as the engine takes it.

use std::sync::Arc;

use glam::Vec2;
use sculptd_clay::face_sets::PartEdit;
use sculptd_control::RpcError;
use sculptd_control::brush as asked;
use sculptd_control::face_sets::{FaceSetRegionAction, FaceSetRegionParams};
use sculptd_engine::mask_region::MaskRegion;
use sculptd_engine::view_region::{SetsRegion, ViewRegion};

/// Converts a region to the engine's form.
///
/// # Errors
/// Returns an error for a line of length 0, or a polygon with too few or too many corners.
pub(super) fn region(asked: asked::ViewRegion) -> Result<ViewRegion, RpcError> {
    let ends = |[x, y, u, v]: [f32; 4]| [Vec2::new(x, y), Vec2::new(u, v)];
    let region = match asked {
        asked::ViewRegion::Box(corners) => ViewRegion::Box(ends(corners)),
        asked::ViewRegion::Line(points) => ViewRegion::Line(ends(points)),
        asked::ViewRegion::Polygon(corners) => {
            let corners = corners.into_iter().map(Vec2::from).collect();
            ViewRegion::Polygon(Arc::new(corners))
        }
    };
    if region.is_sane() {
        return Ok(region);
    }
    let text = "region: expected a line of two places, or a polygon of 3 to 1000 corners";
    Err(RpcError::bad_params(text))
}

/// Converts a request to mask a region to the engine's form.
///
/// # Errors
/// As [`region`].
pub(super) fn mask_region(params: asked::MaskRegionParams) -> Result<MaskRegion, RpcError> {
    let asked::MaskRegionParams { region: asked, mask, front_faces } = params;
    Ok(MaskRegion { region: region(asked)?, mask, front_faces })
}

/// Converts a request about the face sets of a region to the engine's form.
///
/// # Errors
/// As [`region`].
pub(super) fn sets_region(params: FaceSetRegionParams) -> Result<SetsRegion, RpcError> {
    let edit = match params.action {
        FaceSetRegionAction::Make => PartEdit::NewSet,
        FaceSetRegionAction::Hide => PartEdit::Hide,
        FaceSetRegionAction::Isolate => PartEdit::Isolate,
    };
    let front_faces = params.front_faces;
    Ok(SetsRegion { region: region(params.region)?, edit, front_faces })
}
