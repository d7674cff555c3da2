//! Fingers on a touch screen: one is a pointer, several turn the view, and a palm is nobody.
//!
//! Laws kept here:
//! * Nothing is sculpted until it is clear that no second finger comes: a finger waits for
//!   [`HOLD_US`], and what it did meanwhile is then given on with the times at which it was done.
//! * While a pen is near, and for [`AFTER_PEN_US`] after it, every touch is the palm of the hand
//!   that holds it. Where a pen has ever been near, a finger sculpts only by moving: a palm that
//!   lies down before the pen comes leaves nothing.
//! * Time comes in from outside, so the same touches do the same.

use glam::Vec2;

use crate::panels::state::TwoFingers;

/// So long a finger waits for a second one, microseconds: two fingers that mean one gesture land
/// within a few hundredths of a second of each other.
pub(super) const HOLD_US: u64 = 100_000;
/// So long after a pen has left a touch is still its hand's, microseconds.
const AFTER_PEN_US: u64 = 500_000;
/// A touch that is over sooner is a tap, microseconds.
const TAP_US: u64 = 350_000;
/// Fingers of a gesture move the view only after so many points, so that a tap moves nothing.
const SLOP: f32 = 8.0;
/// Distance in points that a finger must move to sculpt if a pen is used. A resting palm creeps by
/// less.
const FAR: f32 = 16.0;
/// Greatest number of touches tracked at once.
const MOST: usize = 16;

/// Phase of a touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchStep {
    Down,
    Moved,
    Up,
    /// The system takes it back: it was no touch.
    Cancelled,
}

/// A touch at a time: microseconds, pixels, and the force 0 to 1 if the screen reports it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    pub id: u64,
    pub t_us: u64,
    pub at: Vec2,
    pub force: Option<f32>,
}

/// Action caused by the fingers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FingerAction {
    /// A finger acts as a pointer: pressed, moved, lifted. Times may be [`HOLD_US`] in the past.
    Press(Contact),
    Drag(Contact),
    Lift(Contact),
    /// The view turns or slides by so many pixels.
    Turn(Vec2),
    Slide(Vec2),
    /// The view comes nearer by a factor about a place, pixels.
    Zoom {
        factor: f32,
        about: Vec2,
    },
    Undo,
    Redo,
}

#[derive(Debug, Clone, Copy)]
struct Finger {
    id: u64,
    began: Contact,
    now: Contact,
    /// It is a palm, or came after the others had begun: it does nothing.
    ignored: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum State {
    #[default]
    Idle,
    /// One finger is down, and a second one may come.
    Waiting,
    /// One finger is a pointer.
    Pointing(u64),
    /// Several turn the view: the middle and the spread that the view was last moved by, once the
    /// fingers have left the place where a tap ends.
    Gesture { most: usize, began_us: u64, moved: bool, last: Option<(usize, Vec2, f32)> },
    /// The action has ended, and some fingers are still down.
    Spent,
}

/// All fingers on the screen.
#[derive(Debug, Default)]
pub struct Fingers {
    down: Vec<Finger>,
    state: State,
    /// Contacts of the first finger while it waited.
    held: Vec<Contact>,
    pen_near: bool,
    /// Time at which a pen was last near; `None`: no pen was seen.
    pen_us: Option<u64>,
    actions: Vec<FingerAction>,
    /// Pixels in a point.
    scale: f32,
    two: TwoFingers,
}

impl Fingers {
    /// Sets the scale of the screen and the person's choice for two fingers.
    pub fn set_up(&mut self, scale: f32, two: TwoFingers) {
        (self.scale, self.two) = (scale, two);
    }

    /// Returns true while a finger is down without a decided action: call [`Fingers::tick`] then.
    pub fn is_waiting(&self) -> bool {
        self.state == State::Waiting
    }

    /// Returns true while a finger is down. The system then moves its pointer along with the first
    /// one: what that says of no finger would tear the finger's stroke, which is told later.
    pub fn is_down(&self) -> bool {
        !self.down.is_empty()
    }

    /// Takes the actions since the last call.
    pub fn take_actions(&mut self) -> Vec<FingerAction> {
        std::mem::take(&mut self.actions)
    }

    /// A pen is over its tablet, or is not.
    pub fn pen(&mut self, t_us: u64, near: bool) {
        let came = near && !self.pen_near;
        self.pen_near = near;
        if near {
            self.pen_us = Some(t_us);
        }
        if came {
            // Every finger that is down is the hand's that holds the pen.
            self.end_pointing();
            self.down.iter_mut().for_each(|f| f.ignored = true);
            self.held.clear();
            self.state = if self.down.is_empty() { State::Idle } else { State::Spent };
        }
    }

    /// A touch of the view. One that began elsewhere is never told, and its id is unknown here.
    pub fn touch(&mut self, step: TouchStep, contact: Contact) {
        match step {
            TouchStep::Down => self.down(contact),
            TouchStep::Moved => self.moved(contact),
            TouchStep::Up | TouchStep::Cancelled => self.up(step, contact),
        }
    }

    /// Time goes by: a finger that has waited long enough is a pointer. To be called when no touch
    /// is left that was not told: while a window draws, a second finger may land unheard.
    pub fn tick(&mut self, t_us: u64) {
        let State::Waiting = self.state else { return };
        let Some(finger) = self.used().next().copied() else { return };
        let waited = t_us.saturating_sub(finger.began.t_us) >= HOLD_US;
        if waited && (self.pen_us.is_none() || self.has_gone_far(&finger)) {
            self.begin_pointing(finger.id);
        }
    }

    fn used(&self) -> impl Iterator<Item = &Finger> {
        self.down.iter().filter(|f| !f.ignored)
    }

