//! The Check page: findings of the present clay at their places, results that are named stale, and
//! the maps of overhang and draft.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::{DQuat, DVec3, Vec3};
use sculptd_check::preset::CheckPreset;
use sculptd_check::{CheckProgress, Finding, FindingKind, PresetLibrary, Severity};
use sculptd_clay::brush::{BrushSettings, MaskAction};
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::Published;
use sculptd_devices::Clock;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::{NewObject, ObjectSource, ObjectTransform, SceneCommand};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::preset::Preset;
use sculptd_geometry::{PolyMesh, TriMesh};
use sculptd_window::look::{AngleMap, Map};
use sculptd_window::panels::state::{
    CheckChoice, CheckFound, CheckPage, CheckStop, CheckUnderWay, MarkedFinding, ObjectVersion,
};
use sculptd_window::panels::{Tab, UiRequest};
use sculptd_window::viewer::check_task::{CheckKey, CheckWork};

use super::panels::{State, harness, show, state};

/// Every preset that the program carries.
pub(super) fn library() -> PresetLibrary {
    use sculptd::cli::embedded_presets::{CHECKS, WALLS};
    PresetLibrary {
        checks: CHECKS.iter().map(|(n, t)| CheckPreset::read(n, t).expect("valid")).collect(),
        walls: WALLS.iter().map(|(n, t)| Preset::read(n, t).expect("valid")).collect(),
    }
}

/// A profile in x and y, drawn out along z.
fn drawn_out(profile: &[[f64; 2]], length: f64) -> TriMesh {
    let n = profile.len() as u32;
    let at = |z: f64| profile.iter().map(move |p| DVec3::new(p[0], p[1], z));
    let mut mesh = PolyMesh::new();
    mesh.positions = at(0.0).chain(at(length)).collect();
    let mut face = |corners: Vec<u32>| {
        mesh.corners.extend(corners);
        mesh.face_starts.push(mesh.corners.len() as u32);
    };
    face((0..n).rev().collect());
    face((n..2 * n).collect());
    (0..n).for_each(|i| face(vec![i, (i + 1) % n, (i + 1) % n + n, i + n]));
    mesh.triangulate().0
}

/// Two legs and a ceiling between them, 10 mm above the plate.
pub(super) fn portal(span: f64) -> TriMesh {
    let profile = [
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 10.0],
        [5.0 + span, 10.0],
        [5.0 + span, 0.0],
        [10.0 + span, 0.0],
        [10.0 + span, 15.0],
        [0.0, 15.0],
    ];
    drawn_out(&profile, 40.0)
}

pub(super) fn world_of(mesh: &TriMesh) -> World {
    let clay = Clay::build(mesh, &Job::default()).expect("builds");
    let options =
        WorldOptions { dab_budget: 1 << 30, undo_bytes: 1 << 30, hands: HandSettings::default() };
    World::new(clay, Camera::default(), BrushSettings::default(), Workers::new(1), options)
}

fn tell(world: &mut World, command: Command) {
    world.step(world.tick() + 1, &[], &[command]);
}

fn work(state: &Published, choice: &CheckChoice, search: bool) -> CheckWork {
    let versions = ObjectVersion::of_choice(state, choice.visible);
    let key = CheckKey { versions, choice: choice.clone(), search };
    let settings = choice.settings(&library()).expect("presets that fit");
    CheckWork::new(key, settings, state, Clock::monotonic())
}

/// What the window's thread finds on a state of the world.
pub(super) fn found(state: &Published, choice: &CheckChoice) -> CheckFound {
    let done = work(state, choice, false).run(&Job::default());
    done.expect("not cancelled").expect("a result")
}

/// The page with a finding of every kind, one of them marked, a map, and a check under way.
pub(super) fn fill(s: &mut State) {
    let mut world = world_of(&portal(20.0));
    s.published = super::published(&mut world);
    let mut found = found(&s.published, &CheckChoice::default());
    let object = &mut found.objects[0];
    let of = |(i, kind): (usize, FindingKind)| {
        let units = ["mm", "mm2", "mm3", "degrees", "edges", "pairs", "times", "kN"];
        let unit = units[i % units.len()];
        let finding = Finding::new(kind, "not checked: overhangs, because 12 edges have one face")
            .at(DVec3::new(i as f64, 5.0, 0.0))
            .measured(12_345.678, 1000.0, unit);
        if i % 2 == 0 { finding } else { finding.warning() }
    };
    object.answer.findings = FindingKind::ALL.into_iter().enumerate().map(of).collect();
    object.answer.facts.size = Some([1_234.56; 3]);
    object.answer.facts.cooling_time = Some(123.4);
    let first = &object.answer.findings[0];
    let place = DVec3::from(first.position.expect("a place"));
    let page = &mut s.ui_state.check;
    page.marked = Some(MarkedFinding { object: object.id, kind: first.kind, place });
    page.library = library();
    page.found = Some(Box::new(found));
    let progress = Arc::new(CheckProgress::new(9));
    page.under_way = Some(CheckUnderWay { job: Arc::default(), progress });
    s.ui_state.look.map = Map::Draft;
    s.ui_state.look.angles = AngleMap { limit: 1.5, ..AngleMap::default() };
}

