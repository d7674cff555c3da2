//! The initial settings of each brush.
//!
//! A brush's code declares its extra numbers ([`OwnNumber`]: name, default, range, meaning). A
//! preset is TOML text that overrides them: `about` describes the brush, `[settings]` holds the
//! differences from [`BrushSettings::default`], and `[extra]` sets the brush's extra numbers by
//! name. [`Presets`] is a plain value: a program without such texts uses [`Presets::default`], the
//! defaults of the code alone.

use std::sync::{Arc, PoisonError, RwLock};

use serde::{Deserialize, Serialize};

use super::own_brush::{AlphaPicture, OwnBrush};
use super::{BrushKind, BrushSettings};

/// One of the numbers that only one brush has, as the brush's code declares it: this one
/// declaration feeds checks, clamping, sliders and the listing of brushes. Its place in the
/// brush's list is its place in [`BrushSettings::extra`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OwnNumber {
    /// As it is written in a preset's `[extra]` and beside the slider.
    pub name: &'static str,
    /// The default.
    pub value: f32,
    /// The least and the greatest value.
    pub min: f32,
    /// See [`OwnNumber::min`].
    pub max: f32,
    /// One line: what it measures, and in which unit.
    pub about: &'static str,
}

/// The initial settings of one brush.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    about: String,
    table: toml::Table,
    settings: BrushSettings,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PresetFile {
    about: String,
    #[serde(default)]
    settings: toml::Table,
    #[serde(default)]
    extra: toml::Table,
}

impl Preset {
    /// The defaults of the code, with no word about the brush.
    fn of_code(kind: BrushKind) -> Preset {
        let settings = BrushSettings::new(kind);
        let mut table = toml::Table::new();
        table.insert("kind".into(), kind.name().into());
        table.insert("extra".into(), numbers(&settings));
        Preset { about: String::new(), table, settings }
    }

    fn read(kind: BrushKind, text: &str) -> Result<Preset, String> {
        let mut file: PresetFile = toml::from_str(text).map_err(|e| e.to_string())?;
        let Preset { table: own, settings: mut blank, .. } = Preset::of_code(kind);
        for (value, number) in blank.extra.iter_mut().zip(kind.own_numbers()) {
            if let Some(given) = file.extra.remove(number.name) {
                *value = given.try_into().map_err(|e| format!("extra.{}: {e}", number.name))?;
            }
        }
        if let Some(key) = file.extra.keys().next() {
            return Err(format!("extra.{key}: the brush has no number of this name"));
        }
        let mut table = file.settings;
        table.extend(own);
        table.insert("extra".into(), numbers(&blank));
        let settings: BrushSettings =
            table.clone().try_into().map_err(|e| format!("settings: {e}"))?;
        settings.check()?;
        Ok(Preset { about: file.about, table, settings })
    }

    /// One line on what the brush does; empty for the defaults of the code.
    pub fn about(&self) -> &str {
        &self.about
    }

    /// The whole settings.
    pub fn settings(&self) -> BrushSettings {
        self.settings
    }

    /// Returns the settings in the text, including `kind` and `extra`: they override the defaults,
    /// and the user's settings override them.
    pub fn table(&self) -> &toml::Table {
        &self.table
    }
}

fn numbers(settings: &BrushSettings) -> toml::Value {
    settings.extra.iter().map(|v| toml::Value::Float(f64::from(*v))).collect::<Vec<_>>().into()
}

/// The initial settings of every brush, and the user's brushes. Clones are cheap: they share both,
/// so a list set through one clone is visible in all.
#[derive(Debug, Clone)]
pub struct Presets {
    /// In the order of [`BrushKind::ALL`].
    all: Arc<[Preset]>,
    /// In the order in which they are listed. Never read within a tick.
    own: Arc<RwLock<Arc<[OwnBrush]>>>,
    /// The user's pictures, beside the user's brushes. Never read within a tick.
    pictures: Arc<RwLock<Arc<[AlphaPicture]>>>,
}

impl PartialEq for Presets {
    /// Of what the program brings along; own brushes do not count.
    fn eq(&self, other: &Presets) -> bool {
        self.all == other.all
    }
}

impl Default for Presets {
    /// The defaults of the code: [`BrushSettings::new`] of each brush. No own brushes.
    fn default() -> Self {
        Presets::of_all(BrushKind::ALL.iter().map(|k| Preset::of_code(*k)).collect())
    }
}

impl Presets {
    fn of_all(all: Arc<[Preset]>) -> Presets {
        let (own, pictures) = (RwLock::new(Vec::new().into()), RwLock::new(Vec::new().into()));
        Presets { all, own: Arc::new(own), pictures: Arc::new(pictures) }
    }

    /// The same presets, and own brushes that no clone of `self` sees.
    #[must_use]
    pub fn apart(&self) -> Presets {
        Presets::of_all(self.all.clone())
    }

