//! The window in every language: each name that comes from the program's own data has a message,
//! and every page fits.

use std::collections::BTreeSet;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use sculptd_check::FindingKind;
use sculptd_check::preset::CheckPreset;
use sculptd_clay::LayerEdit;
use sculptd_clay::brush::BrushKind;
use sculptd_daemon::present_latency::{ABOUT, STAGES};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::thickness::preset::Preset;
use sculptd_window::language::{Translation, Translations, current};
use sculptd_window::look::MATERIALS;
use sculptd_window::panels::Tab;
use sculptd_window::panels::state::action;

use super::layout::{TABS, fill, misplaced, misplaced_but_for_lists};
use super::panels::{State, show, state};

/// Widths and scale of the screens, pixels.
const SCREENS: [(f32, f32); 7] = [
    (420.0, 1.0),
    (700.0, 1.0),
    (1440.0, 1.0),
    (2560.0, 1.0),
    (840.0, 2.0),
    (1440.0, 2.0),
    (2560.0, 2.0),
];
/// Parts that are folded at first, by their titles, the outer ones first.
const FOLDED: [&str; 9] = [
    "brush-more",
    "brush-stroke",
    "brush-settings",
    "brush-dab",
    "brush-stamp",
    "brush-automasks",
    "brush-topology",
    "pressure-heading",
    "mask-heading",
];

/// The messages of names that the program's own data holds, with their English texts.
fn of_data() -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut put = |id: String, text: &str| all.push((id, text.to_owned()));
    for entry in action::all() {
        match entry.action {
            action::Action::Brush(_) => {}
            action::Action::Page(_) => {}
            action => put(format!("action-{}", action.id()), &entry.name),
        }
    }
    for (tab, name, about) in Tab::ALL {
        put(tab.id().to_owned(), name);
        put(format!("{}.about", tab.id()), about);
    }
    for kind in BrushKind::ALL {
        let name = kind.name();
        let title = name.replace('-', " ");
        put(format!("kind-{name}"), &(title[..1].to_uppercase() + &title[1..]));
        put(format!("kind-{name}.about"), sculptd::presets().get(*kind).about());
        for number in kind.own_numbers() {
            put(format!("number-{}", number.name), number.name);
        }
    }
    for (stage, about) in STAGES.iter().zip(ABOUT) {
        put(format!("stage-{stage}"), stage);
        put(format!("stage-{stage}.about"), about);
    }
    for file in std::fs::read_dir("config/thickness").expect("the presets of walls").flatten() {
        let text = std::fs::read_to_string(file.path()).expect("a text");
        let preset: Preset = toml::from_str(&text).expect("a preset");
        put(format!("process-{}", preset.name), &preset.title);
    }
    for preset in super::check::library().checks {
        match preset {
            // Those that have limits of walls are named by these.
            CheckPreset::Process(p) if p.walls.is_none() => {
                put(format!("process-{}", p.name), &p.title);
            }
            CheckPreset::Process(_) => {}
            CheckPreset::Printer(p) => put(format!("check-printer-{}", p.name), &p.title),
            CheckPreset::Material(m) => put(format!("check-material-{}", m.name), &m.title),
        }
    }
    all
}

