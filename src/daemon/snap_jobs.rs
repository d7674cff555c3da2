//! Placing an object flush on another, on the thread of whoever asks: the flat faces are found in
//! immutable snapshots, and the loop carries the placing out only where neither object has changed
//! meanwhile.

use glam::DVec3;

use sculptd_clay::Snapshot;
use sculptd_engine::scene::{
    FaceAlignment, FlatFace, FlushPlacing, ObjectId, ObjectTransform, ObjectView, Operand,
    SceneError, flush,
};
use sculptd_geometry::TriMesh;
use sculptd_geometry::bvh::nearest_on_triangle;
use sculptd_geometry::flat_region::{FlatRegion, large_faces};

use crate::published::Published;

/// Why an object cannot be placed flush.
#[derive(Debug, thiserror::Error)]
pub enum SnapError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("expected two different objects")]
    Same,
    #[error("object {0} has no face there")]
    NoFace(ObjectId),
    #[error("the faces cannot be laid on each other: expected straight sides to align by")]
    NoSide,
}

/// A face of an object, picked by a point: the one that is nearest to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PickedFace {
    /// The object.
    pub id: ObjectId,
    /// In the world.
    pub at: DVec3,
}

/// Result of a placement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// The command for the loop.
    pub placing: FlushPlacing,
    /// Greatest distance of the two faces' corners from their common plane, in world units: the
    /// error of rounding to single precision.
    pub off: f64,
    /// The areas of the moved face and of the target, in the square of the world's unit.
    pub areas: [f64; 2],
}

struct Found<'a> {
    object: &'a ObjectView,
    clay: &'a Snapshot,
    operand: Operand,
}

fn found(shown: &Published, id: ObjectId) -> Result<Found<'_>, SnapError> {
    let found = shown.scene.each(&shown.mesh).find(|(o, _)| o.id == id);
    let (object, clay) = found.ok_or(SceneError::NoObject(id))?;
    let transform = object.settings.transform;
    let operand = Operand { id, clay: clay.object_id(), revision: clay.revision(), transform };
    Ok(Found { object, clay, operand })
}

/// The triangle that is nearest to a point of the mesh's frame; of several the first.
fn nearest_triangle(mesh: &TriMesh, p: DVec3) -> Option<u32> {
    let mut best = (f64::INFINITY, None);
    for (i, t) in mesh.triangles.iter().enumerate() {
        let corners = t.map(|v| mesh.positions[v as usize].as_dvec3());
        let distance = nearest_on_triangle(p, corners).0.distance_squared(p);
        if distance < best.0 {
            best = (distance, Some(i as u32));
        }
    }
    best.1
}

/// The flat face of an object that is nearest to a point of the world, in the object's frame, and
/// how far its corners lie off its plane, world units.
fn face(of: &Found, at: DVec3) -> Result<(FlatFace, f64, f64), SnapError> {
    let (mesh, transform) = (of.clay.to_tri(), of.operand.transform);
    let near = transform.inverse().apply(at);
    let region = nearest_triangle(&mesh, near).and_then(|t| FlatRegion::around(&mesh, t));
    let region = region.ok_or(SnapError::NoFace(of.operand.id))?;
    let scale = transform.scale;
    Ok((FlatFace::of(&region, near), region.off * scale, region.area * scale * scale))
}

/// The first object is placed so that its face lies flush on that of the second. `spin`: a further
/// turn about the second face's normal, radians.
///
/// # Errors
/// [`SnapError`]
pub fn face_to_face(
    shown: &Published,
    moved: PickedFace,
    target: PickedFace,
    alignment: FaceAlignment,
    spin: f64,
) -> Result<Placed, SnapError> {
    if moved.id == target.id {
        return Err(SnapError::Same);
    }
    let (own, other) = (found(shown, moved.id)?, found(shown, target.id)?);
    if own.object.settings.locked {
        return Err(SceneError::Locked(moved.id).into());
    }
    let (own_face, own_off, own_area) = face(&own, moved.at)?;
    let (other_face, other_off, other_area) = face(&other, target.at)?;
    let there = other_face.placed(&other.operand.transform);
    let transform = flush(&own_face, &own.operand.transform, &there, alignment, spin);
    let transform = transform.ok_or(SnapError::NoSide)?;
    let placing = FlushPlacing { moved: own.operand, target: other.operand, transform };
    Ok(Placed { placing, off: own_off + other_off, areas: [own_area, other_area] })
}

