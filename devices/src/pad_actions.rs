//! Actions of the keys, wheels, rings, strips, barrel buttons and the eraser of a tablet.
//!
//! Three steps lead from a state to an action, each plain data and each usable alone:
//!
//! 1. [`ControlEdges`] compares consecutive [`Pad`] and [`Pen`] states and reports each change as a
//!    [`ControlEvent`].
//! 2. An [`ActionTable`] assigns a [`Binding`] to each [`Control`]. It is read from the `[actions]`
//!    table of a model's TOML file; missing entries come from [`ActionTable::defaults`].
//! 3. [`ActionState`] applies the table to the events, with the modes of the pad, and gives
//!    [`ActionEvent`]s: an action is pressed, is released, or a value is turned.
//!
//! The names of actions are strings, because this crate knows no program: the consumer resolves
//! them and reports the unknown ones.
//!
//! ```
//! use sculptd_devices::pad_actions::{ActionEvent, ActionState, ActionTable};
//! use sculptd_devices::Pad;
//!
//! let own: ActionTable = toml::from_str(r#"
//!     [controls]
//!     key-1 = { press = "undo" }
//!     key-2 = { hold = "view.turn" }
//!     wheel-1 = { turn = { value = "brush.radius", step = 0.05 } }
//! "#)?;
//! let mut state = ActionState::new(own.with_defaults(), Default::default());
//! let mut events = Vec::new();
//! state.pad(&Pad { keys: 0b10, ..Pad::default() }, &mut |e| events.push(e));
//! state.pad(&Pad { wheels: [2, 0], ..Pad::default() }, &mut |e| events.push(e));
//! assert_eq!(events, [
//!     ActionEvent::Pressed { action: "view.turn".to_owned(), held: true },
//!     ActionEvent::Released { action: "view.turn".to_owned() },
//!     ActionEvent::Turned { value: "brush.radius".to_owned(), amount: 0.1 },
//! ]);
//! # Ok::<(), toml::de::Error>(())
//! ```

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::sample::{Pad, Pen, Tool};

/// Steps in one turn of a touch ring: 15 degrees each, as libinput's wheel emulation has it.
const RING_STEPS: f32 = 24.0;
/// Steps over the whole length of a touch strip. Wacom's strips have 13 places.
const STRIP_STEPS: f32 = 12.0;
/// Keys of a pad, wheels and strips, and barrel buttons that a state can hold.
const LIMITS: [(&str, u8); 5] =
    [("key", 32), ("barrel", 32), ("wheel", 2), ("ring", 2), ("strip", 2)];

/// One thing on a tablet or its pen that a hand works. Numbers count from 1, as people do; in TOML
/// `key-1`, `barrel-2`, `wheel-1`, `ring-1`, `strip-2`, `eraser`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Control {
    /// A key of the pad, 1 to 32: bit `n - 1` of [`Pad::keys`].
    Key(u8),
    /// A button on the pen's barrel, 1 to 32, the lower one first: bit `n - 1` of [`Pen::buttons`].
    Barrel(u8),
    /// A wheel or dial that turns without end, 1 or 2: [`Pad::wheels`].
    Wheel(u8),
    /// A touch ring, 1 or 2: an entry of [`Pad::strips`] that is circular.
    Ring(u8),
    /// A touch strip, 1 or 2: an entry of [`Pad::strips`] with two ends.
    Strip(u8),
    /// The pen is turned over. Pressed while its eraser is in range.
    Eraser,
}

/// A text that names no control.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}`: expected `eraser`, or `key-N`, `barrel-N`, `wheel-N`, `ring-N` or `strip-N`")]
pub struct ControlError(String);

impl fmt::Display for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Control::Key(n) => write!(f, "key-{n}"),
            Control::Barrel(n) => write!(f, "barrel-{n}"),
            Control::Wheel(n) => write!(f, "wheel-{n}"),
            Control::Ring(n) => write!(f, "ring-{n}"),
            Control::Strip(n) => write!(f, "strip-{n}"),
            Control::Eraser => f.write_str("eraser"),
        }
    }
}

impl FromStr for Control {
    type Err = ControlError;

