//! Undo: a step is the list of pages as they were before its first touch of each.

use std::collections::VecDeque;
use std::sync::Arc;

use super::garbage::{Garbage, GarbageSink};
use super::page::Page;
use super::step_authors::StepAuthors;

/// Pages by number, as they were before a step (or, on the redo side, after it).
type Pages = Vec<(u32, Arc<Page>)>;

/// A step that is done, and what its pages weigh: to let it go none of them is looked at.
#[derive(Debug)]
struct Step {
    pages: Pages,
    bytes: u64,
    /// It changed more than the surface of its pages: see [`StepPages::shares`].
    whole: bool,
}

/// The place of a step in the history: 0 is the newest step that can be undone or redone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepPlace {
    /// A step that can be undone.
    Undo(usize),
    /// A step that can be redone.
    Redo(usize),
}

/// The pages that a step changed.
#[derive(Debug, Clone, Default)]
pub struct StepPages {
    whole: bool,
    bits: Vec<u64>,
}

impl StepPages {
    /// Returns true if two steps changed a page in common, halos included: then neither can be
    /// undone without the later one. A step that changed topology or the list of layers shares with
    /// every other.
    pub fn shares(&self, other: &StepPages) -> bool {
        self.whole || other.whole || self.bits.iter().zip(&other.bits).any(|(a, b)| a & b != 0)
    }
}

/// Steps remembered at most, whatever they weigh.
const STEPS: usize = 1024;

#[derive(Debug)]
pub(super) struct History {
    open: Option<Pages>,
    /// The size of the open step's pages, in bytes.
    open_bytes: u64,
    undo: VecDeque<Step>,
    redo: Vec<Step>,
    /// Bytes that all steps together may hold.
    pub(super) limit: u64,
    bytes: u64,
    /// For each page the step that touched it last, and where in the step's list it lies.
    touched: Vec<(u32, u32)>,
    stamp: u32,
    /// Whose the pages of the open step are, where several people change the clay.
    pub(super) authors: StepAuthors,
    /// Takes the steps that are forgotten.
    pub(super) sink: GarbageSink,
}

impl History {
    pub(super) fn new(pages: usize) -> Self {
        History {
            open: None,
            open_bytes: 0,
            undo: VecDeque::with_capacity(STEPS + 1),
            redo: Vec::new(),
            limit: 1 << 30,
            bytes: 0,
            touched: vec![(0, 0); pages],
            stamp: 0,
            authors: StepAuthors::default(),
            sink: GarbageSink::default(),
        }
    }

    /// Takes the open step of another history, as it is: without the steps before it.
    pub(super) fn go_on_as(&mut self, other: &History) {
        self.open.clone_from(&other.open);
        self.open_bytes = other.open_bytes;
        self.touched.clone_from(&other.touched);
        self.stamp = other.stamp;
        self.authors.clone_from(&other.authors);
    }

    /// Makes room for this many pages in the clay.
    pub(super) fn reserve(&mut self, pages: usize) {
        self.touched.reserve(pages.saturating_sub(self.touched.len()));
    }

    pub(super) fn grow(&mut self, pages: usize) {
        self.touched.resize(pages, (0, 0));
    }

    pub(super) fn begin(&mut self) {
        if self.open.is_none() {
            self.open = Some(Vec::with_capacity(1024));
            self.open_bytes = 0;
            self.stamp += 1;
            self.authors.begin();
        }
        self.authors.join();
    }

    /// Keeps the page if the open step has not touched it before; else (or without a step) hands it
    /// back.
    pub(super) fn keep(&mut self, index: u32, page: Arc<Page>) -> Option<Arc<Page>> {
        let Some(step) = &mut self.open else { return Some(page) };
        let touched = &mut self.touched[index as usize];
        if touched.0 == self.stamp {
            self.authors.mark(touched.1 as usize);
            return Some(page);
        }
        *touched = (self.stamp, step.len() as u32);
        self.authors.mark(step.len());
        let weight = page.weight() as u64;
        self.bytes += weight;
        self.open_bytes += weight;
        step.push((index, page));
        None
    }