/// Limits within which the face of a released object snaps to the face of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearFace {
    /// From the middle of its face to the plane of the other, and from the middle of one beside the
    /// other, world units.
    pub distance: f64,
    /// Cosine of the greatest angle between the two planes.
    pub cosine: f64,
}

/// Faces of at least this share of their object's area are what hands lay on each other.
const FACE_SHARE: f64 = 0.01;

/// A face in its object's frame, with its measures.
struct Candidate {
    face: FlatFace,
    /// Its triangles.
    corners: Vec<[DVec3; 3]>,
    off: f64,
    area: f64,
}

fn candidates(of: &Found) -> Vec<Candidate> {
    let (mesh, scale) = (of.clay.to_tri(), of.operand.transform.scale);
    let corners =
        |t: &u32| mesh.triangles[*t as usize].map(|v| mesh.positions[v as usize].as_dvec3());
    let candidate = |region: &FlatRegion| Candidate {
        face: FlatFace::of(region, region.middle),
        corners: region.triangles.iter().map(corners).collect(),
        off: region.off * scale,
        area: region.area * scale * scale,
    };
    large_faces(&mesh, FACE_SHARE).iter().map(candidate).collect()
}

/// Returns the distance from `p`, in the plane of a face placed at `at`, to the face, in world
/// units; 0 within the face.
fn beside(face: &Candidate, at: &ObjectTransform, p: DVec3) -> f64 {
    let own = at.inverse().apply(p);
    let distance = |c: &[DVec3; 3]| nearest_on_triangle(own, *c).0.distance_squared(own);
    let least = face.corners.iter().map(distance).fold(f64::INFINITY, f64::min);
    least.sqrt() * at.scale
}

fn boxes_are_near(a: &Found, b: &Found, distance: f64) -> bool {
    let [(alo, ahi), (blo, bhi)] = [a, b].map(|f| f.operand.transform.bounds(f.clay.bounds()));
    let slack = distance as f32;
    (alo - slack).cmple(bhi).all() && (blo - slack).cmple(ahi).all()
}

