//! Raised and engraved text: by the area of its letters, turned and moved.

mod common;

use common::*;
use glam::{DQuat, DVec3};
use sculptd_check::repair::lettering::{Lettering, LetteringPlan, MOST_LETTERS, plan_lettering};
use sculptd_check::repair::{RepairError, combined, remaining};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;

fn volume(mesh: &PolyMesh) -> f64 {
    measures(&mesh.triangulate().0).volume
}

fn asked(text: &str, at: DVec3, relief: f64) -> Lettering {
    Lettering { text: text.into(), at, along: None, upright: DVec3::Y, height: 5.0, relief }
}

/// The part with the text, and by how much its volume changed.
fn lettered(part: &PolyMesh, asked: &Lettering) -> (LetteringPlan, PolyMesh, f64) {
    let job = Job::default();
    let plan = plan_lettering(part, asked, &job).expect("a plan");
    let (made, _) = combined(part, &plan.tool, plan.operation, &job).expect("a result");
    let left = remaining(&made, DVec3::Z, 0.05, false, &job).expect("a solid");
    assert!(left.closed && left.manifold && left.crossings == 0, "{left:?}");
    let by = volume(&made) - volume(part);
    (plan, made, by)
}

fn moved(asked: &Lettering, turn: DQuat, shift: DVec3) -> Lettering {
    Lettering { at: turn * asked.at + shift, upright: turn * asked.upright, ..asked.clone() }
}

#[test]
fn letters_on_a_plate_have_their_area_times_the_relief() {
    for (turn, shift) in poses() {
        let plate = placed(&block([0.0; 3], [60.0, 30.0, 4.0]), turn, shift);
        for relief in [0.6, -0.6, 2.0, -2.0] {
            // With holes, separate dots, accents, and two lines.
            for text in ["No. 8", "\u{c4}B%\ni\u{3a9}\u{416}"] {
                let at = asked(text, DVec3::new(30.0, 15.0, 4.2), relief);
                let (plan, _, by) = lettered(&plate, &moved(&at, turn, shift));
                let wanted = plan.area * relief;
                assert!((by - wanted).abs() < 2e-3 * wanted.abs(), "{text}: {by} for {wanted}");
                assert!(plan.area > 15.0 && plan.notes.is_empty(), "{plan:?}");
                assert!((plan.normal - turn * DVec3::Z).length() < 1e-5, "{}", plan.normal);
                let place = turn.inverse() * (plan.place - shift);
                assert!(place.distance(DVec3::new(30.0, 15.0, 4.0)) < 1e-3, "{place}");
            }
        }
    }
}

/// An L has more of itself below and on the left: mirrored or turned letters are found out.
#[test]
fn letters_read_from_outside_and_stand_upright() {
    let plate = block([0.0; 3], [60.0, 30.0, 4.0]);
    let up = |at: DVec3, normal: DVec3, upright: DVec3| {
        let asked = Lettering { upright, ..asked("L", at, 1.0) };
        let (plan, made, _) = lettered(&plate, &asked);
        let right = upright.cross(normal);
        let top: Vec<DVec3> = made
            .positions
            .iter()
            .map(|p| *p - plan.place)
            .filter(|p| (p.dot(normal) - 1.0).abs() < 1e-3)
            .collect();
        let flat = |d: DVec3| top.iter().map(|p| p.dot(d)).fold(f64::NEG_INFINITY, f64::max);
        assert!((flat(upright) - 2.5).abs() < 1e-3 && (flat(-upright) - 2.5).abs() < 1e-3);
        // All corners on the right are low: the foot of the L.
        let edge = flat(right);
        let foot = top.iter().filter(|p| p.dot(right) > edge - 1e-3);
        assert!(foot.clone().count() > 0 && foot.into_iter().all(|p| p.dot(upright) < -1.0));
    };
    up(DVec3::new(30.0, 15.0, 5.0), DVec3::Z, DVec3::Y);
    up(DVec3::new(30.0, 15.0, 5.0), DVec3::Z, DVec3::X);
    up(DVec3::new(30.0, 15.0, -1.0), -DVec3::Z, DVec3::Y);
}

#[test]
fn on_a_bent_surface_every_letter_has_the_relief_at_least() {
    let tube = revolved(&[[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]], 128);
    for relief in [1.0, -1.0] {
        let at = Lettering {
            upright: DVec3::Z,
            ..asked("Hello", DVec3::X * 50.0 + DVec3::Z * 15.0, relief)
        };
        let (plan, _, by) = lettered(&tube, &at);
        assert!(by / (plan.area * relief) > 0.999, "{by} for {}", plan.area * relief);
        assert!(by / (plan.area * relief) < 2.5, "{by}");
        assert!(plan.notes[0].contains("the surface bends"), "{:?}", plan.notes);
        let wanted = if relief > 0.0 { Operation::Union } else { Operation::Difference };
        assert_eq!(plan.operation, wanted);
    }
    // Found along a direction, through the far side of a box.
    let open = block([0.0; 3], [60.0, 30.0, 4.0]);
    let along = Some(-DVec3::Z);
    let (plan, ..) =
        lettered(&open, &Lettering { along, ..asked("x", DVec3::new(20.0, 12.0, 90.0), 1.0) });
    assert!(plan.place.distance(DVec3::new(20.0, 12.0, 4.0)) < 1e-3, "{}", plan.place);
}

#[test]
fn text_that_cannot_be_is_refused() {
    let job = Job::default();
    let plate = block([0.0; 3], [60.0, 30.0, 4.0]);
    let middle = DVec3::new(30.0, 15.0, 4.0);
    let refused = |asked: &Lettering| plan_lettering(&plate, asked, &job).expect_err("refused");
    let at_edge = refused(&asked("a long line", DVec3::new(58.0, 15.0, 4.0), 0.5));
    assert!(matches!(at_edge, RepairError::NoRoom { .. }), "{at_edge}");
    for text in ["", "   ", "\u{4e2d}", &"x".repeat(MOST_LETTERS + 1)] {
        let why = refused(&asked(text, middle, 0.5));
        assert!(matches!(why, RepairError::Text(_)), "{text}: {why}");
    }
    for (height, relief) in [(0.0, 0.5), (f64::NAN, 0.5), (5.0, 0.0), (5.0, f64::INFINITY)] {
        let why = refused(&Lettering { height, relief, ..asked("x", middle, 0.5) });
        assert!(matches!(why, RepairError::OutOfRange { .. }), "{height} {relief}: {why}");
    }
    let nowhere = DVec3::new(f64::NAN, 0.0, 0.0);
    assert!(matches!(refused(&asked("x", nowhere, 0.5)), RepairError::Text(_)));
    let away = Some(DVec3::Z);
    assert!(matches!(
        refused(&Lettering { along: away, ..asked("x", middle + DVec3::Z, 0.5) }),
        RepairError::Text(_)
    ));
}
