//! Computations on whole objects: Booleans between two, merging, splitting, and collecting the
//! objects for a file. They run in the caller's thread on immutable snapshots. The result is a
//! command that the loop carries out only if no operand has changed meanwhile.

use std::sync::Arc;

use glam::DQuat;

use sculptd_clay::layers::{Layer, LayerOffsets, MAX_INTENSITY, MAX_LAYERS};
use sculptd_clay::{Clay, FlatLayers, LayerEdit, Snapshot};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{
    Exchange, LiveBoolean, MAX_NAME, NewObject, ObjectId, ObjectSource, ObjectTransform,
    ObjectView, Operand, Recomputed, SceneCommand, SceneError, SceneEvent, SceneView, clean_name,
};
use sculptd_geometry::boolean::{self, BooleanOptions, Operation};
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::io::{MorphTarget, MorphedMesh, SceneMesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh, repair};

use crate::polygons;
use crate::published::Published;

/// Why no new objects can be made of others.
#[derive(Debug, thiserror::Error)]
pub enum CombineError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Boolean(#[from] boolean::BooleanError),
    #[error("expected two different objects")]
    Same,
    #[error("nothing would be left")]
    Nothing,
    #[error("object {0} is in one piece")]
    OnePiece(ObjectId),
    #[error("the result cannot be sculpted: {0}")]
    Build(String),
    #[error("no object is visible")]
    NoneVisible,
}

/// New objects, and the clay of each.
#[derive(Debug)]
pub struct Combined {
    pub exchange: Exchange,
    pub clays: Vec<Clay>,
    /// The new object follows its operands from now on.
    pub live: Option<LiveBoolean>,
}

impl Combined {
    /// Returns the scene command and the clays that it needs.
    pub fn command(self) -> (SceneCommand, Payload) {
        let command = match self.live {
            Some(live) => SceneCommand::ExchangeLive(Box::new((self.exchange, live))),
            None => SceneCommand::Exchange(self.exchange),
        };
        (command, Payload::Clays(self.clays))
    }
}

/// Selection of objects for a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selection {
    Active,
    Visible,
    All,
    One(ObjectId),
}

/// The layers of an object as morph targets.
fn morphed(clay: &Snapshot) -> Option<MorphedMesh> {
    let FlatLayers { base, layers } = clay.flat_layers()?;
    let target = |(layer, offsets): (Layer, _)| MorphTarget {
        name: layer.name,
        weight: layer.intensity,
        visible: layer.visible,
        offsets,
    };
    Some(MorphedMesh { base, targets: layers.into_iter().map(target).collect() })
}

/// Morph targets that came with a mesh, as layers to be added; `None`: there are none.
pub fn layers_of(targets: &[MorphTarget]) -> Option<LayerEdit> {
    let layer = |t: &MorphTarget| LayerOffsets {
        name: clean_name(&t.name.chars().take(MAX_NAME).collect::<String>())
            .unwrap_or_else(|| "layer".into()),
        intensity: t.weight.clamp(-MAX_INTENSITY, MAX_INTENSITY),
        visible: t.visible,
        offsets: t.offsets.iter().map(|o| (o.0, o.1.to_array())).collect(),
    };
    let layers: Vec<LayerOffsets> = targets.iter().take(MAX_LAYERS).map(layer).collect();
    (!layers.is_empty()).then(|| LayerEdit::Import(Arc::new(layers)))
}

/// Returns the selected objects as meshes with names and transforms.
///
/// # Errors
/// Returns an error if no object is selected.
pub fn selected(
    scene: &SceneView,
    active: &Snapshot,
    which: Selection,
) -> Result<Vec<SceneMesh>, CombineError> {
    let chosen = |(i, (o, _)): &(usize, (&ObjectView, &Snapshot))| match which {
        Selection::Active => *i == scene.active,
        Selection::Visible => o.settings.visible,
        Selection::All => true,
        Selection::One(id) => o.id == id,
    };
    let all: Vec<SceneMesh> = scene
        .each(active)
        .enumerate()
        .filter(chosen)
        .map(|(_, (o, clay))| {
            let ObjectTransform { shift, turn, scale } = o.settings.transform;
            let (name, mesh) = (o.settings.name.clone(), polygons::polygons(&clay.to_tri()));
            SceneMesh { name, mesh, shift, turn, scale, morphed: morphed(clay) }
        })
        .collect();
    match which {
        _ if !all.is_empty() => Ok(all),
        Selection::One(id) => Err(SceneError::NoObject(id).into()),
        _ => Err(CombineError::NoneVisible),
    }
}

