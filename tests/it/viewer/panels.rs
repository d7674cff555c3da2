//! Panels through AccessKit: what a screen reader finds, a keyboard and a pointer can do.

use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{DVec2, DVec3};
use sculptd_clay::brush::{BrushKind, Method, Presets};
use sculptd_daemon::Published;
use sculptd_daemon::trim::Part;
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;
use sculptd_engine::stroke::CurveAction;
use sculptd_geometry::projection::PlaneRegion;
use sculptd_window::language::Translations;
use sculptd_window::look::Map;
use sculptd_window::panels::state::region::{RegionPurpose, RegionShape};
use sculptd_window::panels::state::{
    Action, DistanceSummary, FrameFigures, KeyMap, Measured, Preferences, SessionView, StepPicture,
    TabletKeys, TrialStatus, Views,
};
use sculptd_window::panels::{Tab, UiRequest, UiState, View, all};

pub(super) struct State {
    pub published: Published,
    pub ui_state: UiState,
    pub asked: Vec<UiRequest>,
    pub devices: Vec<String>,
    pub invitation: Option<sculptd_daemon::qr_code::Invitation>,
    pub demo_runs: bool,
    pub tablet: Option<TabletKeys>,
    pub views: Views,
    pub translations: &'static Translations,
    pub presets: Presets,
    pub session: Option<TestSession>,
}

/// State of the session's file.
pub(super) struct TestSession {
    pub fault: Option<String>,
    pub lost: u64,
}

/// The preferences of a person who has chosen English.
fn english() -> Preferences {
    Preferences { language: "en".into(), ..Default::default() }
}

pub(super) fn state(tab: Tab) -> State {
    let mut world = super::world(2_000);
    State {
        published: super::published(&mut world),
        ui_state: UiState { tab, prefs: english(), ..Default::default() },
        asked: Vec::new(),
        devices: Vec::new(),
        invitation: None,
        demo_runs: false,
        tablet: None,
        views: Views::default(),
        translations: super::translations(),
        presets: sculptd::presets().apart(),
        session: None,
    }
}

pub(super) fn show(ui: &mut egui::Ui, s: &mut State) {
    let keys = KeyMap::new(&s.ui_state.prefs.keys);
    let view = View {
        state: &s.published,
        translations: s.translations,
        keys: &keys,
        presets: &s.presets,
        camera: s.published.camera,
        views: &s.views,
        devices: &s.devices,
        camera_preview: None,
        tablet: s.tablet.clone(),
        session: s.session.as_ref().map(|session| SessionView {
            path: "/s/head.sculpt",
            fault: session.fault.clone(),
            lost: session.lost,
        }),
        uploaded: 0,
        adapter: "an adapter",
        frame: FrameFigures::default(),
        latency: Default::default(),
        invitation: s.invitation.as_ref(),
        demo_runs: s.demo_runs,
    };
    all(ui, &view, &mut s.ui_state, &mut s.asked);
}

pub(super) fn harness(tab: Tab) -> Harness<'static, State> {
    let mut h = Harness::builder()
        .with_size([1280.0, 720.0])
        .with_max_steps(64)
        .build_ui_state(show, state(tab));
    h.run_steps(3);
    h
}

/// The part of the window that shows the clay, points.
pub(super) fn view_of(h: &Harness<'_, State>) -> egui::Rect {
    h.state().ui_state.brush_panel.free.expect("a frame was shown")
}

pub(super) fn brushes(h: &Harness<'_, State>) -> Vec<sculptd_clay::brush::BrushSettings> {
    let of = |a: &UiRequest| match a {
        UiRequest::World(Command::Brush(b)) => Some(*b),
        _ => None,
    };
    h.state().asked.iter().filter_map(of).collect()
}

#[test]
fn a_brush_is_chosen_by_its_name_and_a_mirror_by_its_axis() {
    let mut h = harness(Tab::Look);
    h.get_by_label("Smooth").click();
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.kind), Some(BrushKind::Smooth));
    h.get_by_label("y").click();
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.symmetry), Some([false, true, false]));
}

