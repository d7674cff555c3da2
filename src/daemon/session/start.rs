//! The start of a session: a mesh, or the world at the time when a person joined a shared
//! sculpture.
//!
//! The layout of the file begins every start with a mesh. A world's checkpoint follows a ball of 12
//! vertices that is never shown, so the start's checksum and second copy protect it too.

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
    /// The mesh. If there is a world, a ball that is never shown.
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

    /// Returns the number of vertices of the active object.
    pub fn vertices(&self) -> u64 {
        self.world.as_ref().map_or(self.mesh.positions.len() as u64, |w| w.0)
    }

    /// Encodes the start for the file.
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

    /// Decodes a start from a file of a layout with these numbers of fields.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a valid start.
    pub fn from_bytes(bytes: &[u8], counts: &FieldCounts) -> Result<SessionStart, postcard::Error> {
        let (mesh, rest) = take_from_bytes(bytes, counts)?;
        let world = match rest.split_first_chunk::<8>() {
            Some((vertices, world)) => Some((u64::from_le_bytes(*vertices), world.into())),
            None if rest.is_empty() => None,
            None => return Err(postcard::Error::DeserializeUnexpectedEnd),
        };
        Ok(SessionStart { mesh, world })
    }

    /// Returns the active object's clay before the first tick.
    ///
    /// # Errors
    /// Returns an error if the start is invalid.
    pub fn clay(&self, job: &Job) -> Result<Snapshot, BuildError> {
        match &self.world {
            Some((_, bytes)) => {
                let world = checkpoint::restore(bytes, Workers::new(1));
                world.map(|mut world| world.snapshot()).map_err(|_| BuildError::Stored)
            }
            None => Clay::build(&self.mesh, job).map(|mut clay| clay.snapshot()),
        }
    }

    /// Returns the world before the first tick of the session.
    ///
    /// # Errors
    /// Returns an error if the start is invalid.
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