/// An object, its clay, and what an [`Exchange`] says of it.
pub(crate) fn operand(
    shown: &Published,
    id: ObjectId,
) -> Result<(&ObjectView, &Snapshot, Operand), CombineError> {
    let found = shown.scene.each(&shown.mesh).find(|(o, _)| o.id == id);
    let (object, clay) = found.ok_or(SceneError::NoObject(id))?;
    if object.settings.locked {
        return Err(SceneError::Locked(id).into());
    }
    Ok((object, clay, as_operand(object, clay)))
}

/// Returns what an [`Exchange`] says of an object.
pub fn as_operand(object: &ObjectView, clay: &Snapshot) -> Operand {
    let transform = object.settings.transform;
    Operand { id: object.id, clay: clay.object_id(), revision: clay.revision(), transform }
}

/// The mesh of an object in the frame of another.
fn seen_from(clay: &Snapshot, own: &ObjectTransform, frame: &ObjectTransform) -> PolyMesh {
    let mut mesh = clay.to_tri().to_poly();
    if own != frame {
        let way = own.then(&frame.inverse());
        mesh.positions.iter_mut().for_each(|p| *p = way.apply(*p));
    }
    mesh
}

pub(crate) fn built(plain: &TriMesh, job: &Job) -> Result<Clay, CombineError> {
    Clay::build(plain, job).map_err(|e| CombineError::Build(e.to_string()))
}

const ALL_FOUR: [Operation; 4] = [
    Operation::Union,
    Operation::Intersection,
    Operation::Difference,
    Operation::ReverseDifference,
];

/// A requested Boolean of two objects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneBoolean {
    /// The Boolean operation.
    pub operation: Operation,
    /// Keeps the operands, hidden.
    pub keep: bool,
    /// Keeps the operands, and recomputes the result when they change.
    pub live: bool,
    /// Computes all four results from one arrangement, the requested one first. None of them is
    /// live.
    pub all: bool,
    /// Includes faces in which the two objects only touch in an intersection.
    pub keep_contact: bool,
    /// World distance within which points count as one; `None`: the resolution of the vertices.
    pub tolerance: Option<f64>,
}

impl SceneBoolean {
    /// The result takes the place of the operands.
    pub fn new(operation: Operation) -> Self {
        SceneBoolean {
            operation,
            keep: false,
            live: false,
            all: false,
            keep_contact: false,
            tolerance: None,
        }
    }
}

/// The tolerance for two meshes of clay of which the second is seen from the frame of the first, in
/// that frame's unit. Its turned coordinates look like double precision, but a face of it was
/// rounded in the frame in which it is kept: contact is recognised only within that rounding.
fn tolerance([a, b]: [&PolyMesh; 2], own: &PolyMesh, ratio: f64) -> f64 {
    const ERRORS: f64 = 8.0;
    let found = boolean::default_tolerance([a, b]).tolerance;
    let kept = boolean::resolution(own);
    let resolved = match kept.precision {
        // Whole numbers and short decimals are exact, and stay so when they are turned.
        boolean::Precision::Double => 0.0,
        _ => ERRORS * kept.error * ratio,
    };
    found.max(resolved)
}

/// Result of a Boolean of two objects, in the frame of the first.
struct ComputedBoolean {
    /// The results that are not empty, each with its operation; at least one.
    results: Vec<(Operation, TriMesh, Clay)>,
    names: [String; 2],
    transform: ObjectTransform,
    operands: [Operand; 2],
}

