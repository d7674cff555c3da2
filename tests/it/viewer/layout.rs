//! Every page on every screen: nothing is cut at its sides, no text overlaps another, and text has
//! a contrast of at least 4.5:1 with its background.
//!
//! Read from the shapes that the panels paint, so it needs no adapter.

use egui::epaint::{ClippedShape, Shape};
use egui::{Color32, Rect};
use egui_kittest::Harness;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;
use sculptd_window::look::Map;
use sculptd_window::panels::state::{DistanceSummary, FrameFigures, TrialStatus};
use sculptd_window::panels::{HEADER, PANEL, STATUS, Tab, View, all};

use super::panels::{State, show, state};

const SCREENS: [(f32, f32); 3] = [(1280.0, 720.0), (1920.0, 1080.0), (3840.0, 2160.0)];
pub(super) const TABS: [Tab; 9] = [
    Tab::Look,
    Tab::Scene,
    Tab::Walls,
    Tab::Check,
    Tab::Measure,
    Tab::Files,
    Tab::Devices,
    Tab::Loop,
    Tab::More,
];

/// Texts of buttons that cannot be pressed on the pages that the tests show.
const DISABLED: [&str; 8] =
    ["Undo", "Redo", "Open", "Coarser", "to the held object", "Up", "Down", "Snap face to face"];

/// A piece of text as it is painted.
#[derive(Debug)]
struct Text {
    /// Number of opaque shapes that were painted before it.
    after: usize,
    what: String,
    rect: Rect,
    clip: Rect,
    colour: Color32,
    ground: Color32,
}

/// Relative luminance as WCAG 2 has it.
fn luminance(c: Color32) -> f32 {
    let one = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.03928 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * one(c.r()) + 0.7152 * one(c.g()) + 0.0722 * one(c.b())
}

fn contrast(a: Color32, b: Color32) -> f32 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// `over` laid on `under`; egui's colours are premultiplied.
fn blend(over: Color32, under: Color32) -> Color32 {
    let keep = 1.0 - f32::from(over.a()) / 255.0;
    let mix = |o: u8, u: u8| (f32::from(o) + f32::from(u) * keep).min(255.0) as u8;
    Color32::from_rgb(mix(over.r(), under.r()), mix(over.g(), under.g()), mix(over.b(), under.b()))
}

fn walk(
    shape: &Shape,
    clip: Rect,
    opaque: &mut Vec<(Rect, Color32)>,
    out: &mut Vec<Text>,
    clay: Color32,
) {
    match shape {
        Shape::Vec(all) => all.iter().for_each(|s| walk(s, clip, opaque, out, clay)),
        Shape::Rect(r) if r.fill.a() > 0 && r.blur_width == 0.0 => {
            opaque.push((r.rect.intersect(clip), r.fill))
        }
        Shape::Circle(c) if c.fill.a() > 0 => {
            let rect = Rect::from_center_size(c.center, egui::Vec2::splat(c.radius * 1.4));
            opaque.push((rect.intersect(clip), c.fill));
        }
        Shape::Text(t) => {
            let rect = t.galley.mesh_bounds.translate(t.pos.to_vec2());
            // Of the part that is seen: a page may scroll under its edge.
            let centre = rect.intersect(clip).center();
            let under = opaque.iter().filter(|(r, _)| r.contains(centre));
            let ground = under.fold(clay, |ground, (_, fill)| blend(*fill, ground));
            let written = t.override_text_color.unwrap_or_else(|| {
                let colour =
                    t.galley.job.sections.first().map_or(Color32::PLACEHOLDER, |s| s.format.color);
                if colour == Color32::PLACEHOLDER { t.fallback_color } else { colour }
            });
            let colour = blend(written.gamma_multiply(t.opacity_factor), ground);
            let what = t.galley.text().to_owned();
            if !what.trim().is_empty() && clip.intersects(rect) {
                out.push(Text { after: opaque.len(), what, rect, clip, colour, ground });
            }
        }
        _ => {}
    }
}

fn texts(shapes: &[ClippedShape], clay: Color32) -> (Vec<Text>, Vec<(Rect, Color32)>) {
    let (mut opaque, mut out) = (Vec::new(), Vec::new());
    for s in shapes {
        walk(&s.shape, s.clip_rect, &mut opaque, &mut out, clay);
    }
    (out, opaque)
}

