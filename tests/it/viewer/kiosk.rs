//! The screen of an installation: every word in every language, every target large, nothing of one
//! visitor for the next.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use sculptd_clay::brush::BrushKind;
use sculptd_daemon::kiosk::desk::{KioskDesk, Screen, VisitResult};
use sculptd_daemon::kiosk::exhibit::score::Score;
use sculptd_daemon::kiosk::exhibit::{self, Exhibit, forms};
use sculptd_daemon::kiosk::staff::{StaffFacts, StaffRequest};
use sculptd_daemon::kiosk::{Hint, KioskConfig, NextOpening, Stage, View};
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;
use sculptd_window::look::{MATERIALS, material_index};
use sculptd_window::panels::state::FrameFigures;
use sculptd_window::panels::{Tab, UiRequest, kiosk};

use super::panels::{State, state};

pub(super) fn screen() -> Screen {
    let words = KioskConfig::default()
        .every_language(sculptd::settings::LANGUAGES)
        .expect("the built-in languages");
    Screen {
        desk: Arc::new(KioskDesk::default()),
        words,
        staff: true,
        show: Default::default(),
        watch: None,
        exhibits: vec![],
        share_minutes: 30.0,
    }
}

fn at(screen: &Screen, stage: Stage, visits: u64) {
    let view = View { stage, seconds_left: 7, visits, ..View::default() };
    *screen.desk.view.lock().expect("a ui_state") = Some(view);
}

pub(super) fn harness(screen: &Screen, size: [f32; 2]) -> Harness<'static, State> {
    let screen = screen.clone();
    let show = move |ui: &mut egui::Ui, s: &mut State| {
        let view = sculptd_window::panels::View {
            state: &s.published,
            translations: super::translations(),
            keys: &Default::default(),
            presets: sculptd::presets(),
            camera: s.published.camera,
            views: &s.views,
            devices: &s.devices,
            camera_preview: None,
            tablet: None,
            session: None,
            uploaded: 0,
            adapter: "an adapter",
            frame: FrameFigures::default(),
            latency: Default::default(),
            invitation: None,
            demo_runs: false,
        };
        kiosk::ui(ui, &view, &screen, &mut s.ui_state, &mut s.asked);
    };
    let mut h = Harness::builder()
        .with_size(size)
        .with_max_steps(64)
        .build_ui_state(show, state(Tab::Look));
    h.run_steps(4);
    h
}

#[test]
fn a_visit_by_large_targets_in_any_language() {
    let screen = screen();
    for size in [[1280.0, 720.0], [1920.0, 1080.0]] {
        at(&screen, Stage::Working, 0);
        let mut h = harness(&screen, size);
        // Of many languages the chosen one alone is shown until it is pressed.
        assert!(h.query_by_label("Italiano").is_none());
        h.get_by_label("English").click();
        h.run_steps(3);
        let names = [
            "Add",
            "Carve",
            "Smooth",
            "Undo",
            "Finished",
            "English",
            "Italiano",
            "Ελληνικά",
            "Staff",
        ];
        let inside = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let rects: Vec<egui::Rect> = names.iter().map(|n| h.get_by_label(n).rect()).collect();
        for (i, rect) in rects.iter().enumerate() {
            assert!(
                rect.width() >= kiosk::TARGET && rect.height() >= kiosk::TARGET,
                "{}: {rect:?}",
                names[i]
            );
            assert!(inside.contains_rect(*rect), "{} is cut: {rect:?}", names[i]);
            assert!(
                rects[..i].iter().all(|r| !r.shrink(1.0).intersects(*rect)),
                "{} overlaps",
                names[i]
            );
        }
        h.get_by_label("Ελληνικά").click();
        h.run_steps(3);
        assert!(screen.desk.touched.swap(false, Relaxed), "a press counts as a touch");
        h.get_by_label("Σκάψιμο").click();
        h.run_steps(3);
        let carves = |a: &UiRequest| matches!(a, UiRequest::World(Command::Brush(b)) if b.negative);
        assert!(h.state().asked.iter().any(carves));
        h.get_by_label("Τέλος").click();
        h.run_steps(3);
        assert!(screen.desk.finished.swap(false, Relaxed));
        // The next visitor finds the first language again.
        at(&screen, Stage::Attract, 1);
        h.run_steps(3);
        h.get_by_label("Touch to sculpt");
        at(&screen, Stage::Countdown, 1);
        h.run_steps(3);
        h.get_by_label_contains("7 s");
        h.get_by_label("Touch to go on").click();
        h.run_steps(3);
        assert!(screen.desk.touched.swap(false, Relaxed));
    }
}

