//! One task applies the changes found in one page: it touches no vertex beyond the neighbouring
//! pages.

use std::sync::Arc;

use super::edit::Edit;
use super::operations::{Pass, Queues};
use super::scan::PageScan;
use super::{Cuts, Detail, Within};
use crate::page::Page;

/// The memory of one task, and what came of it.
#[derive(Debug)]
pub(crate) struct TopologyTask {
    pub(crate) edit: Edit,
    pub(crate) cuts: Cuts,
    queues: Queues,
    scan: PageScan,
}

impl TopologyTask {
    pub(crate) fn new() -> TopologyTask {
        let (edit, cuts) = (Edit::default(), Cuts::default());
        TopologyTask { edit, cuts, queues: Queues::default(), scan: PageScan::new() }
    }

    /// Changes the page's edges within the ball, in `budget` of counted work and a little more.
    pub(crate) fn run(
        &mut self,
        pages: &[Arc<Page>],
        (page, ball): (u32, Detail),
        within: Within<'_>,
        budget: usize,
    ) {
        let TopologyTask { edit, cuts, queues, scan } = self;
        edit.clear(pages.len());
        edit.limit.push(page);
        edit.limit.extend(pages[page as usize].topology.neighbours.iter().map(|n| n.page));
        edit.limit.sort_unstable();
        let balls = &[ball];
        scan.page = page;
        scan.scan(&pages[page as usize], balls, within);
        let start = Cuts { work: super::PAGE_SCAN, ..Cuts::default() };
        // Protected vertices stay in place.
        let slides = false;
        let mut pass = Pass { edit, queues, pages, balls, within, slides, cuts: start, budget };
        let all = pass.run(&scan.found);
        *cuts = pass.cuts;
        cuts.unfinished = !all;
    }
}
