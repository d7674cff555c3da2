//! The action of each key: a set known from another program, and the person's changes to it.
//!
//! Laws kept here:
//! * A press does one thing. If two actions have the same keys, the one whose keys the person chose
//!   wins, and of two such ones the first of the table.
//! * An unreadable entry in a file of preferences leaves the set's keys, and is reported.

use std::collections::BTreeMap;

use egui::Key;
use sculptd_clay::brush::BrushKind;
use serde::{Deserialize, Serialize};

use super::action::{self, Action};
use super::key::KeyCombination;
use crate::language::tr;

/// Keys to begin with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KeySet {
    #[default]
    Sculptd,
    /// Those of Blender's sculpt mode, as far as the actions exist here.
    Blender,
    /// Those of ZBrush, as far as the actions exist here.
    Zbrush,
}

impl KeySet {
    pub const ALL: [(KeySet, &str); 3] =
        [(KeySet::Sculptd, "sculptd"), (KeySet::Blender, "Blender"), (KeySet::Zbrush, "ZBrush")];

    /// Returns the differences from the table of actions. `None`: the action has no key.
    fn changes(self) -> &'static [(Action, Option<KeyCombination>)] {
        match self {
            KeySet::Sculptd => &[],
            KeySet::Blender => BLENDER,
            KeySet::Zbrush => ZBRUSH,
        }
    }
}

const fn key(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key))
}
const fn shift(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key).shift())
}
const fn ctrl(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key).ctrl())
}

/// The keys of sculpt mode in the manual of Blender 4; its numeric pad is the row of digits here.
const BLENDER: &[(Action, Option<KeyCombination>)] = &[
    (Action::Brush(BrushKind::Grab), key(Key::G)),
    (Action::Brush(BrushKind::Layer), key(Key::L)),
    (Action::Brush(BrushKind::Scrape), key(Key::T)),
    (Action::Brush(BrushKind::Clay), key(Key::C)),
    (Action::Brush(BrushKind::ClayStrips), None),
    (Action::Brush(BrushKind::Paint), None),
    (Action::Brush(BrushKind::Mask), key(Key::M)),
    (Action::SampleColour, shift(Key::X)),
    (Action::NextMaterial, None),
    (Action::Grid, None),
    (Action::Thickness, None),
    (Action::Mask, None),
    (Action::Front, key(Key::Num1)),
    (Action::Back, ctrl(Key::Num1)),
    (Action::Right, key(Key::Num3)),
    (Action::Left, ctrl(Key::Num3)),
    (Action::Top, key(Key::Num7)),
    (Action::Bottom, ctrl(Key::Num7)),
    (Action::MirrorX, None),
    (Action::MirrorY, None),
    (Action::MirrorZ, None),
    (Action::Finer, key(Key::PageUp)),
    (Action::Coarser, key(Key::PageDown)),
    (Action::Search, key(Key::F3)),
    (Action::RegionLasso, None),
];

/// The keys of ZBrush's manual ("Keyboard shortcuts by category").
const ZBRUSH: &[(Action, Option<KeyCombination>)] = &[
    (Action::DragRadius, key(Key::S)),
    (Action::DragStrength, key(Key::U)),
    (Action::MirrorX, key(Key::X)),
    (Action::Carve, key(Key::Z)),
    (Action::Frame, key(Key::F)),
    (Action::Wireframe, shift(Key::F)),
    (Action::Perspective, key(Key::P)),
    (Action::Grid, shift(Key::P)),
    (Action::Finer, key(Key::D)),
    (Action::Coarser, shift(Key::D)),
    (Action::Distance, None),
    (Action::Brush(BrushKind::Smooth), None),
    (Action::Brush(BrushKind::Pinch), None),
    (Action::Brush(BrushKind::Grab), None),
];

/// The person's changes, as the file of preferences keeps them.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct KeySettings {
    pub set: KeySet,
    /// Keys by the action's name ([`Action::id`]); an empty text takes the keys away.
    pub own: BTreeMap<String, String>,
}

