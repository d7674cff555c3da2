//! The languages of the window: every language has every message of English with the same
//! arguments, the code uses each of them and no other, and the code contains no texts.

use std::collections::{BTreeMap, BTreeSet};

use super::{root, sources};

/// Of a message or an attribute: the arguments that it names.
type Arguments = BTreeSet<String>;

/// Prefixes of the message ids that the code builds from data (brushes, actions, stages, ...);
/// tests/it/viewer/languages.rs checks that data.
const OF_DATA: [&str; 8] = [
    "kind-",
    "number-",
    "action-",
    "process-",
    "stage-",
    "check-printer-",
    "check-material-",
    "finding-",
];

/// Texts that stay in the code, and why.
const STAY: [(&str, &[&str]); 18] = [
    // English names of what messages name too, by which Ctrl+K finds an action in any language:
    // tests/it/viewer/languages.rs holds them equal to the messages.
    ("panels/state/action.rs", &[]),
    ("panels/state/tab.rs", &[]),
    // Names of programs.
    ("panels/state/key_map.rs", &["sculptd", "Blender", "ZBrush"]),
    // Families of fonts.
    ("panels/fonts.rs", &[]),
    ("panels/icons.rs", &["icons"]),
    // A file of the crate.
    ("panels/brush_picture.rs", &["brush_pictures.png"]),
    // Keys of a keypad that need no word; the other words of an installation have files of their
    // own (config/languages/CODE.toml).
    ("panels/kiosk/mod.rs", &["OK", "door", "keypad", "language", "languages"]),
    // A quantile, and what files are called.
    ("panels/timing.rs", &["p50", "p99", "max", "ms"]),
    ("panels/files.rs", &["stl, obj, ply, off, glb, 3mf"]),
    ("panels/analysis.rs", &[" mm"]),
    ("panels/check_repairs.rs", &[" mm"]),
    // Units as the checks state them, each with a message, and the name of a preset.
    ("panels/check_values.rs", &["mm", "mm2", "mm3", "degrees", "edges", "pairs", "times", "kN"]),
    ("panels/state/check.rs", &["fdm"]),
    ("panels/state/chooser.rs", &["stl", "obj", "ply", "glb", "gltf", "3mf", "sculpture.stl"]),
    ("panels/state/files.rs", &["sculpture.stl"]),
    ("panels/state/sizes.rs", &["outline.svg"]),
    // Keys as the file of preferences holds them.
    (
        "panels/state/key.rs",
        &[
            "Ctrl+",
            "Alt+",
            "Shift+",
            "Ctrl",
            "Alt",
            "Shift",
            "{text} is no key: expected one such as Z, F12, [ or Ctrl+Shift+Z",
        ],
    ),
    // Names in the tables of tablets.
    (
        "panels/tablet_keys.rs",
        &[
            "brush.",
            "view.fit",
            "view.turn",
            "view.slide",
            "view.zoom",
            "brush.invert",
            "brush.radius",
            "brush.strength",
            "brush.radius-and-strength",
        ],
    ),
];

/// Words of a line after which a text is no text for people: names of widgets, of keys in files, of
/// fields, errors that go to standard error.
const TECHNICAL: [&str; 17] = [
    "unique(",
    "id_salt(",
    "Grid::new(",
    "Panel::left(",
    "Panel::right(",
    "Panel::top(",
    "Panel::bottom(",
    "load_texture(",
    "grid(",
    "with((",
    "#[",
    "place(",
    "debug_struct(",
    ".field(",
    "tracing::",
    "Key(",
    "let key =",
];

/// The messages of a file of Fluent: `id`, and `id.attribute`.
fn messages(text: &str) -> BTreeMap<String, Arguments> {
    let mut all: BTreeMap<String, Arguments> = BTreeMap::new();
    let (mut message, mut at) = (String::new(), String::new());
    for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
        let named = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if let Some((id, _)) = line.split_once(" =").filter(|(id, _)| id.chars().all(named)) {
            (message, at) = (id.to_owned(), id.to_owned());
            assert!(all.insert(at.clone(), Arguments::new()).is_none(), "{id} stands twice");
        } else if let Some((name, _)) =
            line.trim_start().strip_prefix('.').and_then(|l| l.split_once(" ="))
        {
            at = format!("{message}.{name}");
            assert!(all.insert(at.clone(), Arguments::new()).is_none(), "{at} stands twice");
        }
        let arguments = line.split('$').skip(1).map(|rest| {
            rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '-').collect::<String>()
        });
        all.entry(at.clone()).or_default().extend(arguments);
    }
    all
}

fn files() -> BTreeMap<String, BTreeMap<String, Arguments>> {
    let folder = root().join("config/languages");
    let entries = std::fs::read_dir(folder).expect("the languages").flatten();
    let with_file = entries.filter(|e| e.path().join("window.ftl").is_file());
    with_file
        .map(|e| {
            let text = std::fs::read_to_string(e.path().join("window.ftl")).expect("UTF-8");
            (e.file_name().to_string_lossy().into_owned(), messages(&text))
        })
        .collect()
}