/// Returns the texts of a screen that are cut at a side or overlap another one.
pub(super) fn misplaced(h: &Harness<'_, State>) -> Vec<String> {
    misplaced_where(h, false)
}

/// The same where a list is unfolded, which covers what is behind it.
pub(super) fn misplaced_but_for_lists(h: &Harness<'_, State>) -> Vec<String> {
    misplaced_where(h, true)
}

fn misplaced_where(h: &Harness<'_, State>, lists: bool) -> Vec<String> {
    let clay = Color32::from_rgb(150, 100, 80);
    look_at(h, clay, lists).0.into_iter().filter(|wrong| !wrong.contains(":1, ")).collect()
}

/// Returns the faults of one screen, and the least contrast.
fn look_at(h: &Harness<'_, State>, clay: Color32, lists: bool) -> (Vec<String>, f32) {
    let (all, opaque) = texts(&h.output().shapes, clay);
    assert!(all.len() > 15, "only {} texts are painted", all.len());
    let mut wrong = Vec::new();
    let mut least = f32::INFINITY;
    for (i, t) in all.iter().enumerate() {
        // Below or above the part that a page scrolls to is no cut; at the sides it is.
        let (l, r) = (t.rect.left() - t.clip.left(), t.clip.right() - t.rect.right());
        if l < -0.5 || r < -0.5 {
            wrong.push(format!("'{}' is cut at a side: {l:.1}, {r:.1}", t.what));
        }
        let ratio = contrast(t.colour, t.ground);
        // A disabled button is faint (WCAG 2 sets no minimum for it).
        if !DISABLED.contains(&t.what.as_str()) {
            // An icon says by its form what text says by letters: WCAG 2 asks 3:1.
            let icon = t.what.chars().all(|c| ('\u{e000}'..'\u{f900}').contains(&c));
            let enough = if icon { 3.0 } else { 4.5 };
            least = least.min(ratio * 4.5 / enough);
            if ratio < enough {
                wrong.push(format!(
                    "'{}' has {ratio:.2}:1, {:?} on {:?}",
                    t.what, t.colour, t.ground
                ));
            }
        }
        for other in &all[i + 1..] {
            let (a, b) = (t.rect.intersect(t.clip), other.rect.intersect(other.clip));
            let both = a.intersect(b);
            // What a list that is unfolded covers is not seen.
            let between = &opaque[t.after..other.after.max(t.after)];
            let covers = |r: &Rect, fill: &Color32| fill.a() == 255 && r.contains_rect(both);
            let covered = lists && between.iter().any(|(r, fill)| covers(r, fill));
            if both.width() > 1.0 && both.height() > 1.0 && !covered {
                wrong.push(format!("'{}' lies on '{}'", t.what, other.what));
            }
        }
    }
    (wrong, least)
}

/// A page with everything that it can show.
pub(super) fn fill(s: &mut State, tab: Tab) {
    let mut world = super::world(2_000);
    match tab {
        Tab::Scene => {
            let plain = sculptd_geometry::shapes::sphere_of_about(200);
            world.step(1, &[], &[Command::TakeUp(std::sync::Arc::new(plain))]);
            s.published = super::published(&mut world);
            s.ui_state.trial.choice = Some(MenuItem::Carve);
            s.ui_state.trial.said =
                TrialStatus::Wrong("B is open: 1234 edges lack a partner; mend it first".into());
        }
        Tab::Measure => {
            let found = sculptd_window::viewer::distance_field::measure(
                &(s.published.mesh.clone(), Default::default(), glam::DVec3::NEG_X),
                &Default::default(),
            )
            .expect("not cancelled");
            s.ui_state.sizes.found = Some(Box::new(found));
            s.ui_state.look.map = Map::Distance;
            s.ui_state.look.scale = (-123.25, 123.25);
            s.ui_state.sizes.distances =
                Some(DistanceSummary { min: -123.25, max: 99.5, rms: 0.1, known: (50, 100) });
        }
        Tab::Check => super::check::fill(s),
        Tab::Look => {
            s.published.hands = Some(Default::default());
            s.published.menu = Some((1, 0.4));
            s.published.camera.distance = 9.0;
        }
        _ => {}
    }
}

