//! Several people at one world: each has their own view and brush.
//!
//! A world of one person has no state of other people and no extra cost. A command of a person
//! arrives as [`Command::OfPerson`], and a device of a person has the person's number in the upper
//! byte of its id. A new person begins with the initial settings of the world. Each person undoes
//! their own steps ([`crate::scene`] keeps them in one timeline). The hands are followed in the
//! view of the person whose tracker sent the last frame.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::World;
use crate::answer::CommandResult;
use crate::camera::Camera;
use crate::command::{Command, OfPerson};
use crate::desktop_layout::DesktopLayout;
use crate::scene::SceneError;
use sculptd_clay::Author;
use sculptd_clay::brush::BrushSettings;
use sculptd_devices::DeviceId;

/// Settings of one person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct PersonSettings {
    person: u8,
    pub(super) brush: BrushSettings,
    kept_brushes: Arc<Vec<BrushSettings>>,
    pub(super) camera: Camera,
    desktop: DesktopLayout,
}

/// All people but the one whose settings are the world's own fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
pub(super) struct People {
    others: Vec<PersonSettings>,
    /// Whose settings are the world's own fields.
    current: u8,
    /// Whose tracker spoke last.
    pub(super) hands: u8,
    /// Whom the world is shown to; no part of what is stepped.
    #[serde(skip)]
    shown: u8,
    /// Whose strokes go on, and whose did in the tick before; a checkpoint ends all.
    #[serde(skip)]
    pub(super) sculpt: Vec<u8>,
    #[serde(skip)]
    pub(super) sculpted: Vec<u8>,
    /// Of the person that the world is shown to: the newest undo or redo that was refused.
    #[serde(skip)]
    refused: Option<UndoRefusal>,
    /// The undo or redo that is being applied was refused.
    #[serde(skip)]
    refusal: bool,
}

/// An undo or redo that was refused, as a step of somebody else is in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UndoRefusal {
    /// Tick of the request.
    pub tick: u64,
    /// It was a redo.
    pub redo: bool,
    /// An owner of the step that is in the way.
    pub by: u8,
}

impl People {
    /// Nobody but the one person that every world has.
    pub(super) fn is_nobody(&self) -> bool {
        self.others.is_empty()
    }

    /// Whose device it is. In a world of one person, that person's.
    pub(super) fn of_device(&self, device: DeviceId) -> u8 {
        if self.is_nobody() { self.current } else { (device.0 >> 8) as u8 }
    }

    /// Returns true if the device belongs to the person whose input is being applied.
    pub(super) fn is_current(&self, device: DeviceId) -> bool {
        self.of_device(device) == self.current
    }

    /// Something was refused to whoever acts now.
    pub(super) fn refuse(&mut self, refusal: UndoRefusal) {
        self.refusal = true;
        if self.current == self.shown {
            self.refused = Some(refusal);
        }
    }

    /// Returns whether an undo or redo was refused since this was asked last.
    pub(super) fn take_refusal(&mut self) -> bool {
        std::mem::take(&mut self.refusal)
    }

    /// The newest that was refused to the person that the world is shown to.
    pub(super) fn refused(&self) -> Option<UndoRefusal> {
        self.refused
    }

    /// The settings of another person than the current one; `None`: of the current one.
    pub(super) fn other(&self, person: u8) -> Option<&PersonSettings> {
        self.others.iter().find(|o| o.person == person)
    }
}

impl World {
    /// Chooses the person that the world is shown to: [`World::camera`], [`World::brush`] and the
    /// pens are that person's. Stepping does not depend on it: a world has several people from the
    /// first [`Command::OfPerson`] on, so that a replay of its input divides the steps among them
    /// too.
    pub fn show_to(&mut self, person: u8) {
        self.people.shown = person;
        if !self.people.is_nobody() {
            self.act_as(person);
        }
    }

    /// The first view of a person who has no settings here yet: all of the active object. `None`:
    /// the person has a view, or the world is of one person.
    pub fn first_view_of(&self, person: u8) -> Option<Camera> {
        let people = &self.people;
        if people.is_nobody() || people.current == person || people.other(person).is_some() {
            return None;
        }
        let mut view = people.other(0).map_or(self.camera, |first| first.camera);
        let (lo, hi) = self.active_bounds()?;
        view.frame(lo, hi);
        Some(view)
    }

