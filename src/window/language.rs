//! What the window says, in the language that a person has chosen: messages in Fluent files
//! (<https://projectfluent.org>), each with an id and arguments.
//!
//! Laws kept here:
//! * English holds every message. What another language lacks is said in English, and what no file
//!   holds is said as its id: a text is never empty.
//! * A thread speaks one language at a time ([`set_current`]): the window's own thread sets it once
//!   a frame, and a task takes the one that was in force when it began.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fluent_bundle::concurrent::FluentBundle;
use fluent_bundle::{FluentArgs, FluentResource};
use unic_langid::LanguageIdentifier;

/// Argument of a message: a text, or a number that chooses between singular and plural.
pub use fluent_bundle::FluentValue as Argument;

/// Texts of languages in Fluent's syntax, each behind its code (`en`).
pub type FluentTexts<'a> = &'a [(&'a str, &'a str)];

/// The code of the language that is complete.
pub const ENGLISH: &str = "en";

/// The file of a language, in the folder that is called by its code.
const FILE: &str = "window.ftl";

/// The messages of one language.
pub struct Translation {
    code: String,
    bundle: FluentBundle<FluentResource>,
    /// Every character that its files hold, each once, in order.
    letters: String,
    /// English, where this is another language.
    fallback: Option<Arc<Translation>>,
}

impl std::fmt::Debug for Translation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Translation").field("code", &self.code).finish_non_exhaustive()
    }
}

impl Default for Translation {
    fn default() -> Self {
        Translation::new(ENGLISH, None)
    }
}

impl Translation {
    fn new(code: &str, fallback: Option<Arc<Translation>>) -> Translation {
        let language: LanguageIdentifier = code.parse().unwrap_or_default();
        let mut bundle = FluentBundle::new_concurrent(vec![language]);
        // The marks of direction that Fluent puts round arguments are glyphs that fonts lack.
        bundle.set_use_isolating(false);
        Translation { code: code.to_owned(), bundle, letters: String::new(), fallback }
    }

    /// Adds the messages of a text; they replace existing ones of the same name.
    ///
    /// # Errors
    /// The line and the fault, if the text is not valid Fluent.
    fn add(&mut self, text: &str) -> Result<(), String> {
        let resource = FluentResource::try_new(text.to_owned()).map_err(|(_, faults)| {
            let fault = faults.first();
            let line = fault.map_or(0, |f| text[..f.pos.start.min(text.len())].lines().count());
            let what = fault.map_or_else(String::new, |f| f.kind.to_string());
            format!("line {}: {what}", line.max(1))
        })?;
        self.bundle.add_resource_overriding(resource);
        let mut letters: Vec<char> = self.letters.chars().chain(text.chars()).collect();
        letters.retain(|c| !c.is_control() && !c.is_whitespace());
        letters.sort_unstable();
        letters.dedup();
        self.letters = letters.into_iter().collect();
        Ok(())
    }

    /// Such as `en`.
    pub fn code(&self) -> &str {
        &self.code
    }

    /// Every character that a font needs for this language.
    pub fn letters(&self) -> &str {
        &self.letters
    }

