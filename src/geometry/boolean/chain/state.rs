//! States of one solid that a caller holds: each Boolean makes another, and the earlier ones stay
//! readable. They share the solid's search trees, so a step from the last one costs what its tool
//! cuts.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{BooleanChain, State, reported};
use crate::PolyMesh;
use crate::boolean::{BooleanError, BooleanOptions, BooleanReport, Operation};
use crate::job::Job;

/// A state of a solid in a chain of Booleans.
#[derive(Debug, Clone)]
pub struct SolidState {
    shared: Arc<Mutex<BooleanChain<'static>>>,
    /// Changes until this state.
    version: usize,
}

impl SolidState {
    /// Begins a chain with a solid. None where it crosses itself: then only a Boolean of the whole
    /// is right.
    ///
    /// # Errors
    /// As [`super::super::compute`] for its operand A.
    pub fn new(
        mesh: &PolyMesh,
        options: BooleanOptions,
        job: &Job,
    ) -> Result<Option<SolidState>, BooleanError> {
        let mut chain = BooleanChain::new(mesh, usize::MAX, options);
        if !chain.keep(job, &mut |_| ())? {
            return Ok(None);
        }
        let Some(chain) = chain.owned() else { return Ok(None) };
        Ok(Some(SolidState { shared: Arc::new(Mutex::new(chain)), version: 0 }))
    }

    /// The state after a union with `tool`, or a difference. None where the step needs the whole:
    /// from a state that is not the last one, and where the surroundings of the tool do not decide.
    ///
    /// # Errors
    /// As [`super::super::compute`] for its operand B.
    pub fn step(
        &self,
        operation: Operation,
        tool: &PolyMesh,
        job: &Job,
    ) -> Result<Option<(SolidState, BooleanReport)>, BooleanError> {
        let mut chain = self.lock();
        let State::Kept(surface) = &chain.state else { return Ok(None) };
        if surface.version() != self.version || surface.mostly_gone() {
            return Ok(None);
        }
        if !chain.step_if_local(operation, tool, None, job, &|| 0.0)?.0 {
            return Ok(None);
        }
        let precision = chain.scale.resolution.precision;
        let contact = std::mem::take(&mut chain.contact);
        let report = std::mem::take(&mut chain.report);
        let report = reported(report, contact, chain.floor, precision);
        Ok(Some((SolidState { shared: self.shared.clone(), version: self.version + 1 }, report)))
    }

    /// The solid as a mesh.
    pub fn mesh(&self) -> PolyMesh {
        match &self.lock().state {
            State::Kept(surface) => surface.mesh_at(self.version).0,
            State::Whole(mesh, ..) => PolyMesh::clone(mesh),
        }
    }

    fn lock(&self) -> MutexGuard<'_, BooleanChain<'static>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
