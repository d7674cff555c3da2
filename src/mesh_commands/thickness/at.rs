//! `--at`: the wall at one place.

use std::path::Path;

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::ThicknessArgs;
use crate::{Fail, Outcome, answer};
use sculptd_geometry::io::{read_mesh, write_beside};
use sculptd_geometry::job::Job;
use sculptd_geometry::picture::{Camera, Picture, draw};
use sculptd_geometry::thickness::probe::{Probe, ProbedRay, probe};
use sculptd_geometry::{CentredMesh, TriMesh};

/// The answer of `--at`: like [`Probe`], in the file's coordinates.
#[derive(Debug, Serialize)]
struct AtAnswer {
    file: String,
    position: [f64; 3],
    normal: [f32; 3],
    thickness: Option<f32>,
    error: f32,
    /// The face that is measured from, and the one that the ray along the normal meets; indices of
    /// the file's triangles.
    triangle: u32,
    opposite: Option<u32>,
    /// The other side is turned by more than 40 degrees and makes an edge, not a wall.
    edge: bool,
    /// The diameter of the largest ball between the place and the side opposite.
    ball: Option<f32>,
    rays: Vec<ProbedRay>,
}

pub(super) fn tell(path: &Path, args: &ThicknessArgs, at: DVec3, job: &Job, json: bool) -> Outcome {
    let loaded = read_mesh(path, job)?;
    let part = CentredMesh::new(&loaded.mesh, args.how.unit.scale());
    let found = probe(&part.mesh, &args.how.settings(), at - part.centre, job)
        .map_err(|e| Fail::Usage(e.to_string()))?;
    let Some(found) = found else {
        return Err(Fail::Input(format!("{}: no surface there to measure at", path.display())));
    };
    if let Some(out) = &args.png {
        let png = drawn(&part.mesh, &found, args.size).png();
        let png = png.map_err(|e| Fail::Input(format!("{}: {e}", out.display())))?;
        write_beside(out, |w| w.write_all(&png)).map_err(|e| Fail::io(out, &e))?;
    }
    let Probe { position, normal, triangle, opposite, edge, thickness, error, ball, rays } = found;
    let position = part.to_file(position.into()).to_array();
    let file = path.display().to_string();
    let out =
        AtAnswer { file, position, normal, thickness, error, triangle, opposite, edge, ball, rays };
    answer(json, &out, |w| {
        let [x, y, z] = out.position;
        let value = out.thickness.map_or("none".into(), |v| format!("{v:.4} mm"));
        writeln!(w, "thickness {value} +- {:.4} at ({x:.4}, {y:.4}, {z:.4})", out.error)?;
        if out.edge {
            writeln!(w, "  an edge, not a wall: the other side is turned by more than 40 degrees")?;
        }
        if let Some(ball) = out.ball {
            writeln!(w, "  ball {ball:.4} mm")?;
        }
        for r in &out.rays {
            let length = r.length.map_or("none".into(), |l| format!("{l:.4}"));
            writeln!(w, "  ray {:?} {length}", r.direction)?;
        }
        Ok(())
    });
    Ok(())
}

/// The part seen along the surface at a probed place, a little from above, with the rays through
/// it, the outline of the ball and a ring around the place.
fn drawn(mesh: &TriMesh, found: &Probe, (width, height): (u32, u32)) -> Picture {
    let (place, normal) = (Vec3::from(found.position), Vec3::from(found.normal));
    let (side, _) = normal.normalize_or(Vec3::Z).any_orthonormal_pair();
    let aspect = width as f32 / height as f32;
    let camera = Camera::from_side(mesh, side + normal * 0.4, aspect);
    let mut picture = draw(mesh, None, &camera, width as usize, height as usize);
    // The outlines of the face that is measured from, and of the one that is met.
    let faces = [(Some(found.triangle), [20, 90, 200]), (found.opposite, [230, 120, 0])];
    for (face, colour) in faces {
        let Some(face) = face else { continue };
        let corners = mesh.corners(face as usize).map(|p| picture.place(&camera, p));
        for k in 0..3 {
            picture.line(corners[k], corners[(k + 1) % 3], colour);
        }
    }
    let from = picture.place(&camera, place);
    for ray in &found.rays {
        let Some(length) = ray.length else { continue };
        let to = picture.place(&camera, place + Vec3::from(ray.direction) * length);
        picture.line(from, to, [200, 30, 30]);
    }
    if let Some(ball) = found.ball {
        let centre = picture.place(&camera, place - normal * (0.5 * ball));
        picture.ring(centre, 0.25 * ball * picture.height as f32 / camera.half_height);
    }
    picture.ring(from, 8.0);
    picture
}
