//! What a sculptor does in the first minutes, each step seen on the screen and confirmed by the
//! daemon.

use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;
use serde_json::{Value, json};

use super::stage::{MIDDLE, SIZE, Stage, as_kept, pause};

#[test]
fn the_first_minutes_in_a_real_window() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let ball = s.dir.path().join("ball.obj");
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    // From here on the view is the same in every run.
    let view = json!({ "yaw": 0.4887, "pitch": 0.3491, "distance": 5.05 });
    s.ask("camera", &view);
    s.drive(&["key", "m"]);
    as_kept("loaded", &s.seen("2-load"));

    s.drag((-90, -40), (90, -60));
    s.until("the stroke is done", |s| s.figure("undo_steps") == 1);
    as_kept("sculpted", &s.seen("3-sculpt"));
    let rough = s.ask("hash", &Value::Null)["hash"].clone();

    s.drive(&["keydown", "shift"]);
    s.drag((-90, -40), (90, -60));
    s.drive(&["keyup", "shift"]);
    s.until("it is smoothed", |s| s.figure("undo_steps") == 2);
    s.seen("4-smooth");
    assert_ne!(s.ask("hash", &Value::Null)["hash"], rough);
    let kind = |s: &Stage| s.ask("brush", &json!({}))["kind"].clone();
    assert_eq!(kind(&s), "draw", "Shift lends the brush for one stroke");

    s.ask("brush", &json!({ "kind": "mask" }));
    s.drive(&["key", "shift+m"]);
    s.drag((-60, 60), (60, 80));
    s.until("it is masked", |s| s.figure("undo_steps") == 3);
    as_kept("masked", &s.seen("5-mask"));
    s.drive(&["key", "shift+m"]);

    s.drive(&["key", "ctrl+z"]);
    s.drive(&["key", "ctrl+z"]);
    s.until("two steps are taken back", |s| s.figure("undo_steps") == 1);
    assert_eq!(s.ask("hash", &Value::Null)["hash"], rough);
    s.seen("6-undo");

    let tool = s.dir.path().join("tool.obj");
    write_mesh(&tool, &shapes::sphere_of_about(2_000).to_poly()).expect("written");
    // Away from the clay, so that what is held beside it is in view.
    s.drive(&["mousemove", "640", "360", "click", "--repeat", "6", "5"]);
    s.ask("take-up", &json!({ "path": tool }));
    s.seen("7-thing");
    let before = s.figure("triangles");
    s.ask("join", &json!({ "operation": "add" }));
    s.until("they are one", |s| s.figure("triangles") != before);
    s.seen("8-boolean");

    s.drive(&["key", "t"]);
    as_kept("thickness", &s.seen("9-thickness"));
    let walls = s.ask("thickness", &json!({}));
    assert!(walls["valid"].as_u64().unwrap_or(0) > 10_000, "{walls}");

    let out = s.dir.path().join("work.stl");
    s.ask("export", &json!({ "path": out }));
    let read = sculptd_geometry::io::read_mesh(&out, &Default::default())
        .expect("the export is read back");
    assert_eq!(read.mesh.triangulate().0.triangles.len() as u64, s.figure("triangles"));
}