    fn has_gone_far(&self, finger: &Finger) -> bool {
        let far = FAR * self.scale;
        self.held.iter().any(|c| c.at.distance(finger.began.at) >= far)
    }

    /// Returns true if a touch that begins now is the palm of a hand with a pen.
    fn is_palm(&self, t_us: u64) -> bool {
        self.pen_near || self.pen_us.is_some_and(|at| t_us.saturating_sub(at) < AFTER_PEN_US)
    }

    fn down(&mut self, contact: Contact) {
        self.down.retain(|f| f.id != contact.id);
        if self.down.len() >= MOST {
            return;
        }
        let busy = matches!(self.state, State::Pointing(_) | State::Spent);
        let ignored = busy || self.is_palm(contact.t_us);
        self.down.push(Finger { id: contact.id, began: contact, now: contact, ignored });
        if ignored {
            return;
        }
        let count = self.used().count();
        match &mut self.state {
            State::Idle => {
                self.state = State::Waiting;
                self.held = vec![contact];
            }
            State::Waiting => {
                let began_us = self.held.first().map_or(contact.t_us, |c| c.t_us);
                self.held.clear();
                self.state = State::Gesture { most: count, began_us, moved: false, last: None };
            }
            State::Gesture { most, last, .. } => {
                *most = count.max(*most);
                // More fingers have another middle.
                *last = None;
            }
            State::Pointing(_) | State::Spent => {}
        }
    }

    fn moved(&mut self, contact: Contact) {
        let Some(finger) = self.down.iter_mut().find(|f| f.id == contact.id) else { return };
        finger.now = contact;
        if finger.ignored {
            return;
        }
        match self.state {
            State::Waiting => self.held.push(contact),
            State::Pointing(id) if id == contact.id => {
                self.actions.push(FingerAction::Drag(contact));
            }
            State::Gesture { .. } => self.gesture(),
            _ => {}
        }
    }

    fn up(&mut self, step: TouchStep, contact: Contact) {
        let Some(at) = self.down.iter().position(|f| f.id == contact.id) else { return };
        let finger = self.down.remove(at);
        let left = self.used().count();
        if !finger.ignored {
            match self.state {
                State::Waiting => {
                    // A short touch is a dab, where no pen says that it may be a palm.
                    self.held.push(contact);
                    let meant = self.pen_us.is_none() || self.has_gone_far(&finger);
                    if step == TouchStep::Up && meant {
                        self.begin_pointing(finger.id);
                        self.actions.push(FingerAction::Lift(contact));
                    }
                    self.held.clear();
                    self.state = State::Idle;
                }
                State::Pointing(id) if id == finger.id => {
                    self.actions.push(FingerAction::Lift(contact));
                    self.state = State::Spent;
                }
                State::Gesture { most, began_us, moved, .. } => {
                    // The fingers of a tap are lifted one after the other.
                    let short = contact.t_us.saturating_sub(began_us) < TAP_US;
                    let tapped = !moved && short && step == TouchStep::Up;
                    match (left, most) {
                        (0, 3) if tapped => self.actions.push(FingerAction::Undo),
                        (0, 4) if tapped => self.actions.push(FingerAction::Redo),
                        _ => {}
                    }
                    if left == 0 || !tapped {
                        self.state = State::Spent;
                    }
                }
                _ => {}
            }
        }
        if self.down.is_empty() {
            self.state = State::Idle;
        }
    }

    fn begin_pointing(&mut self, id: u64) {
        let mut held = std::mem::take(&mut self.held).into_iter();
        if let Some(first) = held.next() {
            self.actions.push(FingerAction::Press(first));
            self.actions.extend(held.map(FingerAction::Drag));
        }
        self.state = State::Pointing(id);
    }

    fn end_pointing(&mut self) {
        if let State::Pointing(id) = self.state
            && let Some(finger) = self.down.iter().find(|f| f.id == id)
        {
            self.actions.push(FingerAction::Lift(finger.now));
        }
    }

    /// Moves the view by the motion of the fingers since the last move.
    fn gesture(&mut self) {
        let places: Vec<Vec2> = self.used().map(|f| f.now.at).collect();
        let begins: Vec<Vec2> = self.used().map(|f| f.began.at).collect();
        let (middle, spread) = middle_and_spread(&places);
        if places.len() < 2 {
            return;
        }
        let State::Gesture { last, moved, .. } = &mut self.state else { return };
        let Some((count, middle_before, spread_before)) = *last else {
            let (first, wide) = middle_and_spread(&begins);
            let slop = SLOP * self.scale;
            if middle.distance(first) >= slop || (spread - wide).abs() >= slop {
                (*last, *moved) = (Some((places.len(), middle, spread)), true);
            }
            return;
        };
        *last = Some((places.len(), middle, spread));
        if count != places.len() {
            return;
        }
        let by = middle - middle_before;
        let turns = (places.len() == 2) == (self.two == TwoFingers::Turn);
        if by != Vec2::ZERO {
            let action = if turns { FingerAction::Turn(by) } else { FingerAction::Slide(by) };
            self.actions.push(action);
        }
        if places.len() == 2 && spread_before > 1.0 && spread > 1.0 && spread != spread_before {
            let factor = spread / spread_before;
            self.actions.push(FingerAction::Zoom { factor, about: middle });
        }
    }
}

/// The mean of some places, and their mean distance from it.
fn middle_and_spread(places: &[Vec2]) -> (Vec2, f32) {
    let count = places.len().max(1) as f32;
    let middle = places.iter().sum::<Vec2>() / count;
    (middle, places.iter().map(|p| p.distance(middle)).sum::<f32>() / count)
}

#[cfg(test)]
mod tests;
