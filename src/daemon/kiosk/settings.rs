//! The settings of an installation (`config/kiosk.toml` documents them) and the languages.

use std::path::{Path, PathBuf};

use super::NextOpening;
use super::hours::{DimHours, Hours};
use sculptd_clay::brush::BrushKind;
use serde::{Deserialize, Serialize};

/// Texts of languages, each behind its code (`en`), in the form of `config/languages/en.toml`.
pub type LanguageTexts<'a> = &'a [(&'a str, &'a str)];

/// Settings of an installation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct KioskConfig {
    pub idle_s: f64,
    pub countdown_s: f64,
    pub max_triangles: usize,
    pub undo_bytes: u64,
    pub language: String,
    pub languages: Vec<PathBuf>,
    pub staff_pin: String,
    pub gallery: PathBuf,
    pub gallery_store: String,
    pub share: String,
    pub share_name: String,
    pub share_minutes: f64,
    /// Address of the page on which visitors watch; empty: there is none.
    pub web: String,
    /// Address or name by which visitors' telephones reach the page.
    pub web_name: String,
    pub audit: PathBuf,
    /// What becomes of a visit that a kill or a power cut interrupted.
    pub interrupted: Interrupted,
    pub attract: Vec<PathBuf>,
    /// Time for which each work of the gallery wall is shown, seconds; 0: no wall.
    pub wall_s: f64,
    /// Mesh files, and folders of them, on the gallery wall beside the works of the day.
    pub curated: Vec<PathBuf>,
    /// The brush that every visitor begins with; empty: that of the configuration.
    pub brush: String,
    /// Its radius, as a share of the object's bounding radius; 0 keeps the brush's radius.
    pub radius: f32,
    pub screen: ScreenSettings,
    /// A program and its arguments that speaks the screen's text, given as its last argument.
    pub speak: Vec<String>,
    /// Packs of exhibits, or names of built-in exhibits; empty: free sculpting.
    pub exhibits: Vec<PathBuf>,
    pub hours: HoursSettings,
    /// The fleet that manages this installation remotely.
    pub fleet: FleetSettings,
}

/// Opening hours, and the screen outside them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HoursSettings {
    /// See [`Hours::parse`]; empty: always.
    pub open: Vec<String>,
    /// Darkness of the screen while the installation is closed, from 0 (as usual) to 1 (black).
    pub dim: f32,
    /// See [`DimHours::parse`]: darkness of the screen while nobody is here.
    pub dim_at: Vec<String>,
    /// Times at which nothing plays and nothing is spoken, in the form of `open`.
    pub quiet: Vec<String>,
}

/// What becomes of a visit that a kill or a power cut interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interrupted {
    /// The next start shows the work, and the visit goes on.
    #[default]
    Resume,
    /// The next start puts the work into the gallery.
    Gallery,
}

/// The fleet that an installation belongs to (programs with the feature `network`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FleetSettings {
    /// Its name; empty: the installation is in none.
    pub name: String,
    /// The key of this installation, which says its name.
    pub key: PathBuf,
    /// Addresses to listen on, as `tcp/0.0.0.0:7447`; empty: any port.
    pub listen: Vec<String>,
    /// Addresses to connect to, as `tcp/staff.example:7447`.
    pub connect: Vec<String>,
    /// True to look for other installations on the local network.
    pub multicast: bool,
}

/// Display settings for visitors who see, reach or press differently from most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScreenSettings {
    /// Scale of words and buttons; 1 is the usual size.
    pub text: f32,
    /// White on black, with strong outlines.
    pub contrast: bool,
    /// True to place all controls in the lower half of the screen.
    pub seated: bool,
    /// Scanning for one switch, which is any key: each button lights for this many seconds, and the
    /// switch presses the lit one. 0: off.
    pub scan_s: f64,
    /// Name of the clay's material; empty: clay.
    pub material: String,
    /// Ways to sculpt that pictures explain.
    pub hints: Vec<Hint>,
}