#[test]
fn a_curve_that_is_laid_has_buttons_and_keys() {
    let mut world = super::world(2_000);
    let mut brush = *world.brush();
    brush.path.method = Method::Curve;
    let pen = |x: f32, tip: bool, tick: u64| {
        let area_mm = glam::Vec2::new(1600.0, 1000.0);
        let pos_mm = area_mm * glam::Vec2::new(x, 0.5);
        let pen =
            Pen { in_range: true, tip, pos_mm, area_mm, pressure: Some(0.7), ..Pen::default() };
        Sample { device: DeviceId(1), t_us: tick * 8000, device_t_us: None, body: Body::Pen(pen) }
    };
    world.step(1, &[], &[Command::Brush(brush)]);
    for (i, x) in [0.4, 0.5, 0.6].into_iter().enumerate() {
        let tick = 2 + 2 * i as u64;
        world.step(tick, &[pen(x, true, tick)], &[]);
        world.step(tick + 1, &[pen(x, false, tick + 1)], &[]);
    }
    let mut h = harness(Tab::Look);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    assert_eq!(h.state().published.draft.points().len(), 3);
    let acts = |h: &mut Harness<'_, State>| -> Vec<CurveAction> {
        let of = |a: &UiRequest| match a {
            UiRequest::World(Command::CurveStroke(act)) => Some(*act),
            _ => None,
        };
        h.state_mut().asked.drain(..).filter_map(|a| of(&a)).collect()
    };
    h.get_by_label("3 points");
    h.key_press(Key::Enter);
    h.run_steps(2);
    h.key_press(Key::Escape);
    h.run_steps(2);
    // No handle is selected before one was held.
    h.key_press(Key::Delete);
    h.run_steps(2);
    assert_eq!(acts(&mut h), [CurveAction::Apply, CurveAction::Cancel]);
    // The pen holds the middle one.
    world.step(20, &[pen(0.5, true, 20)], &[]);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    world.step(21, &[pen(0.5, false, 21)], &[]);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    h.get_by_label("Remove the point").click();
    h.run_steps(2);
    h.get_by_label("Draw the curve").click();
    h.run_steps(2);
    let asked = acts(&mut h);
    assert_eq!(asked, [CurveAction::Delete(1), CurveAction::Apply]);
    // The world carries out the requests.
    for (i, act) in asked.into_iter().enumerate() {
        world.step(30 + i as u64, &[], &[Command::CurveStroke(act)]);
    }
    assert!(world.curve_stroke().is_none() && world.undo_steps() == 1);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    assert!(h.query_by_label("Draw the curve").is_none());
}

#[test]
fn undo_waits_until_there_is_something_to_take_back() {
    let mut h = harness(Tab::Look);
    h.get_by_label("Undo").click();
    h.run_steps(2);
    assert!(h.state().asked.is_empty());
    h.state_mut().published.undo_steps = 3;
    h.run_steps(2);
    h.get_by_label("Undo").click();
    h.run_steps(2);
    assert!(
        matches!(h.state().asked[..], [UiRequest::World(Command::Undo)]),
        "{:?}",
        h.state().asked
    );
}

#[test]
fn keys_do_what_the_tooltips_say() {
    let mut h = harness(Tab::Look);
    h.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    h.run_steps(2);
    h.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    h.run_steps(2);
    let s = h.state();
    assert!(
        matches!(s.asked[..], [UiRequest::World(Command::Undo), UiRequest::World(Command::Redo)]),
        "{:?}",
        s.asked
    );
    assert!(s.ui_state.prefs.hints.undone);
    h.state_mut().asked.clear();
    h.key_press(Key::CloseBracket);
    h.run_steps(2);
    let before = h.state().published.brush.radius;
    assert!((brushes(&h)[0].radius - before * 1.1).abs() < 1e-6);
    // Twice in one frame is twice.
    h.state_mut().asked.clear();
    let key = Key::CloseBracket;
    for pressed in [true, false, true, false] {
        h.event(egui::Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        });
    }
    h.run_steps(4);
    let last = brushes(&h).last().map_or(0.0, |b| b.radius);
    assert!((last - before * 1.21).abs() < 1e-5, "{last}");
    h.key_press(Key::T);
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Thickness);
    // The legend exists, with its unit.
    h.state_mut().ui_state.look.scale = (0.5, 2.5);
    h.run_steps(2);
    h.key_press(Key::T);
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::None);
}

#[test]
fn the_search_finds_an_action_and_enter_does_it() {
    let mut h = harness(Tab::Look);
    h.key_press_modifiers(Modifiers::COMMAND, Key::K);
    h.run_steps(3);
    h.get_by_role_and_label(Role::TextInput, "Search actions").type_text("wirefr");
    h.run_steps(3);
    // Letters that are typed are not shortcuts.
    assert!(!h.state().ui_state.look.wireframe);
    h.key_press(Key::Enter);
    h.run_steps(3);
    assert!(h.state().ui_state.look.wireframe);
    assert!(h.state().ui_state.search.is_none());
}