    /// The page as it was when the open step began, if the step has touched it.
    pub(super) fn before(&self, index: u32) -> Option<&Arc<Page>> {
        let step = self.open.as_ref()?;
        let (stamp, at) = self.touched[index as usize];
        (stamp == self.stamp).then(|| &step[at as usize].1)
    }

    /// Every page that the open step has touched, as it was when it began.
    pub(super) fn each_before(&self, mut visit: impl FnMut(u32, &Page)) {
        self.open.iter().flatten().for_each(|(i, page)| visit(*i, page));
    }

    /// Closes the step. Moves the steps that can no longer be redone, and the oldest steps beyond
    /// the bound, to the garbage sink. Returns true if a step was added.
    pub(super) fn end(&mut self) -> bool {
        let Some(pages) = self.open.take() else { return false };
        if pages.is_empty() {
            return false;
        }
        self.forget_redo();
        self.undo.push_back(Step { pages, bytes: self.open_bytes, whole: false });
        self.trim();
        true
    }

    /// Closes the step of several people, split by [`StepAuthors`]: the parts whose owners have all
    /// `ended`. The rest stays open; nothing stays open if everybody has ended. Returns the owners
    /// of each closed part, in the order of the steps. Steps that can be redone are kept. `whole`
    /// returns true if a page changed by more than its surface.
    pub(super) fn end_of_people(
        &mut self,
        ended: impl Fn(u8) -> bool,
        whole: impl Fn(u32, &Page) -> bool,
    ) -> Vec<Vec<u8>> {
        let all_ended = self.authors.all(&ended);
        let Some(pages) = self.open.take() else { return Vec::new() };
        if pages.is_empty() {
            self.open = (!all_ended).then_some(pages);
            return Vec::new();
        }
        let whole = pages.iter().any(|(i, page)| whole(*i, page));
        let mut parts = self.authors.parts(pages.len(), whole);
        parts.retain(|p| all_ended || !p.owners.is_empty() && p.owners.iter().all(|o| ended(*o)));
        let step = || Step { pages: Vec::new(), bytes: 0, whole };
        let mut steps: Vec<Step> = parts.iter().map(|_| step()).collect();
        let (mut left, mut marks_left) = (Vec::new(), Vec::new());
        for (place, (i, page)) in pages.into_iter().enumerate() {
            let marks = self.authors.marks(place);
            match parts.iter().position(|p| p.holds(marks)) {
                Some(at) => {
                    let bytes = page.weight() as u64;
                    steps[at].bytes += bytes;
                    self.open_bytes -= bytes;
                    self.touched[i as usize] = (0, 0);
                    steps[at].pages.push((i, page));
                }
                None => {
                    self.touched[i as usize] = (self.stamp, left.len() as u32);
                    marks_left.push(marks);
                    left.push((i, page));
                }
            }
        }
        if !all_ended {
            self.authors.go_on_with(marks_left, &ended);
            self.open = Some(left);
        }
        self.undo.extend(steps);
        self.trim();
        parts.into_iter().map(|p| p.owners).collect()
    }

    /// Returns the pages that the open step has changed so far; `None` if there is no step or no
    /// change.
    pub(super) fn open_pages(&self, whole: impl Fn(u32, &Page) -> bool) -> Option<StepPages> {
        let pages = self.open.as_ref().filter(|p| !p.is_empty())?;
        Some(StepPages {
            whole: pages.iter().any(|(i, page)| whole(*i, page)),
            bits: self.bits(pages),
        })
    }

    fn bits(&self, pages: &Pages) -> Vec<u64> {
        let mut bits = vec![0; self.touched.len().div_ceil(64)];
        for (i, _) in pages {
            bits[*i as usize / 64] |= 1 << (i % 64);
        }
        bits
    }