/// Returns the placement of a held object on the nearest face opposite one of its faces; `None` if
/// no face is near enough.
///
/// # Errors
/// Returns an error if the object does not exist or is locked.
pub fn onto_what_is_near(
    shown: &Published,
    id: ObjectId,
    near: NearFace,
) -> Result<Option<Placed>, SnapError> {
    let own = found(shown, id)?;
    if own.object.settings.locked {
        return Err(SceneError::Locked(id).into());
    }
    let now = own.operand.transform;
    let mine = candidates(&own);
    let mut best: Option<(f64, Placed)> = None;
    for (other, _) in shown.scene.each(&shown.mesh) {
        if other.id == id || !other.settings.visible {
            continue;
        }
        let target = found(shown, other.id)?;
        if !boxes_are_near(&own, &target, near.distance) {
            continue;
        }
        for their in candidates(&target) {
            let there = their.face.placed(&target.operand.transform);
            for own_face in &mine {
                let here = own_face.face.placed(&now);
                let way = here.middle - there.middle;
                let height = way.dot(there.normal);
                if here.normal.dot(there.normal) > -near.cosine || height.abs() > near.distance {
                    continue;
                }
                // The middle of one of the two lies over the other, or not far beside it.
                let foot = here.middle - there.normal * height;
                let head = there.middle + there.normal * height;
                let aside = beside(&their, &target.operand.transform, foot)
                    .min(beside(own_face, &now, head));
                let cost = height.abs() + aside;
                if aside > near.distance || best.as_ref().is_some_and(|(least, _)| *least <= cost) {
                    continue;
                }
                let alignment = FaceAlignment::Nearest;
                if let Some(transform) = flush(&own_face.face, &now, &there, alignment, 0.0) {
                    let placing =
                        FlushPlacing { moved: own.operand, target: target.operand, transform };
                    let areas = [own_face.area, their.area];
                    best = Some((cost, Placed { placing, off: own_face.off + their.off, areas }));
                }
            }
        }
    }
    Ok(best.map(|(_, placed)| placed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::PublishedFigures;
    use crate::scene_jobs::{CombineError, SceneBoolean, boolean};
    use glam::DQuat;
    use sculptd_engine::answer::Answer;
    use sculptd_engine::command::Command;
    use sculptd_engine::scene::{NewObject, ObjectSource, SceneCommand};
    use sculptd_engine::world::World;
    use sculptd_geometry::boolean::Operation;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::measure::measures;
    use sculptd_geometry::{PolyMesh, check, shapes};

    struct Dice(u64);

    impl Dice {
        fn share(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.share(), self.share(), self.share())
        }

        fn transform(&mut self, scale: f64) -> ObjectTransform {
            let axis = self.vector().normalize_or(DVec3::X);
            let turn = DQuat::from_axis_angle(axis, self.share() * 3.1);
            ObjectTransform { shift: self.vector() * 40.0, turn, scale }
        }
    }

    /// A solid, and the middle, the normal and the area of a face of it.
    struct Part {
        mesh: PolyMesh,
        middle: DVec3,
        area: f64,
    }

    fn part(kind: usize) -> Part {
        let (mesh, middle, area) = match kind {
            0 => {
                let half = DVec3::new(3.0, 2.0, 0.5);
                (shapes::cuboid(-half, half), DVec3::new(0.0, 0.0, 0.5), 24.0)
            }
            1 => {
                let area = 32.0 * 0.5 * (std::f64::consts::TAU / 32.0).sin();
                (shapes::cylinder(1.0, 1.5, 32), DVec3::new(0.0, 0.0, 0.75), area)
            }
            2 => {
                let half = DVec3::splat(0.7);
                (shapes::cuboid(-half, half), DVec3::new(-0.7, 0.0, 0.0), 1.96)
            }
            _ => {
                let area = 24.0 * 0.5 * 0.81 * (std::f64::consts::TAU / 24.0).sin();
                (shapes::cone(0.9, 1.2, 24), DVec3::new(0.0, 0.0, f64::NAN), area)
            }
        };
        Part { mesh, middle, area }
    }

    /// A world of two objects, their vertices turned and rounded to single precision in their own
    /// frames, so that no face lies along an axis.
    fn scene(dice: &mut Dice, parts: [&Part; 2], scales: [f64; 2]) -> (World, [PickedFace; 2]) {
        let made = [0, 1].map(|k| {
            let (own, placed) = (dice.transform(1.0), dice.transform(scales[k]));
            let own = ObjectTransform { shift: own.shift * 0.1, ..own };
            let mut mesh = parts[k].mesh.triangulate().0;
            let mut middle = parts[k].middle;
            if middle.z.is_nan() {
                // The base of a cone.
                middle.z = mesh.positions.iter().map(|p| f64::from(p.z)).fold(0.0, f64::min);
            }
            mesh.positions.iter_mut().for_each(|p| *p = own.apply(p.as_dvec3()).as_vec3());
            (mesh, placed, placed.apply(own.apply(middle)))
        });
        let clay = sculptd_clay::Clay::build(&shapes::icosphere(0.01, 1), &Job::default());
        let mut world = crate::startup::world(clay.expect("a ball"), &Default::default());
        let add = |(mesh, placed, _): &(TriMesh, ObjectTransform, DVec3)| {
            let source = ObjectSource::Mesh(std::sync::Arc::new(mesh.clone()));
            Command::Scene(SceneCommand::Add(NewObject::new("part", source, *placed)))
        };
        world.step(1, &[], &[add(&made[0]), add(&made[1])]);
        let ids: Vec<ObjectId> =
            world.answers().iter().filter_map(|a| a.expect("added").object()).collect();
        let picked = [0, 1].map(|k| PickedFace { id: ids[k], at: made[k].2 });
        (world, picked)
    }

    fn published(world: &mut World) -> Published {
        Published::of(world, PublishedFigures::default())
    }

    #[test]
    fn a_thousand_turned_faces_are_in_contact_for_the_booleans() {
        let mut dice = Dice(22);
        for i in 0..1000 {
            let kinds = [[0, 1], [0, 2], [0, 3], [1, 3]][i % 4];
            let parts = kinds.map(part);
            let scales = [1.0, [1.0, 0.8][i / 4 % 2]];
            let (mut world, [target, moved]) = scene(&mut dice, [&parts[0], &parts[1]], scales);
            let alignment = FaceAlignment::Centre;
            let spin = dice.share() * 3.0;
            let before = published(&mut world);
            let placed = face_to_face(&before, moved, target, alignment, spin).expect("faces");
            let contact = parts[1].area * scales[1] * scales[1];
            assert!((placed.areas[0] / contact - 1.0).abs() < 1e-4, "{i}: {:?}", placed.areas);
            assert!((placed.areas[1] / parts[0].area - 1.0).abs() < 1e-4, "{i}");
            let command = SceneCommand::Snap(Box::new(placed.placing));
            world.step(2, &[], &[Command::Scene(command)]);
            assert_eq!(world.answers(), [Ok(Answer::Object(moved.id))], "{i}");

            let shown = published(&mut world);
            let of = |asked: SceneBoolean| {
                boolean(&shown, [target.id, moved.id], asked, &Job::default())
            };
            let facts = |made: &crate::scene_jobs::Combined| {
                let plain = made.clays[0].to_tri();
                let report = check::report(&plain.to_poly(), true, &Job::default());
                (measures(&plain), report.expect("checked"))
            };
            let sizes = [0, 1].map(|k| {
                let m = measures(&parts[k].mesh.triangulate().0);
                (m.volume * scales[k].powi(3), m.area * scales[k].powi(2))
            });
            // The union has no faces within: its area is that of both without the contact twice.
            let union = of(SceneBoolean::new(Operation::Union)).expect("a union");
            let (m, report) = facts(&union);
            let volume = sizes[0].0 + sizes[1].0;
            let area = sizes[0].1 + sizes[1].1 - 2.0 * contact;
            assert!((m.volume / volume - 1.0).abs() < 1e-5, "{i}: {} of {volume}", m.volume);
            assert!((m.area / area - 1.0).abs() < 1e-5, "{i}: {} of {area}", m.area);
            assert!(report.closed && report.manifold && report.oriented, "{i}: {report:?}");
            assert_eq!((report.components, report.self_intersections), (1, Some(0)), "{i}");
            // The intersection is nothing, or with contact the polygon, from both sides.
            let nothing = of(SceneBoolean::new(Operation::Intersection));
            assert!(matches!(nothing, Err(CombineError::Nothing)), "{i}: {nothing:?}");
            let touching =
                SceneBoolean { keep_contact: true, ..SceneBoolean::new(Operation::Intersection) };
            let (m, _) = facts(&of(touching).expect("a polygon"));
            assert!((m.area / (2.0 * contact) - 1.0).abs() < 1e-5, "{i}: {}", m.area);
            assert!(m.volume.abs() < 1e-5 * contact, "{i}: {}", m.volume);
            // The difference is the first part as it was: nothing of the other is left in it.
            let difference = of(SceneBoolean::new(Operation::Difference)).expect("a difference");
            let (m, report) = facts(&difference);
            assert!((m.volume / sizes[0].0 - 1.0).abs() < 1e-5, "{i}: {}", m.volume);
            assert!((m.area / sizes[0].1 - 1.0).abs() < 1e-5, "{i}: {}", m.area);
            assert!(report.closed && report.components == 1, "{i}: {report:?}");
        }
    }
}
