//! Objects in a real window: the outliner, the gizmo, layers and face sets, driven with the pointer
//! and read back by the protocol.

use glam::{DQuat, DVec3};
use sculptd_engine::camera::Camera;
use serde_json::{Value, json};

use super::places::{
    ADD_LAYER, DIFFERENCE, EYE_OF_LAYER, EYE_OF_SECOND, EYE_OF_SET, FACE_SETS, FOLLOW, GIZMO,
    NAME_OF_FIRST, NAME_OF_SECOND, SET_FROM_MASK, SLIDER_OF_LAYER, TURNS,
};
use super::stage::{Stage, VIEW, differs};

/// The camera of the window.
fn camera(s: &Stage) -> Camera {
    serde_json::from_value(s.ask("camera", &json!({}))).expect("a camera")
}

/// Returns the pixel of a point in the world.
fn pixel(s: &Stage, place: DVec3) -> (i32, i32) {
    let view = camera(s).project(place.as_vec3()).expect("before the eye");
    let at = VIEW[0] + view * VIEW[1];
    (at.x.round() as i32, at.y.round() as i32)
}

fn at(s: &Stage, (x, y): (i32, i32)) {
    s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
}

fn click(s: &Stage, place: (i32, i32)) {
    at(s, place);
    s.drive(&["click", "1"]);
}

/// The button goes down at one place and moves to another; it stays down.
fn pull(s: &Stage, from: (i32, i32), to: (i32, i32)) {
    at(s, from);
    s.drive(&["mousedown", "1"]);
    for i in 1..=8 {
        at(s, (from.0 + (to.0 - from.0) * i / 8, from.1 + (to.1 - from.1) * i / 8));
    }
}

fn object(s: &Stage, id: u64) -> Value {
    let list = s.ask("scene.list", &Value::Null)["objects"].as_array().expect("a list").clone();
    list.into_iter().find(|o| o["id"] == id).expect("there")
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().expect("a number"))
}

fn shift(s: &Stage, id: u64) -> DVec3 {
    DVec3::from_array(numbers(&object(s, id)["transform"]["shift"]))
}

fn turn(s: &Stage, id: u64) -> DQuat {
    DQuat::from_array(numbers(&object(s, id)["transform"]["turn"]))
}

fn scale(s: &Stage, id: u64) -> f64 {
    object(s, id)["transform"]["scale"].as_f64().expect("a number")
}

struct Gizmo {
    centre: DVec3,
    size: f64,
}

/// The gizmo of an object whose middle is its origin, as the window draws it: an axis is 0.16 of
/// the view's height long.
fn gizmo(s: &Stage, id: u64) -> Gizmo {
    let (camera, centre) = (camera(s), shift(s, id));
    let depth = (camera.eye() - centre.as_vec3()).dot(camera.backward());
    Gizmo { centre, size: f64::from(camera.world_per_view(depth)) * 0.16 }
}

/// A window with a box beside the ball, seen from the front on the page of the scene.
fn stage() -> Option<(Stage, u64)> {
    let mut s = Stage::open(&[])?;
    s.seen("objects-start");
    let place = json!({ "shift": [80.0, 0.0, 0.0] });
    let added = s.ask(
        "scene.add",
        &json!({ "primitive": { "box": [40.0, 40.0, 40.0] }, "transform": place }),
    );
    let id = added["id"].as_u64().expect("an id");
    let view = json!({ "yaw": 0.4, "pitch": 0.3, "distance": 300.0, "target": [40.0, 0.0, 0.0] });
    s.ask("camera", &view);
    s.seen("objects-view");
    s.answer("ctrl+k", "scene");
    s.seen("objects-page");
    Some((s, id))
}