#[test]
fn the_radius_is_dragged_with_the_pointer_alone_and_escape_leaves_it() {
    let mut h = harness(Tab::Look);
    h.hover_at(egui::pos2(600.0, 300.0));
    h.run_steps(2);
    h.key_press(Key::F);
    h.run_steps(2);
    assert!(h.state().ui_state.modal.is_some());
    h.hover_at(egui::pos2(720.0, 300.0));
    h.run_steps(2);
    let before = h.state().published.brush.radius;
    let asked = brushes(&h).last().expect("asked for").radius;
    assert!((asked - before * 2.0).abs() < 0.01 * before, "{before} to {asked}");
    h.key_press(Key::Escape);
    h.run_steps(2);
    assert!(h.state().ui_state.modal.is_none());
}

#[test]
fn holding_space_opens_the_ring_and_letting_go_chooses() {
    let mut h = harness(Tab::Look);
    h.hover_at(egui::pos2(640.0, 360.0));
    h.run_steps(2);
    h.key_down(Key::Space);
    h.run_steps(2);
    assert!(h.state().ui_state.radial.is_some());
    // Straight down: the thickness map.
    h.hover_at(egui::pos2(640.0, 440.0));
    h.run_steps(2);
    h.key_up(Key::Space);
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Thickness);
    assert!(h.state().ui_state.radial.is_none());
}

#[test]
fn the_device_page_says_what_is_there() {
    let mut h = harness(Tab::Devices);
    assert!(
        h.query_by_label_contains("No tablet found: plug one in, nothing to restart").is_some()
    );
    h.state_mut().devices = vec!["A tablet on /dev/hidraw0: connected".into()];
    h.run_steps(2);
    assert!(h.query_by_label_contains("No tablet found").is_none());
    assert!(h.query_by_label_contains("hidraw0: connected").is_some());
}

#[test]
fn a_thing_is_taken_up_placed_and_joined() {
    let mut world = super::world(2_000);
    let mut h = harness(Tab::Scene);
    // The whole page is in view.
    h.set_size(egui::vec2(1280.0, 1200.0));
    h.run_steps(2);
    h.get_by_label("Ball").click();
    h.run_steps(2);
    let asked = std::mem::take(&mut h.state_mut().asked);
    let [UiRequest::World(take)] = &asked[..] else { panic!("{asked:?}") };
    world.step(1, &[], std::slice::from_ref(take));
    h.state_mut().published = super::published(&mut world);
    assert!(h.state().published.thing.is_some());
    h.run_steps(2);
    h.get_by_label("Cut").click();
    h.run_steps(2);
    assert!(matches!(h.state().asked[..], [UiRequest::Join(_)]), "{:?}", h.state().asked);
}

#[test]
fn the_cube_looks_along_an_axis() {
    let mut h = harness(Tab::Look);
    h.get_by_label(Action::Front.entry().name.as_ref()).click();
    h.run_steps(2);
    let Some(UiRequest::Camera(c)) = h.state().asked.last() else {
        panic!("{:?}", h.state().asked)
    };
    assert_eq!((c.yaw, c.pitch), (0.0, 0.0));
}

#[test]
fn a_join_is_tried_then_applied_or_dismissed() {
    let mut world = super::world(2_000);
    let take = Command::TakeUp(std::sync::Arc::new(sculptd_geometry::shapes::sphere_of_about(200)));
    world.step(1, &[], std::slice::from_ref(&take));
    let mut h = harness(Tab::Scene);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    assert!(h.query_by_label("Apply").is_none(), "nothing is tried yet");
    assert!(h.query_by_role_and_label(Role::ComboBox, "Preview").is_some());
    h.key_press_modifiers(Modifiers::COMMAND, Key::K);
    h.run_steps(3);
    h.get_by_role_and_label(Role::TextInput, "Search actions").type_text("preview: cut");
    h.run_steps(3);
    h.key_press(Key::Enter);
    h.run_steps(3);
    assert_eq!(h.state().ui_state.trial.choice, Some(MenuItem::Carve));
    h.state_mut().ui_state.trial.said = TrialStatus::Shown(321);
    h.run_steps(2);
    assert!(h.query_by_label("321 triangles of the held object").is_some());
    h.state_mut().ui_state.trial.said =
        TrialStatus::Wrong("B is open: 3 edges lack a partner; mend it first".into());
    h.run_steps(2);
    assert!(h.query_by_label_contains("B is open").is_some());
    // The page may be longer than the window is high.
    h.get_by_label("Dismiss").click_accesskit();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.trial.choice, None);
    assert!(h.state().asked.is_empty());
    h.state_mut().ui_state.trial.choice = Some(MenuItem::Add);
    h.run_steps(2);
    h.get_by_label("Apply").click_accesskit();
    h.run_steps(2);
    assert!(
        matches!(h.state().asked[..], [UiRequest::Join(MenuItem::Add)]),
        "{:?}",
        h.state().asked
    );
}