#[test]
fn a_message_of_the_fleet_s_staff_stays_until_it_is_pressed_away() {
    let screen = screen();
    at(&screen, Stage::Attract, 0);
    *screen.desk.message.lock().expect("a desk") = Some("Please restart the lights".into());
    let mut h = harness(&screen, [1280.0, 720.0]);
    h.get_by_label("Please restart the lights");
    at(&screen, Stage::Working, 0);
    h.run_steps(3);
    h.get_by_label("Please restart the lights");
    let close = h.get_by_label("×");
    assert!(close.rect().width() >= kiosk::TARGET && close.rect().height() >= kiosk::TARGET);
    close.click();
    h.run_steps(3);
    assert!(h.query_by_label("Please restart the lights").is_none());
    assert_eq!(*screen.desk.message.lock().expect("a desk"), None);
}

#[test]
fn staff_types_a_number_that_is_not_shown() {
    let screen = screen();
    at(&screen, Stage::Attract, 0);
    let mut h = harness(&screen, [1280.0, 720.0]);
    h.get_by_label("Staff").click();
    h.run_steps(3);
    for key in ["4", "7", "1", "1"] {
        h.get_by_label(key).click();
        h.run_steps(3);
    }
    assert!(h.query_by_label_contains("4711").is_none());
    h.get_by_label("••••");
    h.get_by_label("OK").click();
    h.run_steps(3);
    assert_eq!(screen.desk.typed.lock().expect("a ui_state").as_deref(), Some("4711"));
    // The number was wrong: the keypad says so and takes another one, until it is locked.
    let view = |wrong, locked| {
        let view = View { locked, wrong, ..View::default() };
        *screen.desk.view.lock().expect("a ui_state") = Some(view);
    };
    view(1, false);
    h.run_steps(3);
    h.get_by_label("Wrong PIN");
    h.get_by_label("–");
    view(3, true);
    h.run_steps(3);
    h.get_by_label("Too many wrong PINs: wait a minute");
    h.get_by_label("×").click();
    h.run_steps(3);
    assert!(h.query_by_label("OK").is_none(), "the keypad is closed");
    view(3, false);
    h.run_steps(3);
    h.get_by_label("Staff").click();
    h.run_steps(3);
    assert!(h.query_by_label("Wrong PIN").is_none(), "that was somebody else");
}