#[test]
fn the_outliner_is_clicked_and_the_gizmo_dragged() {
    let Some((mut s, id)) = stage() else { return };
    let active = |s: &Stage| s.ask("scene.list", &Value::Null)["active"].as_u64();
    assert_eq!(active(&s), Some(id));
    click(&s, NAME_OF_FIRST);
    s.until("the ball is active", |s| active(s) == Some(0));
    click(&s, NAME_OF_SECOND);
    s.until("the box is active", |s| active(s) == Some(id));
    click(&s, EYE_OF_SECOND);
    s.until("the box is hidden", |s| object(s, id)["visible"] == false);
    s.seen("objects-hidden");
    click(&s, EYE_OF_SECOND);
    s.until("the box is shown", |s| object(s, id)["visible"] == true);
    let bare = s.seen("objects-shown");
    click(&s, GIZMO);
    // Away from the button, so that the picture has no hint over it.
    at(&s, (640, 600));
    let with = s.seen("objects-gizmo");
    assert!(differs(&bare, &with) > 0.1, "the gizmo is drawn");

    // Along x: the object goes with the pointer while it is dragged, in one step.
    let (steps, before) = (s.figure("undo_steps"), shift(&s, id));
    let g = gizmo(&s, id);
    let tip = g.centre + DVec3::X * g.size * 0.95;
    let (from, to) = (pixel(&s, tip), pixel(&s, tip + DVec3::X * 25.0));
    pull(&s, from, to);
    s.until("it goes with the pointer", |s| (shift(s, id) - before).x > 20.0);
    s.look("objects-dragged");
    s.drive(&["mouseup", "1"]);
    s.until("it is moved in one step", |s| s.figure("undo_steps") == steps + 1);
    let moved = |s: &Stage| shift(s, id) - before;
    s.until("it is moved by 25 along x", |s| (moved(s) - DVec3::X * 25.0).length() < 1.0);
    println!("moved by {}, asked 25 along x", moved(&s));

    // About y, by 0.6 radians.
    let g = gizmo(&s, id);
    let spoke = |angle: f64| g.centre + DQuat::from_rotation_y(angle) * DVec3::X * g.size * 0.75;
    // From where no other handle is near.
    let begin = -1.1;
    pull(&s, pixel(&s, spoke(begin)), pixel(&s, spoke(begin + 0.6)));
    s.drive(&["mouseup", "1"]);
    s.until("it is turned in one step", |s| s.figure("undo_steps") == steps + 2);
    // The step is there from the drag's beginning: its last place comes with the release.
    let turned = |s: &Stage| turn(s, id).to_scaled_axis();
    s.until("it is turned by 0.6 about y", |s| (turned(s) - DVec3::Y * 0.6).length() < 0.05);
    println!("turned by {}, asked 0.6 about y", turned(&s));

    // The corner, twice as far from the middle.
    let g = gizmo(&s, id);
    let corner = |by: f64| g.centre + DVec3::splat(g.size * 0.45 * by);
    pull(&s, pixel(&s, corner(1.0)), pixel(&s, corner(1.5)));
    s.drive(&["mouseup", "1"]);
    s.until("it is scaled in one step", |s| s.figure("undo_steps") == steps + 3);
    s.until("by 1.5 as the corner is seen", |s| (scale(s, id) - 1.5).abs() < 0.25);
    println!("scaled by {}, asked 1.5", scale(&s, id));
    s.seen("objects-scaled");
    for left in (steps..steps + 3).rev() {
        s.drive(&["key", "ctrl+z"]);
        s.until("a step is taken back", |s| s.figure("undo_steps") == left);
    }
    assert_eq!((shift(&s, id), scale(&s, id)), (before, 1.0));
}

