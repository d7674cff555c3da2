//! Tracks which people changed the pages of an open step, where several change one clay at once.
//!
//! Simultaneous strokes share one open step, which is split when it is closed. People who changed
//! no page in common get a step each, with the pages that they changed. People who changed a common
//! page own one step together, because their changes in it cannot be separated. So the steps of one
//! closing share no page, and each can be undone without the others. If some of the people
//! continue, only the steps of the others are closed, and the rest stays open.

/// The author of the next changes to the clay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Author {
    /// Changes are not attributed: a clay of one person.
    #[default]
    Nobody,
    /// One of several people.
    Person(u8),
    /// Consequences of several people's changes, as pages that follow a stroke.
    Everybody,
}

/// The bit of pages that belong to all who are in the step.
const EVERYBODY: u32 = 1 << 31;

/// The people of the open step, and what is whose.
#[derive(Debug, Clone, Default)]
pub(super) struct StepAuthors {
    pub(super) now: Author,
    /// By the number of their bit; `None`: the bit is free.
    people: Vec<Option<u8>>,
    /// For each page of the step the people who changed it, as bits.
    marks: Vec<u32>,
}

/// One of the steps that an open step is split into.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct StepPart {
    /// Ascending; empty where nobody is known.
    pub(super) owners: Vec<u8>,
    /// The bits of its pages; 0 and [`EVERYBODY`] are only in a step that is whole.
    bits: u32,
}

impl StepPart {
    /// Returns true if it contains a page with these marks.
    pub(super) fn holds(&self, marks: u32) -> bool {
        self.bits & marks != 0 || self.bits == u32::MAX
    }
}

impl StepAuthors {
    /// Another step is opened.
    pub(super) fn begin(&mut self) {
        self.people.clear();
        self.marks.clear();
    }

    /// Whoever changes the clay now is in the step, whether or not a page follows.
    pub(super) fn join(&mut self) {
        self.bit();
    }

    /// Returns true if changes are attributed to people.
    pub(super) fn is_told(&self) -> bool {
        self.now != Author::Nobody
    }

    /// Returns one of the people of the step.
    pub(super) fn first(&self) -> Option<u8> {
        self.people.iter().flatten().copied().next()
    }

    /// Returns true if `of` holds for all people of the step.
    pub(super) fn all(&self, of: impl Fn(u8) -> bool) -> bool {
        self.people.iter().flatten().all(|p| of(*p))
    }

    /// Some pages left the step, and these marks are those of the others. People who have `ended`
    /// and have no page in it any more are in it no longer.
    pub(super) fn go_on_with(&mut self, marks: Vec<u32>, ended: impl Fn(u8) -> bool) {
        let used = marks.iter().fold(0, |all, m| all | m);
        for (at, person) in self.people.iter_mut().enumerate().take(31) {
            if used & 1 << at == 0 && person.is_some_and(&ended) {
                *person = None;
            }
        }
        self.marks = marks;
    }

    /// Returns true if a person is in the step.
    pub(super) fn holds(&self, person: u8) -> bool {
        self.people.contains(&Some(person))
    }

    fn bit(&mut self) -> u32 {
        let person = match self.now {
            Author::Nobody => return 0,
            Author::Everybody => return EVERYBODY,
            Author::Person(person) => person,
        };
        let place = |of: Option<u8>| self.people.iter().position(|p| *p == of);
        let at = place(Some(person)).or_else(|| place(None)).unwrap_or(self.people.len());
        match self.people.get_mut(at) {
            Some(bit) => *bit = Some(person),
            None => self.people.push(Some(person)),
        }
        if at < 31 { 1 << at } else { EVERYBODY }
    }

    /// The page at this place of the step is changed now.
    pub(super) fn mark(&mut self, place: usize) {
        let bit = self.bit();
        if bit != 0 {
            if self.marks.len() <= place {
                self.marks.resize(place + 1, 0);
            }
            self.marks[place] |= bit;
        }
    }

    /// The marks of the page at this place of the step.
    pub(super) fn marks(&self, place: usize) -> u32 {
        self.marks.get(place).copied().unwrap_or(0)
    }

    /// Splits a step of `pages` pages into parts, in the order of their first owners.
    /// `whole`: its pages cannot be parted.
    pub(super) fn parts(&self, pages: usize, whole: bool) -> Vec<StepPart> {
        let owned = |bits: u32| {
            let has = |at: usize| at >= 31 || bits & 1 << at != 0;
            let of = |(at, p): (usize, &Option<u8>)| p.filter(|_| has(at));
            let mut owners: Vec<u8> = self.people.iter().enumerate().filter_map(of).collect();
            owners.sort_unstable();
            owners
        };
        let mut groups: Vec<u32> = Vec::new();
        let all = (0..pages).map(|place| self.marks(place));
        let several = self.people.iter().flatten().count() > 1;
        let mut joined = whole || !several || self.people.len() > 31;
        for marks in all {
            joined |= marks == 0 || marks & EVERYBODY != 0;
            // Groups that this page brings together become one.
            let mut group = marks;
            groups.retain(|g| {
                let apart = g & marks == 0;
                group |= if apart { 0 } else { *g };
                apart
            });
            groups.push(group);
        }
        if joined || groups.len() < 2 {
            return vec![StepPart { owners: owned(u32::MAX), bits: u32::MAX }];
        }
        let mut parts: Vec<StepPart> =
            groups.into_iter().map(|bits| StepPart { owners: owned(bits), bits }).collect();
        parts.sort_by(|a, b| a.owners.cmp(&b.owners));
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owners(pages: &[&[u8]]) -> Vec<Vec<u8>> {
        let mut authors = StepAuthors::default();
        authors.begin();
        for (place, people) in pages.iter().enumerate() {
            for person in *people {
                authors.now = match person {
                    0 => Author::Everybody,
                    p => Author::Person(*p),
                };
                authors.join();
                authors.mark(place);
            }
        }
        let parts = authors.parts(pages.len(), false);
        for place in 0..pages.len() {
            let held = parts.iter().filter(|p| p.holds(authors.marks(place))).count();
            assert_eq!(held, 1, "page {place} of {parts:?}");
        }
        parts.into_iter().map(|p| p.owners).collect()
    }

    #[test]
    fn people_without_a_common_page_get_a_step_each() {
        assert_eq!(owners(&[&[2], &[1], &[2]]), [vec![1], vec![2]]);
        assert_eq!(owners(&[&[2], &[2, 1], &[3]]), [vec![1, 2], vec![3]]);
        // Two groups are brought together by a page that comes last.
        assert_eq!(owners(&[&[2, 1], &[3, 4], &[4, 1]]), [vec![1, 2, 3, 4]]);
        assert_eq!(owners(&[&[2], &[1], &[0]]), [vec![1, 2]], "a page of everybody");
        assert_eq!(owners(&[&[5]]), [vec![5]]);
    }

    #[test]
    fn a_whole_step_and_one_of_nobody_are_not_parted() {
        let mut authors = StepAuthors::default();
        authors.begin();
        authors.mark(0);
        assert_eq!(authors.parts(1, false).len(), 1);
        assert!(authors.parts(1, false)[0].owners.is_empty());
        for (place, person) in [7, 3].into_iter().enumerate() {
            authors.now = Author::Person(person);
            authors.mark(place);
        }
        let parts = authors.parts(2, true);
        assert_eq!((parts.len(), &*parts[0].owners), (1, &[3, 7][..]));
    }
}