#[cfg(unix)]
#[test]
fn a_visitor_consents_in_any_language_and_gets_a_code() {
    use sculptd_daemon::kiosk::share::Link;
    use sculptd_daemon::qr_code::Code;
    let screen = screen();
    at(&screen, Stage::Working, 0);
    let mut h = harness(&screen, [1280.0, 720.0]);
    h.get_by_label("English").click();
    h.run_steps(3);
    h.get_by_label("Deutsch").click();
    h.run_steps(3);
    screen.desk.touched.store(false, Relaxed);
    screen.desk.asks_consent.store(true, Relaxed);
    // The visit has ended, and the visitor's language stays.
    at(&screen, Stage::Farewell, 1);
    h.run_steps(3);
    h.get_by_label_contains("für 30 Minuten");
    let kept = screen.words.iter().find(|words| words.name == "Deutsch").map(|w| &w.kept);
    let kept = kept.expect("German");
    assert!(h.query_by_label(kept).is_none(), "nobody said that the gallery took it");
    screen.desk.kept.store(true, Relaxed);
    h.run_steps(3);
    h.get_by_label(kept);
    assert!(h.query_by_label("Fertig").is_none(), "there are no tools");
    h.get_by_label("Nein, danke").click();
    h.run_steps(3);
    assert!(screen.desk.finished.swap(false, Relaxed) && !screen.desk.consents.load(Relaxed));
    h.get_by_label("Code zeigen").click();
    h.run_steps(3);
    assert!(screen.desk.consents.swap(false, Relaxed) && !screen.desk.finished.load(Relaxed));
    let url = "http://192.168.100.200:65535/0123456789abcdef0123456789abcdef".to_owned();
    let code = Code::of(&url).expect("a code");
    let link = Link { url: url.clone(), code, until_us: u64::MAX };
    *screen.desk.link.lock().expect("a ui_state") = Some(link);
    screen.desk.asks_consent.store(false, Relaxed);
    h.run_steps(3);
    h.get_by_label(&url);
    h.get_by_label("Der Code gilt 30 min");
    h.get_by_label("Schluss").click();
    h.run_steps(3);
    assert!(screen.desk.finished.swap(false, Relaxed));
    // Gone with the farewell, whatever the keeper still holds; and the language with it.
    at(&screen, Stage::Attract, 1);
    h.run_steps(3);
    assert!(h.query_by_label(&url).is_none());
    h.get_by_label("Touch to sculpt");
}

#[test]
fn the_clay_has_the_material_of_the_settings() {
    // The settings file names every material.
    let text = include_str!("../../../config/kiosk.toml");
    let line = text.lines().find(|line| line.starts_with("material = ")).expect("the setting");
    let names = line.split_once("the clay's: ").expect("a list").1.split(", ");
    let found: Vec<usize> = names.map(|name| material_index(name).expect(name)).collect();
    assert_eq!(found, (0..MATERIALS.len()).collect::<Vec<_>>());
    assert_eq!((material_index(""), material_index("cheese")), (Some(0), None));
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("kiosk.toml");
    sculptd_geometry::io::write_beside(&file, |out| {
        out.write_all(b"[screen]\nmaterial = \"cheese\"\n")
    })
    .expect("written");
    let out = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .args(["run", "--kiosk", "--headless", "--kiosk-config"])
        .arg(&file)
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(3), "{said}");
    assert!(said.contains("screen.material = \"cheese\": expected clay, porcelain"), "{said}");
}

#[test]
fn texts_drift_while_nobody_is_here_and_stand_still_during_a_visit() {
    let screen = screen();
    let places = |stage| {
        at(&screen, stage, 0);
        let mut h = harness(&screen, [1280.0, 720.0]);
        let name = if stage == Stage::Attract { "Touch to sculpt" } else { "Finished" };
        let place = |h: &mut Harness<'_, State>, time: f64| {
            h.input_mut().time = Some(time);
            h.run_steps(2);
            h.get_by_label(name).rect().center()
        };
        [0.0, 4.0, 150.0, 300.0].map(|time| place(&mut h, time))
    };
    let drifts = places(Stage::Attract);
    assert!((drifts[1] - drifts[0]).length() < 3.0, "slowly: {drifts:?}");
    assert!((drifts[2] - drifts[0]).length() > 10.0, "{drifts:?}");
    assert!((drifts[3] - drifts[2]).length() > 10.0, "{drifts:?}");
    let still = places(Stage::Working);
    assert!(still.iter().all(|place| *place == still[0]), "{still:?}");
}

