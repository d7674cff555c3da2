//! A key with its modifiers, as it is shown, written and pressed.

use std::fmt;
use std::str::FromStr;

use crate::language::tr;
use egui::Key;

/// A key with the modifiers that are held with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct KeyCombination {
    pub key: Key,
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl KeyCombination {
    pub const fn of(key: Key) -> KeyCombination {
        KeyCombination { key, ctrl: false, shift: false, alt: false }
    }

    pub const fn ctrl(self) -> KeyCombination {
        KeyCombination { ctrl: true, ..self }
    }

    pub const fn shift(self) -> KeyCombination {
        KeyCombination { shift: true, ..self }
    }

    pub const fn alt(self) -> KeyCombination {
        KeyCombination { alt: true, ..self }
    }

    /// As panels show it, in the language of this thread: `Ctrl+Shift+Z`.
    pub fn shown(&self) -> String {
        let held = [(self.ctrl, "key-ctrl"), (self.alt, "key-alt"), (self.shift, "key-shift")];
        let held = held.into_iter().filter(|(held, _)| *held).map(|(_, name)| tr!(name) + "+");
        held.collect::<String>() + self.key.symbol_or_name()
    }

    /// Returns true if these modifiers are held, for a key already known to match. A plus sign is
    /// the shifted half of its key on many keyboards.
    fn is_held(&self, modifiers: egui::Modifiers) -> bool {
        (modifiers.command || modifiers.ctrl) == self.ctrl
            && modifiers.alt == self.alt
            && (modifiers.shift == self.shift || self.key == Key::Plus)
    }

    /// Returns true if `key` with `modifiers` is this combination.
    pub fn is_pressed(&self, key: Key, modifiers: egui::Modifiers) -> bool {
        // Some keyboards report "=" for "+".
        let plus = key == Key::Equals && self.key == Key::Plus && self.ctrl;
        (key == self.key || plus) && self.is_held(modifiers)
    }
}

/// As files hold it: `Ctrl+Shift+Z`.
impl fmt::Display for KeyCombination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (held, name) in [(self.ctrl, "Ctrl+"), (self.alt, "Alt+"), (self.shift, "Shift+")] {
            f.write_str(if held { name } else { "" })?;
        }
        f.write_str(self.key.symbol_or_name())
    }
}

/// From the text that [`fmt::Display`] writes. The modifiers may come in any order.
impl FromStr for KeyCombination {
    type Err = String;

    fn from_str(text: &str) -> Result<KeyCombination, String> {
        let (mut left, mut all) = (text.trim(), KeyCombination::of(Key::Space));
        loop {
            let (taken, rest) = match left.split_once('+') {
                Some(("Ctrl", rest)) => (&mut all.ctrl, rest),
                Some(("Alt", rest)) => (&mut all.alt, rest),
                Some(("Shift", rest)) => (&mut all.shift, rest),
                _ => break,
            };
            (*taken, left) = (true, rest);
        }
        all.key = Key::from_name(left).ok_or_else(|| {
            format!("\"{text}\" is no key: expected one such as Z, F12, [ or Ctrl+Shift+Z")
        })?;
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_read_as_it_is_shown() {
        for key in Key::ALL {
            let plain = KeyCombination::of(*key);
            for keys in [plain, plain.ctrl(), plain.shift().alt(), plain.ctrl().shift().alt()] {
                assert_eq!(keys.to_string().parse(), Ok(keys), "{keys}");
            }
        }
        let turned = "Shift+Ctrl+Z".parse::<KeyCombination>();
        assert_eq!(turned, Ok(KeyCombination::of(Key::Z).ctrl().shift()));
        assert!("Ctrl+".parse::<KeyCombination>().is_err_and(|e| e.contains("Ctrl+Shift+Z")));
        assert!("Hyper+Z".parse::<KeyCombination>().is_err());
    }

    #[test]
    fn a_plus_is_found_on_either_half_of_its_key() {
        let larger = KeyCombination::of(Key::Plus).ctrl();
        let ctrl = egui::Modifiers::CTRL;
        assert!(larger.is_pressed(Key::Plus, ctrl | egui::Modifiers::SHIFT));
        assert!(larger.is_pressed(Key::Equals, ctrl));
        assert!(!larger.is_pressed(Key::Equals, egui::Modifiers::NONE));
        assert!(!KeyCombination::of(Key::Z).is_pressed(Key::Z, ctrl));
    }
}
