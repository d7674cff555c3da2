//! An edit of the face sets on its way through the pages of an object, in portions.
//!
//! Laws kept here:
//! * The portion is counted in vertices, including those of pages that are only read, so that a
//!   replay stops at the same page and no portion is larger than its share.
//! * A rejected edit changes nothing: conditions that later pages may violate are checked before
//!   the first page is written.

use std::sync::Arc;

use super::{HIDDEN, MASKED, MOST_SETS, PartEdit, SetsEdit, SetsError};
use crate::clay::Clay;
use crate::page::Page;

/// An edit of the face sets.
#[derive(Debug)]
pub enum SetsTask {
    /// An edit of the whole object.
    Edit(SetsEdit),
    /// An edit of a part that is given vertex by vertex.
    Part(PartEdit),
}

/// An edit that has begun; see [`Clay::begin_sets`].
#[derive(Debug)]
pub struct SetsWork {
    task: SetsTask,
    /// The set that is made or that it is about; 0: none.
    set: u16,
    /// Pages are looked through for what would refuse it; nothing was written yet.
    looking: bool,
    /// The next page; while [`SetsEdit::Assign`] is looked through, the next place in its list.
    next: usize,
    /// The next place in the list of [`SetsEdit::Assign`].
    given: usize,
    /// The set that it is about has been seen.
    found: bool,
    changed: bool,
}

/// The sets of a page's own vertices by `value`, where one differs from what it is.
fn differing(page: &Page, value: impl Fn(usize) -> u16) -> Option<Vec<u16>> {
    let own = 0..page.own();
    let differs = own.clone().any(|v| value(v) != page.set_bits(v));
    differs.then(|| own.map(value).collect())
}

fn has(page: &Page, set: u16) -> bool {
    page.highest_set() >= set && (0..page.own()).any(|v| page.face_set(v) == set)
}

impl SetsWork {
    /// Returns the new sets of a page's owned vertices; `None` keeps the current ones.
    fn page(
        &mut self,
        number: u32,
        page: &Page,
        holds: &dyn Fn(&Page, usize) -> bool,
    ) -> Option<Vec<u16>> {
        let set = self.set;
        let edit = match &self.task {
            SetsTask::Part(edit) => {
                return differing(page, |v| {
                    let now = page.set_bits(v);
                    match edit {
                        PartEdit::NewSet if now & HIDDEN == 0 && holds(page, v) => set,
                        PartEdit::Hide if holds(page, v) => now | HIDDEN,
                        PartEdit::Isolate if !holds(page, v) => now | HIDDEN,
                        _ => now,
                    }
                });
            }
            SetsTask::Edit(edit) => edit,
        };
        let mut assigned = None;
        match edit {
            SetsEdit::Assign { pages, .. } => {
                let next = pages.get(self.given).filter(|p| p.0 == number);
                self.given += usize::from(next.is_some());
                assigned = next.map(|p| &p.1);
            }
            SetsEdit::Hide(_) | SetsEdit::Show(_) => self.found = self.found || has(page, set),
            _ => {}
        }
        differing(page, |v| {
            let now = page.set_bits(v);
            let (of, hidden) = (now & !HIDDEN, now & HIDDEN);
            match edit {
                SetsEdit::FromMask if hidden == 0 && page.mask(v) >= MASKED => set,
                SetsEdit::FromVisible if hidden == 0 => set,
                SetsEdit::Assign { .. } if hidden == 0 => assigned.map_or(now, |a| a[v]),
                SetsEdit::Clear => hidden,
                SetsEdit::Hide(_) if of == set => now | HIDDEN,
                SetsEdit::Show(_) if of == set => of,
                SetsEdit::HideMasked if page.mask(v) >= MASKED => now | HIDDEN,
                SetsEdit::Invert => now ^ HIDDEN,
                SetsEdit::Isolate(_) if of == set => of,
                SetsEdit::Isolate(_) => now | HIDDEN,
                SetsEdit::ShowAll => of,
                _ => now,
            }
        })
    }

    /// Looks through what fits in the budget. `Ok(true)`: nothing refuses the edit.
    fn look(&mut self, clay: &Clay, budget: u64, spent: &mut u64) -> Result<bool, SetsError> {
        let assigned = match &self.task {
            SetsTask::Edit(SetsEdit::Assign { pages, .. }) => Some(pages.clone()),
            _ => None,
        };
        while *spent < budget {
            let (vertices, found) = match &assigned {
                Some(pages) => match pages.get(self.next) {
                    Some((_, sets)) if sets.iter().any(|s| *s > MOST_SETS) => {
                        return Err(SetsError::Full);
                    }
                    Some((_, sets)) => (sets.len(), false),
                    None => (0, true),
                },
                None => {
                    let page = clay.pages.get(self.next).ok_or(SetsError::NoSet(self.set))?;
                    (page.own(), has(page, self.set))
                }
            };
            if found {
                (self.looking, self.next) = (false, 0);
                return Ok(true);
            }
            *spent += 1 + vertices as u64;
            self.next += 1;
        }
        Ok(false)
    }
}