#[test]
fn levels_go_up_and_down_and_a_box_is_trimmed_by_a_drag() {
    let mut h = harness(Tab::Scene);
    h.get_by_label("Finer").scroll_to_me();
    h.run_steps(3);
    assert!(h.query_by_label_contains("level 1 of 1").is_some());
    h.get_by_label("Coarser").click();
    h.run_steps(2);
    assert!(h.state().asked.is_empty(), "there is no coarser one");
    h.get_by_label("Finer").click();
    h.run_steps(2);
    assert!(matches!(h.state().asked[..], [UiRequest::Level(true)]), "{:?}", h.state().asked);
    h.state_mut().asked.clear();
    // The solid "Box" stands above the trim's.
    h.get_all_by_label("Box").last().expect("a button").scroll_to_me();
    h.run_steps(3);
    h.get_all_by_label("Box").last().expect("a button").click();
    h.run_steps(3);
    assert!(h.state().ui_state.region.drawing.is_some());
    h.drag_at(egui::pos2(480.0, 180.0));
    h.run_steps(2);
    h.hover_at(egui::pos2(640.0, 360.0));
    h.run_steps(2);
    h.drop_at(egui::pos2(640.0, 360.0));
    h.run_steps(3);
    let [UiRequest::Trim(Part::Box(part))] = h.state().asked[..] else {
        panic!("{:?}", h.state().asked)
    };
    // Shares of the part between the panels, which the harness surrounds by a margin of 8.
    let view = view_of(&h);
    let share = |x: f32, y: f32| {
        let at = (egui::pos2(x, y) - view.min) / view.size();
        [at.x, at.y]
    };
    let [from, to] = [share(480.0, 180.0), share(640.0, 360.0)];
    let want = [from[0], from[1], to[0], to[1]];
    assert!(part.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-2), "{part:?}");
    assert!(h.state().ui_state.region.drawing.is_none());
    // Escape leaves the work as it is.
    h.state_mut().ui_state.region.begin(RegionShape::Line, RegionPurpose::Trim);
    h.run_steps(2);
    h.key_press(Key::Escape);
    h.run_steps(2);
    assert!(h.state().ui_state.region.drawing.is_none());
}

#[test]
fn sizes_are_told_with_their_units_and_the_outline_is_written() {
    let mut h = harness(Tab::Measure);
    assert!(h.query_by_label_contains("Measured when nothing changes").is_some());
    let ring = vec![DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(3.0, 2.0), DVec2::ZERO];
    h.state_mut().ui_state.sizes.found = Some(Box::new(Measured {
        revision: h.state().published.mesh.revision(),
        volume: 4.18879,
        area: 12.56637,
        dimensions: [2.0, 3.0, 4.0],
        projected: [3.24, 3.25, 3.26],
        direction: DVec3::NEG_Z,
        shadow: 3.0,
        outline: vec![PlaneRegion { outer: ring, holes: vec![] }],
    }));
    h.run_steps(2);
    assert!(h.query_by_label("4.1888 mm³").is_some());
    assert!(h.query_by_label("12.5664 mm²").is_some());
    assert!(h.query_by_label_contains("3.0000 x 2.0000 mm, 0 holes").is_some());
    assert!(h.query_by_label("Outline of the shadow").is_some());
    h.get_by_label("shadow along x").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.sizes.direction, DVec3::NEG_X);
    h.get_by_label("From here").click();
    h.run_steps(2);
    let back = h.state().published.camera.backward().as_dvec3();
    assert!((h.state().ui_state.sizes.direction + back).length() < 1e-6);
    h.get_by_label("SVG").click();
    h.run_steps(2);
    let asked = &h.state().asked;
    assert!(
        matches!(&asked[..], [UiRequest::Outline(p)] if p.ends_with("outline.svg")),
        "{asked:?}"
    );
}