#[test]
fn layers_and_face_sets_are_worked_with_the_pointer() {
    let Some((mut s, _)) = stage() else { return };
    let layers = |s: &Stage| s.ask("layers.list", &Value::Null)["layers"].clone();
    let hash = |s: &Stage| s.ask("hash", &Value::Null)["hash"].clone();
    click(&s, NAME_OF_FIRST);
    s.until("the ball is active", |s| s.ask("scene.list", &Value::Null)["active"] == 0);
    click(&s, ADD_LAYER);
    s.until("there is a layer", |s| layers(s).as_array().is_some_and(|l| l.len() == 1));
    s.seen("objects-layer");
    let bare = hash(&s);
    let (dabs, ball) = (s.figure("dabs"), pixel(&s, DVec3::new(0.0, 0.0, 50.0)));
    let steps = s.figure("undo_steps");
    pull(&s, (ball.0 - 40, ball.1), (ball.0 + 40, ball.1 + 10));
    s.drive(&["mouseup", "1"]);
    s.until("a stroke goes to the layer", |s| s.figure("dabs") > dabs && hash(s) != bare);
    // Its end brings the last dabs.
    s.until("it has ended", |s| s.figure("undo_steps") == steps + 1);
    let with = hash(&s);
    s.seen("objects-layer-stroke");
    click(&s, EYE_OF_LAYER);
    s.until("the layer is hidden", |s| layers(s)[0]["visible"] == false && hash(s) != with);
    s.seen("objects-layer-hidden");
    click(&s, EYE_OF_LAYER);
    s.until("the layer is shown, to the bit", |s| hash(s) == with);
    // The slider of its intensity, from the middle of the right half to its end.
    pull(&s, SLIDER_OF_LAYER, (SLIDER_OF_LAYER.0 + 60, SLIDER_OF_LAYER.1));
    s.drive(&["mouseup", "1"]);
    s.until("the layer is stronger", |s| layers(s)[0]["intensity"].as_f64() > Some(1.2));
    s.seen("objects-layer-strong");

    s.ask("mask-region", &json!({ "region": { "box": [0.0, 0.0, 0.5, 1.0] } }));
    click(&s, FACE_SETS);
    s.seen("objects-sets");
    (0..TURNS).for_each(|_| s.drive(&["click", "5"]));
    s.seen("objects-sets-below");
    click(&s, SET_FROM_MASK);
    let sets = |s: &Stage| s.ask("sets.list", &Value::Null);
    s.until("there is a set", |s| {
        sets(s)["sets"].as_array().is_some_and(|all| all.iter().any(|set| set["set"] == 1))
    });
    s.seen("objects-set");
    click(&s, EYE_OF_SET);
    s.until("the set is hidden", |s| sets(s)["hidden"].as_u64() > Some(100));
    s.seen("objects-set-hidden");
    click(&s, EYE_OF_SET);
    s.until("all is shown", |s| sets(s)["hidden"] == 0);
}

#[test]
fn a_result_follows_the_operand_that_the_gizmo_drags() {
    let Some((mut s, id)) = stage() else { return };
    click(&s, GIZMO);
    click(&s, NAME_OF_FIRST);
    s.until("the ball is active", |s| s.ask("scene.list", &Value::Null)["active"] == 0);
    click(&s, FOLLOW);
    s.seen("follow-asked");
    at(&s, NAME_OF_SECOND);
    s.drive(&["click", "3"]);
    s.seen("follow-menu");
    click(&s, (NAME_OF_SECOND.0 + DIFFERENCE.0, NAME_OF_SECOND.1 + DIFFERENCE.1));
    let last = |s: &Stage| {
        let list = s.ask("scene.list", &Value::Null);
        list["objects"].as_array().and_then(|l| l.last().cloned()).expect("objects")
    };
    s.until("there is a result", |s| last(s)["follows"]["operation"] == "difference");
    let result = last(&s)["id"].as_u64().expect("an id");
    assert_eq!((&object(&s, id)["visible"], shift(&s, id).x), (&json!(false), 80.0));
    s.seen("follow-result");
    click(&s, NAME_OF_SECOND);
    s.until("the box is active", |s| s.ask("scene.list", &Value::Null)["active"] == id);
    s.seen("follow-operand");
    let (steps, g) = (s.figure("undo_steps"), gizmo(&s, id));
    let tip = g.centre + DVec3::X * g.size * 0.95;
    let right = |s: &Stage| numbers::<3>(&object(s, result)["bounds"][1])[0];
    assert!(right(&s) > 49.5);
    pull(&s, pixel(&s, tip), pixel(&s, tip - DVec3::X * 30.0));
    // The button is still down.
    s.until("the result follows", |s| right(s) < 47.5);
    s.look("follow-dragged");
    s.drive(&["mouseup", "1"]);
    s.until("it is one step", |s| s.figure("undo_steps") == steps + 1);
    s.seen("follow-done");
    s.drive(&["key", "ctrl+z"]);
    s.until("both are taken back", |s| right(s) > 49.5 && shift(s, id).x == 80.0);
}
