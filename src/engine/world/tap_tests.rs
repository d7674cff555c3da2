//! Every contact of a pen with pressure leaves a dab, and a stroke ends where the pen was lifted.

use std::path::PathBuf;

use glam::Vec2;

use super::{World, WorldOptions};
use crate::camera::Camera;
use crate::command::Command;
use crate::hand::HandSettings;
use sculptd_clay::brush::{BrushKind, BrushSettings, Method};
use sculptd_clay::{Clay, LayerEdit, Workers};
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::Player;
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// A square that fills the view.
fn world(brush: BrushSettings) -> World {
    let plain = shapes::grid(2.0, 2.0, 120, 120).triangulate().0;
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let clay = Clay::build(&plain, &Job::default()).expect("a square");
    let mut world = World::new(clay, Camera::default(), brush, Workers::new(1), options);
    let front = Camera { yaw: 0.0, pitch: 0.0, orthographic: true, ..*world.camera() };
    let distance = front.distance * 0.3;
    world.step(1, &[], &[Command::Camera(Camera { distance, ..front })]);
    world
}

/// Result of a contact: its dabs, and the greatest distance that a vertex moved.
#[derive(Debug, Default, Clone, Copy)]
struct Mark {
    dabs: u64,
    moved: f32,
    firmest: f32,
}

/// Steps the world by one sample a tick, and returns the result of each contact.
fn contacts(world: &mut World, pens: &[Pen]) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    let (mut down, mut tick) = (false, 1);
    let mut before = world.mesh().to_tri().positions;
    for pen in pens {
        tick += 1;
        let sample = Sample {
            device: DeviceId(1),
            t_us: tick * 8000,
            device_t_us: None,
            body: Body::Pen(*pen),
        };
        let tip = pen.tip && pen.in_range;
        if tip && !down {
            before = world.mesh().to_tri().positions;
            marks.push(Mark::default());
        }
        let dabs = world.step(tick, &[sample], &[]).dabs;
        let Some(mark) = marks.last_mut() else { continue };
        mark.dabs += dabs;
        if tip {
            mark.firmest = mark.firmest.max(pen.pressure.unwrap_or(1.0));
        } else if down {
            let after = world.mesh().to_tri().positions;
            let far = before.iter().zip(&after).map(|(a, b)| a.distance(*b));
            mark.moved = far.fold(0.0, f32::max);
        }
        down = tip;
    }
    marks
}

fn pen(view: Vec2, pressure: f32, tip: bool) -> Pen {
    let area_mm = Vec2::new(Camera::default().aspect, 1.0) * 100.0;
    Pen {
        in_range: true,
        tip,
        pos_mm: view * area_mm,
        area_mm,
        pressure: Some(pressure),
        ..Pen::default()
    }
}

/// A tap as a hand makes it: the pressure rises from nearly nothing and falls again while the pen
/// slides by `slide` heights of the view.
fn tap(at: Vec2, slide: f32, reports: usize) -> Vec<Pen> {
    let mut pens: Vec<Pen> = (0..reports)
        .map(|i| {
            let t = i as f32 / (reports - 1) as f32;
            pen(at + Vec2::new(slide * t, 0.3 * slide * t), 1.6 * t * (1.0 - t), true)
        })
        .collect();
    pens.push(pen(at + Vec2::splat(slide), 0.0, false));
    pens
}

/// Returns the greatest distance that a tap of one report moves a vertex.
fn firm(brush: BrushSettings, pressure: f32) -> f32 {
    let at = Vec2::splat(0.5);
    contacts(&mut world(brush), &[pen(at, pressure, true), pen(at, 0.0, false)])[0].moved
}

/// Returns each brush that stays on the surface and raises or paints without a drag.
fn kinds() -> impl Iterator<Item = BrushSettings> {
    [BrushKind::Draw, BrushKind::Inflate, BrushKind::Clay, BrushKind::Layer, BrushKind::Gaussian]
        .into_iter()
        .map(|kind| BrushSettings {
            accumulate: !kind.found(),
            radius: 0.05,
            ..BrushSettings::new(kind)
        })
}

#[test]
fn a_tap_leaves_one_dab_however_the_pen_slides() {
    for brush in kinds() {
        for (steady, rope, average) in
            [(0.0, 0.0, 0), (0.1, 0.0, 0), (1.0, 0.0, 0), (0.0, 0.1, 0), (0.1, 0.0, 8)]
        {
            let mut brush = BrushSettings { steady, ..brush };
            (brush.path.rope, brush.path.average) = (rope, average);
            let mut world = world(brush);
            let pens: Vec<Pen> = (0..12)
                .flat_map(|i| {
                    let at = Vec2::new(0.3 + 0.1 * (i % 4) as f32, 0.3 + 0.15 * (i / 4) as f32);
                    tap(at, i as f32 * 0.001, 3 + 2 * i)
                })
                .collect();
            let marks = contacts(&mut world, &pens);
            assert_eq!(marks.len(), 12);
            let firm = firm(brush, 0.4);
            assert!(firm > 1e-3 * brush.strength * brush.radius, "{}: {firm}", brush.kind);
            for (i, mark) in marks.iter().enumerate() {
                let what = format!("{} {steady} {rope} {average}, {i}", brush.kind);
                assert!(mark.dabs >= 1 && mark.moved > 0.25 * firm, "{what}: {mark:?} of {firm}");
            }
        }
    }
}

