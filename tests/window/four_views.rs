//! Four views in a real window: worked in with pointer and keys, and read back by the protocol.

use image::RgbaImage;
use sculptd_engine::camera::{Camera, MAX_PITCH};
use serde_json::{Value, json};

use super::stage::{Stage, differs, pause};

/// The middles of the four views, pixels: above, free, front, right.
const ABOVE: (i32, i32) = (446, 203);
const FREE: (i32, i32) = (834, 203);
const FRONT: (i32, i32) = (446, 530);
const RIGHT: (i32, i32) = (834, 530);
/// A view's size, pixels.
const PART: (u32, u32) = (387, 326);

fn camera(s: &Stage) -> Camera {
    serde_json::from_value(s.ask("camera", &json!({}))).expect("a camera")
}

fn go(s: &Stage, (x, y): (i32, i32)) {
    s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
}

fn drag(s: &Stage, from: (i32, i32), to: (i32, i32)) {
    go(s, from);
    s.drive(&["mousedown", "1"]);
    for i in 1..=8 {
        go(s, (from.0 + (to.0 - from.0) * i / 8, from.1 + (to.1 - from.1) * i / 8));
    }
    s.drive(&["mouseup", "1"]);
}

/// The inner part of a view, without its name, its frame, and the hints at the window's foot.
fn part(picture: &RgbaImage, (x, y): (i32, i32)) -> RgbaImage {
    let (wide, high) = (PART.0 - 40, PART.1 - 150);
    let corner = (x as u32 - wide / 2, y as u32 - high / 2);
    image::imageops::crop_imm(picture, corner.0, corner.1, wide, high).to_image()
}

#[test]
fn four_views_are_worked_in_each_and_left_again() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let one = s.seen("four-one");
    let free = camera(&s);
    s.drive(&["key", "4"]);
    let four = s.seen("four-views");
    assert!(differs(&one, &four) > 2.0, "four views are shown");
    let views = [(ABOVE, 0.0, MAX_PITCH), (FRONT, 0.0, 0.0), (RIGHT, 1.570_796_4, 0.0)];
    for (at, yaw, pitch) in views {
        go(&s, at);
        s.until("the world has the camera of the view", |s| {
            let c = camera(s);
            c.orthographic && (c.yaw, c.pitch) == (yaw, pitch)
        });
        // A stroke where it is seen: on the side of the ball that faces this view.
        let steps = s.figure("undo_steps");
        let before = s.look("four-before");
        drag(&s, (at.0 - 30, at.1 - 20), (at.0 + 30, at.1 + 20));
        s.until("one stroke", |s| s.figure("undo_steps") == steps + 1);
        go(&s, (at.0, at.1 + 30));
        s.last = Some(before.clone());
        let after = s.seen("four-stroke");
        let changed = differs(&part(&before, at), &part(&after, at));
        assert!(changed > 0.1, "the stroke is seen in its own view: {changed}");
    }
    // The ring is in the view under the pointer, and nothing else is drawn again for it.
    go(&s, (FRONT.0 - 40, FRONT.1));
    let before = s.seen("four-ring-before");
    go(&s, (FRONT.0 + 40, FRONT.1));
    let after = s.seen("four-ring");
    assert!(differs(&part(&before, FRONT), &part(&after, FRONT)) > 0.05, "the ring has moved");
    for other in [ABOVE, FREE, RIGHT] {
        assert!(part(&before, other) == part(&after, other), "another view: {other:?}");
    }
    // Beside the clay: a view along an axis slides, the free one turns.
    go(&s, FRONT);
    s.until("the front", |s| camera(s).orthographic && camera(s).yaw == 0.0);
    let was = camera(&s);
    drag(&s, (FRONT.0 - 180, FRONT.1 + 150), (FRONT.0 - 160, FRONT.1 + 130));
    s.until("it slides", |s| camera(s).target != was.target);
    assert_eq!((camera(&s).yaw, camera(&s).pitch), (0.0, 0.0), "and looks the same way");
    let was = camera(&s);
    s.drive(&["click", "4"]);
    s.until("the wheel comes nearer", |s| camera(s).distance < was.distance);
    s.drive(&["key", "Home"]);
    s.until("it is framed again", |s| camera(s).target.length() < 10.0);
    go(&s, FREE);
    s.until("the free camera", |s| !camera(s).orthographic);
    assert_eq!((camera(&s).yaw, camera(&s).pitch), (free.yaw, free.pitch));
    drag(&s, (FREE.0 - 180, FREE.1 + 150), (FREE.0 - 120, FREE.1 + 140));
    s.until("it turns", |s| camera(s).yaw != free.yaw);
    let turned = camera(&s);
    // A key that would turn a view along an axis turns the free one.
    go(&s, RIGHT);
    s.until("the right", |s| camera(s).orthographic);
    s.drive(&["key", "shift+7"]);
    s.until("the free one from behind", |s| {
        !camera(s).orthographic && (camera(s).yaw - std::f32::consts::PI).abs() < 1e-4
    });
    assert_eq!(camera(&s).distance, turned.distance);
    // Nothing happens when nothing happens.
    // The hand of the lesson has shown its hint by then.
    pause(12_000);
    let told = |s: &Stage| s.log().lines().filter(|l| l.contains("mean_ms=")).count();
    let frames = told(&s);
    pause(4000);
    assert!(told(&s) <= frames + 1, "frames without a change:\n{}", s.log());
    // A double click beside the clay: this view alone, and the key leads back.
    go(&s, (FRONT.0 - 180, FRONT.1 + 150));
    s.until("the front", |s| camera(s).orthographic && camera(s).yaw == 0.0);
    let four = s.look("four-again");
    s.drive(&["click", "--repeat", "2", "--delay", "60", "1"]);
    s.last = Some(four.clone());
    let alone = s.seen("four-front-alone");
    assert!(differs(&four, &alone) > 2.0);
    assert!(camera(&s).orthographic && camera(&s).yaw == 0.0);
    s.drive(&["key", "4"]);
    let back = s.seen("four-back");
    assert!(differs(&alone, &back) > 2.0);
    go(&s, FREE);
    s.until("the free camera", |s| !camera(s).orthographic);
    s.answer("ctrl+k", "four views");
    s.last = Some(back);
    s.seen("four-free-alone");
    assert!(!camera(&s).orthographic && s.ask("status", &Value::Null)["undo_steps"] == 3);
}