/// A way to sculpt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hint {
    Pen,
    Touch,
    OneHand,
    TwoHands,
}

impl Default for FleetSettings {
    fn default() -> Self {
        let (name, key, listen, connect) = (String::new(), PathBuf::new(), vec![], vec![]);
        FleetSettings { name, key, listen, connect, multicast: true }
    }
}

impl Default for ScreenSettings {
    fn default() -> Self {
        ScreenSettings {
            text: 1.0,
            contrast: false,
            seated: false,
            scan_s: 0.0,
            material: String::new(),
            hints: vec![Hint::Pen, Hint::Touch],
        }
    }
}

impl Default for KioskConfig {
    fn default() -> Self {
        KioskConfig {
            idle_s: 60.0,
            countdown_s: 15.0,
            max_triangles: 500_000,
            undo_bytes: 256 << 20,
            language: "en".into(),
            languages: vec![],
            staff_pin: String::new(),
            gallery: PathBuf::new(),
            gallery_store: String::new(),
            share: String::new(),
            share_name: String::new(),
            share_minutes: 30.0,
            web: String::new(),
            web_name: String::new(),
            audit: PathBuf::new(),
            interrupted: Interrupted::default(),
            attract: vec![],
            wall_s: 20.0,
            curated: vec![],
            brush: String::new(),
            radius: 0.0,
            screen: ScreenSettings::default(),
            speak: vec![],
            exhibits: vec![],
            hours: HoursSettings::default(),
            fleet: FleetSettings::default(),
        }
    }
}