fn bridges(found: &CheckFound) -> Vec<(f64, DVec3)> {
    let all = found.objects.iter().flat_map(|o| &o.answer.findings);
    let bridges = all.filter(|f| f.kind == FindingKind::Bridge);
    bridges.map(|f| (f.value.expect("a span"), f.position.expect("a place").into())).collect()
}

#[test]
fn a_bridge_is_found_at_its_place_and_is_gone_once_it_is_short() {
    let choice = CheckChoice::default();
    let mut world = world_of(&portal(20.0));
    let before = super::published(&mut world);
    let long = found(&before, &choice);
    let all = bridges(&long);
    assert_eq!(all.len(), 1, "{all:?}");
    let (span, place) = all[0];
    assert!((span - 20.0).abs() < 1e-3, "{span}");
    assert!((place.y - 10.0).abs() < 1e-3 && (5.0..25.0).contains(&place.x), "{place}");
    assert!((0.0..40.0).contains(&place.z), "{place}");
    assert!(!long.passes() && long.is_present(&before));
    tell(&mut world, Command::Replace(NewClay::new(Arc::new(portal(8.0)), true)));
    let after = super::published(&mut world);
    assert!(!long.is_present(&after), "it is of clay that is gone");
    let short = found(&after, &choice);
    assert!(short.is_present(&after) && short.passes(), "{:#?}", short.objects);
    assert!(bridges(&short).is_empty());
    // The long one again.
    tell(&mut world, Command::Undo);
    let back = super::published(&mut world);
    assert!(!short.is_present(&back));
    assert_eq!(bridges(&found(&back, &choice)).len(), 1);
}

#[test]
fn an_object_is_checked_where_it_stands_in_the_world() {
    let mut world = world_of(&portal(8.0));
    // A bridge on its side stands upright once it is turned.
    let source = ObjectSource::Mesh(Arc::new(portal(20.0)));
    let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let transform = ObjectTransform { shift: DVec3::new(100.0, 3.0, 0.0), turn, scale: 2.0 };
    tell(
        &mut world,
        Command::Scene(SceneCommand::Add(NewObject::new("portal", source, transform))),
    );
    let state = super::published(&mut world);
    let up = transform.turn * DVec3::Y;
    let choice = CheckChoice { visible: true, up, ..CheckChoice::default() };
    let found = found(&state, &choice);
    assert_eq!(found.objects.len(), 2);
    let spans: Vec<_> = bridges(&found);
    assert_eq!(spans.len(), 1, "{spans:?}");
    assert!((spans[0].0 - 40.0).abs() < 1e-3, "twice as large: {spans:?}");
    let own = (transform.turn.inverse() * (spans[0].1 - transform.shift)) / transform.scale;
    assert!((own.y - 10.0).abs() < 1e-3 && (5.0..25.0).contains(&own.x), "{own}");
    // Moving an object makes the result one of the past.
    let id = state.scene.active().expect("one").id;
    let moved = ObjectTransform { shift: DVec3::new(101.0, 3.0, 0.0), ..transform };
    tell(&mut world, Command::Scene(SceneCommand::Transform(id, moved)));
    assert!(!found.is_present(&super::published(&mut world)));
}

#[test]
fn the_best_direction_is_searched_and_checked_along() {
    let mut world = world_of(&portal(20.0));
    let state = super::published(&mut world);
    let work = work(&state, &CheckChoice::default(), true);
    let best = work.run(&Job::default()).expect("not cancelled").expect("a result");
    assert_ne!(best.choice.up, DVec3::Y, "upright it has a bridge");
    assert_eq!(best.count(Severity::Error), 0, "{:#?}", best.objects);
    let (ended, all) = work.progress.count();
    assert_eq!(ended, all, "each check is counted");
    let job = Job::default();
    job.cancel();
    assert!(work.run(&job).is_none(), "a cancelled check has no result");
}

fn open_page(published: Published, found: Option<CheckFound>) -> Harness<'static, State> {
    let mut s = state(Tab::Check);
    s.published = published;
    s.ui_state.check.library = library();
    s.ui_state.check.found = found.map(Box::new);
    let mut h =
        Harness::builder().with_size([1280.0, 1000.0]).with_max_steps(64).build_ui_state(show, s);
    h.run_steps(3);
    h
}

#[test]
fn a_click_and_enter_fly_to_a_finding_and_mark_it() {
    let mut world = world_of(&portal(20.0));
    let published = super::published(&mut world);
    let result = found(&published, &CheckChoice::default());
    let place = bridges(&result)[0].1;
    let mut h = open_page(published, Some(result));
    let flights = |h: &Harness<'_, State>| -> Vec<Vec3> {
        let of = |a: &UiRequest| match a {
            UiRequest::FlyTo(place) => Some(*place),
            _ => None,
        };
        h.state().asked.iter().filter_map(of).collect()
    };
    let row = h.get_by_label_contains("20 mm (limit 10 mm)");
    assert!(row.accesskit_node().label().is_some_and(|l| l.starts_with("Long bridge")));
    row.click();
    h.run_steps(2);
    assert_eq!(flights(&h), [place.as_vec3()]);
    let marked = h.state().ui_state.check.marked.expect("marked");
    assert_eq!((marked.kind, marked.place), (FindingKind::Bridge, place));
    // By the keyboard alone.
    h.state_mut().ui_state.check.marked = None;
    h.get_by_label_contains("20 mm (limit 10 mm)").focus();
    h.run_steps(2);
    h.key_press(egui::Key::Enter);
    h.run_steps(2);
    assert_eq!(flights(&h).len(), 2);
    assert!(h.state().ui_state.check.marked.is_some());
}

