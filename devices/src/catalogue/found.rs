//! The result of an identification.

use std::sync::Arc;

use crate::tablet::{Id, Tablet};

/// A model, and which of its `[[id]]` tables matched.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The model's facts.
    pub tablet: Arc<Tablet>,
    /// Index into [`Tablet::id`].
    pub at: usize,
    /// Why this model was chosen, where that is not plain from its ids. For people.
    pub note: Option<String>,
    /// Reports are read by the report descriptor, whose ranges may differ from report to report.
    pub described: bool,
    /// Full pressure in counts as the device's parameter string states it. It outweighs the
    /// descriptor and the model's file.
    pub stated_pressure: Option<u32>,
}

impl Found {
    /// A model by one of its `[[id]]` tables, with nothing to say about the choice.
    pub fn new(tablet: Arc<Tablet>, at: usize) -> Found {
        Found { tablet, at, note: None, described: false, stated_pressure: None }
    }

    /// The `[[id]]` table that matched.
    pub fn id(&self) -> &Id {
        &self.tablet.id[self.at]
    }

    /// Takes the size and the name of a model that is known by another interface of the same
    /// device.
    pub fn sized_like(&mut self, known: &Found) {
        let tablet = Arc::make_mut(&mut self.tablet);
        tablet.name.clone_from(&known.tablet.name);
        tablet.area.width_mm = known.tablet.area.width_mm;
        tablet.area.height_mm = known.tablet.area.height_mm;
        self.stated_pressure = self.stated_pressure.or(known.stated_pressure);
        tablet.pen.max_pressure = tablet.pen.max_pressure.max(known.tablet.pen.max_pressure);
    }

    /// Model, parser and reason, for people.
    pub fn in_words(&self) -> String {
        let why = self.note.as_ref().map_or(String::new(), |n| format!(" ({n})"));
        format!("{}, parser {}{why}", self.tablet.name, self.id().parser.name())
    }
}

/// Result of identifying an interface.
#[derive(Debug, Clone, PartialEq)]
pub enum Identification {
    /// One model.
    Identified(Found),
    /// The interface is left alone; the text says why.
    Declined(String),
    /// Several models match equally well, the likeliest first. The user is asked once.
    Ambiguous(Vec<Found>),
}
