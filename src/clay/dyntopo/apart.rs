//! Pages that lie apart, changed by several threads at once.
//!
//! Each page's task changes no vertex beyond the pages beside it, and two tasks share none of
//! those: each finds what it would find alone, in whatever order they run. Their edits are put
//! together in the order of the pages, and written as one: the same bits with any number of
//! workers.

use super::LAST_NUMBER;
use crate::Clay;
use crate::retopology::task::TopologyTask;
use crate::retopology::{Cuts, Detail, LEAST_TOPOLOGY_BUDGET, TopologyBuffers, Within};
use crate::workers::Workers;

impl Clay {
    /// The first `most` of these pages, as far as they lie apart: no page is beside two of them, or
    /// is one of them and beside another. Those before in the list go first.
    pub fn pages_apart(&self, pages: impl Iterator<Item = u32>, most: usize) -> Vec<u32> {
        let (mut taken, mut apart) = (Vec::with_capacity(16 * most), Vec::with_capacity(most));
        for page in pages {
            if apart.len() == most {
                break;
            }
            let neighbours = &self.pages[page as usize].topology.neighbours;
            let around = || neighbours.iter().map(|n| n.page).chain([page]);
            if around().all(|p| !taken.contains(&p)) {
                taken.extend(around());
                apart.push(page);
            }
        }
        apart
    }

    /// Brings the triangles of some pages to the target size, as far as they are in the ball beside
    /// each, and those near them; `budget` of counted work for each. The pages must be apart
    /// ([`Clay::pages_apart`]). Bit `i` of the number is set if page `i` was not finished.
    ///
    /// Leaves clay with layers unchanged: layers are stored by vertex.
    pub fn adapt_pages(
        &mut self,
        wanted: &mut [(u32, Detail)],
        within: Within<'_>,
        budget: usize,
        workers: &Workers,
    ) -> (Cuts, u32) {
        let used = self.next_vertex.max(self.next_triangle);
        if used >= LAST_NUMBER || self.layer_count() > 0 || wanted.iter().any(|w| !w.1.is_sane()) {
            return (Cuts::default(), 0);
        }
        self.prepare_topology();
        let Clay { topology, pages, .. } = self;
        let TopologyBuffers { edit, tasks, map, .. } = topology;
        if tasks.len() < wanted.len() {
            tasks.resize_with(wanted.len(), TopologyTask::new);
        }
        // Numbers for new triangles: four a split, two a flip, nine a collapse.
        let budget = budget.min((LAST_NUMBER - used) as usize / 16 / wanted.len().max(1));
        if budget < LEAST_TOPOLOGY_BUDGET {
            return (Cuts::default(), 0);
        }
        workers.each(wanted.len() > 1, wanted, tasks, |&mut wanted, task| {
            task.run(pages, wanted, within, budget);
        });
        edit.clear(pages.len());
        let (mut cuts, mut unfinished) = (Cuts::default(), 0);
        for (at, task) in tasks[..wanted.len()].iter_mut().enumerate() {
            edit.absorb(pages, &mut task.edit, map);
            cuts.splits += task.cuts.splits;
            cuts.collapses += task.cuts.collapses;
            cuts.flips += task.cuts.flips;
            cuts.work += task.cuts.work;
            unfinished |= u32::from(task.cuts.unfinished) << at;
        }
        cuts.unfinished = unfinished != 0;
        if cuts.changes() > 0 && !self.rebuild(workers, &mut cuts) {
            cuts = Cuts { work: cuts.work, tangled: true, ..Cuts::default() };
        }
        (cuts, unfinished)
    }
}
