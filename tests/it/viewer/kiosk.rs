//! The screen of an installation: every word in every language, every target large, nothing of one
//! visitor for the next.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use sculptd_clay::brush::BrushKind;
use sculptd_daemon::kiosk::keeper::{KioskDesk, Screen};
use sculptd_daemon::kiosk::{KioskConfig, Stage, View};
use sculptd_engine::command::Command;
use sculptd_window::panels::state::FrameFigures;
use sculptd_window::panels::{Tab, UiRequest, kiosk};

use super::panels::{State, state};

fn screen() -> Screen {
    let words = KioskConfig::default()
        .every_language(sculptd::settings::LANGUAGES)
        .expect("the built-in languages");
    Screen {
        desk: Arc::new(KioskDesk::default()),
        words,
        staff: true,
        show: Default::default(),
        watch: None,
    }
}

fn at(screen: &Screen, stage: Stage, visits: u64) {
    let view = View { stage, seconds_left: 7, visits, locked: false, wrong: 0 };
    *screen.desk.view.lock().expect("a ui_state") = Some(view);
}

fn harness(screen: &Screen, size: [f32; 2]) -> Harness<'static, State> {
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
        let view = View { stage: Stage::Attract, seconds_left: 0, visits: 0, locked, wrong };
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
fn the_last_visitor_s_work_goes_home_by_a_code_in_every_language() {
    use sculptd_daemon::kiosk::share::Link;
    use sculptd_daemon::qr_code::{Code, Invitation};
    let mut screen = screen();
    let page = "http://192.168.100.200:8710/#0123456789abcdef0123456789abcdef".to_owned();
    let code = Code::of(&page).expect("a code");
    screen.watch = Some(Invitation { url: page, code });
    let url = "http://192.168.100.200:65535/0123456789abcdef0123456789abcdef".to_owned();
    let code = Code::of(&url).expect("a code");
    *screen.desk.link.lock().expect("a ui_state") =
        Some(Link { url: url.clone(), code, until_us: u64::MAX });
    for size in [[1280.0, 720.0], [1920.0, 1080.0]] {
        at(&screen, Stage::Attract, 0);
        let mut h = harness(&screen, size);
        let inside = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for (i, language) in screen.words.iter().enumerate() {
            h.state_mut().ui_state.pad.language = i;
            h.run_steps(3);
            // Without a font for its letters, English stands in.
            let english = &screen.words[0];
            let drawn = h.query_by_label(&language.kept).map_or(english, |_| language);
            let place = |text: &String| {
                let rect = h.get_by_label(text).rect();
                assert!(inside.contains_rect(rect), "{text} is cut: {rect:?}");
                rect
            };
            let work = [&drawn.kept, &drawn.fetch, &url].map(place);
            let watch = place(&drawn.watch);
            let middle = [&drawn.welcome, &drawn.turn].map(place);
            let apart = |r: &egui::Rect| !r.intersects(watch);
            assert!(work.iter().chain(&middle).all(apart), "{}: {watch:?}", drawn.name);
        }
        // Gone with the next visitor's first touch, whatever the keeper still holds.
        at(&screen, Stage::Working, 0);
        h.run_steps(3);
        assert!(h.query_by_label(&url).is_none());
    }
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
