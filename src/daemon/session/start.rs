//! What a session begins with: a mesh; or, where a person joined a shared sculpture, the world as
//! it was then.
//!
//! In the file the world's checkpoint lies behind a mesh that stands for nothing, so that all that
//! guards a start guards it too: its sum, and its second copy.

use std::sync::Arc;

use super::format::Settings;
use sculptd_clay::{BuildError, Clay, Snapshot, Workers};
use sculptd_engine::checkpoint;
use sculptd_engine::old_layout::{FieldCounts, take_from_bytes};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

/// A session's start.
#[derive(Debug, Clone)]
pub struct SessionStart {
    /// The mesh; where there is a world, a small one in its place.
    pub mesh: TriMesh,
    /// A world at rest, as [`checkpoint::Captured::to_bytes`] makes it, and its vertices.
    pub world: Option<(u64, Arc<[u8]>)>,
}

impl From<&TriMesh> for SessionStart {
    fn from(mesh: &TriMesh) -> SessionStart {
        SessionStart { mesh: mesh.clone(), world: None }
    }
}

impl SessionStart {
    /// Begins with a world that is at rest. `None`: it is not.
    pub fn of_world(world: &mut World) -> Option<SessionStart> {
        let bytes = checkpoint::Captured::of(world)?.to_bytes();
        let vertices = world.snapshot().vertex_count() as u64;
        let mesh = shapes::sphere_of_about(12);
        Some(SessionStart { mesh, world: Some((vertices, bytes.into())) })
    }

    /// How many vertices the active object has.
    pub fn vertices(&self) -> u64 {
        self.world.as_ref().map_or(self.mesh.positions.len() as u64, |w| w.0)
    }

    /// As it stands in the file.
    ///
    /// # Errors
    /// None that plain data can have.
    pub fn to_bytes(&self) -> Result<Vec<u8>, postcard::Error> {
        let mut out = postcard::to_stdvec(&self.mesh)?;
        if let Some((vertices, world)) = &self.world {
            out.extend_from_slice(&vertices.to_le_bytes());
            out.extend_from_slice(world);
        }
        Ok(out)
    }

    /// What stands in a file of a layout with these numbers of fields.
    ///
    /// # Errors
    /// Where the bytes are not those of a start.
    pub fn from_bytes(bytes: &[u8], counts: &FieldCounts) -> Result<SessionStart, postcard::Error> {
        let (mesh, rest) = take_from_bytes(bytes, counts)?;
        let world = match rest.split_first_chunk::<8>() {
            Some((vertices, world)) => Some((u64::from_le_bytes(*vertices), world.into())),
            None if rest.is_empty() => None,
            None => return Err(postcard::Error::DeserializeUnexpectedEnd),
        };
        Ok(SessionStart { mesh, world })
    }

    /// The active object's clay before the first tick.
    ///
    /// # Errors
    /// Where the start is none.
    pub fn clay(&self, job: &Job) -> Result<Snapshot, BuildError> {
        match &self.world {
            Some((_, bytes)) => {
                let world = checkpoint::restore(bytes, Workers::new(1));
                world.map(|mut world| world.snapshot()).map_err(|_| BuildError::Stored)
            }
            None => Clay::build(&self.mesh, job).map(|mut clay| clay.snapshot()),
        }
    }

    /// The world before the first tick of the session.
    ///
    /// # Errors
    /// Where the start is none.
    pub fn begin(&self, s: &Settings, workers: Workers, job: &Job) -> Result<World, BuildError> {
        if let Some((_, bytes)) = &self.world {
            return checkpoint::restore(bytes, workers).map_err(|_| BuildError::Stored);
        }
        let options =
            WorldOptions { dab_budget: s.dab_budget, undo_bytes: s.undo_bytes, hands: s.hands };
        let mesh = Clay::build(&self.mesh, job)?;
        Ok(World::new(mesh, s.camera, s.brush, workers, options))
    }
}