#[test]
fn every_language_has_every_message_with_the_same_arguments() {
    let all = files();
    let codes: Vec<&str> = all.keys().map(String::as_str).collect();
    assert_eq!(codes, ["de", "el", "en", "es", "fr", "it", "ja", "zh"]);
    let english = &all["en"];
    assert!(english.len() > 400, "{} messages", english.len());
    let mut wrong = Vec::new();
    for (code, own) in &all {
        let said = |what: &str, id: &str| format!("{code}: {what}: {id}");
        wrong.extend(english.keys().filter(|id| !own.contains_key(*id)).map(|i| said("lacks", i)));
        wrong.extend(own.keys().filter(|id| !english.contains_key(*id)).map(|i| said("has", i)));
        for (id, arguments) in own {
            if english.get(id).is_some_and(|e| e != arguments) {
                wrong.push(said("other arguments", id));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The sources of the window without their tests and comments: path under src/window, line, text.
fn lines() -> Vec<(String, usize, String)> {
    let mut all = Vec::new();
    for (path, text) in sources("src/window") {
        let name = path.strip_prefix(root().join("src/window")).expect("below").to_owned();
        let name = name.display().to_string();
        if name.ends_with("tests.rs") || name == "language.rs" {
            continue;
        }
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        for (i, line) in code.lines().enumerate() {
            let comment = line.find("//").filter(|at| !line[..*at].contains('"'));
            let line = comment.map_or(line, |at| &line[..at]);
            all.push((name.clone(), i + 1, line.to_owned()));
        }
    }
    all
}

/// Returns the quoted texts of a line.
fn literals(line: &str) -> Vec<String> {
    let (mut all, mut now, mut escaped) = (Vec::new(), None::<String>, false);
    let chars: Vec<char> = line.chars().collect();
    for (i, c) in chars.iter().enumerate() {
        match &mut now {
            _ if escaped => escaped = false,
            Some(_) if *c == '\\' => escaped = true,
            Some(_) if *c == '"' => all.extend(now.take()),
            Some(text) => text.push(*c),
            None if *c == '"' && (i == 0 || chars[i - 1] != '\'') => now = Some(String::new()),
            None => {}
        }
    }
    all.extend(now);
    all
}

#[test]
fn every_message_is_used_and_every_id_in_the_code_is_one() {
    let english = files().remove("en").expect("English");
    let (mut used, mut wrong) = (BTreeSet::new(), Vec::new());
    for (file, line, text) in lines() {
        for literal in literals(&text) {
            let base = literal.split('.').next().unwrap_or_default().to_owned();
            used.insert(literal.clone());
            used.insert(base);
            // A message id given as a literal.
            let asked = text.replace("include_str!", "").contains(&format!("tr!(\"{literal}\""));
            if asked && !english.contains_key(&literal) {
                wrong.push(format!("{file}:{line}: no message is called {literal}"));
            }
        }
    }
    let of_data = |id: &str| OF_DATA.iter().any(|prefix| id.starts_with(prefix));
    for id in english.keys() {
        let message = id.split('.').next().unwrap_or_default();
        if !used.contains(message) && !of_data(message) && message != "language-name" {
            wrong.push(format!("nothing says {id}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Returns true if a text contains a word of two letters or more outside of its placeables.
fn has_words(text: &str) -> bool {
    let mut depth = 0;
    let mut letters = 0;
    for c in text.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        letters = if depth == 0 && c.is_alphabetic() { letters + 1 } else { 0 };
        if letters > 1 {
            return true;
        }
    }
    false
}

#[test]
fn no_text_for_people_stands_in_the_panels() {
    let english = files().remove("en").expect("English");
    let mut found = Vec::new();
    let said = |text: &str| ["say(", "Message(", "add_filter("].iter().any(|s| text.contains(s));
    let shown = |l: &(String, usize, String)| l.0.starts_with("panels") || said(&l.2);
    for (file, line, text) in lines().into_iter().filter(shown) {
        let stays = STAY.iter().find(|(name, _)| *name == file).map(|(_, texts)| *texts);
        if stays.is_some_and(<[&str]>::is_empty) {
            continue;
        }
        if TECHNICAL.iter().any(|what| text.contains(what)) && !text.contains(".on_hover_text(\"") {
            continue;
        }
        for literal in literals(&text) {
            // An id, or the beginning or the attribute of one.
            let id = english.contains_key(&literal)
                || OF_DATA.iter().any(|prefix| literal.starts_with(prefix))
                || literal.starts_with("{name}.")
                || literal.starts_with("{row}.")
                || literal.starts_with("{id}.");
            let stays = stays.is_some_and(|texts| texts.contains(&literal.as_str()));
            if has_words(&literal) && !id && !stays {
                found.push(format!("{file}:{line}: \"{literal}\""));
            }
        }
    }
    assert!(found.is_empty(), "texts belong into config/languages/*/window.ftl: {found:#?}");
}
