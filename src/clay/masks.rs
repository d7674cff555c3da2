//! Masks of the whole clay as plain numbers, for what makes new clay of it.

use std::sync::Arc;

use super::clay::Clay;
use super::page::PageTopology;
use super::snapshot::Snapshot;
use crate::assembly::{BuildError, build};
use sculptd_geometry::flat::TriMesh;
use sculptd_geometry::job::Job;

impl Clay {
    /// As [`Clay::build`], with a mask for each vertex (0 free to 1 protected; one that is missing
    /// or no number is 0).
    ///
    /// # Errors
    /// As [`Clay::build`].
    pub fn build_masked(tri: &TriMesh, masks: &[f32], job: &Job) -> Result<Clay, BuildError> {
        let mut built = build(tri, job)?;
        let topologies: Vec<Arc<PageTopology>> =
            built.pages.iter().map(|p| p.topology.clone()).collect();
        let of = |id: u32| masks.get(id as usize).copied().unwrap_or(0.0).max(0.0).min(1.0);
        for page in &mut built.pages {
            // Nobody else has seen it yet.
            let Some(page) = Arc::get_mut(page) else { continue };
            for (v, row) in page.points.iter_mut().enumerate() {
                let id = match v.checked_sub(page.topology.own) {
                    None => page.topology.ids[v],
                    Some(k) => {
                        let (home, local) = page.topology.halo_home(k);
                        topologies[home as usize].ids[local as usize]
                    }
                };
                row.w = of(id);
            }
        }
        Ok(Clay::of(built, 0))
    }
}

impl Snapshot {
    /// The mask of each vertex, in the order of [`Snapshot::to_tri`]; `None`: all are free.
    pub fn masks(&self) -> Option<Vec<f32>> {
        let free = |p: &Arc<super::Page>| (0..p.own()).all(|v| p.mask(v) == 0.0);
        if self.pages().all(free) {
            return None;
        }
        let ranks = self.ranks();
        let mut out = vec![0.0; self.vertex_count()];
        for page in self.pages() {
            for (v, &id) in page.topology.ids.iter().enumerate() {
                out[ranks.of(id)] = page.mask(v);
            }
        }
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes::icosphere;

    #[test]
    fn masks_come_back_as_they_were_given() {
        let ball = icosphere(1.0, 20);
        let given: Vec<f32> = (0..ball.positions.len()).map(|i| (i % 7) as f32 / 6.0).collect();
        let mut clay = Clay::build_masked(&ball, &given, &Job::default()).expect("clay");
        clay.verify_invariants().expect("sound");
        assert_eq!(clay.snapshot().masks(), Some(given));
        let mut free = Clay::build_masked(&ball, &[0.0, f32::NAN], &Job::default()).expect("clay");
        assert_eq!(free.snapshot().masks(), None);
    }
}