#[test]
fn what_is_not_final_until_the_pen_lifts_stays_when_its_pressure_falls() {
    for method in [Method::Anchored, Method::DragDot, Method::Line] {
        let mut brush = BrushSettings { radius: 0.05, ..BrushSettings::new(BrushKind::Draw) };
        brush.path.method = method;
        let marks = contacts(&mut world(brush), &tap(Vec2::splat(0.45), 0.1, 30));
        println!("{method:?}: {marks:?}");
        assert!(
            marks[0].moved > 0.3 * brush.strength * brush.radius * 0.2,
            "{method:?}: {marks:?}"
        );
    }
}

#[test]
fn a_stroke_ends_where_the_pen_was_lifted() {
    for brush in kinds() {
        for (steady, rope, average) in
            [(0.0, 0.0, 0), (0.1, 0.0, 0), (1.0, 0.0, 0), (0.0, 0.1, 0), (0.0, 0.0, 16)]
        {
            let mut brush = BrushSettings { steady, hardness: 0.0, ..brush };
            (brush.path.rope, brush.path.average) = (rope, average);
            let mut world = world(brush);
            let before = world.mesh().to_tri().positions;
            let end = Vec2::new(0.6, 0.5);
            let mut pens: Vec<Pen> =
                (0..=80).map(|i| pen(Vec2::new(0.4 + 0.0025 * i as f32, 0.5), 0.8, true)).collect();
            pens.push(pen(end, 0.0, false));
            contacts(&mut world, &pens);
            let after = world.mesh().to_tri().positions;
            // The furthest vertex to the right that moved lies a radius from the end.
            let ray = world.camera().ray(end);
            let far = before.iter().zip(&after).filter(|(a, b)| a != b).map(|(a, _)| a.x);
            let far = far.fold(f32::MIN, f32::max);
            let radius = brush.radius * 2f32.sqrt() * brush.pressure_radius.factor(0.8);
            let wanted = ray.origin.x + radius;
            println!("{} {steady} {rope} {average}: {far} for {wanted}", brush.kind);
            assert!((far - wanted).abs() < 2.5 / 60.0, "{}: {far} for {wanted}", brush.kind);
        }
    }
}

#[test]
fn no_tap_of_a_real_pen_is_lost() {
    let Some(corpus) = std::env::var_os("SCULPTD_CORPUS").map(PathBuf::from) else {
        return println!("skipped: SCULPTD_CORPUS is not set");
    };
    let path = corpus.join("devices/open/hid/Wacom_Intuos4_4x6_056a_00B8.hid");
    let catalogue = Catalogue::builtin().expect("the embedded tablets are valid");
    let mut pens = Vec::new();
    let mut player = Player::open(&path, DeviceId(1), &catalogue).expect("a recording");
    player.advance(u64::MAX, &mut |sample| {
        if let Body::Pen(pen) = sample.body {
            pens.push(pen);
        }
    });
    for brush in kinds() {
        for steady in [0.0, 0.1, 0.5] {
            let brush = BrushSettings { steady, ..brush };
            let marks = contacts(&mut world(brush), &pens);
            assert_eq!(marks.len(), 8);
            for mark in marks {
                let firm = firm(brush, mark.firmest);
                let what = format!("{} {steady}: {mark:?} of {firm}", brush.kind);
                assert!(mark.dabs >= 1 && mark.moved > 0.25 * firm, "{what}");
            }
        }
    }
}

/// A line that hung delivers strokes all at once: each is a step of its own, whatever the budget.
#[test]
fn strokes_that_come_in_one_tick_are_steps_of_their_own() {
    let brush = BrushSettings { radius: 0.05, ..BrushSettings::new(BrushKind::Draw) };
    for (layers, budget) in [(false, 1 << 20), (false, 1), (true, 1 << 20)] {
        let mut world = world(brush);
        world.options.dab_budget = budget;
        if layers {
            super::layer_tests::edit(&mut world, LayerEdit::Add("one".into())).expect("a layer");
        }
        let start = world.hash();
        let strokes = [0.3, 0.5, 0.7].map(|x| tap(Vec2::new(x, 0.5), 0.03, 6));
        let all: Vec<Sample> = (0..)
            .zip(strokes.iter().flatten())
            .map(|(i, pen)| Sample {
                device: DeviceId(1),
                t_us: 20_000 + i * 100,
                device_t_us: None,
                body: Body::Pen(*pen),
            })
            .collect();
        world.step(3, &all, &[]);
        for tick in 4..400 {
            world.step(tick, &[], &[]);
        }
        let mut hashes = vec![world.hash()];
        for tick in 400..403 {
            world.step(tick, &[], &[Command::Undo]);
            hashes.push(world.hash());
        }
        assert_eq!(hashes[3], start, "{layers} {budget}");
        let different = |i: usize| hashes[..i].iter().all(|h| *h != hashes[i]);
        assert!((1..4).all(different), "{layers} {budget}: {hashes:?}");
    }
}