impl KioskConfig {
    /// Reads a file; the message names it, and the line or the key and its range.
    pub fn load(path: &Path) -> Result<Self, String> {
        let name = path.display();
        let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
        KioskConfig::parse(&text).map_err(|e| format!("{name}: {e}"))
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// Names the line, or the key and its range.
    pub fn parse(text: &str) -> Result<Self, String> {
        let config: KioskConfig =
            toml::from_str(text).map_err(|e| format!("{}{}", e, hint(&e.to_string())))?;
        config.check()?;
        Ok(config)
    }

    fn check(&self) -> Result<(), String> {
        for (key, s) in [("idle_s", self.idle_s), ("countdown_s", self.countdown_s)] {
            if !(1.0..=86_400.0).contains(&s) {
                return Err(format!("{key} = {s}: expected a number from 1 to 86400"));
            }
        }
        if !(1_000..=100_000_000).contains(&self.max_triangles) {
            return Err(format!(
                "max_triangles = {}: expected 1000 to 100000000",
                self.max_triangles
            ));
        }
        if self.undo_bytes < 1 << 20 {
            return Err(format!("undo_bytes = {}: expected at least 1048576", self.undo_bytes));
        }
        if !(1.0..=1440.0).contains(&self.share_minutes) {
            return Err(format!(
                "share_minutes = {}: expected a number from 1 to 1440",
                self.share_minutes
            ));
        }
        #[cfg(unix)]
        self.web_address()?;
        if self.gallery.as_os_str().is_empty() && self.interrupted == Interrupted::Gallery {
            return Err("interrupted = \"gallery\" needs a gallery".into());
        }
        if self.gallery.as_os_str().is_empty()
            && !(self.gallery_store.is_empty() && self.share.is_empty())
        {
            return Err("gallery_store and share need a gallery: works are kept there first".into());
        }
        let ScreenSettings { text, scan_s, .. } = self.screen;
        if !(1.0..=2.5).contains(&text) {
            return Err(format!("screen.text = {text}: expected a number from 1 to 2.5"));
        }
        if scan_s != 0.0 && !(0.3..=30.0).contains(&scan_s) {
            return Err(format!(
                "screen.scan_s = {scan_s}: expected 0, or a number from 0.3 to 30"
            ));
        }
        if !(0.0..=2.0).contains(&self.radius) {
            return Err(format!("radius = {}: expected a number from 0 to 2", self.radius));
        }
        if !(0.0..=1.0).contains(&self.hours.dim) {
            let dim = self.hours.dim;
            return Err(format!("hours.dim = {dim}: expected a number from 0 to 1"));
        }
        Hours::parse(&self.hours.open).map_err(|e| format!("hours.open: {e}"))?;
        Hours::parse(&self.hours.quiet).map_err(|e| format!("hours.quiet: {e}"))?;
        DimHours::parse(&self.hours.dim_at).map_err(|e| format!("hours.dim_at: {e}"))?;
        if self.wall_s != 0.0 && !(5.0..=600.0).contains(&self.wall_s) {
            let text = format!("wall_s = {}: expected 0, or a number from 5 to 600", self.wall_s);
            return Err(text);
        }
        if !self.fleet.name.is_empty() && self.fleet.key.as_os_str().is_empty() {
            return Err("fleet.name needs fleet.key: `sculptd fleet key` makes one".into());
        }
        self.brush_kind()?;
        let digits = self.staff_pin.chars().all(|c| c.is_ascii_digit());
        if !(self.staff_pin.is_empty() || digits && self.staff_pin.len() >= 4) {
            return Err("staff_pin: expected four digits or more, in quotes, or nothing".into());
        }
        Ok(())
    }

    /// Returns the address of the page on which visitors watch; `None`: there is none.
    ///
    /// # Errors
    /// Returns an error if it is no address.
    #[cfg(unix)]
    pub fn web_address(&self) -> Result<Option<std::net::SocketAddr>, String> {
        let wanted = (!self.web.is_empty()).then(|| crate::metrics::address(&self.web));
        wanted.transpose().map_err(|e| format!("web: {e}"))
    }

    /// Returns the brush that every visitor starts with; `None`: that of the configuration.
    ///
    /// # Errors
    /// Returns an error that names the unknown brush and the known ones.
    pub fn brush_kind(&self) -> Result<Option<BrushKind>, String> {
        let name = Some(&self.brush).filter(|name| !name.is_empty());
        name.map(|name| name.parse().map_err(|e| format!("brush: {e}"))).transpose()
    }

    /// Returns the texts to show: from the files among `languages`, or from the built-in ones. A
    /// text that a file lacks is shown in English.
    ///
    /// # Errors
    /// Returns a message if the language is unknown or its file is wrong.
    pub fn words(&self, built_in: LanguageTexts<'_>) -> Result<Language, String> {
        let english = built_in.iter().find(|(code, _)| *code == "en").map_or("", |(_, text)| text);
        for path in &self.languages {
            let name = path.display();
            if code_of(path) == self.language && !is_code(path, built_in) {
                let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
                let words = Language::parse(&self.language, &text, english);
                return words.map_err(|e| format!("{name}: {e}"));
            }
        }
        let known = built_in.iter().find(|(n, _)| *n == self.language);
        let (name, text) = known.ok_or_else(|| {
            let codes: Vec<&str> = built_in.iter().map(|(n, _)| *n).collect();
            let (language, codes) = (&self.language, codes.join(", "));
            format!("language = \"{language}\": expected {codes}, or one of `languages`")
        })?;
        Language::parse(name, text, english).map_err(|e| format!("{name}: {e}"))
    }

    /// Returns every language that can be chosen on the screen, the one of the settings first.
    ///
    /// # Errors
    /// As [`KioskConfig::words`].
    pub fn every_language(&self, built_in: LanguageTexts<'_>) -> Result<Vec<Language>, String> {
        let mut all = vec![self.words(built_in)?];
        let own = self.languages.iter().map(|path| code_of(path));
        // Codes say which of the built-in ones may be chosen.
        let chosen = self.languages.iter().any(|path| is_code(path, built_in));
        let built = built_in.iter().filter(|_| !chosen).map(|(name, _)| (*name).to_owned());
        for language in built.chain(own) {
            all.push(KioskConfig { language, ..self.clone() }.words(built_in)?);
        }
        let mut seen: Vec<String> = Vec::new();
        all.retain(|l| {
            let new = !seen.contains(&l.name);
            seen.push(l.name.clone());
            new
        });
        Ok(all)
    }
}

/// Returns true for the code of a built-in language, without an ending and a folder.
fn is_code(path: &Path, built_in: LanguageTexts<'_>) -> bool {
    built_in.iter().any(|(code, _)| path == Path::new(code))
}

/// Returns advice on frequent mistakes in a file of settings, as a further line.
fn hint(said: &str) -> String {
    let unknown = said.split("unknown field `").nth(1).and_then(|rest| rest.split('`').next());
    let known = toml::Table::try_from(KioskConfig::default()).unwrap_or_default();
    match unknown {
        Some(key) if known.contains_key(key) => {
            format!("`{key}` belongs above the first line in brackets, such as [hours]\n")
        }
        _ if said.contains("expected a string") => "write it in quotes: \"1234\"\n".into(),
        _ if said.contains("expected a sequence") => {
            "write it in square brackets: [\"one\", \"another\"]\n".into()
        }
        _ => String::new(),
    }
}

/// The code of the language in a file: its name.
fn code_of(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Texts of a screen; words in braces, such as `{seconds}`, are replaced by numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Language {
    /// Its code, `en`: the name of its file.
    #[serde(default)]
    pub code: String,
    pub name: String,
    pub welcome: String,
    pub countdown: String,
    pub go_on: String,
    pub finish: String,
    pub kept: String,
    pub fetch: String,
    /// Label of the code that leads to the page for watching.
    pub watch: String,
    pub too_large: String,
    pub draw: String,
    pub carve: String,
    pub smooth: String,
    pub undo: String,
    pub staff: String,
    /// Turning the work and coming nearer.
    pub turn: String,
    pub wrong_pin: String,
    /// Too many wrong PINs were entered.
    pub locked: String,
    /// Invitation to choose an exhibit.
    pub choose: String,
    /// Shows the goal of an exhibit through the clay.
    pub goal: String,
    /// Shows where there is too much and too little clay.
    pub compare: String,
    /// Goes on to the next step of an exhibit.
    pub next: String,
    /// The share of the work that is right.
    pub near: String,
    pub too_much: String,
    pub too_little: String,
    /// Time left of a visit.
    pub time_left: String,
    /// The score of a finished work.
    pub result: String,
    /// Outside the opening hours.
    pub closed: String,
    /// The time at which the installation opens again, within a day and later.
    pub opens: String,
    pub opens_on: String,
    /// The days of the week in the form that `opens_on` needs, Monday first, with commas between.
    pub days: String,
    /// The sign between whole and broken numbers.
    pub decimal_sign: String,
    /// During cleaning.
    pub cleaning: String,
    /// Asks for consent before a work is shared, and says what that means; `{minutes}` is replaced.
    pub consent: String,
    pub consent_about: String,
    pub yes: String,
    pub no: String,
    /// Ends the farewell.
    pub done: String,
    /// Says for how long a link works.
    pub expires: String,
    /// On the page of a shared work: deletes it, after a question; and the answer.
    pub delete: String,
    pub delete_sure: String,
    pub deleted: String,
    /// Beside the pictures of a pen, a finger, one hand and two hands.
    pub hint_pen: String,
    pub hint_touch: String,
    pub hint_hand: String,
    pub hint_hands: String,
    /// Label of a work on the gallery wall; `{number}` is replaced.
    pub work: String,
}

impl Language {
    /// Reads the text of a language's file. `english`: the file that has every text.
    ///
    /// # Errors
    /// Returns what is wrong with the file.
    pub fn parse(code: &str, text: &str, english: &str) -> Result<Language, String> {
        let mut texts: toml::Table = toml::from_str(text).map_err(|e| e.to_string())?;
        let fallback: toml::Table = toml::from_str(english).map_err(|e| e.to_string())?;
        for (key, value) in fallback {
            // Each language names itself.
            if key != "name" {
                texts.entry(key).or_insert(value);
            }
        }
        texts.insert("code".into(), code.into());
        texts.try_into().map_err(|e| e.to_string())
    }

    /// Returns the text for the next opening time.
    pub fn opens_text(&self, next: NextOpening) -> String {
        let time = format!("{}:{:02}", next.minute / 60, next.minute % 60);
        let day = next.weekday.and_then(|day| self.days.split(',').nth(day as usize));
        match day {
            Some(day) => self.opens_on.replace("{day}", day.trim()).replace("{time}", &time),
            None => self.opens.replace("{time}", &time),
        }
    }

    /// Returns a number with one decimal.
    pub fn decimal(&self, number: f64) -> String {
        format!("{number:.1}").replace('.', &self.decimal_sign)
    }

    /// Returns every text, for choosing a font that can draw them.
    pub fn all(&self) -> String {
        let texts = toml::Table::try_from(self).unwrap_or_default();
        texts.values().filter_map(|text| text.as_str()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_language_file_without_a_text_has_it_in_english() {
        let english = include_str!("../../../config/languages/en.toml");
        let words =
            Language::parse("xx", "name = \"Own\"\nundo = \"Back\"", english).expect("read");
        assert_eq!((words.code.as_str(), words.name.as_str()), ("xx", "Own"));
        assert_eq!((words.undo.as_str(), words.finish.as_str()), ("Back", "Finished"));
        assert!(Language::parse("xx", "undo = \"Back\"", english).is_err(), "it has no name");
        assert!(Language::parse("xx", "name = \"Own\"\nundoo = \"\"", english).is_err());
        assert!(words.all().contains("Back"));
    }

    #[test]
    fn codes_choose_among_the_built_in_languages() {
        let english = include_str!("../../../config/languages/en.toml");
        let built_in =
            [("en", english), ("de", "name = \"Deutsch\""), ("el", "name = \"Ελληνικά\"")];
        let offered = |languages: &[&str]| {
            let languages = languages.iter().map(PathBuf::from).collect();
            let config = KioskConfig { languages, ..KioskConfig::default() };
            let all = config.every_language(&built_in).expect("texts");
            all.into_iter().map(|l| l.code).collect::<Vec<_>>()
        };
        assert_eq!(offered(&[]), ["en", "de", "el"]);
        assert_eq!(offered(&["de"]), ["en", "de"], "the language of the settings is always there");
    }

    #[test]
    fn frequent_mistakes_get_advice() {
        for (text, advice) in [
            ("[hours]\ndim = 0.5\nexhibits = [\"pot\"]", "`exhibits` belongs above"),
            ("staff_pin = 1234", "write it in quotes"),
            ("exhibits = \"pot\"", "write it in square brackets"),
        ] {
            let said = KioskConfig::parse(text).expect_err(text);
            assert!(said.contains(advice), "{said}");
        }
        let said = KioskConfig::parse("[hours]\nopened = []").expect_err("unknown");
        assert!(!said.contains("belongs above"), "{said}");
    }

    #[test]
    fn the_next_opening_names_a_day_that_is_not_the_next() {
        let english = include_str!("../../../config/languages/en.toml");
        let words = Language::parse("en", english, english).expect("read");
        let text = |weekday| words.opens_text(NextOpening { weekday, minute: 605 });
        assert_eq!(text(None), "We open at 10:05");
        assert_eq!(text(Some(1)), "We open on Tuesday at 10:05");
    }

    #[test]
    fn an_unknown_language_is_refused_with_the_known_ones() {
        let config = KioskConfig { language: "xx".into(), ..KioskConfig::default() };
        let said = config.words(&[("en", ""), ("el", "")]).expect_err("unknown");
        assert!(said.contains("\"xx\"") && said.contains("en, el"), "{said}");
        assert!(config.words(&[("xx", "name = \"half\"")]).is_err(), "words are missing");
    }
}