#[test]
fn nothing_is_cut_nothing_overlaps_and_text_can_be_read() {
    let (mut table, mut bad) = (Vec::new(), Vec::new());
    for (w, h) in SCREENS {
        for scale in [1.0, 2.0] {
            for light in [false, true] {
                let mut least = f32::INFINITY;
                for tab in TABS {
                    let mut s = state(tab);
                    s.ui_state.prefs.light = light;
                    s.devices = vec![
                        "A tablet with a long name, model PTK-440 (medium) on /dev/hidraw12: \
                            connected"
                            .into(),
                    ];
                    fill(&mut s, tab);
                    s.published.undo_steps = 4;
                    s.published.redo_steps = 2;
                    let mut harness = Harness::builder()
                        .with_size([w / scale, h / scale])
                        .with_pixels_per_point(scale)
                        .build_ui_state(show, s);
                    harness.run_steps(4);
                    // The dimmest and the palest clay under a cursor's text does not matter: text
                    // over the clay has a separate background; this colour would be under it.
                    let clay = Color32::from_rgb(150, 100, 80);
                    let (wrong, ratio) = look_at(&harness, clay, false);
                    let where_ = format!("{w}x{h} at {scale}, light {light}, {tab:?}");
                    bad.extend(wrong.into_iter().map(|what| format!("{where_}: {what}")));
                    least = least.min(ratio);
                }
                table.push(format!(
                    "{w}x{h} scale {scale} {}: least contrast {least:.2}:1",
                    if light { "light" } else { "dark" }
                ));
            }
        }
    }
    table.iter().for_each(|line| println!("{line}"));
    assert!(bad.is_empty(), "{} faults: {:#?}", bad.len(), &bad[..bad.len().min(60)]);
}

#[test]
fn the_search_the_ring_and_a_message_fit_the_smallest_screen() {
    for light in [false, true] {
        for which in 0..3 {
            let mut s = state(Tab::Look);
            s.ui_state.prefs.light = light;
            match which {
                0 => s.ui_state.search = Some(Default::default()),
                1 => s.ui_state.hidden = true,
                _ => s.ui_state.say(
                    "/a/rather/long/path/to/a/file/that/was/not/there.stl: no such file or \
                        directory",
                    true,
                ),
            }
            let mut harness = Harness::builder()
                .with_size([640.0, 360.0])
                .with_pixels_per_point(2.0)
                .build_ui_state(show, s);
            if which == 1 {
                harness.hover_at(egui::pos2(320.0, 180.0));
                harness.key_down(egui::Key::Space);
            }
            harness.run_steps(4);
            let clay = Color32::from_rgb(150, 100, 80);
            let (all, _) = texts(&harness.output().shapes, clay);
            let screen = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(640.0, 360.0));
            for t in all.iter().filter(|t| t.clip.contains(t.rect.center())) {
                let inside = screen.expand(0.5).contains_rect(t.rect);
                assert!(
                    inside || t.rect.bottom() > 340.0,
                    "'{}' leaves the screen: {:?}",
                    t.what,
                    t.rect
                );
            }
        }
    }
}

#[test]
fn the_free_part_lies_between_the_panels_and_the_legend_waits_for_numbers() {
    let mut s = state(Tab::Look);
    s.ui_state.look.map = Map::Thickness;
    let mut h = Harness::builder().with_size([1280.0, 720.0]).build_ui_state(
        |ui: &mut egui::Ui, (s, free): &mut (State, Rect)| {
            let view = View {
                state: &s.published,
                translations: super::translations(),
                keys: &Default::default(),
                presets: sculptd::presets(),
                camera: s.published.camera,
                views: &s.views,
                devices: &[],
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
            *free = all(ui, &view, &mut s.ui_state, &mut s.asked);
        },
        (s, Rect::NOTHING),
    );
    h.run_steps(4);
    let free = h.state().1;
    assert!((free.width() - (1280.0 - 2.0 * PANEL)).abs() < 20.0, "{free:?}");
    assert!((free.height() - (720.0 - HEADER - STATUS)).abs() < 20.0, "{free:?}");
    assert!((free.center().x - 640.0).abs() < 2.0, "{free:?}");
    h.state_mut().0.ui_state.hidden = true;
    h.run_steps(4);
    assert!(h.state().1.width() > 1250.0, "{:?}", h.state().1);
}
