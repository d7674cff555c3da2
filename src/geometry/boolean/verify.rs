//! Checks results against winding numbers of the operands: a face of a result is part of one
//! operand, and is kept only because of its winding number in the other.

use super::BooleanSolid;
use super::box_tree::Span;
use super::broad_phase::SurfaceView;
use super::classify::{WindingOracle, probe};
use super::pieces::Placement;
use crate::PolyMesh;
use crate::job::{Cancelled, Job};

/// Faces of each result that are asked.
const SAMPLES: usize = 1000;

/// Returns what is wrong with the results, from samples on their faces. Samples within four times
/// `eps` of the other operand are ignored.
pub fn results(
    operands: [&PolyMesh; 2],
    solids: &[BooleanSolid],
    eps: f64,
    job: &Job,
) -> Result<Option<String>, Cancelled> {
    let triangles = operands.map(|m| m.triangles().0);
    let mut oracles = [0, 1].map(|s| {
        let at = &operands[s].positions[..];
        let view = SurfaceView { triangles: &triangles[s], at, base: 0 };
        WindingOracle::new(view, Span::of(at.iter().copied()), eps)
    });
    for solid in solids {
        let step = solid.mesh.face_count().div_ceil(SAMPLES).max(1);
        for f in (0..solid.mesh.face_count()).step_by(step) {
            let (size, place) = probe(&[solid.mesh.face(f)], &solid.mesh.positions);
            let own = solid.origins[f].operand as usize;
            if size <= 16.0 * eps * eps {
                continue;
            }
            let Some(winding) = oracles[1 - own].clear_winding(place, job)? else { continue };
            let found = if winding > 0 { Placement::Inside } else { Placement::Outside };
            if solid.operation.takes(own, found, false).is_none() {
                return Ok(Some(format!(
                    "a face of the {} at ({:.6}, {:.6}, {:.6}) does not belong to it",
                    solid.operation.name(),
                    place.x,
                    place.y,
                    place.z
                )));
            }
        }
    }
    Ok(None)
}