impl KeySettings {
    /// Gives an action other keys, or none. Keys that are the set's own are not kept.
    pub fn bind(&mut self, action: Action, keys: Option<KeyCombination>) {
        let own = std::mem::take(&mut self.own);
        let usual = KeyMap::new(&KeySettings { set: self.set, own: BTreeMap::new() }).of(action);
        self.own = own;
        match keys == usual {
            true => self.own.remove(&action.id()),
            false => self.own.insert(action.id(), keys.map_or(String::new(), |k| k.to_string())),
        };
    }
}

/// The keys of one action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    pub action: Action,
    pub keys: Option<KeyCombination>,
    /// The person has chosen them.
    pub own: bool,
}

/// The keys of every action, resolved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyMap {
    /// Settings it was built from.
    settings: KeySettings,
    /// In the order of the table of actions.
    bindings: Vec<Binding>,
    /// Settings that could not be read.
    pub wrong: Vec<String>,
}

impl Default for KeyMap {
    fn default() -> KeyMap {
        KeyMap::new(&KeySettings::default())
    }
}

impl KeyMap {
    pub fn new(settings: &KeySettings) -> KeyMap {
        let changes = settings.set.changes();
        let mut map =
            KeyMap { settings: settings.clone(), bindings: Vec::new(), wrong: Vec::new() };
        for entry in action::all() {
            let changed = changes.iter().find(|c| c.0 == entry.action);
            let keys = changed.map_or(entry.keys, |c| c.1);
            map.bindings.push(Binding { action: entry.action, keys, own: false });
        }
        for (id, text) in &settings.own {
            let Some(binding) = map.bindings.iter_mut().find(|b| b.action.id() == *id) else {
                map.wrong.push(tr!("keys-unknown-action", id = id.as_str()));
                continue;
            };
            match (text.is_empty(), text.parse()) {
                (true, _) => (binding.keys, binding.own) = (None, true),
                (_, Ok(keys)) => (binding.keys, binding.own) = (Some(keys), true),
                (_, Err(_)) => {
                    let (id, keys) = (id.as_str(), text.as_str());
                    map.wrong.push(tr!("keys-unreadable", id = id, keys = keys));
                }
            }
        }
        map
    }

    /// Returns true if it was built from these settings.
    pub fn is_of(&self, settings: &KeySettings) -> bool {
        self.settings == *settings
    }

    pub fn bindings(&self) -> &[Binding] {
        &self.bindings
    }

    /// The keys of an action.
    pub fn of(&self, action: Action) -> Option<KeyCombination> {
        self.bindings.iter().find(|b| b.action == action).and_then(|b| b.keys)
    }

    /// The keys of an action as text, which is empty where it has none.
    pub fn text(&self, action: Action) -> String {
        self.of(action).map_or(String::new(), |k| k.shown())
    }

    /// The other actions with the keys of this one.
    pub fn conflicts(&self, binding: &Binding) -> impl Iterator<Item = Action> + '_ {
        let (action, keys) = (binding.action, binding.keys);
        let same = move |b: &&Binding| b.keys.is_some() && b.keys == keys && b.action != action;
        self.bindings.iter().filter(same).map(|b| b.action)
    }

    /// Returns the action of a press. On keyboards of other alphabets the physical key decides, if
    /// its printed character has no action.
    pub fn pressed(&self, press: &Press) -> Option<Action> {
        let by = |key: Key| {
            let is = |b: &&Binding| b.keys.is_some_and(|k| k.is_pressed(key, press.modifiers));
            let mut found = self.bindings.iter().filter(is);
            let first = found.next()?;
            Some([first].into_iter().chain(found).find(|b| b.own).unwrap_or(first).action)
        };
        let redo = || {
            let usual = press.key == Key::Y && press.modifiers.command && !press.modifiers.shift;
            usual.then_some(Action::Redo)
        };
        by(press.key).or_else(|| press.physical.and_then(by)).or_else(redo)
    }
}

/// A key that went down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Press {
    pub key: Key,
    /// The key at this place of a keyboard of the United States.
    pub physical: Option<Key>,
    pub modifiers: egui::Modifiers,
}

