//! What a result was computed from, kept until the result is in place.

use std::sync::Arc;

use crate::published::Published;
use crate::scene_jobs::as_operand;
use sculptd_clay::Snapshot;
use sculptd_engine::scene::{ObjectTransform, Operand};
use sculptd_geometry::TriMesh;

/// How the vertices of a result are placed on the surface that it was computed from.
#[derive(Debug)]
pub enum Placing {
    /// At the nearest place: another net over the same surface.
    Nearest,
    /// On vertices and edges: one subdivision of it.
    Finer,
    /// On its first vertices: the level below it.
    Coarser,
    /// On it or on another operand, at the very place. `tool`: a solid that is no object.
    Boolean { tool: Option<TriMesh> },
}

/// The objects that a result was computed from.
#[derive(Debug)]
pub struct Basis {
    /// Each with its clay at that time, and the way from its frame to the result's.
    pub operands: Vec<(Operand, Snapshot, Option<ObjectTransform>)>,
    pub placing: Placing,
}

impl Basis {
    /// Returns the active object; `None` if there is none.
    pub fn of_active(shown: &Published, placing: Placing) -> Option<Basis> {
        let operand = as_operand(shown.scene.active()?, &shown.mesh);
        Some(Basis { operands: vec![(operand, shown.mesh.clone(), None)], placing })
    }

    /// Returns the operands of a Boolean whose result is in the frame of the first of them.
    pub fn of_operands(shown: &Published, all: &[Operand]) -> Option<Basis> {
        let frame = all.first()?.transform;
        let operand = |o: &Operand| {
            let (_, clay) = shown.scene.each(&shown.mesh).find(|(view, _)| view.id == o.id)?;
            let into = (o.transform != frame).then(|| o.transform.then(&frame.inverse()));
            Some((*o, clay.clone(), into))
        };
        let operands = all.iter().map(operand).collect::<Option<Vec<_>>>()?;
        Some(Basis { operands, placing: Placing::Boolean { tool: None } })
    }

    /// Returns the operands as they are now, and their clay; `None` if one of them is gone, has
    /// other triangles or, of a Boolean, stands elsewhere.
    pub fn now(&self, shown: &Published) -> Option<Vec<(Operand, Snapshot)>> {
        let find = |(was, basis, _): &(Operand, Snapshot, Option<ObjectTransform>)| {
            let (object, clay) = shown.scene.each(&shown.mesh).find(|(o, _)| o.id == was.id)?;
            let now = as_operand(object, clay);
            let stays = !matches!(self.placing, Placing::Boolean { .. });
            let same = now.clay == was.clay && (stays || now.transform == was.transform);
            (same && has_same_triangles(basis, clay)).then(|| (now, clay.clone()))
        };
        self.operands.iter().map(find).collect()
    }

    /// Returns true if none of them has changed.
    pub fn is_current(&self, shown: &Published) -> bool {
        let now = self.now(shown);
        let same = |all: Vec<(Operand, Snapshot)>| {
            all.iter().zip(&self.operands).all(|(now, was)| now.0.revision == was.0.revision)
        };
        now.is_some_and(same)
    }
}

/// Returns true if the clay has only been moved, painted and masked between two moments.
fn has_same_triangles(basis: &Snapshot, now: &Snapshot) -> bool {
    let mut same = basis.page_count() == now.page_count();
    if same {
        now.each_changed(basis, |i, page| {
            same &= Arc::ptr_eq(page.topology(), basis.page(i).topology());
        });
    }
    same
}