    fn from_str(text: &str) -> Result<Self, ControlError> {
        if text == "eraser" {
            return Ok(Control::Eraser);
        }
        let fail = || ControlError(text.to_owned());
        let (kind, n) = text.split_once('-').ok_or_else(fail)?;
        let n: u8 = n.parse().map_err(|_| fail())?;
        let (_, most) = LIMITS.iter().find(|(k, _)| *k == kind).ok_or_else(fail)?;
        if n == 0 || n > *most {
            return Err(fail());
        }
        Ok(match kind {
            "key" => Control::Key(n),
            "barrel" => Control::Barrel(n),
            "wheel" => Control::Wheel(n),
            "ring" => Control::Ring(n),
            _ => Control::Strip(n),
        })
    }
}

impl Serialize for Control {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Control {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// Action of a control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Binding {
    /// The action happens once, when the control is pressed.
    Press(String),
    /// The action lasts for as long as the control is held.
    Hold(String),
    /// The value changes by `step` for each step that the control is turned. A key or button turns
    /// one step each time that it is pressed.
    Turn {
        /// Name of the value.
        value: String,
        /// Change for one step clockwise, toward the user's right, or toward larger counts. The
        /// unit is the value's. Negative turns the direction round.
        step: f32,
    },
    /// The pad goes to its next mode. After the last one comes the first.
    NextMode,
    /// Nothing: a default is taken away.
    Nothing,
}

/// Actions of each control of one tablet.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ActionTable {
    /// Bindings of every mode.
    pub controls: BTreeMap<Control, Binding>,
    /// Bindings that differ in each mode, the first mode first. Empty: the pad has one mode. A mode
    /// corresponds to a mode of a libinput mode group; the consumer sets the LED if there is one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<BTreeMap<Control, Binding>>,
}

impl ActionTable {
    /// Returns the default bindings, for controls that neither the tablet's file nor the user sets.
    pub fn defaults() -> ActionTable {
        let press = |name: &str| Binding::Press(name.to_owned());
        let hold = |name: &str| Binding::Hold(name.to_owned());
        let turn = |name: &str, step| Binding::Turn { value: name.to_owned(), step };
        let controls = BTreeMap::from([
            (Control::Barrel(1), hold("view.turn")),
            (Control::Barrel(2), hold("brush.radius-and-strength")),
            (Control::Key(1), press("undo")),
            (Control::Key(2), press("redo")),
            (Control::Key(3), hold("brush.invert")),
            (Control::Key(4), hold("brush.smooth")),
            (Control::Key(5), hold("view.slide")),
            (Control::Key(6), press("view.fit")),
            (Control::Wheel(1), turn("brush.radius", 0.05)),
            (Control::Wheel(2), turn("brush.strength", 0.05)),
            (Control::Ring(1), turn("brush.radius", 0.05)),
            (Control::Ring(2), turn("brush.strength", 0.05)),
            (Control::Strip(1), turn("brush.radius", 0.05)),
            (Control::Strip(2), turn("brush.strength", 0.05)),
        ]);
        ActionTable { controls, modes: Vec::new() }
    }

    /// This table over the defaults.
    pub fn with_defaults(self) -> ActionTable {
        self.over(ActionTable::defaults())
    }

    /// This table over another: what it names wins, what it does not name stays.
    pub fn over(self, mut below: ActionTable) -> ActionTable {
        below.controls.extend(self.controls);
        if !self.modes.is_empty() {
            below.modes = self.modes;
        }
        below
    }

    /// Returns the binding of a control in a mode; `None` if it does nothing.
    pub fn binding(&self, control: Control, mode: usize) -> Option<&Binding> {
        let own = self.modes.get(mode).and_then(|m| m.get(&control));
        own.or_else(|| self.controls.get(&control)).filter(|b| **b != Binding::Nothing)
    }