impl Press {
    /// The keys that went down in this frame.
    pub fn all(ctx: &egui::Context) -> Vec<Press> {
        ctx.input(|i| {
            let press = |e: &egui::Event| match *e {
                egui::Event::Key { key, physical_key, pressed: true, modifiers, .. } => {
                    Some(Press { key, physical: physical_key, modifiers })
                }
                _ => None,
            };
            i.events.iter().filter_map(press).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language;

    fn press(key: Key, modifiers: egui::Modifiers) -> Press {
        Press { key, physical: None, modifiers }
    }

    #[test]
    fn no_set_has_two_actions_with_the_same_keys() {
        for (set, name) in KeySet::ALL {
            let map = KeyMap::new(&KeySettings { set, own: BTreeMap::new() });
            for binding in map.bindings() {
                let same: Vec<_> = map.conflicts(binding).collect();
                assert!(same.is_empty(), "{name}: {:?} and {same:?}", binding.action);
            }
        }
    }

    #[test]
    fn what_a_person_chose_goes_before_the_set_and_survives_the_file() {
        let mut settings = KeySettings { set: KeySet::Blender, ..Default::default() };
        let keys = KeyCombination::of(Key::C).alt();
        settings.bind(Action::Undo, Some(keys));
        settings.bind(Action::Brush(BrushKind::Clay), None);
        // The set's own keys are no choice.
        settings.bind(Action::Brush(BrushKind::Draw), Some(KeyCombination::of(Key::V)));
        assert_eq!(settings.own.len(), 2);
        let text = toml::to_string(&settings).expect("plain data");
        let back: KeySettings = toml::from_str(&text).expect("read");
        assert_eq!(back, settings);
        let map = KeyMap::new(&back);
        assert_eq!(map.pressed(&press(Key::C, egui::Modifiers::ALT)), Some(Action::Undo));
        assert_eq!(map.pressed(&press(Key::C, egui::Modifiers::NONE)), None);
        assert_eq!(
            map.pressed(&press(Key::K, egui::Modifiers::NONE)),
            Some(Action::Brush(BrushKind::SnakeHook))
        );
    }

    #[test]
    fn of_two_actions_with_the_same_keys_the_chosen_one_is_done() {
        let mut settings = KeySettings::default();
        settings.bind(Action::Wireframe, Some(KeyCombination::of(Key::Z).ctrl()));
        let map = KeyMap::new(&settings);
        let ctrl = egui::Modifiers::CTRL | egui::Modifiers::COMMAND;
        assert_eq!(map.pressed(&press(Key::Z, ctrl)), Some(Action::Wireframe));
        let wireframe = map.bindings().iter().find(|b| b.own).expect("one is the person's");
        assert_eq!(map.conflicts(wireframe).collect::<Vec<_>>(), [Action::Undo]);
    }

    #[test]
    fn what_cannot_be_read_is_told_and_changes_nothing() {
        language::set_current(language::tests::of_config("").english());
        let own = [("undo", "Hyper+Z"), ("fly", "F")].map(|(a, b)| (a.to_owned(), b.to_owned()));
        let map = KeyMap::new(&KeySettings { own: own.into(), ..Default::default() });
        assert_eq!(map.of(Action::Undo), KeyMap::default().of(Action::Undo));
        assert_eq!(map.wrong.len(), 2);
        assert!(map.wrong.iter().any(|w| w.contains("\"fly\"")));
    }

    #[test]
    fn a_keyboard_of_another_alphabet_is_known_by_its_places() {
        let map = KeyMap::default();
        let cyrillic =
            Press { key: Key::Space, physical: Some(Key::W), modifiers: egui::Modifiers::NONE };
        assert_eq!(map.pressed(&cyrillic), Some(Action::Wireframe));
        // The printed character of a key wins over its position: "Z" of a French keyboard is at
        // "W".
        let ctrl = egui::Modifiers::CTRL | egui::Modifiers::COMMAND;
        let french = Press { key: Key::Z, physical: Some(Key::W), modifiers: ctrl };
        assert_eq!(map.pressed(&french), Some(Action::Undo));
    }
}
