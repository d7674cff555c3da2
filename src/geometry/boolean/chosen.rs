//! The faces of one result, chosen from an arrangement: in the same way for a whole operand and for
//! a patch of a larger surface.

use super::arrange::{Arrangement, FaceState};
use super::emit::{self, FaceOrigin};
use super::{BooleanOptions, Operation, ResultFaces, simplify};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};

/// Faces of a result, and the origin of each. Corners are over the points of the arrangement.
pub struct ChosenFaces {
    pub mesh: PolyMesh,
    pub origins: Vec<FaceOrigin>,
}

/// Chooses the faces of the result of one operation. Faces that are cut come in the shape that the
/// options ask for, in triangles if `triangles`.
pub fn chosen(
    a: &Arrangement,
    operands: [&PolyMesh; 2],
    operation: Operation,
    options: &BooleanOptions,
    triangles: bool,
    floor: f64,
    job: &Job,
) -> Result<ChosenFaces, Cancelled> {
    job.check()?;
    let faces = operands.iter().map(|m| m.face_count()).sum();
    let (mut mesh, mut origins) = (PolyMesh::new(), Vec::with_capacity(faces));
    mesh.face_starts.reserve(faces);
    mesh.corners.reserve(operands.iter().map(|m| m.corners.len()).sum());
    let mut cut: Vec<simplify::CutFace> = Vec::new();
    a.faces(operation, options.keep_contact, job, |origin, corners, state| match options.faces {
        _ if state != FaceState::Cut && (!triangles || corners.len() == 3) => {
            mesh.push_face(corners);
            origins.push(origin);
        }
        ResultFaces::ConvexPolygons => {
            for ring in simplify::convex(corners, &a.points.at) {
                mesh.push_face(&ring);
                origins.push(origin);
            }
        }
        _ if triangles => cut.push(simplify::CutFace { origin, corners: corners.to_vec() }),
        _ => {
            mesh.push_face(corners);
            origins.push(origin);
        }
    });
    job.check()?;
    let flat = 4.0 * floor.max(a.points.contact.farthest);
    let group = |o| simplify::group_of(operands, o);
    for (origin, t) in simplify::retriangulated(&cut, a.own, &a.points.at, flat, group) {
        mesh.push_face(&t);
        origins.push(origin);
    }
    job.check()?;
    // Kept contact is such a sheet, and wanted.
    if !options.keep_contact {
        emit::drop_folded_faces(&mut mesh, &mut origins, a.on_both());
    }
    Ok(ChosenFaces { mesh, origins })
}
