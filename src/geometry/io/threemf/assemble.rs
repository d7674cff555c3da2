//! The objects of the build list as one mesh. Each mesh that is placed is a group, named by its
//! object, or by the object around it.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::{ParseError, PartName, ThreemfPackage, bad};
use crate::io::face_colours::FaceColours;
use crate::io::gltf::MAX_INSTANCED;
use crate::io::problem::FilePlace;
use crate::io::text::refuse;
use crate::job::Job;
use crate::{FaceAttributes, GroupName, PolyMesh, repair};

/// Objects may hold objects; deeper than this is a circle.
const DEPTH: usize = 32;

pub(super) fn assemble(
    package: &ThreemfPackage,
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let mut out = PolyMesh::new();
    let (mut groups, mut names) = (Vec::new(), Vec::new());
    let unit = DMat4::from_scale(DVec3::splat(package.unit));
    let mut todo: Vec<(&PartName, DMat4, usize, &str)> =
        package.build.iter().rev().map(|(name, t)| (name, unit * *t, 0, "")).collect();
    let (mut visits, mut supports) = (0usize, 0usize);
    let mut colours = FaceColours::default();
    while let Some((name, place, depth, around)) = todo.pop() {
        job.check()?;
        visits += 1;
        let Some(object) = package.objects.get(name) else {
            return Err(bad(
                FilePlace::File,
                format!("an object {} in {}", name.1, name.0),
                "none",
            ));
        };
        if depth > DEPTH || visits > 1_000_000 {
            return Err(bad(
                FilePlace::File,
                "objects within objects, up to 32 deep",
                "a circle or too many",
            ));
        }
        if out.corners.len() + object.mesh.corners.len() > MAX_INSTANCED {
            return Err(bad(
                FilePlace::File,
                format!("at most {MAX_INSTANCED} corners in all objects"),
                "more",
            ));
        }
        if object.support {
            supports += 1;
            continue;
        }
        let base = out.positions.len() as u32;
        for p in &object.mesh.positions {
            let q = place.transform_point3(*p);
            if let Some(found) = q.to_array().into_iter().find_map(refuse) {
                return Err(bad(FilePlace::File, "finite coordinates after the transforms", found));
            }
            out.positions.push(q);
        }
        for (corners, of) in object.mesh.faces().zip(&object.colours) {
            corners.iter().zip(of).for_each(|(v, colour)| colours.add(base + v, *colour));
        }
        let mut part = PolyMesh::new();
        object.mesh.faces().for_each(|f| part.push_face(&[f[0] + base, f[1] + base, f[2] + base]));
        if place.determinant() < 0.0 {
            repair::flip(&mut part);
        }
        part.faces().for_each(|f| out.push_face(f));
        let called = if object.name.is_empty() { around } else { object.name.as_str() };
        if out.face_count() > groups.len() {
            groups.resize(out.face_count(), names.len() as u32);
            names.push(GroupName { object: called.to_owned(), ..GroupName::default() });
        }
        let components = object.components.iter().rev();
        todo.extend(components.map(|(n, t)| (n, place * *t, depth + 1, called)));
    }
    if out.face_count() == 0 {
        let found = match (package.beams, supports) {
            (0, 0) => "none".to_owned(),
            (0, _) => format!("none, but {supports} supports, which are no part"),
            (beams, _) => format!("none, but {beams} beams of a beam lattice, which are not read"),
        };
        return Err(bad(FilePlace::File, "an object with triangles in the build list", found));
    }
    if supports > 0 {
        warnings.push(format!("{supports} supports left out"));
    }
    out.colours = colours.of(out.positions.len(), warnings);
    let named = names.iter().any(|n| *n != GroupName::default());
    out.groups = (named || names.len() > 1).then_some(groups);
    out.attributes =
        named.then(|| Arc::new(FaceAttributes { groups: names, ..FaceAttributes::default() }));
    Ok(out)
}