#[test]
fn a_result_of_earlier_clay_says_so_and_does_not_pass() {
    let mut world = world_of(&portal(8.0));
    let published = super::published(&mut world);
    let result = found(&published, &CheckChoice::default());
    let mut h = open_page(published, Some(result));
    assert!(h.query_by_label_contains("Passed").is_some());
    let revision = h.state().published.mesh.revision();
    let line = format!("Measured on the clay as it is now (revision {revision}).");
    assert!(h.query_by_label(&line).is_some());
    // An edit of the same clay; several ticks, where it takes portions.
    tell(&mut world, Command::Mask(MaskAction::Fill));
    for _ in 0..10 {
        world.step(world.tick() + 1, &[], &[]);
    }
    assert!(world.snapshot().revision() > revision);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    assert!(h.query_by_label_contains("Passed").is_none());
    assert!(h.query_by_label_contains("Measured before your last change").is_some());
    // Of other limits nothing is said at all.
    h.state_mut().ui_state.check.choose_process("sla");
    h.run_steps(2);
    assert!(h.query_by_label_contains("Measured before").is_none());
    assert!(h.query_by_label_contains("starts when nothing changes").is_some());
}

#[test]
fn a_check_that_was_stopped_or_failed_never_passes() {
    let mut world = world_of(&portal(8.0));
    let published = super::published(&mut world);
    let mut h = open_page(published, None);
    let running = CheckUnderWay { job: Arc::default(), progress: Arc::new(CheckProgress::new(9)) };
    h.state_mut().ui_state.check.under_way = Some(running);
    h.step();
    assert!(h.query_by_label_contains("Passed").is_none());
    h.get_by_label("Cancel").click();
    h.step();
    assert!(h.state().asked.iter().any(|a| matches!(a, UiRequest::CancelCheck)));
    for (stop, text) in [
        (CheckStop::Cancelled, "The check was stopped"),
        (CheckStop::Failed("no memory".into()), "The check failed: no memory"),
    ] {
        h.state_mut().ui_state.check.stop(stop);
        h.run_steps(2);
        assert!(h.query_by_label_contains(text).is_some());
        assert!(h.query_by_label_contains("Passed").is_none());
        assert!(h.query_by_label_contains("not measured").is_some());
    }
    h.get_by_label("Check again").click();
    h.run_steps(2);
    assert!(h.state().asked.iter().any(|a| matches!(a, UiRequest::CheckAgain)));
}

#[test]
fn a_mark_follows_its_finding_and_goes_with_it() {
    let mut world = world_of(&portal(20.0));
    let choice = CheckChoice::default();
    let first = found(&super::published(&mut world), &choice);
    let mut page = CheckPage::default();
    let at = first.by_severity()[0];
    let (object, finding) = first.finding(at).expect("one");
    assert_eq!(finding.kind, FindingKind::Bridge);
    let place = DVec3::from(finding.position.expect("a place"));
    let mark = MarkedFinding { object: object.id, kind: finding.kind, place };
    page.marked = Some(mark);
    page.take(first, 5.0);
    assert_eq!(page.marked, Some(mark));
    tell(&mut world, Command::Replace(NewClay::new(Arc::new(portal(22.0)), true)));
    page.take(found(&super::published(&mut world), &choice), 5.0);
    let moved = page.marked.expect("the bridge is there");
    assert!((0.1..3.0).contains(&(moved.place.x - place.x)), "{moved:?}");
    tell(&mut world, Command::Replace(NewClay::new(Arc::new(portal(8.0)), true)));
    page.take(found(&super::published(&mut world), &choice), 5.0);
    assert_eq!(page.marked, None);
}

#[test]
fn a_process_drops_the_machine_of_another_and_every_choice_has_settings() {
    let mut h = harness(Tab::Check);
    let page = &mut h.state_mut().ui_state.check;
    page.library = library();
    let names: Vec<String> = page.processes().map(|p| p.name.clone()).collect();
    assert_eq!(names.len(), 4);
    for name in names {
        page.choose_process(&name);
        assert_eq!((&page.choice.printer, &page.choice.material), (&None, &None));
        assert!(page.choice.settings(&page.library).is_ok(), "{name}");
        assert!(page.printers().all(|p| p.process == name) && page.printers().count() > 0);
        assert!(page.materials().count() > 0);
        let first = page.printers().next().map(|p| p.name.clone());
        page.choice.printer = first;
        assert!(page.choice.settings(&page.library).is_ok(), "{name} with a machine");
    }
}