#[test]
fn names_of_the_program_s_data_are_messages_with_the_same_english_text() {
    let english = super::translations().english();
    let said = |id: &str| english.find(id, &[]);
    let mut wrong = Vec::new();
    for (id, text) in of_data() {
        if said(&id).as_deref() != Some(text.as_str()) {
            wrong.push(format!("{id} = {text}, not {:?}", said(&id)));
        }
    }
    for kind in BrushKind::ALL {
        for number in kind.own_numbers() {
            let id = format!("number-{}", number.name);
            let known = [format!("{id}.{}", kind.name()), format!("{id}.about")];
            if !known.iter().any(|id| said(id).as_deref() == Some(number.about)) {
                wrong.push(format!("{id} of {kind}: {}", number.about));
            }
        }
    }
    for kind in FindingKind::ALL {
        let id = format!("finding-{}", kind.name());
        let known = said(&id).is_some() && said(&format!("{id}.advice")).is_some();
        // What was not checked says why.
        if !known && kind != FindingKind::NotChecked {
            wrong.push(id);
        }
    }
    wrong.extend(MATERIALS.iter().filter(|m| said(m.name).is_none()).map(|m| m.name.to_owned()));
    assert!(wrong.is_empty(), "{wrong:#?}");
    // And none of these messages is about something that is not there any more.
    let of_data: BTreeSet<String> = of_data().into_iter().map(|(id, _)| id).collect();
    let prefixes =
        ["kind-", "number-", "stage-", "process-", "page-", "check-printer-", "check-material-"];
    let text = include_str!("../../../config/languages/en/window.ftl");
    let ids = text.lines().filter_map(|l| l.split_once(" = ")).map(|(id, _)| id);
    let of_prefix = ids.filter(|id| prefixes.iter().any(|p| id.starts_with(p)));
    let stale: Vec<&str> = of_prefix.filter(|id| !of_data.contains(*id)).collect();
    assert!(stale.is_empty(), "{stale:?}");
}

fn harness(language: &Translation, width: f32, height: f32, scale: f32) -> Harness<'static, State> {
    let mut s = state(Tab::Look);
    s.ui_state.prefs.language = language.code().to_owned();
    s.published.undo_steps = 4;
    s.published.redo_steps = 2;
    let mut h = Harness::builder()
        .with_size([width / scale, height / scale])
        .with_pixels_per_point(scale)
        .build_ui_state(show, s);
    h.run_steps(3);
    h
}

/// Returns true if the window can display this language here: some need a font that a machine may
/// lack.
fn speaks(h: &Harness<'_, State>, language: &Translation) -> bool {
    let fontless = h.state().ui_state.shown_language.fontless;
    if fontless {
        println!("skipped: no font of this machine has the letters of {}", language.code());
        assert_eq!(current().code(), "en", "English stands in");
    }
    !fontless
}

#[test]
fn every_page_fits_in_every_language() {
    let (mut bad, mut pages) = (Vec::new(), 0);
    for language in super::translations().all() {
        for (width, scale) in SCREENS {
            let mut h = harness(language, width, 3200.0, scale);
            if !speaks(&h, language) {
                break;
            }
            for tab in TABS {
                h.state_mut().ui_state.tab = tab;
                let s = h.state_mut();
                s.ui_state.look.map = Default::default();
                s.published.hands = None;
                fill(s, tab);
                h.run_steps(3);
                assert_eq!(current().code(), language.code());
                pages += 1;
                let at = format!("{} {width} at {scale}, {tab:?}", language.code());
                bad.extend(misplaced(&h).into_iter().map(|what| format!("{at}: {what}")));
            }
            // The layers of the object.
            let mut world = super::world(2_000);
            let layer = SceneCommand::Layers(LayerEdit::Add("layer 1".into()));
            world.step(1, &[], &[Command::Scene(layer)]);
            h.state_mut().published = super::published(&mut world);
            assert!(h.state().published.mesh.layers().is_some(), "the page shows one");
            h.state_mut().ui_state.tab = Tab::Scene;
            h.run_steps(3);
            let at = format!("{} {width} at {scale}, layers", language.code());
            bad.extend(misplaced(&h).into_iter().map(|what| format!("{at}: {what}")));
        }
    }
    println!("{pages} pages");
    assert!(bad.is_empty(), "{} faults: {:#?}", bad.len(), &bad[..bad.len().min(80)]);
}