#[test]
fn a_visitor_who_has_not_sculpted_yet_sees_how() {
    let mut screen = screen();
    screen.show.hints = vec![Hint::Pen, Hint::Touch, Hint::OneHand, Hint::TwoHands];
    let english = screen.words[0].clone();
    let all = [&english.hint_pen, &english.hint_touch, &english.hint_hand, &english.hint_hands];
    at(&screen, Stage::Attract, 0);
    let mut h = harness(&screen, [1280.0, 720.0]);
    all.iter().for_each(|text| _ = h.get_by_label(text));
    at(&screen, Stage::Working, 0);
    let set = |h: &mut Harness<'_, State>, steps| {
        h.state_mut().published.undo_steps = steps;
        h.run_steps(3);
    };
    set(&mut h, 0);
    all.iter().for_each(|text| _ = h.get_by_label(text));
    set(&mut h, 1);
    all.iter().for_each(|text| assert!(h.query_by_label(text).is_none(), "{text}"));
}

#[test]
fn one_switch_presses_what_is_lit_and_all_lies_within_reach() {
    let mut screen = screen();
    screen.show.scan_s = 1.0;
    screen.show.seated = true;
    screen.show.contrast = true;
    at(&screen, Stage::Working, 0);
    let mut h = harness(&screen, [1280.0, 720.0]);
    // All controls are in the lower half.
    for name in ["Add", "Carve", "Smooth", "Finished", "English", "Staff"] {
        let rect = h.get_by_label(name).rect();
        assert!(rect.top() >= 360.0 && rect.bottom() <= 720.0, "{name}: {rect:?}");
    }
    // The context's time goes on by a step a frame: within a round of the buttons the switch has
    // met Carve and Smooth and Finished, whichever was lit first.
    let finished = || screen.desk.finished.swap(false, Relaxed);
    let (mut carved, mut smoothed, mut ended) = (false, false, false);
    for _ in 0..400 {
        h.key_press(egui::Key::Space);
        h.step();
        for asked in h.state_mut().asked.drain(..) {
            if let UiRequest::World(Command::Brush(brush)) = asked {
                carved |= brush.negative;
                smoothed |= brush.kind == BrushKind::Smooth;
            }
        }
        ended |= finished();
    }
    assert!(carved && smoothed && ended, "{carved} {smoothed} {ended}");
    // Without scanning a key presses nothing.
    screen.show.scan_s = 0.0;
    let mut h = harness(&screen, [1280.0, 720.0]);
    for _ in 0..100 {
        h.key_press(egui::Key::Space);
        h.step();
    }
    assert!(h.state().asked.is_empty() && !finished());
}

pub(super) fn exhibits() -> Vec<Arc<Exhibit>> {
    let open =
        |name: &&str| Arc::new(exhibit::open(Path::new(name), &Job::default()).expect("known"));
    forms::NAMES.iter().map(open).collect()
}

/// Everything on the screen lies within it, and apart from everything else.
fn apart(h: &Harness<'_, State>, size: [f32; 2], texts: &[String], what: &str) {
    let inside = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
    let rects: Vec<egui::Rect> = texts.iter().map(|t| h.get_by_label(t).rect()).collect();
    for (i, rect) in rects.iter().enumerate() {
        assert!(inside.contains_rect(*rect), "{what}: {} is cut: {rect:?}", texts[i]);
        for (other, text) in rects[..i].iter().zip(texts) {
            let meets = rect.shrink(1.0).intersects(*other);
            assert!(!meets, "{what}: {} {rect:?} lies over {text} {other:?}", texts[i]);
        }
    }
}