#[test]
fn distances_have_a_map_a_legend_and_a_reference() {
    let mut h = harness(Tab::Measure);
    h.get_by_label("Live distance map").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Distance);
    h.state_mut().ui_state.look.scale = (-0.25, 0.25);
    h.state_mut().ui_state.sizes.distances =
        Some(DistanceSummary { min: -0.125, max: 0.5, rms: 0.1, known: (50, 100) });
    h.run_steps(2);
    assert!(h.query_by_label("-0.1250 mm").is_some());
    assert!(h.query_by_label("+0.5000 mm").is_some());
    assert!(h.query_by_label("50 %").is_some());
    let shown = format!("{:?}", h.output().shapes);
    assert!(shown.contains("+0.250 mm") && shown.contains("-0.250 mm"), "the legend has its ends");
    h.get_by_label("Compare with now").click();
    h.run_steps(2);
    assert!(matches!(h.state().asked[..], [UiRequest::Reference]), "{:?}", h.state().asked);
}

#[test]
fn the_hands_menu_has_its_words_at_its_balls() {
    let mut h = harness(Tab::Look);
    assert!(h.query_by_label("cylinder").is_none(), "no hands, no menu");
    let s = h.state_mut();
    s.published.hands = Some(sculptd_devices::Hands::default());
    s.published.menu = Some((1, 0.4));
    // Seen from the front, from where all of them are in view.
    s.published.camera.distance = 20.0;
    (s.published.camera.yaw, s.published.camera.pitch) = (0.0, 0.0);
    h.run_steps(4);
    for choice in MenuItem::EMPTY {
        assert!(h.query_by_label(choice.label()).is_some(), "{}", choice.label());
    }
    let balls = sculptd_window::panels::hand_menu::menu_balls(&h.state().published);
    assert_eq!(
        balls.iter().map(|b| b.ring).collect::<Vec<_>>(),
        [None, Some(0.4), None, None, None, None]
    );
    assert!(balls.windows(2).all(|b| b[1].place.y > b[0].place.y), "one over the other");
}

#[test]
fn a_step_is_gone_to_by_its_picture() {
    let mut h = harness(Tab::Look);
    let image = egui::ColorImage::filled([8, 5], egui::Color32::from_rgb(120, 60, 40));
    let texture = h.ctx.load_texture("thumb", image, Default::default());
    let s = h.state_mut();
    (s.published.undo_steps, s.published.redo_steps) = (4, 2);
    s.ui_state.history =
        (0..=8).map(|step| StepPicture { step, mark: 0, texture: texture.clone() }).collect();
    h.run_steps(2);
    assert!(h.query_by_label("After step 7").is_none(), "there is no such step any more");
    h.get_by_label("After step 1").click();
    h.run_steps(2);
    let undone = |a: &UiRequest| matches!(a, UiRequest::World(Command::Undo));
    assert!(
        h.state().asked.len() == 3 && h.state().asked.iter().all(undone),
        "{:?}",
        h.state().asked
    );
    h.state_mut().asked.clear();
    h.get_by_label("After step 6").click();
    h.run_steps(2);
    let redone = |a: &UiRequest| matches!(a, UiRequest::World(Command::Redo));
    assert!(
        h.state().asked.len() == 2 && h.state().asked.iter().all(redone),
        "{:?}",
        h.state().asked
    );
}

#[test]
fn a_view_is_kept_under_a_number_shown_again_and_forgotten() {
    let mut h = harness(Tab::Look);
    let before = h.state().published.camera;
    h.get_by_label("Keep view").scroll_to_me();
    h.run_steps(4);
    h.get_by_label("Keep view").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.prefs.kept_views, [before]);
    let turned = Camera { yaw: before.yaw + 1.0, ..before };
    h.state_mut().published.camera = turned;
    h.run_steps(2);
    h.get_by_label("1").click();
    h.run_steps(2);
    let [UiRequest::Camera(asked)] = h.state().asked[..] else { panic!("{:?}", h.state().asked) };
    assert_eq!(asked, before);
    h.get_by_label("1").click_secondary();
    h.run_steps(2);
    assert!(h.state().ui_state.prefs.kept_views.is_empty());
}