#[test]
fn what_unfolds_and_what_lies_over_the_clay_fits_in_every_language() {
    let mut bad = Vec::new();
    for language in super::translations().all() {
        for (width, scale) in [(420.0, 1.0), (1440.0, 1.0), (2560.0, 2.0)] {
            let mut h = harness(language, width, 5200.0, scale);
            if !speaks(&h, language) {
                break;
            }
            h.state_mut().published.brush.kind = BrushKind::Plane;
            h.state_mut().published.brush.path.jitter = 0.5;
            h.state_mut().published.brush.path.continuous = true;
            h.state_mut().published.brush.stamp.by = sculptd_clay::brush::StampBy::Stencil;
            h.state_mut().published.brush.topology.by = sculptd_clay::brush::Measure::Brush;
            for title in FOLDED {
                let title = language.find(title, &[]).expect("a message");
                // Not by the pointer: what unfolds moves what else has the label.
                h.query_all_by_label(&title).for_each(|node| node.click_accesskit());
                h.run_steps(2);
            }
            // The animation of what unfolds.
            h.run_steps(8);
            let inner = ["dab-hardness", "stamp-size", "automask-cavity", "topology-length"];
            for inner in inner.map(|id| language.find(id, &[]).expect("a message")) {
                assert!(h.query_all_by_label(&inner).next().is_some(), "{inner} is unfolded");
            }
            let at = format!("{} {width} at {scale}", language.code());
            let wrong = misplaced_but_for_lists(&h).into_iter();
            bad.extend(wrong.map(|what| format!("{at}, unfolded: {what}")));
            for which in ["help", "keys", "search"] {
                let mut h = harness(language, width, 1000.0 * scale, scale);
                match which {
                    "help" => h.state_mut().ui_state.help = true,
                    "keys" => h.state_mut().ui_state.keys.open = true,
                    _ => h.state_mut().ui_state.search = Some(Default::default()),
                }
                h.run_steps(4);
                let cut = misplaced(&h).into_iter().filter(|wrong| wrong.contains("is cut"));
                bad.extend(cut.map(|what| format!("{at}, {which}: {what}")));
            }
        }
    }
    assert!(bad.is_empty(), "{} faults: {:#?}", bad.len(), &bad[..bad.len().min(80)]);
}

#[test]
fn a_language_is_chosen_in_the_preferences_and_spoken_at_once() {
    let english = super::translations().english();
    let mut h = harness(english, 1280.0, 720.0, 1.0);
    h.state_mut().ui_state.tab = Tab::More;
    h.run_steps(2);
    h.get_by_label("Language").click();
    h.run_steps(2);
    h.get_by_label("Italiano").click();
    h.run_steps(3);
    assert_eq!(h.state().ui_state.prefs.language, "it");
    assert!(h.query_by_label("Preferenze").is_some(), "at once");
    // Kept from day to day.
    let kept = toml::to_string(&h.state().ui_state.prefs).expect("plain data");
    assert!(kept.contains("language = \"it\""), "{kept}");
    // The palette knows the English words too.
    let found = action::search("thickness map");
    assert_eq!(found[0].action, action::Action::Thickness);
    assert_eq!(action::search("mappa dello spessore")[0].action, action::Action::Thickness);
}

#[test]
fn where_no_font_has_the_letters_english_stands_in_and_the_page_says_so() {
    // A code point that Unicode leaves to private use.
    let unwritten = "language-name = \u{10fffd}\n    .latin = Unwritten\noff = \u{10fffd}\n";
    let texts: Vec<(&str, &str)> =
        sculptd::settings::WINDOW_TEXTS.iter().copied().chain([("qaa", unwritten)]).collect();
    let mut s = state(Tab::More);
    s.translations = Box::leak(Box::new(Translations::new(&texts, None, "en")));
    s.ui_state.prefs.language = "qaa".into();
    let mut h = Harness::builder().with_size([1280.0, 900.0]).build_ui_state(show, s);
    h.run_steps(3);
    assert!(h.state().ui_state.shown_language.fontless);
    assert_eq!(current().code(), "en");
    assert!(h.query_by_label_contains("Unwritten needs a font that this computer lacks").is_some());
    // Another language is spoken again.
    h.state_mut().ui_state.prefs.language = "el".into();
    h.run_steps(3);
    assert!(!h.state().ui_state.shown_language.fontless);
    assert_eq!(current().code(), "el");
}