    /// A message of this language alone; `id.attribute` is an attribute of one.
    fn own(&self, id: &str, arguments: &[(&str, Argument<'_>)]) -> Option<String> {
        let (message, attribute) = match id.split_once('.') {
            Some((message, attribute)) => (message, Some(attribute)),
            None => (id, None),
        };
        let message = self.bundle.get_message(message)?;
        let pattern = match attribute {
            Some(name) => message.get_attribute(name)?.value(),
            None => message.value()?,
        };
        let arguments: FluentArgs<'_> =
            arguments.iter().map(|(name, value)| (*name, value.clone())).collect();
        let mut faults = Vec::new();
        let text = self.bundle.format_pattern(pattern, Some(&arguments), &mut faults);
        Some(text.into_owned())
    }

    /// A message, in English where this language lacks it; `None` where English lacks it too.
    pub fn find(&self, id: &str, arguments: &[(&str, Argument<'_>)]) -> Option<String> {
        let english = || self.fallback.as_ref().and_then(|f| f.own(id, arguments));
        self.own(id, arguments).or_else(english)
    }

    /// The language's own name, and its name in Latin letters.
    pub fn names(&self) -> (String, String) {
        let name = |id: &str| self.own(id, &[]).unwrap_or_else(|| self.code.clone());
        (name("language-name"), name("language-name.latin"))
    }
}

/// Every language that can be chosen.
#[derive(Debug)]
pub struct Translations {
    /// English first.
    all: Vec<Arc<Translation>>,
    /// Index of the language that the system asks for.
    of_system: usize,
    /// Files that cannot be read, and why.
    pub wrong: Vec<(PathBuf, String)>,
}

impl Translations {
    /// The languages that the program brings along, and those of a folder: what
    /// `FOLDER/CODE/window.ftl` holds is laid over a language, or is a new one. `locale` is what
    /// the system asks for, in the form of the variable `LANG` (`it_IT.UTF-8`); empty: English.
    pub fn new(built_in: FluentTexts<'_>, folder: Option<&Path>, locale: &str) -> Translations {
        let mut wrong = Vec::new();
        let mut texts: Vec<(String, PathBuf, String)> = Vec::new();
        for (code, text) in built_in {
            texts.push(((*code).to_owned(), PathBuf::from(FILE), (*text).to_owned()));
        }
        for (code, path) in folder.map(of_folder).unwrap_or_default() {
            match std::fs::read_to_string(&path) {
                Ok(text) => texts.push((code, path, text)),
                Err(e) => wrong.push((path, e.to_string())),
            }
        }
        // A stable sort: what is laid over a language comes after it.
        texts.sort_by_key(|(code, ..)| code != ENGLISH);
        let mut all: Vec<Translation> = vec![Translation::new(ENGLISH, None)];
        for (code, path, text) in &texts {
            let at = all.iter().position(|t| t.code == *code).unwrap_or_else(|| {
                all.push(Translation::new(code, None));
                all.len() - 1
            });
            if let Err(e) = all[at].add(text) {
                wrong.push((path.clone(), e));
            }
        }
        let mut all = all.into_iter();
        let english = Arc::new(all.next().unwrap_or_default());
        let mut shared = vec![english.clone()];
        shared.extend(all.map(|t| Arc::new(Translation { fallback: Some(english.clone()), ..t })));
        let of_system = of_locale(&shared, locale);
        Translations { all: shared, of_system, wrong }
    }

    pub fn all(&self) -> &[Arc<Translation>] {
        &self.all
    }

    pub fn english(&self) -> &Arc<Translation> {
        &self.all[0]
    }

    /// The language of a code; that of the system where the code is empty or not known.
    pub fn choose(&self, code: &str) -> &Arc<Translation> {
        self.all.iter().find(|t| t.code == code).unwrap_or(&self.all[self.of_system])
    }
}

/// The languages of a folder, by code.
fn of_folder(folder: &Path) -> Vec<(String, PathBuf)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<(String, PathBuf)> = entries
        .flatten()
        .map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().join(FILE)))
        .filter(|(code, path)| code.parse::<LanguageIdentifier>().is_ok() && path.is_file())
        .collect();
    found.sort();
    found
}

/// The language of a locale: `it_IT.UTF-8` is `it-IT`, else `it`; what is not known is English.
fn of_locale(all: &[Arc<Translation>], locale: &str) -> usize {
    let whole = locale.split(['.', '@']).next().unwrap_or_default().replace('_', "-");
    let language = whole.split('-').next().unwrap_or_default();
    let known = |code: &str| all.iter().position(|t| t.code.eq_ignore_ascii_case(code));
    known(&whole).or_else(|| known(language)).unwrap_or(0)
}

thread_local! {
    static CURRENT: RefCell<Arc<Translation>> = RefCell::default();
}

/// From now on this thread speaks this language.
pub fn set_current(translation: &Arc<Translation>) {
    CURRENT.with_borrow_mut(|now| {
        if !Arc::ptr_eq(now, translation) {
            *now = translation.clone();
        }
    });
}

/// The language of this thread.
pub fn current() -> Arc<Translation> {
    CURRENT.with_borrow(Arc::clone)
}

/// A message in the language of this thread: `id`, or `id.attribute`.
pub fn text(id: &str, arguments: &[(&str, Argument<'_>)]) -> String {
    CURRENT.with_borrow(|t| t.find(id, arguments)).unwrap_or_else(|| id.to_owned())
}

/// The same where the program knows the id by its data alone: what no file holds is said as
/// `otherwise`.
pub fn text_or(id: &str, otherwise: &str) -> String {
    CURRENT.with_borrow(|t| t.find(id, &[])).unwrap_or_else(|| otherwise.to_owned())
}

/// A text of the data, translated where English has the same text for it: one that a person has
/// changed stays.
pub fn text_of(id: &str, data: &str) -> String {
    CURRENT.with_borrow(|t| {
        let english = t.fallback.as_ref().and_then(|f| f.own(id, &[]));
        let same = english.is_some_and(|e| e == data);
        same.then(|| t.own(id, &[])).flatten().unwrap_or_else(|| data.to_owned())
    })
}

/// A message by its id, with its arguments by name: `tr!("percent", value = 12)`.
macro_rules! tr {
    ($id:expr) => { $crate::language::text($id, &[]) };
    ($id:expr, $($name:ident = $value:expr),+ $(,)?) => {
        $crate::language::text(
            $id,
            &[$((stringify!($name), $crate::language::Argument::from($value))),+],
        )
    };
}
pub(crate) use tr;

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The languages of this repository.
    pub(crate) fn of_config(locale: &str) -> Translations {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/languages");
        let all = Translations::new(&[], Some(&folder), locale);
        assert!(all.wrong.is_empty(), "{:?}", all.wrong);
        all
    }

    #[test]
    fn a_language_lacks_nothing_that_english_has_and_counts_as_people_do() {
        let built_in = [
            ("xx", "greeting = Salve"),
            ("en", "greeting = Hello\nleft = { $n ->\n    [one] one\n   *[other] { $n } more\n}\n"),
        ];
        let all = Translations::new(&built_in, None, "xx_YY.UTF-8@euro");
        assert!(all.wrong.is_empty(), "{:?}", all.wrong);
        set_current(all.choose(""));
        assert_eq!(current().code(), "xx");
        assert_eq!(tr!("greeting"), "Salve");
        assert_eq!([tr!("left", n = 1), tr!("left", n = 3)], ["one", "3 more"]);
        assert_eq!(tr!("nowhere.tip"), "nowhere.tip");
        set_current(all.choose("en"));
        assert_eq!(tr!("greeting"), "Hello");
        for locale in ["", "C", "POSIX", "tlh_QO"] {
            let all = Translations::new(&built_in, None, locale);
            assert_eq!(all.choose("").code(), "en", "{locale}");
        }
    }

    #[test]
    fn a_person_s_folder_changes_a_language_and_adds_one() {
        let dir = tempfile::tempdir().expect("a folder");
        for (code, text) in [("en", "greeting = Ahoy"), ("gl", "greeting = Ola"), ("de", "a = {")] {
            std::fs::create_dir(dir.path().join(code)).expect("a folder");
            #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
            std::fs::write(dir.path().join(code).join(FILE), text).expect("written");
        }
        let built_in = [("en", "greeting = Hello\nbye = Bye"), ("de", "greeting = Hallo")];
        let all = Translations::new(&built_in, Some(dir.path()), "");
        assert_eq!(all.wrong.len(), 1, "{:?}", all.wrong);
        assert!(all.wrong[0].0.ends_with("de/window.ftl"), "{:?}", all.wrong);
        let said = |code: &str, id: &str| all.choose(code).find(id, &[]);
        assert_eq!(said("en", "greeting").as_deref(), Some("Ahoy"));
        assert_eq!(said("gl", "greeting").as_deref(), Some("Ola"));
        assert_eq!(said("gl", "bye").as_deref(), Some("Bye"));
        assert_eq!(said("de", "greeting").as_deref(), Some("Hallo"));
    }

    #[test]
    fn a_text_that_a_person_changed_is_not_translated() {
        let built_in = [("en", "a = A word"), ("it", "a = Una parola")];
        let all = Translations::new(&built_in, None, "it");
        set_current(all.choose(""));
        assert_eq!(text_of("a", "A word"), "Una parola");
        assert_eq!(text_of("a", "My word"), "My word");
        assert_eq!(text_of("b", "Another"), "Another");
    }
}