impl Clay {
    /// Begins an edit of the face sets, which [`Clay::run_sets`] then carries out in portions.
    /// Until it is done nothing else may change the clay. Visits each page.
    ///
    /// # Errors
    /// Returns an error if no number is left, or [`SetsError::Changed`].
    pub fn begin_sets(&self, task: SetsTask) -> Result<SetsWork, SetsError> {
        let (mut set, mut looking) = (0, false);
        match &task {
            SetsTask::Edit(SetsEdit::FromMask | SetsEdit::FromVisible)
            | SetsTask::Part(PartEdit::NewSet) => set = self.next_set().ok_or(SetsError::Full)?,
            SetsTask::Edit(SetsEdit::Hide(of) | SetsEdit::Show(of)) => set = *of,
            SetsTask::Edit(SetsEdit::Isolate(of)) => (set, looking) = (*of, true),
            SetsTask::Edit(SetsEdit::Assign { revision, pages }) => {
                let fits = |(p, own): &(u32, Vec<u16>)| {
                    self.pages.get(*p as usize).is_some_and(|page| page.own() == own.len())
                };
                let ascending = pages.windows(2).all(|two| two[0].0 < two[1].0);
                if *revision != self.revision || !ascending || !pages.iter().all(fits) {
                    return Err(SetsError::Changed);
                }
                looking = true;
            }
            SetsTask::Edit(_) | SetsTask::Part(PartEdit::Hide | PartEdit::Isolate) => {}
        }
        Ok(SetsWork { task, set, looking, next: 0, given: 0, found: false, changed: false })
    }

    /// Runs a portion of an edit, as a part of the open undo step, until `budget` is spent or
    /// nothing is left: a vertex costs `cost`. `holds` returns true for the vertices of the part.
    /// Returns `None` if there is more to do, else the set that was made or edited, 0 for none.
    ///
    /// # Errors
    /// Returns an error if there was nothing to do, or no such set. Nothing was changed
    /// then.
    pub fn run_sets(
        &mut self,
        work: &mut SetsWork,
        budget: u64,
        cost: u64,
        holds: &dyn Fn(&Page, usize) -> bool,
    ) -> Option<Result<u16, SetsError>> {
        let mut spent = 0;
        if work.looking {
            match work.look(self, budget, &mut spent) {
                Ok(true) => {}
                Ok(false) => return None,
                Err(e) => return Some(Err(e)),
            }
        }
        let mut changed: Vec<(u32, Vec<u16>)> = Vec::new();
        while spent < budget {
            let number = work.next;
            let Some(page) = self.pages.get(number) else { break };
            spent = spent.saturating_add(1 + cost * page.own() as u64);
            if let Some(sets) = work.page(number as u32, page, holds) {
                changed.push((number as u32, sets));
            }
            work.next += 1;
        }
        if !changed.is_empty() {
            work.changed = true;
            self.put_sets(&changed);
            self.history.sink.discard_owned(changed);
        }
        if work.next < self.pages.len() {
            return None;
        }
        let named = matches!(&work.task, SetsTask::Edit(SetsEdit::Hide(_) | SetsEdit::Show(_)));
        Some(match work.changed {
            _ if named && !work.found => Err(SetsError::NoSet(work.set)),
            false => Err(SetsError::Nothing),
            true => Ok(work.set),
        })
    }

    /// Runs an edit of the face sets at once, as a part of the open undo step: it visits every
    /// vertex. Returns the set that was made or edited; 0 for none.
    ///
    /// # Errors
    /// Returns an error if there is nothing to do, no such set, or no number left. Nothing
    /// is changed then.
    pub fn edit_sets(&mut self, edit: &SetsEdit) -> Result<u16, SetsError> {
        let mut work = self.begin_sets(SetsTask::Edit(edit.clone()))?;
        let done = self.run_sets(&mut work, u64::MAX, 1, &|_, _| false);
        done.unwrap_or(Err(SetsError::Nothing))
    }

    /// Takes what an edit holds off the thread that drops it.
    pub fn discard_sets(&self, work: SetsWork) {
        if let SetsTask::Edit(SetsEdit::Assign { pages, .. }) = work.task
            && Arc::strong_count(&pages) == 1
        {
            self.history.sink.discard_owned(pages);
        }
    }
}