    /// Checks that the figures and names are valid.
    ///
    /// # Errors
    /// An empty name or a step that is not finite; the text names the control.
    pub fn check(&self) -> Result<(), String> {
        let all = self.controls.iter().chain(self.modes.iter().flatten());
        for (control, binding) in all {
            match binding {
                Binding::Press(name) | Binding::Hold(name) | Binding::Turn { value: name, .. }
                    if name.is_empty() =>
                {
                    return Err(format!("actions: {control}: the name is empty"));
                }
                Binding::Turn { step, .. } if !step.is_finite() => {
                    return Err(format!("actions: {control}: step = {step}: expected a number"));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Shape of an entry of [`Pad::strips`]: with or without ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TouchShape {
    /// Circular: 0 and 1 are the same place.
    Ring,
    /// From one end to the other.
    #[default]
    Strip,
}

/// A change of one control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControlEvent {
    /// It went down.
    Pressed(Control),
    /// It went up, or its device left.
    Released(Control),
    /// It turned by so many steps, clockwise positive. Never 0.
    Turned(Control, i32),
}

/// Finds what changed between consecutive states of one tablet.
#[derive(Debug, Clone, Default)]
pub struct ControlEdges {
    shapes: [TouchShape; 2],
    pad: Pad,
    buttons: u32,
    eraser: bool,
    /// Remainder of a finger's movement, in steps, after the reported whole steps.
    rest: [f32; 2],
}

impl ControlEdges {
    /// Begins with nothing pressed and every wheel at 0, as a device does that was just plugged in.
    pub fn new(shapes: [TouchShape; 2]) -> Self {
        ControlEdges { shapes, ..ControlEdges::default() }
    }

    /// Takes the pad's next state and tells every change: releases first, then presses, then turns.
    pub fn pad(&mut self, now: &Pad, emit: &mut dyn FnMut(ControlEvent)) {
        edges(self.pad.keys, now.keys, Control::Key, emit);
        for i in 0..now.wheels.len() {
            let steps = now.wheels[i].wrapping_sub(self.pad.wheels[i]);
            if steps != 0 {
                emit(ControlEvent::Turned(Control::Wheel(i as u8 + 1), steps));
            }
        }
        for i in 0..now.strips.len() {
            let steps = self.slid(i, now.strips[i]);
            let n = i as u8 + 1;
            let control = match self.shapes[i] {
                TouchShape::Ring => Control::Ring(n),
                TouchShape::Strip => Control::Strip(n),
            };
            if steps != 0 {
                emit(ControlEvent::Turned(control, steps));
            }
        }
        self.pad = *now;
    }

    /// Takes the pen's next state and tells every change of its buttons and its eraser.
    pub fn pen(&mut self, now: &Pen, emit: &mut dyn FnMut(ControlEvent)) {
        // A pen that left holds nothing, whatever its last report said.
        let buttons = if now.in_range { now.buttons } else { 0 };
        edges(self.buttons, buttons, Control::Barrel, emit);
        self.buttons = buttons;
        let eraser = now.in_range && now.tool == Tool::Eraser;
        if eraser != self.eraser {
            self.eraser = eraser;
            emit(match eraser {
                true => ControlEvent::Pressed(Control::Eraser),
                false => ControlEvent::Released(Control::Eraser),
            });
        }
    }

    /// Whole steps that a finger went since the last state. The place where it comes down is no
    /// movement.
    fn slid(&mut self, i: usize, now: Option<f32>) -> i32 {
        let (Some(from), Some(to)) = (self.pad.strips[i], now) else {
            self.rest[i] = 0.0;
            return 0;
        };
        let way = match self.shapes[i] {
            // The shorter way round.
            TouchShape::Ring => ((to - from + 1.5).rem_euclid(1.0) - 0.5) * RING_STEPS,
            TouchShape::Strip => (to - from) * STRIP_STEPS,
        };
        let whole = self.rest[i] + way;
        // Rounded a little up, so that twelve twelfths of a strip are twelve steps.
        let steps = (whole.abs() + 1e-3).floor().copysign(whole);
        self.rest[i] = whole - steps;
        steps as i32
    }
}

fn edges(before: u32, now: u32, control: fn(u8) -> Control, emit: &mut dyn FnMut(ControlEvent)) {
    let bits = |set: u32| (0..32u8).filter(move |n| set >> n & 1 == 1);
    for n in bits(before & !now) {
        emit(ControlEvent::Released(control(n + 1)));
    }
    for n in bits(now & !before) {
        emit(ControlEvent::Pressed(control(n + 1)));
    }
}

/// Change to be carried out by the consumer.
#[derive(Debug, Clone, PartialEq)]
pub enum ActionEvent {
    /// The action begins.
    Pressed {
        /// Its name in the table.
        action: String,
        /// It lasts until it is released; otherwise it happens once and no release follows.
        held: bool,
    },
    /// A held action ends.
    Released {
        /// Its name in the table.
        action: String,
    },
    /// A value changes.
    Turned {
        /// Its name in the table.
        value: String,
        /// By how much, in the value's own unit.
        amount: f32,
    },
    /// The pad is in another mode: the consumer shows it, and sets the LED where there is one.
    Mode(usize),
}

/// The table at work on one tablet: it knows the mode and which actions are held.
#[derive(Debug, Clone)]
pub struct ActionState {
    table: ActionTable,
    edges: ControlEdges,
    mode: usize,
    /// Actions that are held, by the control that holds each. A change of mode does not change
    /// what is released.
    held: Vec<(Control, String)>,
    latest: Option<Control>,
}

impl ActionState {
    /// Begins in the first mode with nothing held.
    pub fn new(table: ActionTable, shapes: [TouchShape; 2]) -> Self {
        ActionState {
            table,
            edges: ControlEdges::new(shapes),
            mode: 0,
            held: Vec::new(),
            latest: None,
        }
    }

    /// The mode of the pad, from 0.
    pub fn mode(&self) -> usize {
        self.mode
    }

    /// Takes the pad's next state.
    pub fn pad(&mut self, now: &Pad, emit: &mut dyn FnMut(ActionEvent)) {
        let mut changes = Vec::new();
        self.edges.pad(now, &mut |e| changes.push(e));
        changes.into_iter().for_each(|e| self.apply(e, emit));
    }

    /// Takes the pen's next state.
    pub fn pen(&mut self, now: &Pen, emit: &mut dyn FnMut(ActionEvent)) {
        let mut changes = Vec::new();
        self.edges.pen(now, &mut |e| changes.push(e));
        changes.into_iter().for_each(|e| self.apply(e, emit));
    }

    /// Replaces the table. Releases held actions first.
    pub fn set_table(&mut self, table: ActionTable, emit: &mut dyn FnMut(ActionEvent)) {
        for (_, action) in self.held.drain(..) {
            emit(ActionEvent::Released { action });
        }
        self.table = table;
        self.mode = 0;
    }

    /// The control that was pressed or turned since the last call, the newest one of several.
    pub fn take_latest(&mut self) -> Option<Control> {
        self.latest.take()
    }

    fn apply(&mut self, event: ControlEvent, emit: &mut dyn FnMut(ActionEvent)) {
        if let ControlEvent::Pressed(control) | ControlEvent::Turned(control, _) = event {
            self.latest = Some(control);
        }
        match event {
            ControlEvent::Released(control) => {
                if let Some(at) = self.held.iter().position(|(c, _)| *c == control) {
                    emit(ActionEvent::Released { action: self.held.remove(at).1 });
                }
            }
            ControlEvent::Pressed(control) => {
                match self.table.binding(control, self.mode).cloned() {
                    Some(Binding::Press(action)) => {
                        emit(ActionEvent::Pressed { action, held: false });
                    }
                    Some(Binding::Hold(action)) => {
                        self.held.push((control, action.clone()));
                        emit(ActionEvent::Pressed { action, held: true });
                    }
                    Some(Binding::Turn { value, step }) => {
                        emit(ActionEvent::Turned { value, amount: step });
                    }
                    Some(Binding::NextMode) => {
                        self.mode = (self.mode + 1) % self.table.modes.len().max(1);
                        emit(ActionEvent::Mode(self.mode));
                    }
                    Some(Binding::Nothing) | None => {}
                }
            }
            ControlEvent::Turned(control, steps) => {
                if let Some(Binding::Turn { value, step }) = self.table.binding(control, self.mode)
                {
                    let (value, amount) = (value.clone(), step * steps as f32);
                    emit(ActionEvent::Turned { value, amount });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
