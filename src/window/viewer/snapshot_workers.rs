//! The latest-wins workers that follow the newest snapshot: previews of Booleans, distances,
//! measures, checks. Each runs on a separate thread, started at its first request.

use std::sync::Arc;

use super::check_task::CheckWork;
use super::distance_field::{self, DistanceField, SizesRequest};
use super::latest_wins::LatestWins;
use super::preview;
use super::section_figures::{SectionRequest, SectionWork};
use super::tasks::{TaskReport, Tasks};
use sculptd_geometry::job::Job;

/// Threads for one worker's parallel steps; one core is left to the loop.
fn pool() -> Option<rayon::ThreadPool> {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    rayon::ThreadPoolBuilder::new().num_threads((cores - 1).max(1)).build().ok()
}

#[derive(Debug, Default)]
pub struct SnapshotWorkers {
    preview: Option<LatestWins<preview::PreviewRequest>>,
    field: Option<LatestWins<distance_field::DistanceRequest>>,
    sizes: Option<LatestWins<SizesRequest>>,
    check: Option<LatestWins<CheckWork>>,
    section: Option<LatestWins<SectionRequest>>,
}

impl SnapshotWorkers {
    pub fn preview(&mut self, wanted: preview::PreviewRequest, tasks: &Tasks) {
        let say = tasks.reporter();
        let thread = self.preview.get_or_insert_with(|| {
            LatestWins::start("sculptd-preview", move |wanted: preview::PreviewRequest, job| {
                let done = preview::compute(&wanted, job).map_err(|e| e.to_string());
                job.cancelled()
                    || say.send(TaskReport::Preview(done.map(|p| p.map(Into::into)))).is_ok()
            })
        });
        thread.request(wanted);
    }

    pub fn distances(&mut self, wanted: distance_field::DistanceRequest, tasks: &Tasks) {
        let say = tasks.reporter();
        let thread = self.field.get_or_insert_with(|| {
            let (mut field, pool) = (DistanceField::default(), pool());
            LatestWins::start("sculptd-distance", move |wanted, job| match &pool {
                Some(pool) => pool.install(|| field.follow(wanted, job, &say)),
                None => field.follow(wanted, job, &say),
            })
        });
        thread.request(wanted);
    }

    pub fn sizes(&mut self, wanted: SizesRequest, tasks: &Tasks) {
        let say = tasks.reporter();
        let thread = self.sizes.get_or_insert_with(|| {
            LatestWins::start("sculptd-measure", move |wanted: SizesRequest, job| {
                match distance_field::measure(&wanted, job) {
                    Ok(found) => say.send(TaskReport::Measured(Box::new(found))).is_ok(),
                    Err(_) => true,
                }
            })
        });
        thread.request(wanted);
    }

    pub fn section(&mut self, wanted: SectionRequest, tasks: &Tasks) {
        let say = tasks.reporter();
        let thread = self.section.get_or_insert_with(|| {
            let mut work = SectionWork::default();
            LatestWins::start("sculptd-section", move |wanted: SectionRequest, _| {
                let found = work.section(&wanted);
                found.is_none_or(|found| say.send(TaskReport::Section(found)).is_ok())
            })
        });
        thread.request(wanted);
    }

    /// Returns the job of the check, by which it is watched.
    pub fn check(&mut self, wanted: CheckWork, tasks: &Tasks) -> Arc<Job> {
        let say = tasks.reporter();
        let thread = self.check.get_or_insert_with(|| {
            let pool = pool();
            LatestWins::start("sculptd-check", move |wanted: CheckWork, job| {
                let done = match &pool {
                    Some(pool) => pool.install(|| wanted.run(job)),
                    None => wanted.run(job),
                };
                let Some(done) = done.filter(|_| !job.cancelled()) else { return true };
                say.send(TaskReport::Checked(Box::new((wanted.key, done)))).is_ok()
            })
        });
        thread.request(wanted)
    }

    pub fn no_check(&self) {
        if let Some(thread) = &self.check {
            thread.cancel();
        }
    }

    pub fn no_preview(&self) {
        if let Some(thread) = &self.preview {
            thread.cancel();
        }
    }
}
