//! A flat base: the part cut parallel to its plate.

use glam::DVec3;
use sculptd_geometry::PolyMesh;

use super::tool::half_space;
use super::{RepairError, direction};

/// Returns the solid to subtract so that the part stands flat: all below the plane at `height`
/// above its lowest point along `up`.
///
/// # Errors
/// Returns an error if `height` is not above 0 and below the part's own.
pub fn base_tool(mesh: &PolyMesh, up: DVec3, height: f64) -> Result<PolyMesh, RepairError> {
    let up = direction("up", up)?;
    let (low, high) = extent(mesh, up);
    let tall = high - low;
    if !(height > 0.0 && height < tall) {
        let range = format!("above 0 and below {tall}, the height of the part");
        return Err(RepairError::OutOfRange { name: "base", value: height, range });
    }
    Ok(half_space(mesh, up, low + height))
}

/// The least and the greatest height of a part along a direction.
pub(super) fn extent(mesh: &PolyMesh, along: DVec3) -> (f64, f64) {
    let heights = mesh.corners.iter().map(|&c| along.dot(mesh.positions[c as usize]));
    heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)))
}