#[test]
fn an_exhibit_in_every_language_without_overlaps() {
    let mut screen = screen();
    screen.exhibits = exhibits();
    let score = Score { near: 0.9, off: 0.5, done: 0.876, too_much: 12.34, too_little: 3.21 };
    for size in [[1280.0, 720.0], [1920.0, 1080.0], [1080.0, 1920.0]] {
        at(&screen, Stage::Attract, 0);
        let mut h = harness(&screen, size);
        for i in 0..screen.words.len() {
            let set = |stage, step: usize, exhibit| {
                let view = View {
                    stage,
                    exhibit: Some(exhibit),
                    step,
                    visit_left_s: Some(125),
                    ..View::default()
                };
                *screen.desk.view.lock().expect("a desk") = Some(view);
            };
            set(Stage::Attract, 0, 0);
            *screen.desk.score.lock().expect("a desk") = None;
            h.state_mut().ui_state.pad.language = i;
            h.run_steps(3);
            let language = &screen.words[i];
            let drawn = h.query_by_label(&language.choose).map_or(&screen.words[0], |_| language);
            let mut texts: Vec<String> = screen.words.iter().map(|l| l.name.clone()).collect();
            texts.retain(|name| h.query_by_label(name).is_some());
            texts.push(drawn.staff.clone());
            let names = texts.clone();
            texts.push(drawn.choose.clone());
            texts.extend(screen.exhibits.iter().map(|e| e.manifest.title.get(&drawn.code).into()));
            apart(&h, size, &texts, &format!("{} {size:?} choice", drawn.name));
            // A visit to each.
            *screen.desk.score.lock().expect("a desk") = Some(score);
            for (e, exhibit) in screen.exhibits.iter().enumerate() {
                set(Stage::Working, 0, e);
                h.run_steps(3);
                // The languages are folded to the chosen one.
                let mut texts = names.clone();
                texts.retain(|name| h.query_by_label(name).is_some());
                assert!(texts.len() <= 2, "{texts:?}");
                texts.push(exhibit.manifest.title.get(&drawn.code).into());
                texts.push(exhibit.steps[0].text.get(&drawn.code).into());
                texts.push(drawn.near.replace("{percent}", "87"));
                texts.push(drawn.too_much.replace("{length}", &drawn.decimal(12.34)));
                texts.push(drawn.too_little.replace("{length}", &drawn.decimal(3.21)));
                texts.push(drawn.time_left.replace("{time}", "2:05"));
                texts.extend(
                    [&drawn.goal, &drawn.compare, &drawn.finish, &drawn.undo].map(Clone::clone),
                );
                apart(&h, size, &texts, &format!("{} {size:?} {}", drawn.name, exhibit.name));
            }
        }
    }
}

#[test]
fn a_visitor_chooses_an_exhibit_hides_the_goal_and_compares() {
    let mut screen = screen();
    screen.exhibits = exhibits();
    at(&screen, Stage::Attract, 0);
    let mut h = harness(&screen, [1280.0, 720.0]);
    h.get_by_label("A pot on the wheel").click();
    h.run_steps(3);
    assert!(screen.desk.touched.swap(false, Relaxed), "that begins the visit");
    let working = |exhibit| {
        let view = View { stage: Stage::Working, exhibit: Some(exhibit), ..View::default() };
        *screen.desk.view.lock().expect("a desk") = Some(view);
    };
    working(1);
    h.run_steps(3);
    // The pot has tools of its own.
    for tool in ["Grab", "Add", "Carve", "Smooth"] {
        h.get_by_label(tool);
    }
    h.get_by_label("Grab").click();
    h.run_steps(3);
    let grabs = |a: &UiRequest| match a {
        UiRequest::World(Command::Brush(b)) => b.kind == BrushKind::Grab,
        _ => false,
    };
    assert!(h.state().asked.iter().any(grabs));
    assert!(h.query_by_label("Next step").is_none(), "it has one step");
    assert!(h.query_by_label("Italiano").is_none(), "the form needs the room");
    h.get_by_label("English").click();
    h.run_steps(3);
    h.get_by_label("Italiano");
    h.get_by_label("English").click();
    h.run_steps(3);
    assert!(h.query_by_label("Italiano").is_none());
    h.get_by_label("Show the goal").click();
    h.run_steps(3);
    assert_eq!(h.state().ui_state.pad.ghost, Some(false));
    h.get_by_label("Show the difference").click();
    h.run_steps(3);
    assert!(h.state().ui_state.pad.compares);
    // The next visitor finds neither.
    at(&screen, Stage::Working, 1);
    h.run_steps(3);
    assert_eq!((h.state().ui_state.pad.ghost, h.state().ui_state.pad.compares), (None, false));
    // The result of the last visit.
    let score = Score { near: 0.95, off: 0.2, done: 0.9361, too_much: 1.0, too_little: 2.0 };
    *screen.desk.result.lock().expect("a desk") = Some(VisitResult { exhibit: 1, score });
    at(&screen, Stage::Attract, 1);
    h.run_steps(3);
    h.get_by_label("Your work: 93 % done");
}