#[test]
fn a_curve_is_laid_changed_and_drawn_with_the_pointer() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let ball = s.dir.path().join("ball.obj");
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("c1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    s.drive(&["key", "Home"]);
    s.ask("brush", &json!({ "radius": 0.1, "path": { "method": "curve" } }));
    let smooth = s.ask("hash", &Value::Null)["hash"].clone();
    s.seen("c2-loaded");
    let points = |n: u64| move |s: &mut Stage| s.figure("curve_points") == n;
    // Drawn freely: five handles.
    s.drag((-120, 0), (120, 20));
    s.until("it is laid", points(5));
    s.seen("c3-laid");
    // The middle one dragged up, one more beside the end, the first taken away by the right button.
    s.drag((0, 10), (0, -80));
    s.seen("c4-dragged");
    s.drag((140, 60), (140, 80));
    s.until("there is one more", points(6));
    let [x, y] = [(MIDDLE.0 - 120).to_string(), MIDDLE.1.to_string()];
    s.drive(&["mousemove", &x, &y, "click", "3"]);
    s.until("there is one less", points(5));
    s.seen("c5-changed");
    assert_eq!(
        (s.figure("undo_steps"), s.ask("hash", &Value::Null)["hash"].clone()),
        (0, smooth.clone())
    );
    s.drive(&["key", "Return"]);
    s.until("it is drawn", |s| s.figure("undo_steps") == 1);
    s.until("nothing is laid", points(0));
    s.seen("c6-drawn");
    assert_ne!(s.ask("hash", &Value::Null)["hash"], smooth);
    s.drive(&["key", "ctrl+z"]);
    s.until("it is one step", |s| s.figure("undo_steps") == 0);
    assert_eq!(s.ask("hash", &Value::Null)["hash"], smooth);
    // Another, and put away.
    s.drag((-100, -50), (100, -60));
    s.until("it is laid", points(5));
    s.drive(&["key", "Escape"]);
    s.until("it is put away", points(0));
    assert_eq!(s.figure("undo_steps"), 0);
}

#[test]
fn what_would_come_is_seen_before_it_is_made() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let (ball, tool) = (s.dir.path().join("ball.obj"), s.dir.path().join("tool.obj"));
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    write_mesh(&tool, &shapes::sphere_of_about(2_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("a1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    // Away from the clay, so that what is held beside it is in view. By the daemon: a key is taken
    // with the next frame and the wheel at once, so on a loaded machine they change places.
    s.ask("camera", &json!({ "yaw": 0.4887, "pitch": 0.3491, "distance": 7.0 }));
    s.ask("take-up", &json!({ "path": tool }));
    s.seen("a2-thing");
    let (triangles, hash) = (s.figure("triangles"), s.ask("hash", &Value::Null)["hash"].clone());
    // It appears beside the sculpture: the preview shows it as clay.
    s.answer("ctrl+k", "preview: add");
    s.seen("a3-preview");
    assert_eq!(s.ask("hash", &Value::Null)["hash"], hash, "a preview is of the window alone");
    s.answer("ctrl+k", "preview: add");
    s.seen("a4-dismissed");
    s.ask("join", &json!({ "operation": "add" }));
    s.until("it is added", |s| s.figure("triangles") != triangles);
    s.seen("a5-added");
    // Distances are to the work as it was opened: what was added lies outside.
    s.drive(&["key", "shift+d"]);
    s.seen("a6-distance");
    s.drive(&["key", "shift+d"]);
    s.seen("a7-clay");
    let added = s.figure("triangles");
    s.answer("ctrl+k", "trim by a box");
    s.look("a8-asked");
    s.drag((-150, 60), (150, 250));
    s.look("a8-dragged");
    s.until("it is trimmed", |s| s.figure("triangles") != added);
    s.seen("a8-trimmed");
    let trimmed = s.figure("triangles");
    s.answer("ctrl+k", "finer");
    s.until("it is finer", |s| s.figure("triangles") == trimmed * 4);
    s.seen("a9-finer");
    s.answer("ctrl+k", "coarser");
    s.until("it is coarser", |s| s.figure("triangles") == trimmed);
}

#[test]
fn the_installation_s_screen() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("kiosk.toml");
    #[allow(clippy::disallowed_methods)]
    std::fs::write(&path, "idle_s = 3.0\ncountdown_s = 8.0\nstaff_pin = \"4711\"\n")
        .expect("written");
    let Some(mut s) = Stage::open(&["--kiosk", "--kiosk-config", path.to_str().expect("UTF-8")])
    else {
        return;
    };
    s.until("the film sculpts", |s| s.figure("dabs") > 30);
    pause(1500);
    let attract = s.look("kiosk-1-attract");
    assert_eq!(attract.dimensions(), SIZE);
    s.drag((-80, 0), (80, 10));
    s.until("the visitor's own work", |s| s.figure("undo_steps") == 1);
    s.last = Some(attract);
    s.seen("kiosk-2-working");
    pause(3600);
    s.seen("kiosk-3-countdown");
}
