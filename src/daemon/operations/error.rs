//! Reasons that an operation changed nothing.

use crate::command_queue::NoAnswer;
use crate::scene_jobs::CombineError;
use crate::snap_jobs::SnapError;
use sculptd_check::repair::RepairError;
use sculptd_clay::LevelError;
use sculptd_clay::face_sets::{ExtractError, SetsError};
use sculptd_clay::measured_mask::MeasuredMaskError;
use sculptd_engine::scene::SceneError;
use sculptd_geometry::boolean::BooleanError;
use sculptd_geometry::job::Cancelled;
use sculptd_geometry::quads::QuadError;
use sculptd_geometry::remesh::RemeshError;

/// Number of attempts before an operation fails because the sculpture keeps changing.
pub const TRIES: usize = 3;

/// Reason that an operation changed nothing.
#[derive(Debug, thiserror::Error)]
pub enum OperationError {
    #[error("nothing is in the hands")]
    Empty,
    #[error(transparent)]
    Boolean(#[from] BooleanError),
    #[error("this part of the view holds nothing that could be cut off")]
    NoPart,
    #[error(transparent)]
    Level(#[from] LevelError),
    #[error("nothing of the sculpture would be left")]
    Nothing,
    #[error("the result cannot be sculpted: {0}")]
    Build(String),
    #[error(
        "the sculpture changed {TRIES} times while the result was computed. Pause sculpting and \
         try again"
    )]
    Restless,
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error(transparent)]
    Remesh(#[from] RemeshError),
    #[error("voxel = {voxel}: expected {least} to {most}, 1024 to 8 along the longest side")]
    Voxel { voxel: f32, least: f32, most: f32 },
    #[error(transparent)]
    Quads(#[from] QuadError),
    #[error("levels = {0}: expected 0 to 6")]
    QuadLevels(u32),
    #[error("triangles = {0}: expected at least 4, or a max_error")]
    Triangles(usize),
    /// The world refused it.
    #[error(transparent)]
    Refused(#[from] SceneError),
    #[error(transparent)]
    NoAnswer(#[from] NoAnswer),
    #[error(transparent)]
    Combine(#[from] CombineError),
    #[error(transparent)]
    Snap(#[from] SnapError),
    #[error(transparent)]
    FaceSets(#[from] SetsError),
    #[error(transparent)]
    Extract(#[from] ExtractError),
    #[error(transparent)]
    Mask(#[from] MeasuredMaskError),
    #[error(transparent)]
    Repair(#[from] RepairError),
}

impl OperationError {
    /// Returns whether the result was computed from objects that are no longer as they were.
    pub fn is_stale(&self) -> bool {
        matches!(
            self,
            OperationError::Refused(
                SceneError::Stale | SceneError::Changed(_) | SceneError::MaskChanged
            )
        )
    }
}