/// Returns the name of a result if all four are computed.
fn result_name(operation: Operation, [a, b]: &[String; 2]) -> String {
    let name = match operation {
        Operation::Union => format!("{a} + {b}"),
        Operation::Intersection => format!("{a} & {b}"),
        Operation::Difference => format!("{a} - {b}"),
        Operation::ReverseDifference => format!("{b} - {a}"),
    };
    name.chars().take(MAX_NAME).collect()
}

fn compute(
    [(a, a_clay), (b, b_clay)]: [(&ObjectView, &Snapshot); 2],
    asked: SceneBoolean,
    job: &Job,
) -> Result<ComputedBoolean, CombineError> {
    let frame = a.settings.transform;
    let first = seen_from(a_clay, &frame, &frame);
    let second = seen_from(b_clay, &b.settings.transform, &frame);
    let ratio = b.settings.transform.scale / frame.scale;
    let tolerance = match asked.tolerance {
        Some(length) => length / frame.scale,
        None => tolerance([&first, &second], &b_clay.to_tri().to_poly(), ratio),
    };
    let options = BooleanOptions {
        tolerance: Some(tolerance),
        keep_contact: asked.keep_contact,
        ..BooleanOptions::default()
    };
    let mut operations = vec![asked.operation];
    if asked.all {
        operations.extend(ALL_FOUR.into_iter().filter(|o| *o != asked.operation));
    }
    let (solids, report) = boolean::compute([&first, &second], &operations, &options, job, || 0.0)?;
    report.warnings.iter().for_each(|w| tracing::warn!("Boolean of two objects: {w}"));
    let mut results = Vec::with_capacity(operations.len());
    for operation in operations {
        let solid = solids.iter().find(|s| s.operation == operation);
        let Some(solid) = solid.filter(|s| s.mesh.face_count() > 0) else { continue };
        let plain = solid.mesh.triangulate().0;
        let clay = built(&plain, job)?;
        results.push((operation, plain, clay));
    }
    if results.is_empty() {
        return Err(CombineError::Nothing);
    }
    let operands = [as_operand(a, a_clay), as_operand(b, b_clay)];
    let names = [a, b].map(|o| o.settings.name.clone());
    Ok(ComputedBoolean { results, names, transform: frame, operands })
}

/// A Boolean of two objects where they stand. The result stands where the first does.
///
/// # Errors
/// [`CombineError`]
pub fn boolean(
    shown: &Published,
    ids: [ObjectId; 2],
    asked: SceneBoolean,
    job: &Job,
) -> Result<Combined, CombineError> {
    if ids[0] == ids[1] {
        return Err(CombineError::Same);
    }
    let (a, a_clay, _) = operand(shown, ids[0])?;
    let (b, b_clay, _) = operand(shown, ids[1])?;
    let ComputedBoolean { results, names, transform, operands } =
        compute([(a, a_clay), (b, b_clay)], asked, job)?;
    let (mut add, mut clays) = (Vec::new(), Vec::new());
    for (operation, plain, clay) in results {
        let name = if asked.all { result_name(operation, &names) } else { names[0].clone() };
        add.push(NewObject::new(&name, ObjectSource::Mesh(Arc::new(plain)), transform));
        clays.push(clay);
    }
    let keep = asked.keep || asked.live;
    let (remove, hide) = if keep { (Vec::new(), ids.to_vec()) } else { (ids.to_vec(), Vec::new()) };
    let event = SceneEvent::Boolean;
    let exchange = Exchange { event, from: operands.to_vec(), remove, hide, add };
    let live = (asked.live && !asked.all).then_some(LiveBoolean {
        operation: asked.operation,
        operands,
        keep_contact: asked.keep_contact,
        tolerance: asked.tolerance,
        result: 0,
    });
    Ok(Combined { exchange, clays, live })
}

/// Returns the live Boolean results whose operands have changed, with the current operands.
pub fn stale(shown: &Published) -> Vec<(ObjectId, [Operand; 2])> {
    let all = || shown.scene.each(&shown.mesh);
    let now = |was: &Operand| {
        let (object, clay) = all().find(|(o, _)| o.id == was.id)?;
        Some(as_operand(object, clay))
    };
    let stale = |(object, clay): (&ObjectView, &Snapshot)| {
        let live = object.live(clay)?;
        let [a, b] = &live.operands;
        let found = [now(a)?, now(b)?];
        (found != live.operands).then_some((object.id, found))
    };
    all().filter_map(stale).collect()
}

