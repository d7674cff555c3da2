//! The Check page in a real window: a finding is flown to, and is gone once it is fixed.

use glam::{DQuat, Vec3};
use sculptd_engine::camera::Camera;
use serde_json::json;

use super::places::FIRST_FINDING;
use super::stage::{Stage, differs, pause};

/// Beside the clay and the panels' widgets.
const NOWHERE: (i32, i32) = (640, 680);

fn camera(s: &Stage) -> Camera {
    serde_json::from_value(s.ask("camera", &json!({}))).expect("a camera")
}

fn click(s: &Stage, (x, y): (i32, i32)) {
    s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
    s.drive(&["click", "1"]);
    s.drive(&["mousemove", &NOWHERE.0.to_string(), &NOWHERE.1.to_string()]);
}

/// Clicks on the first finding; the place that the camera flies to.
fn flown_to(s: &mut Stage) -> Option<Vec3> {
    let before = camera(s).target;
    click(s, FIRST_FINDING);
    let flies = s.soon(|s| camera(s).target != before);
    // The flight takes half a second.
    pause(1500);
    flies.then(|| camera(s).target)
}

#[test]
fn a_finding_is_flown_to_and_is_gone_once_the_part_is_turned() {
    let Some(mut s) = Stage::open(&[]) else { return };
    s.seen("check-start");
    // Its lower face looks down at 55 degrees from the vertical.
    let turn = DQuat::from_rotation_z(35f64.to_radians());
    let place = json!({ "turn": turn.to_array() });
    let cube = json!({ "primitive": { "box": [20.0, 20.0, 20.0] }, "transform": place });
    let id = s.ask("scene.add", &cube)["id"].as_u64().expect("an id");
    s.ask("scene.show", &json!({ "id": 0, "visible": false }));
    let view = json!({ "yaw": 0.0, "pitch": 0.0, "distance": 120.0, "target": [0.0, 0.0, 0.0] });
    s.ask("camera", &view);
    s.seen("check-view");
    s.answer("ctrl+k", "check");
    // The check has ended once the page stands still.
    s.seen("check-page");
    let place = flown_to(&mut s).expect("there is a finding");
    println!("flown to {place}");
    let marked = s.seen("check-marked");
    let own = turn.as_quat().inverse() * place;
    assert!((own.y + 10.0).abs() < 0.05 && own.abs().max_element() < 10.1, "{own}");
    // Upright it is ready.
    let up = json!({ "id": id, "transform": { "turn": DQuat::IDENTITY.to_array() } });
    s.ask("scene.transform", &up);
    let fixed = s.seen("check-fixed");
    assert!(differs(&marked, &fixed) > 0.1);
    assert_eq!(flown_to(&mut s), None, "no finding is left to fly to");
}