    fn step(&self, place: StepPlace) -> Option<&Step> {
        match place {
            StepPlace::Undo(k) => self.undo.get(self.undo.len().checked_sub(k + 1)?),
            StepPlace::Redo(k) => self.redo.get(self.redo.len().checked_sub(k + 1)?),
        }
    }

    /// Returns the pages that a step changed.
    pub(super) fn pages_of(&self, place: StepPlace) -> Option<StepPages> {
        let step = self.step(place)?;
        Some(StepPages { whole: step.whole, bits: self.bits(&step.pages) })
    }

    /// Makes a step the newest, as if it came after all steps with which it shares no page.
    pub(super) fn raise(&mut self, place: StepPlace) {
        match place {
            StepPlace::Undo(k) if k < self.undo.len() => {
                let step = self.undo.remove(self.undo.len() - 1 - k);
                self.undo.extend(step);
            }
            StepPlace::Redo(k) if k < self.redo.len() => {
                let step = self.redo.remove(self.redo.len() - 1 - k);
                self.redo.push(step);
            }
            StepPlace::Undo(_) | StepPlace::Redo(_) => {}
        }
    }

    /// One step can no longer be done again; the newest is 0.
    pub(super) fn forget_one_redo(&mut self, k: usize) {
        if k < self.redo.len() {
            let gone = self.redo.remove(self.redo.len() - 1 - k);
            self.bytes -= gone.bytes;
            self.sink.discard(Garbage::Pages(gone.pages));
        }
    }

    pub(super) fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Forgets all steps, so that nothing can be undone or redone.
    pub(super) fn forget(&mut self) {
        if let Some(open) = self.open.take() {
            self.sink.discard(Garbage::Pages(open));
        }
        self.forget_redo();
        for gone in self.undo.drain(..) {
            self.sink.discard(Garbage::Pages(gone.pages));
        }
        self.bytes = 0;
    }

    pub(super) fn forget_redo(&mut self) {
        for gone in self.redo.drain(..) {
            self.bytes -= gone.bytes;
            self.sink.discard(Garbage::Pages(gone.pages));
        }
    }

    pub(super) fn trim(&mut self) {
        while (self.bytes > self.limit && !self.undo.is_empty()) || self.undo.len() > STEPS {
            let Some(gone) = self.undo.pop_front() else { break };
            self.bytes -= gone.bytes;
            self.sink.discard(Garbage::Pages(gone.pages));
        }
    }

    /// Discards the oldest step, which can then no longer be undone.
    pub(super) fn forget_oldest(&mut self) {
        if let Some(gone) = self.undo.pop_front() {
            self.bytes -= gone.bytes;
            self.sink.discard(Garbage::Pages(gone.pages));
        }
    }

    /// Swaps the newest step's pages with the clay's through `swap`; false when there is none.
    pub(super) fn undo(&mut self, swap: impl FnMut(u32, Arc<Page>) -> Arc<Page>) -> bool {
        let Some(step) = self.undo.pop_back() else { return false };
        let step = self.swapped(step, swap);
        self.redo.push(step);
        true
    }

    pub(super) fn redo(&mut self, swap: impl FnMut(u32, Arc<Page>) -> Arc<Page>) -> bool {
        let Some(step) = self.redo.pop() else { return false };
        let step = self.swapped(step, swap);
        self.undo.push_back(step);
        true
    }

    fn swapped(&mut self, step: Step, mut swap: impl FnMut(u32, Arc<Page>) -> Arc<Page>) -> Step {
        self.bytes -= step.bytes;
        let mut bytes = 0;
        let swapped = step.pages.into_iter().map(|(i, page)| {
            let page = swap(i, page);
            bytes += page.weight() as u64;
            (i, page)
        });
        let pages = swapped.collect();
        self.bytes += bytes;
        Step { pages, bytes, whole: step.whole }
    }

    pub(super) fn undo_steps(&self) -> usize {
        self.undo.len()
    }

    pub(super) fn redo_steps(&self) -> usize {
        self.redo.len()
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}