/// The result of a live Boolean of what its operands are now.
///
/// # Errors
/// [`CombineError`]
pub fn recompute(
    shown: &Published,
    id: ObjectId,
    job: &Job,
) -> Result<(Recomputed, Clay), CombineError> {
    let find = |id: ObjectId| {
        let found = shown.scene.each(&shown.mesh).find(|(o, _)| o.id == id);
        found.ok_or(SceneError::NoObject(id))
    };
    let (object, clay) = find(id)?;
    let live = object.live(clay).ok_or(SceneError::NotLive(id))?.clone();
    let [a, b] = [find(live.operands[0].id)?, find(live.operands[1].id)?];
    let asked = SceneBoolean {
        operation: live.operation,
        keep: true,
        live: true,
        all: false,
        keep_contact: live.keep_contact,
        tolerance: live.tolerance,
    };
    let mut made = compute([a, b], asked, job)?;
    let (_, plain, clay) = made.results.pop().ok_or(CombineError::Nothing)?;
    let source = ObjectSource::Mesh(Arc::new(plain));
    let new = NewObject::new(&object.settings.name, source, made.transform);
    let live = LiveBoolean { operands: made.operands, ..live };
    Ok((Recomputed { id, live, new }, clay))
}

/// An object mirrored in a plane through the origin of the world, 0 of x, 1 of y, 2 of z: a new
/// object behind the others. Each coordinate keeps its digits, and the faces of a file theirs.
///
/// # Errors
/// [`CombineError`]
pub fn mirror(
    shown: &Published,
    id: ObjectId,
    axis: usize,
    job: &Job,
) -> Result<Combined, CombineError> {
    let (object, clay, of) = operand(shown, id)?;
    let mut mesh = polygons::polygons(&clay.to_tri());
    mesh.positions.iter_mut().for_each(|p| p[axis] = -p[axis]);
    repair::flip(&mut mesh);
    let plain = mesh.triangulate().0;
    polygons::remember(mesh, &plain);
    let clay = built(&plain, job)?;
    // Mirrored in the world and in its own frame again, it is turned and not mirrored.
    let ObjectTransform { mut shift, turn, scale } = object.settings.transform;
    shift[axis] = -shift[axis];
    let [x, y, z, w] = turn.to_array();
    let mut vector = [-x, -y, -z];
    vector[axis] = -vector[axis];
    let turn = DQuat::from_array([vector[0], vector[1], vector[2], w]);
    let transform = ObjectTransform { shift, turn, scale };
    let name: String =
        format!("{} mirrored", object.settings.name).chars().take(MAX_NAME).collect();
    let new = NewObject::new(&name, ObjectSource::Mesh(Arc::new(plain)), transform);
    let event = SceneEvent::Mirror;
    let exchange =
        Exchange { event, from: vec![of], remove: Vec::new(), hide: Vec::new(), add: vec![new] };
    Ok(Combined { exchange, clays: vec![clay], live: None })
}

/// Several objects as one, in the frame of the first.
///
/// # Errors
/// [`CombineError`]
pub fn merge(shown: &Published, ids: &[ObjectId], job: &Job) -> Result<Combined, CombineError> {
    let mut remove = ids.to_vec();
    remove.sort_unstable();
    remove.dedup();
    if ids.len() < 2 || remove.len() != ids.len() {
        return Err(CombineError::Same);
    }
    let (first, _, _) = operand(shown, ids[0])?;
    let frame = first.settings.transform;
    let mut from = Vec::with_capacity(ids.len());
    let mut plain = TriMesh::default();
    let mut colours = Vec::new();
    for id in ids {
        let (object, clay, of) = operand(shown, *id)?;
        from.push(of);
        let part = clay.to_tri();
        let (offset, way) =
            (plain.positions.len() as u32, object.settings.transform.then(&frame.inverse()));
        let stays = object.settings.transform == frame;
        let place = |p: &glam::Vec3| if stays { *p } else { way.point(*p) };
        plain.positions.extend(part.positions.iter().map(place));
        plain.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + offset)));
        match part.colours {
            Some(own) => {
                colours.resize(offset as usize, [255; 4]);
                colours.extend(own);
            }
            None if !colours.is_empty() => colours.resize(plain.positions.len(), [255; 4]),
            None => {}
        }
    }
    plain.colours = (!colours.is_empty()).then_some(colours);
    let clay = built(&plain, job)?;
    let new = NewObject::new(&first.settings.name, ObjectSource::Mesh(Arc::new(plain)), frame);
    let event = SceneEvent::Merge;
    let exchange = Exchange { event, from, remove, hide: Vec::new(), add: vec![new] };
    Ok(Combined { exchange, clays: vec![clay], live: None })
}