    /// Changes the view of the person that the world is shown to, beside the ordered input: of one
    /// who sculpts nothing, or as a command says that comes before any stroke.
    ///
    /// # Errors
    /// As [`Command::Camera`].
    pub fn look_from(&mut self, view: Camera) -> CommandResult {
        self.act_as_shown();
        self.apply_command(&Command::Camera(view))
    }

    /// Returns true if the device belongs to the person that the world is shown to.
    pub(super) fn is_shown(&self, device: DeviceId) -> bool {
        self.people.is_nobody() || self.people.of_device(device) == self.people.shown
    }

    /// Who acts now; `None`: the world is of one person.
    pub(super) fn person(&self) -> Option<u8> {
        (!self.people.is_nobody()).then_some(self.people.current)
    }

    /// Whom the world is shown to; `None`: it is of one person.
    pub(super) fn shown_person(&self) -> Option<u8> {
        (!self.people.is_nobody()).then_some(self.people.shown)
    }

    /// Whose changes of the active object's clay follow: one person's, or `None`: what follows from
    /// what several did. Nothing in a world of one person.
    pub(super) fn author(&mut self, person: Option<u8>) {
        if !self.people.is_nobody() {
            let author = person.map_or(Author::Everybody, Author::Person);
            self.scene.active_mut().clay.set_author(author);
        }
    }

    /// Returns true if several people have shared the world.
    pub fn has_people(&self) -> bool {
        !self.people.is_nobody()
    }

    /// The first person's settings are the only ones: number 1 where people sculpt over a network,
    /// else number 0, whom guests have joined.
    pub(super) fn forget_people(&mut self) {
        if self.people.other(1).is_some() {
            self.act_as(1);
        } else if self.people.current != 1 {
            self.act_as(0);
        }
        self.people = People::default();
        self.timeline.set_person(None);
        self.scene.objects_mut().iter_mut().for_each(|o| o.clay.set_author(Author::Nobody));
    }

    /// A command without a person, in a world of several, is that of number 0.
    pub(super) fn act_for(&mut self, command: &Command) {
        if !self.people.is_nobody() && !matches!(command, Command::OfPerson(_)) {
            self.act_as(0);
            self.timeline.set_person(self.person());
            self.author(self.person());
        }
    }

    /// A command of a person.
    pub(super) fn apply_of_person(&mut self, of: &OfPerson) -> CommandResult {
        if matches!(of.command, Command::OfPerson(_)) {
            return Err(SceneError::Value("a command of one person"));
        }
        self.act_as(of.person);
        self.timeline.set_person(self.person());
        self.author(self.person());
        let answer = self.apply_command(&of.command);
        self.author(None);
        answer
    }

    /// The view and the brush are those of the person who holds hands over the tracker.
    pub(super) fn act_as_hands(&mut self) {
        if !self.people.is_nobody() {
            self.act_as(self.people.hands);
        }
    }

    /// The tracker of this device spoke.
    pub(super) fn hands_of(&mut self, device: DeviceId) {
        self.people.hands = self.people.of_device(device);
    }

    /// After a step, switches to the person that the world is shown to.
    pub(super) fn act_as_shown(&mut self) {
        if !self.people.is_nobody() {
            self.act_as(self.people.shown);
        }
    }

    /// The desktops of all are unknown again.
    pub(super) fn forget_desktops(&mut self) {
        self.desktop = DesktopLayout::default();
        self.people.others.iter_mut().for_each(|o| o.desktop = DesktopLayout::default());
    }

    /// The settings of a person become the world's own fields, for what is applied next.
    pub(super) fn act_as(&mut self, person: u8) {
        if self.people.current == person {
            return;
        }
        let now = PersonSettings {
            person: self.people.current,
            brush: self.brush,
            kept_brushes: self.kept_brushes.clone(),
            camera: self.camera,
            desktop: self.desktop,
        };
        let others = &mut self.people.others;
        let next = match others.iter().position(|o| o.person == person) {
            Some(at) => std::mem::replace(&mut others[at], now),
            None => {
                others.push(now);
                // As the world began: it is the same in every replica.
                let first = others.iter().find(|o| o.person == 0).cloned();
                let first = first.unwrap_or_else(|| others[0].clone());
                PersonSettings { person, ..first }
            }
        };
        self.people.current = person;
        (self.brush, self.kept_brushes) = (next.brush, next.kept_brushes);
        (self.camera, self.desktop) = (next.camera, next.desktop);
    }
}