#[test]
fn the_staff_page_shows_figures_and_asks_twice_before_the_end() {
    let mut screen = screen();
    screen.exhibits = exhibits();
    *screen.desk.staff.lock().expect("a desk") = StaffFacts {
        visits_today: 12,
        visits: 34,
        kept_today: 7,
        mean_s: 83,
        up_s: 7260,
        errors: vec!["gallery: no space left".into()],
        free_bytes: Some(12_345_678_901),
        celsius: Some(61.0),
        cleaning: false,
        exported: None,
    };
    let view = View { staff: true, exhibit: Some(0), ..View::default() };
    *screen.desk.view.lock().expect("a desk") = Some(view);
    for size in [[1280.0, 720.0], [1080.0, 1920.0]] {
        let mut h = harness(&screen, size);
        for text in ["12", "34", "7", "1:23", "2:01", "12.3 GB", "61 °C", "gallery: no space left"]
        {
            h.get_by_label(text);
        }
        assert!(h.query_by_label("Staff").is_some() && h.query_by_label("Finished").is_none());
        let asked = || std::mem::take(&mut *screen.desk.requests.lock().expect("a desk"));
        for (name, request) in [
            ("Close for cleaning", StaffRequest::Cleaning(true)),
            ("Pack today's works", StaffRequest::Export),
            ("The broken relief", StaffRequest::Exhibit(2)),
            ("Restart", StaffRequest::Restart),
            ("Back to the visit", StaffRequest::Leave),
        ] {
            h.get_by_label(name).click();
            h.run_steps(3);
            assert_eq!(asked(), [request], "{name}");
        }
        h.get_by_label("End for good").click();
        h.run_steps(3);
        assert_eq!(asked(), [], "once is not enough");
        h.get_by_label("Press again to end").click();
        h.run_steps(3);
        assert_eq!(asked(), [StaffRequest::End]);
    }
}

#[test]
fn a_closed_installation_says_when_it_opens_and_has_no_tools() {
    let screen = screen();
    let closed = |cleaning| {
        let opens_next = Some(NextOpening { weekday: None, minute: 9 * 60 + 5 });
        let view =
            View { stage: Stage::Closed, cleaning, opens_next, dim_percent: 60, ..View::default() };
        *screen.desk.view.lock().expect("a desk") = Some(view);
    };
    closed(false);
    for size in [[1280.0, 720.0], [1080.0, 1920.0]] {
        let mut h = harness(&screen, size);
        for (i, language) in screen.words.iter().enumerate() {
            h.state_mut().ui_state.pad.language = i;
            h.run_steps(3);
            let drawn = h.query_by_label(&language.closed).map_or(&screen.words[0], |_| language);
            let opens = drawn.opens.replace("{time}", "9:05");
            apart(&h, size, &[drawn.closed.clone(), opens, drawn.staff.clone()], &drawn.name);
            assert!(h.query_by_label(&drawn.finish).is_none());
        }
    }
    closed(true);
    let h = harness(&screen, [1280.0, 720.0]);
    h.get_by_label("A short break. We will be back soon.");
    assert!(h.query_by_label("We open at 9:05").is_none());
}