/// Splits each connected part of an object into a separate object, the largest first.
///
/// # Errors
/// [`CombineError`]
pub fn split(shown: &Published, id: ObjectId, job: &Job) -> Result<Combined, CombineError> {
    let (object, clay, of) = operand(shown, id)?;
    let parts = components(&clay.to_tri());
    if parts.len() < 2 {
        return Err(CombineError::OnePiece(id));
    }
    let (name, transform) = (&object.settings.name, object.settings.transform);
    let mut clays = Vec::with_capacity(parts.len());
    let mut add = Vec::with_capacity(parts.len());
    for (k, part) in parts.into_iter().enumerate() {
        clays.push(built(&part, job)?);
        let source = ObjectSource::Mesh(Arc::new(part));
        add.push(NewObject::new(&format!("{name} {}", k + 1), source, transform));
    }
    let event = SceneEvent::Split;
    let exchange = Exchange { event, from: vec![of], remove: vec![id], hide: Vec::new(), add };
    Ok(Combined { exchange, clays, live: None })
}

/// The connected parts of a mesh, by shared vertices: the one of most triangles first, ties in the
/// order of their first triangle.
fn components(mesh: &TriMesh) -> Vec<TriMesh> {
    let mut sets = DisjointSets::new(mesh.positions.len());
    for t in &mesh.triangles {
        sets.join(t[0], t[1]);
        sets.join(t[0], t[2]);
    }
    let mut part_of = vec![u32::MAX; mesh.positions.len()];
    let mut place = vec![u32::MAX; mesh.positions.len()];
    let mut parts: Vec<TriMesh> = Vec::new();
    for t in &mesh.triangles {
        let root = sets.root(t[0]) as usize;
        if part_of[root] == u32::MAX {
            part_of[root] = parts.len() as u32;
            let colours = mesh.colours.as_ref().map(|_| Vec::new());
            parts.push(TriMesh { colours, ..TriMesh::default() });
        }
        let part = &mut parts[part_of[root] as usize];
        let corners = t.map(|v| {
            if place[v as usize] == u32::MAX {
                place[v as usize] = part.positions.len() as u32;
                part.positions.push(mesh.positions[v as usize]);
                if let (Some(to), Some(from)) = (&mut part.colours, &mesh.colours) {
                    to.push(from[v as usize]);
                }
            }
            place[v as usize]
        });
        part.triangles.push(corners);
    }
    parts.sort_by_key(|p| std::cmp::Reverse(p.triangles.len()));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes;

    #[test]
    fn parts_are_what_hangs_together_the_largest_first() {
        let (small, large) = (shapes::icosphere(1.0, 2), shapes::icosphere(1.0, 4));
        let mut both = small.clone();
        let offset = both.positions.len() as u32;
        both.positions.extend(large.positions.iter().map(|p| *p + glam::Vec3::X * 5.0));
        both.triangles.extend(large.triangles.iter().map(|t| t.map(|v| v + offset)));
        let parts = components(&both);
        let sizes: Vec<_> = parts.iter().map(|p| (p.positions.len(), p.triangles.len())).collect();
        let of = |m: &TriMesh| (m.positions.len(), m.triangles.len());
        assert_eq!(sizes, [of(&large), of(&small)]);
        assert_eq!(parts[1].bounds(), small.bounds());
    }
}
