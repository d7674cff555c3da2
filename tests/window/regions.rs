//! A region drawn over the view with the pointer of a real window, read back by the protocol.

use serde_json::{Value, json};

use super::stage::{MIDDLE, Stage, VIEW, differs};

/// A drag with the button held, in pixels from the middle of the clay, that is not released.
fn lasso(s: &Stage, way: &[(i32, i32)]) {
    for (i, (x, y)) in way.iter().enumerate() {
        let (x, y) = ((MIDDLE.0 + x).to_string(), (MIDDLE.1 + y).to_string());
        s.drive(&["mousemove", &x, &y]);
        if i == 0 {
            s.drive(&["mousedown", "1"]);
        }
    }
}

/// The vertices of the active object that are masked by half or more.
fn masked(s: &Stage) -> u64 {
    let made = s.ask("sets.make", &json!({ "from": "mask" }));
    let sets = s.ask("sets.list", &Value::Null)["sets"].as_array().expect("a list").clone();
    let set = sets.iter().find(|set| set["set"] == made["set"]).expect("the new one");
    s.ask("undo", &Value::Null);
    set["vertices"].as_u64().expect("a number")
}

#[test]
fn a_lasso_drawn_with_the_pointer_masks_what_it_surrounds() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let before = s.seen("region-start");
    let steps = s.figure("undo_steps");
    s.drive(&["key", "l"]);
    s.seen("region-bar");
    let around =
        [(-80, -60), (0, -90), (80, -60), (90, 0), (60, 70), (-20, 90), (-80, 60), (-90, 0)];
    lasso(&s, &around);
    // The outline is there while the button is held, and the clay feels nothing.
    let drawing = s.seen("region-lasso");
    assert!(differs(&before, &drawing) > 0.1);
    assert_eq!(s.figure("undo_steps"), steps);
    s.drive(&["mouseup", "1"]);
    s.until("the mask is a step", |s| s.figure("undo_steps") == steps + 1);
    let through = masked(&s);
    // The same as by request: the view fills what the panels leave.
    s.ask("undo", &Value::Null);
    let (wide, high) = (f64::from(VIEW[1].x), f64::from(VIEW[1].y));
    let share = |(x, y): &(i32, i32)| [0.5 + f64::from(*x) / wide, 0.5 + f64::from(*y) / high];
    let corners: Vec<[f64; 2]> = around.iter().map(share).collect();
    s.ask("mask-region", &json!({ "region": { "polygon": corners } }));
    s.until("the mask is a step", |s| s.figure("undo_steps") == steps + 1);
    let asked = masked(&s);
    println!("{through} vertices masked by the pointer, {asked} by request");
    assert!(through > 100 && through.abs_diff(asked) * 50 < asked, "{through} and {asked}");
    // Escape in the middle of a drag: nothing is masked.
    lasso(&s, &[(-150, -150), (0, -150), (0, 0)]);
    s.drive(&["key", "Escape"]);
    s.drive(&["mouseup", "1"]);
    // The other buttons and the wheel move the view all the same.
    let view = s.ask("camera", &json!({}));
    s.drive(&["click", "4"]);
    s.until("the view is nearer", |s| s.ask("camera", &json!({})) != view);
    assert_eq!(s.figure("undo_steps"), steps + 1);
    // Back to sculpting, from the frame on that has taken the key.
    s.drive(&["key", "Escape"]);
    let dabs = s.figure("dabs");
    s.until("a stroke", |s| {
        s.drag((-30, 0), (30, 10));
        s.soon(|s| s.figure("dabs") > dabs)
    });
}