    /// A person's own brushes, in the order in which they are listed.
    pub fn own(&self) -> Arc<[OwnBrush]> {
        // The list is replaced as a whole: one that a panic left behind is whole, too.
        self.own.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The own brush of this name.
    pub fn own_of(&self, name: &str) -> Option<OwnBrush> {
        self.own().iter().find(|own| own.name == name).cloned()
    }

    /// Replaces the user's brushes, here and in all clones.
    pub fn set_own(&self, mut own: Vec<OwnBrush>) {
        own.sort_by(|a, b| (a.order, &a.name).cmp(&(b.order, &b.name)));
        *self.own.write().unwrap_or_else(PoisonError::into_inner) = own.into();
    }

    /// A person's own pictures of heights that belong to no brush, in the order of their names.
    pub fn pictures(&self) -> Arc<[AlphaPicture]> {
        self.pictures.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Replaces the user's pictures, here and in all clones.
    pub fn set_pictures(&self, pictures: Vec<AlphaPicture>) {
        *self.pictures.write().unwrap_or_else(PoisonError::into_inner) = pictures.into();
    }

    /// Reads presets from texts of TOML, each with the name of its brush. A brush without a text
    /// keeps the defaults of the code; of two texts for one brush the later one holds.
    ///
    /// # Errors
    /// The message names the brush and the key: a name that no brush has, a key that is not known,
    /// a value out of its range.
    pub fn read(texts: &[(&str, &str)]) -> Result<Presets, String> {
        let mut all: Vec<Preset> = BrushKind::ALL.iter().map(|k| Preset::of_code(*k)).collect();
        for (name, text) in texts {
            let kind: BrushKind = name.parse()?;
            all[kind as usize] = Preset::read(kind, text).map_err(|e| format!("{name}: {e}"))?;
        }
        Ok(Presets::of_all(all.into()))
    }

    /// The preset of one brush.
    pub fn get(&self, kind: BrushKind) -> &Preset {
        &self.all[kind as usize]
    }

    /// The settings that one brush begins with.
    pub fn of(&self, kind: BrushKind) -> BrushSettings {
        self.get(kind).settings
    }

    /// An own brush in the same hand, as it was set when it was last used (the one of its key in
    /// `kept`), or else as its file has it; with the mirrors of `now`. One that is in hand already
    /// is taken as its file has it: so a person gets back what was saved.
    #[must_use]
    pub fn taken(
        &self,
        now: &BrushSettings,
        kept: &[BrushSettings],
        own: &OwnBrush,
    ) -> BrushSettings {
        let key = own.settings.key();
        let last = kept.iter().find(|k| k.key() == key).filter(|_| now.key() != key);
        let settings = last.unwrap_or(&own.settings);
        BrushSettings { symmetry: now.symmetry, mirror: now.mirror, ..*settings }
    }

    /// Returns the settings of another brush at the size and with the mirrors of `now`. For a brush
    /// that was never set; see [`Presets::recalled`].
    #[must_use]
    pub fn switched(&self, now: &BrushSettings, kind: BrushKind) -> BrushSettings {
        BrushSettings {
            radius: now.radius,
            symmetry: now.symmetry,
            mirror: now.mirror,
            ..self.of(kind)
        }
    }

    /// Another brush of the program in the same hand, as it was set when it was last used (the one
    /// of its key in `kept`), its size among it, with the mirrors of `now`; or else as its preset
    /// has it, at the size of `now`.
    #[must_use]
    pub fn recalled(
        &self,
        now: &BrushSettings,
        kept: &[BrushSettings],
        kind: BrushKind,
    ) -> BrushSettings {
        match kept.iter().find(|k| k.key() == (kind, 0)) {
            Some(kept) => BrushSettings { symmetry: now.symmetry, mirror: now.mirror, ..*kept },
            None => self.switched(now, kind),
        }
    }

    /// The brush of this key as `kept` has it, or else as it begins: what a brush that was lent for
    /// a while is put away as.
    #[must_use]
    pub fn kept(
        &self,
        now: &BrushSettings,
        kept: &[BrushSettings],
        key: (BrushKind, u32),
    ) -> BrushSettings {
        match self.own().iter().find(|own| own.settings.key() == key) {
            Some(own) => self.taken(now, kept, own),
            None => self.recalled(now, kept, key.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_the_code_are_valid_for_every_brush() {
        let presets = Presets::default();
        for kind in BrushKind::ALL {
            let settings = presets.of(*kind);
            settings.check().unwrap_or_else(|e| panic!("{kind}: {e}"));
            assert_eq!(settings.clamped(), settings, "{kind}");
            assert_eq!(settings.kind, *kind);
            assert_eq!(kind.name().parse(), Ok(*kind));
            for n in kind.own_numbers() {
                assert!(n.min <= n.value && n.value <= n.max && !n.about.is_empty(), "{n:?}");
            }
        }
    }

    #[test]
    fn a_text_sets_what_it_names_and_its_faults_are_told() {
        let text = "about = 'x'\n[settings]\nspacing = 0.07\n[extra]\nfloor = 0.25";
        let presets = Presets::read(&[("texture", text)]).expect("valid");
        let texture = presets.of(BrushKind::Texture);
        assert_eq!((texture.spacing, texture.extra[0], texture.extra[1]), (0.07, 1.0, 0.25));
        assert_eq!(presets.of(BrushKind::Draw), BrushSettings::new(BrushKind::Draw));
        for (name, text, word) in [
            ("brush", "about = 'x'", "no brush 'brush'"),
            ("draw", "about = 'x'\n[extra]\nscale = 1", "extra.scale"),
            ("texture", "about = 'x'\n[extra]\nscale = 100.0", "expected 0.1 to 10"),
            ("texture", "about = 'x'\n[settings]\nspace = 1", "space"),
        ] {
            let e = Presets::read(&[(name, text)]).expect_err(word);
            assert!(e.contains(word) && e.contains(name), "{e}");
        }
    }
}
